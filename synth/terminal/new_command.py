"""A spec to start from, written for a family; in a terminal what is needed is asked for."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from synth.errors import InputError
from synth.folders.files import write_atomically
from synth.question.request_fields import pair
from synth.terminal.options import Family
from synth.terminal.session import tell

Stated = Annotated[
    list[str] | None, typer.Argument(help="Values that are known, by name or symbol.", metavar="[NAME=VALUE]...")
]


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("new")(new)


def new(
    family: Family,
    stated: Stated = None,
    option: Annotated[
        list[str] | None, typer.Option("--option", help="A structural choice, name=value.", metavar="NAME=VALUE")
    ] = None,
    file: Annotated[
        Path | None, typer.Option("--output", "-o", help="The file; without one it is shown.", metavar="FILE.yaml")
    ] = None,
) -> None:
    """Write a commented spec to start from; in a terminal what is needed and not said is asked for."""
    from synth.analysis.describe import described
    from synth.analysis.spec_template import checked_value, needed, spec_template
    from synth.model.registry import load

    if file is not None and file.exists():
        raise InputError("--output", str(file), "a file that is not there yet")
    problem = load(family, **dict(pair("--option", text) for text in option or []))
    rows = {row["name"]: row for row in described(problem) if row["kind"] == "requirement"}
    by_symbol = {row["symbol"]: name for name, row in rows.items() if row["symbol"]}
    values = {}
    for name, value in (pair("NAME=VALUE", text) for text in stated or []):
        own = by_symbol.get(name, name)
        if own not in rows:
            raise InputError("NAME=VALUE", name, f"a requirement of {family}: {', '.join(rows)}")
        values[own] = checked_value(rows[own], value)
    if sys.stdin.isatty() and sys.stdout.isatty():
        for row in needed(described(problem, stated=values)):
            if row["name"] not in values:
                answer = _answer(row)
                values |= {row["name"]: answer} if answer else {}
    text = spec_template(problem, values, "SPEC.yaml" if file is None else str(file))
    if file is None:
        print(text, end="")
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(file, text)
    print(f"written to {file}")
    left = [row["name"] for row in needed(described(problem, stated=values)) if row["name"] not in values]
    if left:
        print(f"to be filled in: {', '.join(left)}")


def _answer(row: Mapping[str, object]) -> str:
    """Ask for a value until it is one; nothing leaves it to be filled in."""
    from synth.analysis.spec_template import checked_value

    shown = f"{row['name']} ({row['symbol']}) in {row['unit']}: {row['text']}"
    while True:
        text = str(typer.prompt(shown, default="", show_default=False)).strip()
        if not text:
            return ""
        try:
            return checked_value(row, text)
        except InputError as error:
            tell(str(error))
