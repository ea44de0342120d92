// What reports/explorer/record.py and comparison.py write, and what model.js makes of it. Read by the checks only.

export type Sense = "min" | "max";

/** A requirement, or what else was asked; a word where it is no number. */
export interface Asked {
  label: string;
  text: string;
  value?: number | null;
  unit: string;
  words?: string;
}

export interface Certificate {
  level: "good" | "open" | "bad";
  word: string;
  sentence: string;
  head: string;
  gap: number | null;
  details: string[];
  combinations: number;
  excluded: number;
  solved: number;
  unresolved: number;
  offered: string[];
  not_part: string[];
}

/** The two sides of a limit: what a design has, and what is allowed. */
export type Sides = [number | null, number | null];

export interface Miss {
  label: string;
  sides: Sides;
  unit: string;
  sign: string;
  by: string;
}

export interface Quantity {
  name: string;
  label: string;
  unit: string;
  kind: "variable" | "count" | "derived";
  text: string;
  symbol: string;
  source: string;
}

export interface Limit {
  name: string;
  label: string;
  unit: string;
  sign: string;
  text: string;
  source: string;
}

export interface Part {
  name: string;
  table: string;
  source: string;
  confidence: string;
  note: string;
}

export interface Family {
  name: string;
  title: string;
  outcome: string;
  why: string;
  file?: string;
  spec?: Record<string, unknown>;
}

export interface Design {
  rank: number;
  score: number | null;
  status: string;
  gap: number | null;
  note: string;
  why: string;
  v: (number | null)[];
  choices: Record<string, string>;
  parts: Record<string, string>;
  used: (number | null)[];
  sides: Sides[];
  spec: Record<string, unknown>;
  at_limit: string[];
  family?: string;
  slopes?: [string, (number | null)[]][];
  prices?: string[];
  remarks?: string[];
  alternatives?: string[];
  group?: number | null;
  near?: string;
  violated?: string[];
  off_grid?: Record<string, string>;
  next?: [string, string][];
  robust?: { verdict: string; yield: number | null; words: string };
  files?: [string, string][];
  drawing?: string;
}

export interface FrontRecord {
  format: number;
  program: string;
  title: string;
  family: string;
  facts: [string, string][];
  objectives: Record<string, Sense>;
  asked: Asked[];
  assumed: Asked[];
  certificate: Certificate;
  nothing: { message: string; conflicts: Miss[]; nearest: [string, string][] } | null;
  families?: Family[];
  quantities: Quantity[];
  limits: Limit[];
  parts: Record<string, Part>;
  spec: Record<string, unknown>;
  designs: Design[];
}

interface ColumnHead {
  key: string;
  label: string;
  unit: string;
  /** what it means */
  text: string;
  varies: boolean;
}

/** A column of numbers, one for each design. */
export interface NumberColumn extends ColumnHead {
  kind: "objective" | "variable" | "count" | "derived" | "robust";
  values: (number | null)[];
}

/** A column of words, one for each design. */
export interface WordColumn extends ColumnHead {
  kind: "word";
  values: string[];
}

export type Column = NumberColumn | WordColumn;

export interface Model {
  record: FrontRecord;
  /** of designs */
  count: number;
  columns: Column[];
  column: (key: string) => Column | undefined;
  /** a column of numbers that a chart has as an axis */
  axis: (key: string) => NumberColumn;
  objectives: NumberColumn[];
  axes: NumberColumn[];
  sizes: NumberColumn[];
  derived: NumberColumn[];
  words: WordColumn[];
  same: Column[];
  groupable: Column[];
  groupBy: string;
  names: string[][];
  knee: number;
}

/** Designs in groups: what these are called, which one each design is of, and which one holds the others. */
export interface Groups {
  names: string[];
  of: number[];
  rest: number;
}

export type Range = [number, number];
export type Point = [number, number];

/** An axis of the parallel coordinates: where it stands, and where on it a value lies, from 0 to 1. */
export interface NumberAxis {
  column: NumberColumn;
  at: number;
  share: (value: number) => number;
  /** the value that lies at a share */
  value: (share: number) => number;
  range: Range;
}

export interface WordAxis {
  column: WordColumn;
  at: number;
  words: string[];
  share: (word: string) => number;
  value: null;
}

export type ParallelAxis = NumberAxis | WordAxis;
