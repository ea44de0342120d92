// Types of what elements are made of, for the explorer and for the pages. Read by the checks only.

/** What is put into an element; texts go in as text. */
export type Child = Node | string | number | null | undefined | false | Child[];

/** A listener; it may say more exactly what it hears. */
export type Listener = { hear(event: Event): void }["hear"];

/** Attributes by name; `onclick` and the like are listeners. */
export type Attributes = Record<string, string | number | boolean | null | undefined | Listener>;

/** An event of an element that is known. */
export type EventOf<T extends EventTarget> = Event & { target: T };
