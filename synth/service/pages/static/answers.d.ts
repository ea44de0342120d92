// What the service answers, made of its description: `make answers`. Read by the checks only.

import type { DeclarationRow, FlatDesign, Progress, Question, Spec, Summary } from "./records.js";

export interface BatchCheck {
  rows: number;
  checked: number;
  bad: number;
  faults: TableFault[];
  more_faults: number;
  families: string[];
  columns: TableColumn[];
  carried: string[];
  unused: Record<string, string[]>;
}

export interface BroughtCatalogue {
  name: string;
  version: number;
  reference: string;
  table: string;
  rows: number;
  digest: string;
  created: number;
  note: string;
  reading: TableReading;
  columns: BroughtColumn[];
  missing: MissingColumns[];
  remarks: string[];
}

export interface BroughtColumn {
  name: string;
  unit: string | null;
  known: boolean;
  meant: string | null;
}

export interface CatalogueAnswer {
  entry: CatalogueEntry;
  csv: string;
  separator: string;
  schema: string;
  used_by: string[];
}

export interface CatalogueDiff {
  before: CatalogueEntry;
  after: CatalogueEntry;
  added: string[];
  removed: string[];
  changed: ChangedCell[];
  columns_added: string[];
  columns_removed: string[];
}

export interface CatalogueEntry {
  name: string;
  version: number;
  reference: string;
  table: string;
  rows: number;
  digest: string;
  created: number;
  note: string;
}

export interface CatalogueList {
  catalogues: CatalogueEntry[];
}

export interface ChangedCell {
  designation: string;
  column: string;
  before: string;
  after: string;
}

export interface CheckAnswer {
  ready: boolean;
  problems: Problem[];
  read: Record<string, string>;
  remarks: Remark[];
  combinations: number | null;
}

export interface ColumnAnswer {
  name: string;
  unit: string | null;
}

export interface DeclarationAnswer {
  name: string;
  title: string;
  sources: string[];
  options: Record<string, string>;
  rows: DeclarationRow[];
}

export interface DesignPage {
  total: number;
  columns: ColumnAnswer[];
  designs: FlatDesign[];
  next: string | null;
}

export interface ExampleAnswer {
  name: string;
  family: string;
  description: string;
  design: boolean;
  spec: Spec;
  text: string;
}

export interface ExampleList {
  examples: ExampleAnswer[];
}

export interface FamilyAnswer {
  name: string;
  title: string;
  line: string;
  sources: string[];
  options: OptionAnswer[];
  understands: string[];
  examples: string[];
}

export interface FamilyList {
  families: FamilyAnswer[];
}

export interface FileAnswer {
  name: string;
  size: number | null;
  href: string;
}

export interface FileList {
  files: FileAnswer[];
}

export interface FirstRow {
  line: number;
  cells: string[];
}

export interface JobAnswer {
  id: string;
  kind: string;
  title: string;
  state: "open" | "running" | "done" | "cancelled" | "failed" | "stopped";
  outcome: string | null;
  progress: Progress | null;
  summary: Summary | null;
  error: JobFault | null;
  families: string[];
  priority: number;
  parent: string | null;
  pinned: boolean;
  rows: number;
  seconds_limit: number | null;
  created: number;
  started: number | null;
  updated: number;
  ended: number | null;
  expires: number | null;
  links: JobLinks;
}

export interface JobFault {
  code: string;
  message: string;
  problems: Problem[];
}

export interface JobLinks {
  self: string;
  request: string;
  result: string;
  designs: string;
  files: string;
  events: string;
  rows: string | null;
}

export interface JobList {
  jobs: JobAnswer[];
  next: string | null;
}

export interface MadeToken {
  id: number;
  prefix: string;
  value: string;
}

export interface MissingColumns {
  family: string;
  slot: string;
  columns: string[];
}

export interface OptionAnswer {
  name: string;
  symbol: string;
  choices: string[];
  default: string;
  text: string;
  source: string;
  group: string;
}

export interface Problem {
  path: (string | number)[];
  value: unknown;
  expected: string;
  message: string;
}

export interface RefusalBody {
  error: RequestRefusal;
}

export interface Remark {
  path: (string | number)[];
  message: string;
}

export interface RequestRefusal {
  code: string;
  message: string;
  problems: Problem[];
  request_id: string;
}

export interface RowAnswer {
  line: number;
  key: string | null;
  family: string;
  status: string;
  designs: number;
  seconds: number | null;
  certificate: string | null;
  gap: number | null;
  best_design: string;
  explanation: string;
  remarks: string;
  cells: string[];
}

export interface RowPage {
  header: string[];
  rows: RowAnswer[];
  next: string | null;
}

export interface RowRecord {
  row: RowAnswer;
  header: string[];
  faults: TableFault[];
  question: Question | null;
  columns: ColumnAnswer[];
  designs: FlatDesign[];
}

export interface SessionAnswer {
  tenant: string;
  scopes: string[];
}

export interface ShippedColumn {
  name: string;
  unit: string | null;
  symbol: string;
  text: string;
  lower: number | null;
  upper: number | null;
}

export interface TableAnswer {
  name: string;
  families: string[];
  columns: ShippedColumn[];
  rows: ((number | string | null)[])[];
}

export interface TableColumn {
  title: string;
  name: string;
}

export interface TableEntry {
  name: string;
  rows: number;
  families: string[];
}

export interface TableFault {
  line: number;
  column: string | null;
  value: unknown;
  expected: string;
  message: string;
}

export interface TableList {
  tables: TableEntry[];
}

export interface TableReading {
  separator: string;
  encoding: string;
  decimal_commas: string[];
}

export interface TokenAnswer {
  id: number;
  name: string;
  prefix: string;
  tenant: string;
  scopes: string[];
  created: number;
  expires: number | null;
  used: number | null;
  revoked: number | null;
}

export interface TokenList {
  tokens: TokenAnswer[];
}

export interface TraceAnswer {
  id: string;
  tenant: string;
  kind: string;
  state: string;
  rows: number;
  created: number;
  started: number | null;
  ended: number | null;
}

export interface TraceList {
  jobs: TraceAnswer[];
  next: string | null;
}

export interface UploadAnswer {
  id: string;
  name: string;
  size: number;
  digest: string;
  expires: number;
  reading: string;
  header: string[];
  rows: FirstRow[];
}

export interface VersionAnswer {
  version: string;
  interface: string;
  database: string;
  python: string;
}

/** Answer to GET of an address. */
export type GetAnswer<P extends string> =
  P extends `/catalogues/${string}/${string}/changes` | `/catalogues/${string}/${string}/changes?${string}` ? CatalogueDiff :
  P extends `/jobs/${string}/files/${string}` | `/jobs/${string}/files/${string}?${string}` ? unknown :
  P extends `/jobs/${string}/rows/${string}` | `/jobs/${string}/rows/${string}?${string}` ? RowRecord :
  P extends `/catalogues/${string}/${string}` | `/catalogues/${string}/${string}?${string}` ? CatalogueAnswer :
  P extends `/jobs/${string}/designs` | `/jobs/${string}/designs?${string}` ? DesignPage :
  P extends `/jobs/${string}/events` | `/jobs/${string}/events?${string}` ? unknown :
  P extends `/jobs/${string}/files` | `/jobs/${string}/files?${string}` ? FileList :
  P extends `/jobs/${string}/request` | `/jobs/${string}/request?${string}` ? Spec :
  P extends `/jobs/${string}/result` | `/jobs/${string}/result?${string}` ? unknown :
  P extends `/jobs/${string}/rows` | `/jobs/${string}/rows?${string}` ? RowPage :
  P extends `/tenants/jobs` | `/tenants/jobs?${string}` ? TraceList :
  P extends `/families/${string}` | `/families/${string}?${string}` ? DeclarationAnswer :
  P extends `/jobs/${string}` | `/jobs/${string}?${string}` ? JobAnswer :
  P extends `/tables/${string}` | `/tables/${string}?${string}` ? TableAnswer :
  P extends `/catalogues` | `/catalogues?${string}` ? CatalogueList :
  P extends `/events` | `/events?${string}` ? unknown :
  P extends `/examples` | `/examples?${string}` ? ExampleList :
  P extends `/families` | `/families?${string}` ? FamilyList :
  P extends `/jobs` | `/jobs?${string}` ? JobList :
  P extends `/session` | `/session?${string}` ? SessionAnswer :
  P extends `/tables` | `/tables?${string}` ? TableList :
  P extends `/tokens` | `/tokens?${string}` ? TokenList :
  P extends `/version` | `/version?${string}` ? VersionAnswer :
  unknown;

/** Answer to POST of an address. */
export type PostAnswer<P extends string> =
  P extends `/jobs/${string}/cancel` | `/jobs/${string}/cancel?${string}` ? JobAnswer :
  P extends `/jobs/${string}/resume` | `/jobs/${string}/resume?${string}` ? JobAnswer :
  P extends `/batches/check` | `/batches/check?${string}` ? BatchCheck :
  P extends `/batches` | `/batches?${string}` ? JobAnswer :
  P extends `/catalogues` | `/catalogues?${string}` ? BroughtCatalogue :
  P extends `/check` | `/check?${string}` ? CheckAnswer :
  P extends `/evaluate` | `/evaluate?${string}` ? unknown :
  P extends `/jobs` | `/jobs?${string}` ? JobAnswer :
  P extends `/session` | `/session?${string}` ? SessionAnswer :
  P extends `/tokens` | `/tokens?${string}` ? MadeToken :
  P extends `/uploads` | `/uploads?${string}` ? UploadAnswer :
  unknown;

export interface PricesQuestion {
  of: string;
  family?: string;
  design?: number | number[];
  step?: number | string;
  time_limit?: number | string;
}

export interface NearEqualsQuestion {
  of: string;
  family?: string;
  design?: number;
  within?: number | string;
  count?: number;
  seed?: number;
  time_limit?: number | string;
}

export interface VerifyQuestion {
  of: string;
  family?: string;
  time_limit?: number | string;
}

export interface ReportQuestion {
  of: string;
  family?: string;
  design?: string | number | (string | number)[];
  full?: number;
  formats?: "html" | "explorer" | "pdf" | "xlsx" | "json" | "svg" | "dxf" | ("html" | "explorer" | "pdf" | "xlsx" | "json" | "svg" | "dxf")[];
  length?: "summary" | "normal" | "full";
  about?: Record<string, string>;
}

export interface SizeRangeQuestion {
  of: string;
  variants?: number;
  objective?: string;
  per_row?: string[];
  candidates?: number;
  gap?: number;
  time_limit?: number | string;
}

/** Requests about the result of a job, by kind. */
export interface Requests {
  prices: PricesQuestion;
  near_equals: NearEqualsQuestion;
  verify: VerifyQuestion;
  report: ReportQuestion;
  size_range: SizeRangeQuestion;
}
