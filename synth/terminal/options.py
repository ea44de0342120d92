"""Arguments and options that several commands share, and those that come from the records of the verbs."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Concatenate, ParamSpec, TypeVar

import typer

from synth.question.request_fields import FIELDS, RequestField
from synth.text.notices import ignore_notices
from synth.text.numbers import typed_number
from synth.verbs.request import VerbRequest, as_flag, shared
from synth.verbs.requests import BatchRequest, ExplainRequest, WhatIfRequest

P = ParamSpec("P")
Asked = TypeVar("Asked", bound=VerbRequest)


def option(record: RequestField, **other: Any) -> Any:
    """Option of the command line for a field of a request; ``other`` as for ``typer.Option``."""
    words = {"metavar": record.metavar, "help": _help(record), **other}
    if record.unit == "s" and record.usual is not None:
        words["show_default"] = f"{typed_number(record.usual)} s"
    if record.typed is not None:
        words |= {"metavar": record.typed.metavar, "help": record.typed.help}
    return typer.Option(record.flag or flag_of(record), **words)


def flag_of(record: RequestField) -> str:
    """Option of a field in messages."""
    return as_flag(record.name) if record.typed is None else record.typed.flag


def _help(record: RequestField) -> str:
    """Help in one line; a list is given by repeating its option."""
    text = record.help.replace("`", "")
    return text if record.value.option not in (list[int], list[str]) or "repeat" in text else f"{text[:-1]}; repeat it."


def takes(request: type[Asked]) -> Callable[[Callable[Concatenate[Asked, P], None]], Callable[..., None]]:
    """Command whose options are the fields of a request; its first argument is the request that they state.

    Those that it needs come behind what the command is about, the others behind where its results go.
    """

    def decorated(command: Callable[Concatenate[Asked, P], None]) -> Callable[..., None]:
        fields = {name: record for name, record in request.fields().items() if record.option is not None}

        def run(*args: P.args, **values: P.kwargs) -> None:
            stated = {name: value for name in fields if (value := values.pop(name)) != []}
            command(request.read(stated, lambda name: flag_of(fields[name]), typed=True), *args, **values)

        own = list(inspect.signature(command, eval_str=True).parameters.values())[1:]
        for place, needed in ((FOLDER, False), (ABOUT, True)):
            behind = 1 + max((k for k, one in enumerate(own) if one.name in place), default=-1)
            own[behind:behind] = [_parameter(one) for one in fields.values() if bool(one.needed) is needed]
        run.__signature__ = inspect.Signature(own)  # type: ignore[attr-defined]
        run.__annotations__ = {one.name: one.annotation for one in own}
        run.__name__, run.__doc__, run.__module__ = command.__name__, command.__doc__, command.__module__
        return run

    return decorated


ABOUT = ("source", "spec", "rows")
FOLDER = (*ABOUT, "folder")


def _parameter(record: RequestField) -> inspect.Parameter:
    required = bool(record.needed)
    typed = record.option if required or record.usual is not None else record.option | None
    annotation = Annotated.__class_getitem__((typed, option(record)))  # type: ignore[attr-defined]
    default = inspect.Parameter.empty if required else record.usual
    return inspect.Parameter(record.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _families(begun: str) -> list[str]:
    from synth.model.registry import families

    return [name for name in families() if name.startswith(begun)]


def _without_notices(quiet: bool) -> bool:
    if quiet:
        ignore_notices()
    return quiet


Family = Annotated[
    str, typer.Argument(help="Name of a family.", metavar="FAMILY", autocompletion=_families, show_default=False)
]
SpecFile = Annotated[Path, typer.Argument(help="A spec, YAML or JSON.", metavar="SPEC.yaml")]
FrontFolder = Annotated[Path, typer.Argument(help="A folder that run has written.", metavar="DIR")]


@dataclass(frozen=True, kw_only=True)
class SearchOptions(VerbRequest):
    """Options of a search, each in place of the key of the spec."""

    points: int | None = shared(FIELDS["points"], usual=None)
    gap: float | None = shared(FIELDS["gap"], usual=None)
    grid: bool | None = shared(FIELDS["grid"], usual=None)
    seed: int | None = shared(FIELDS["seed"], usual=None)
    time_limit: float | None = shared(FIELDS["time_limit"])
    workers: int | None = shared(FIELDS["workers"], usual=None)
    objectives: Any = shared(FIELDS["objectives"])

    def of_spec(self) -> dict[str, Any]:
        """Entries of a spec that are stated."""
        return {name: value for name, value in self.to_json().items() if name in FIELDS}


@dataclass(frozen=True, kw_only=True)
class WhatIfOptions(SearchOptions):
    """Options of a study."""

    points: int | None = shared(
        FIELDS["points"], usual=None, help="At most this many designs per step; 3 unless the spec says otherwise."
    )
    time_limit: float | None = shared(
        FIELDS["time_limit"], help="Stop after this time for all steps, in seconds or such as '2 min'."
    )
    vary: Mapping[str, Any] = shared(WhatIfRequest.fields()["vary"])
    breaks: bool = shared(WhatIfRequest.fields()["breaks"])


@dataclass(frozen=True, kw_only=True)
class ExplainOptions(ExplainRequest):
    """Options of a way out."""

    time_limit: float | None = shared(FIELDS["time_limit"])


# Without -o a result is shown and nothing is written; of a table that is worked off the result is files, see session.
Folder = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Folder for the results; without one nothing is written.", metavar="DIR"),
]
RowsFolder = Annotated[
    Path | None,
    typer.Option(
        "--output", "-o", help="Folder for the results; by default ROWS_batch beside the table.", metavar="DIR"
    ),
]
RowFamily = Annotated[str | None, option(BatchRequest.fields()["family"])]
Headings = Annotated[
    Path | None, typer.Option(help="YAML: headings of the table and the names they stand for.", metavar="FILE")
]
RowPoints = Annotated[int, option(BatchRequest.fields()["points"])]
Encoding = Annotated[
    str | None, typer.Option(help="Of CSV files where it is not recognised, such as cp1250.", metavar="NAME")
]
VisibleRows = Annotated[bool, typer.Option("--visible-rows", help="Leave out hidden and filtered rows of workbooks.")]
Plot = Annotated[bool, typer.Option("--plot", help="Draw the front here, and with -o into front.svg as well.")]
Csv = Annotated[
    str, typer.Option("--csv", help="How CSV is written: en, or de (semicolons, decimal commas).", metavar="en|de")
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Show nothing; files and exit code tell.", callback=_without_notices)
]
