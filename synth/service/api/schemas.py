"""What goes over the interface: bodies of requests, each with an example that a test runs, and of answers."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict

from synth.kinds import KINDS
from synth.service.api.asking import LONGEST
from synth.service.errors import Problem
from synth.service.wording import LINE, TITLE, WORD

# Bodies to begin with. They name families, which the programs do not.
EXAMPLES: dict[str, Any] = json.loads((files("synth.service.api") / "examples.json").read_text(encoding="utf-8"))

Words = Annotated[str, Field(max_length=LONGEST, pattern=WORD)]
Line = Annotated[str, Field(max_length=LONGEST, pattern=LINE)]
Title = Annotated[str, Field(min_length=1, max_length=LONGEST, pattern=TITLE)]


def _example(body: JsonDict) -> ConfigDict:
    return ConfigDict(extra="forbid", strict=True, json_schema_extra={"examples": [body]})


# ---- families -------------------------------------------------------------------------------------------------------


class OptionAnswer(BaseModel):
    """An option of a family."""

    name: str
    symbol: str
    choices: list[str]
    default: str
    text: str
    source: str
    group: str


class FamilyAnswer(BaseModel):
    """A family that can be asked."""

    name: str
    title: str
    line: str
    sources: list[str]
    options: list[OptionAnswer]
    understands: list[str]
    examples: list[str]


class FamilyList(BaseModel):
    """All families."""

    families: list[FamilyAnswer]


class DeclarationAnswer(BaseModel):
    """What a family declares: a row for everything that has a name; `section` tells where a form shows it."""

    name: str
    title: str
    sources: list[str]
    options: dict[str, str]
    rows: list[dict[str, Any]]


class ExampleAnswer(BaseModel):
    """An example: a spec, as JSON and as it was written."""

    name: str
    family: str
    description: str
    design: bool
    spec: dict[str, Any]
    text: str


class ExampleList(BaseModel):
    """The examples of all families."""

    examples: list[ExampleAnswer]


class Remark(BaseModel):
    """What is no fault, and perhaps not meant."""

    path: list[str | int]
    message: str


class CheckAnswer(BaseModel):
    """What is wrong with a spec, and how it is understood."""

    ready: bool
    problems: list[Problem]
    read: dict[str, str]
    remarks: list[Remark]
    combinations: int | None


# ---- jobs -----------------------------------------------------------------------------------------------------------


class JobRequest(BaseModel):
    """What is asked as a job."""

    model_config = _example({"kind": "synthesis", "request": EXAMPLES["spec"], "title": "Lifting drive"})

    kind: str = Field(json_schema_extra={"enum": list(KINDS)}, description="What is wanted.")
    request: dict[str, Any] = Field(description="A spec, or what the kind takes; `of` names an earlier job.")
    title: Title | None = Field(None, description="For people; by default made of the request.")
    parent: Words | None = Field(None, description="Id of the job that it follows from.")
    priority: int | None = Field(None, ge=0, le=1, description="0 lets it wait behind what others wait for.")
    seconds_limit: float | None = Field(None, gt=0, le=1e9, description="In s, after which it is stopped.")


class JobChange(BaseModel):
    """What may be changed of a job."""

    model_config = _example({"title": "Lifting drive, second try", "pinned": True})

    title: Title | None = None
    pinned: bool | None = Field(None, description="Whether it is kept for good.")


class JobLinks(BaseModel):
    """Where the rest of a job is."""

    self: str
    request: str
    result: str
    designs: str
    files: str
    events: str
    rows: str | None


class JobFault(BaseModel):
    """Why a job has no result."""

    code: str
    message: str
    problems: list[Problem] = []


class JobAnswer(BaseModel):
    """A job. Times are seconds since 1970."""

    id: str
    kind: str
    title: str
    state: str = Field(json_schema_extra={"enum": ["open", "running", "done", "cancelled", "failed", "stopped"]})
    outcome: str | None = Field(
        description="How its question stands: optimal, feasible, infeasible, not_found, not_solved."
    )
    progress: dict[str, Any] | None
    summary: dict[str, Any] | None
    error: JobFault | None
    families: list[str]
    priority: int
    parent: str | None
    pinned: bool
    rows: int
    seconds_limit: float | None
    created: float
    started: float | None
    updated: float
    ended: float | None
    expires: float | None
    links: JobLinks


class JobList(BaseModel):
    """A page of jobs, the latest first."""

    jobs: list[JobAnswer]
    next: str | None = Field(description="The cursor of the next page, where there is one.")


class TraceAnswer(BaseModel):
    """That there is a job, and whose. Times are seconds since 1970."""

    id: str
    tenant: str
    kind: str
    state: str
    rows: int = Field(description="Of a batch; 0 of all else.")
    created: float
    started: float | None
    ended: float | None


class TraceList(BaseModel):
    """A page of the jobs of all tenants, the latest first."""

    jobs: list[TraceAnswer]
    next: str | None = Field(description="The cursor of the next page, where there is one.")


class ColumnAnswer(BaseModel):
    """A column of designs."""

    name: str
    unit: str | None


class DesignPage(BaseModel):
    """A page of designs as flat rows: values by column, in the units of the columns."""

    total: int = Field(description="Designs that fit the condition.")
    columns: list[ColumnAnswer]
    designs: list[dict[str, Any]]
    next: str | None


class FileAnswer(BaseModel):
    """A file of a job; `size` is known before it is made only of those that are kept."""

    name: str
    size: int | None
    href: str


class FileList(BaseModel):
    """The files of a job."""

    files: list[FileAnswer]


class RowAnswer(BaseModel):
    """A row of a batch, and what became of it."""

    line: int
    key: str | None
    family: str
    status: str
    designs: int
    seconds: float | None
    certificate: str | None
    gap: float | None
    best_design: str
    explanation: str
    remarks: str
    cells: list[str]


class RowPage(BaseModel):
    """A page of the rows of a batch, in the order of the table."""

    header: list[str]
    rows: list[RowAnswer]
    next: str | None


class RowRecord(BaseModel):
    """A row of a batch in full: what it asks, its faults, and its designs as far as they are kept."""

    row: RowAnswer
    header: list[str]
    faults: list[dict[str, Any]]
    question: dict[str, Any] | None
    columns: list[ColumnAnswer]
    designs: list[dict[str, Any]]


# ---- tables ---------------------------------------------------------------------------------------------------------


class FirstRow(BaseModel):
    """One of the first rows of a file."""

    line: int
    cells: list[str]


class UploadAnswer(BaseModel):
    """A file that was brought for a batch."""

    id: str
    name: str
    size: int
    digest: str
    expires: float
    reading: str = Field(description="How it is read, if not as is expected: encoding, sheet, hidden rows, ...")
    header: list[str]
    rows: list[FirstRow]


class TableColumn(BaseModel):
    """A column of a table of requirements, and what it is understood as; nothing where it is carried along."""

    title: str
    name: str


class TableFault(BaseModel):
    """What is wrong in a line of a table."""

    line: int
    column: str | None
    value: Any = None
    expected: str
    message: str


class BatchCheck(BaseModel):
    """What a table says, and which rows cannot be asked."""

    rows: int
    checked: int
    bad: int
    faults: list[TableFault]
    more_faults: int
    families: list[str]
    columns: list[TableColumn]
    carried: list[str]
    unused: dict[str, list[str]]


class CatalogueRequest(BaseModel):
    """A version of a part table."""

    model_config = _example(EXAMPLES["catalogue"])

    name: str = Field(min_length=1, max_length=60, description="By which questions name it: `my_linings@3`.")
    table: Words = Field("", description="The table of a family that it is rows for; by default its name.")
    csv: str = Field("", description="The rows, as text.")
    upload: str = Field("", description="Instead of text: the id of a file, CSV in any encoding or an .xlsx workbook.")
    sheet: Words = Field("", description="Which sheet of a workbook; by default the first with designations.")
    schema_: str = Field("", alias="schema", description="What its columns are, where the table is none of ours.")
    note: Line = ""


class CatalogueEntry(BaseModel):
    """A version of a part table as lists show it."""

    name: str
    version: int
    reference: str
    table: str
    rows: int
    digest: str
    created: float
    note: str


class TableReading(BaseModel):
    """How the text of a table is written, as it was recognised."""

    separator: str = Field(description="Between the columns.")
    encoding: str
    decimal_commas: list[str] = Field(description="Headings of the columns whose numbers have them.")


class BroughtColumn(BaseModel):
    """A column of a part table that was brought."""

    name: str
    unit: str | None
    known: bool = Field(description="Whether families, or the schema that came with it, know the name.")
    meant: str | None = Field(description="Of one that is not known: which known name it looks like.")


class MissingColumns(BaseModel):
    """What a slot of a family cannot do without and a table lacks, with the options as they are by default."""

    family: str
    slot: str
    columns: list[str]


class BroughtCatalogue(CatalogueEntry):
    """A version of a part table that was brought, and how it was understood."""

    reading: TableReading
    columns: list[BroughtColumn]
    missing: list[MissingColumns]
    remarks: list[str] = Field(description="What of this is not as it should be, in sentences.")


class CatalogueList(BaseModel):
    """All versions of all part tables that you have brought."""

    catalogues: list[CatalogueEntry]


class CatalogueAnswer(BaseModel):
    """A version of a part table in full, and the jobs that name it."""

    entry: CatalogueEntry
    csv: str
    separator: str = Field(description="Between the columns of `csv`.")
    schema_: str = Field(alias="schema")
    used_by: list[str]


class ChangedCell(BaseModel):
    """A cell that differs between two versions."""

    designation: str
    column: str
    before: str
    after: str


class CatalogueDiff(BaseModel):
    """What is different between two versions of a part table: rows by designation."""

    before: CatalogueEntry
    after: CatalogueEntry
    added: list[str]
    removed: list[str]
    changed: list[ChangedCell]
    columns_added: list[str]
    columns_removed: list[str]
