// What engines write and the description of the service leaves open: facts of jobs, rows of declarations, results.
// tests/service/test_answers.py compares it with what they write. Read by the checks only.

import type { JobAnswer } from "./answers.js";

export type Cell = string | number | null;

/** A value that JSON holds. */
export type Json = string | number | boolean | null | undefined | Json[] | { [name: string]: Json };

/** A row of `synth.describe`; `section` says where a form shows it. */
export interface DeclarationRow {
  kind: string;
  name: string;
  symbol: string;
  unit: string;
  default: Cell;
  lower: number | null;
  upper: number | null;
  choices: string;
  optional: boolean;
  sense: string;
  text: string;
  source: string;
  classification: string;
  group: string;
  section: string;
}

/** A spec, or what else a job was asked. */
export interface Spec {
  [key: string]: Json;
  family?: string | (string | { [key: string]: Json; family: string })[];
  of?: string;
  options?: Record<string, string>;
  requirements?: Record<string, string | number>;
  objectives?: string[] | Record<string, string> | null;
  weights?: Record<string, number>;
  limits?: Record<string, string>;
  fix?: Record<string, Json>;
  parts?: Record<string, Json>;
  points?: number | string;
}

/** What a row of a batch asks. */
export interface Question {
  [key: string]: Json;
  family: string;
  options: Record<string, string>;
}

/** A design as a flat row: values by column. */
export interface FlatDesign {
  [column: string]: Cell;
  rank: number;
  note: string;
}

/** How far a job is: of a search its stage, of a batch its rows. */
export interface Progress {
  stage?: string;
  done?: number;
  combinations?: number;
  incumbents?: number;
  message?: string;
  columns?: string[];
  points?: number[][];
  rows?: number;
  bad?: number;
  status?: Record<string, number>;
}

/** Facts of a result, for lists; which there are depends on the kind of the job. */
export interface Summary {
  outcome?: string;
  family?: string;
  certificate?: string;
  interrupted?: string;
  message?: string;
  sentence?: string;
  objective?: string;
  unit?: string;
  step?: string | number;
  designs?: number;
  asked?: number;
  ways?: number;
  steps?: number;
  feasible_steps?: number;
  breaks?: number;
  rated?: number;
  holding?: number;
  rows?: number;
  variants?: number;
  total_excess?: number;
  complete?: boolean;
  files?: string[];
  notes?: string[];
  status?: Record<string, number>;
}

/** What happens to jobs, as `listen` passes it on; of a snapshot the job. */
export interface Happening extends Progress {
  job: string;
  state: JobAnswer["state"] | "deleted";
  outcome: string | null;
}

/** study.json */
export interface Study {
  objectives: Record<string, string>;
  units: Record<string, string>;
  varied: { label: string; unit: string }[];
  along: number | null;
  steps: Step[];
  breaks: Break[];
  interrupted: string;
}

export interface Step {
  number: number;
  values: (string | number | string[])[];
  status: string;
  reason: string;
  front: { designs: unknown[] } | null;
}

export interface Break {
  objective: string;
  value: number;
  kind: string;
  change: string;
  before: unknown;
  proven: boolean;
}

/** Values by section of a spec: what changes in it. */
export type Patch = Record<string, Record<string, string | number>>;

/** explanation.json */
export interface Explanation {
  feasible: boolean;
  message: string;
  conflict: string[];
  minimal: boolean;
  ways: Way[];
  not_settled: string[];
  interrupted: string;
}

export interface Way {
  kind: string;
  name: string;
  proven: boolean;
  sentence: string;
  patch: Patch;
}

/** front.json */
export interface Front {
  objectives: Record<string, string>;
  certificate: { kind: string; gap: number | null; combinations?: number; excluded_by_bound?: number; solved?: number } | null;
  explanation: { message: string; conflicts: { sentence: string }[] } | null;
  interrupted: string;
}

/** verification.json */
export interface Verification {
  holds: boolean;
  verdict: string;
  sentence: string;
  certificate: string;
  designs: number;
  claimed_gap: number | null;
  proven_gap: number | null;
  nodes: number;
  seconds: number;
  findings: string[];
  open: string[];
}

/** size_range.json */
export interface SizeRange {
  variants: number;
  fewest: number;
  fewest_proven: boolean;
  objective: string;
  unit: string;
  total_excess: number;
  gap: number;
}
