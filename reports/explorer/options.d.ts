// What a page that shows the explorer may say, and what it holds in its hands. Read by the checks only.

import type { Design, FrontRecord } from "./record.js";

export interface Download {
  label: string;
  /** of the same host */
  href?: string;
  /** name of the file */
  download?: string;
  /** in place of an address */
  run?: (design: Design) => void;
}

/** What whoever mounts the explorer may say; all of it may be left out. */
export interface Options {
  /** what the panel offers beside DESIGN.yaml */
  downloads?: (design: Design) => Download[];
  /** the drawing of a design, as SVG, that the record does not hold */
  picture?: (design: Design) => Promise<string>;
  /** fills the strip below the scatter, once: it stays the same element whatever is shown */
  whatIf?: (slot: HTMLElement, handle: Handle) => void;
  /** fills the place for ways out where nothing is feasible */
  ways?: (slot: HTMLElement, handle: Handle) => void;
  /** fills the corner beside the title */
  actions?: (slot: HTMLElement, handle: Handle) => void;
  /** text of an earlier state, as `onState` told it */
  state?: string;
  /** is told the state after every change, for an address */
  onState?: (text: string) => void;
  /** is told which design is shown */
  onSelect?: (design: Design | null) => void;
  /** false where the page has a title of its own */
  heading?: boolean;
}

/** What a page holds in its hands. */
export interface Handle {
  /** shows another record; axes, colours and the chosen parts stay */
  update: (record: FrontRecord) => void;
  /**
   * draws the designs of another record as outlines; where the record that is shown has no design, on the axes of the
   * other
   */
  compareWith: (record: FrontRecord | null) => void;
  select: (rank: number) => void;
  /** the design that is shown */
  selected: () => Design | null;
  state: () => string;
  destroy: () => void;
}
