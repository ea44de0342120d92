"""Arguments and options that several commands share, and those that come from the records of the verbs."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Concatenate, ParamSpec, TypeVar

import typer

from synth.errors import InputError
from synth.question.request_fields import FIELDS, RequestField, ValueKind
from synth.terminal.session import pair
from synth.text.notices import ignore_notices
from synth.text.numbers import typed_number
from synth.verbs.request import VerbRequest, as_flag, shared
from synth.verbs.requests import BatchRequest, WhatIfRequest

P = ParamSpec("P")
Asked = TypeVar("Asked", bound=VerbRequest)


def option(record: RequestField, **other: Any) -> Any:
    """Option of the command line for a field of a request; ``other`` as for ``typer.Option``."""
    words = {"metavar": record.metavar, "help": _help(record), **other}
    if record.unit == "s" and record.usual is not None:
        words["show_default"] = f"{typed_number(record.usual)} s"
    return typer.Option(record.flag or as_flag(record.name), **words)


def _help(record: RequestField) -> str:
    """Help in one line; a list is given by repeating its option."""
    text = record.help.replace("`", "")
    return text if record.value.option not in (list[int], list[str]) or "repeat" in text else f"{text[:-1]}; repeat it."


def takes(request: type[Asked]) -> Callable[[Callable[Concatenate[Asked, P], None]], Callable[..., None]]:
    """Command whose options are the fields of a request; its first argument is the request that they state.

    They come behind what the command is about and where its results go.
    """

    def decorated(command: Callable[Concatenate[Asked, P], None]) -> Callable[..., None]:
        fields = {name: record for name, record in request.fields().items() if record.value.option is not None}

        def run(*args: P.args, **values: P.kwargs) -> None:
            stated = {name: value for name in fields if (value := values.pop(name)) != []}
            command(request.read(stated, as_flag), *args, **values)

        own = list(inspect.signature(command, eval_str=True).parameters.values())[1:]
        behind = 1 + max(k for k, one in enumerate(own) if one.name in ABOUT)
        every = [*own[:behind], *map(_parameter, fields.values()), *own[behind:]]
        run.__signature__ = inspect.Signature(every)  # type: ignore[attr-defined]
        run.__annotations__ = {one.name: one.annotation for one in every}
        run.__name__, run.__doc__, run.__module__ = command.__name__, command.__doc__, command.__module__
        return run

    return decorated


ABOUT = ("source", "spec", "rows", "vary", "folder")


def _parameter(record: RequestField) -> inspect.Parameter:
    typed = record.value.option if record.usual is not None else record.value.option | None
    annotation = Annotated.__class_getitem__((typed, option(record)))  # type: ignore[attr-defined]
    return inspect.Parameter(record.name, inspect.Parameter.KEYWORD_ONLY, default=record.usual, annotation=annotation)


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


def _objectives(where: str, texts: list[str]) -> list[str] | dict[str, str]:
    """Objectives from repeated options: names, or names with min or max."""
    if not any("=" in text for text in texts):
        return texts
    pairs = [pair(where, text) if "=" in text else (text, "") for text in texts]
    unsaid = next((name for name, sense in pairs if not sense), None)
    if unsaid is not None:
        raise InputError(where, unsaid, f"{unsaid}=min or {unsaid}=max: all objectives with a sense, or none")
    return dict(pairs)


OBJECTIVE = replace(
    FIELDS["objectives"],
    value=ValueKind({}, _objectives, list[str]),
    help="An objective, name or name=min or name=max; repeat it.",
    flag="--objective",
    metavar="NAME[=SENSE]",
)


@dataclass(frozen=True, kw_only=True)
class SearchOptions(VerbRequest):
    """Options of a search, each in place of the key of the spec."""

    points: int | None = shared(FIELDS["points"], usual=None)
    gap: float | None = shared(FIELDS["gap"], usual=None)
    grid: bool | None = shared(FIELDS["grid"], usual=None)
    seed: int | None = shared(FIELDS["seed"], usual=None)
    time_limit: float | None = shared(FIELDS["time_limit"])
    workers: int | None = shared(FIELDS["workers"], usual=None)
    objectives: Any = shared(OBJECTIVE)

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
    breaks: bool = shared(WhatIfRequest.fields()["breaks"])


@dataclass(frozen=True, kw_only=True)
class RowsOptions(BatchRequest):
    """Options of a batch."""

    objectives: Any = shared(OBJECTIVE)


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
TimeLimit = Annotated[str | None, option(FIELDS["time_limit"])]
Plot = Annotated[bool, typer.Option("--plot", help="Draw the front here, and with -o into front.svg as well.")]
Csv = Annotated[
    str, typer.Option("--csv", help="How CSV is written: en, or de (semicolons, decimal commas).", metavar="en|de")
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Show nothing; files and exit code tell.", callback=_without_notices)
]
