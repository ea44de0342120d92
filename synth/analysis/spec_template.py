"""A spec to start from: everything that a family asks for, with what it means, and what stands if nothing is said."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from synth.analysis.describe import described
from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.question.settings import SearchSettings
from synth.text.numbers import FULL_DIGITS, number_text
from synth.units import parse_quantity, to_si

WIDTH = 100  # of a line with its comment; a longer comment stands on lines of its own above
COLUMN = 34  # where comments begin, if there is room
Row = Mapping[str, Any]


def needed(rows: Iterable[Row]) -> list[Row]:
    """Return the requirements of a description that a spec must state."""
    return [row for row in rows if row["kind"] == "requirement" and row["default"] is None and not row["optional"]]


def checked_value(row: Row, text: str) -> str:
    """Value of a requirement in the words of the user, once it was read as one.

    Raises
    ------
    InputError
        It is no quantity of its kind, or out of its range.
    """
    field, unit = f"requirement {row['name']}", row["unit"]
    value = parse_quantity(text, unit, field)
    low, high = (to_si(float(row[end]), unit) if math.isfinite(row[end]) else row[end] for end in ("lower", "upper"))
    if value < low or value > high:
        raise InputError(field, text, f"a value of {_range(row)} {unit}", ("requirements", row["name"]))
    return " ".join(text.split())


def spec_template(problem: DesignProblem, values: Mapping[str, str], file: str = "SPEC.yaml") -> str:
    """Return a commented spec of a family as YAML.

    Parameters
    ----------
    problem : DesignProblem
        Options that differ from their default are written.
    values : mapping
        Requirement -> value with its unit; needed requirements without one stay blank.
    file : str
        The name it will have, for the command that it shows.

    Returns
    -------
    str
        Everything else stands in comments, so that the question is the same as without it.
    """
    rows = described(problem, stated=values)
    of = {kind: [row for row in rows if row["kind"] == kind] for kind in ("option", "requirement", "objective")}
    sizes = [row for row in rows if row["kind"] in ("variable", "count", "choice")]
    slots = [row for row in rows if row["kind"] == "slot"]
    defaults = [row["name"] for row in of["objective"] if row["default"] == "yes"]
    others = [row["name"] for row in of["objective"] if row["default"] != "yes"]
    lines = [
        f"# {problem.title}: a spec to start from.",
        "#",
        f"#     clutchsynth run {file} -o out/",
        "#",
        "# Numbers carry their unit; a bare number is in the unit that is shown. What is commented out",
        "# stands so if nothing is said.",
        f"family: {problem.name}",
        "",
        "requirements:",
        *_requirements(of["requirement"], values),
        *_options(of["option"], problem.options),
        "",
        "# What to make small or large.",
        *_entry("objectives", f"[{', '.join(defaults)}]", f"also: {', '.join(others)}" if others else "", indent=0),
        *_entry("points", str(SearchSettings().points), "at most so many designs; fewer if no more exist", indent=0),
        "",
        "# Bounds on anything that is computed:",
        f'# limits: {{{defaults[0] if defaults else "mass"}: "<= ..."}}',
        "",
        "# Sizes and counts that are given; the search finds the others.",
        "# fix:",
        *(line for row in sizes for line in _entry(row["name"], _example(row), _meaning(row, _span(row)), off=True)),
    ]
    if slots:
        lines += [
            "",
            "# Parts that are given, by designation; the search chooses among the rows otherwise.",
            "# parts:",
        ]
        lines += [line for row in slots for line in _entry(row["name"], "...", _meaning(row, _table(row)), off=True)]
    return "\n".join(lines) + "\n"


def _options(rows: Sequence[Row], chosen: Mapping[str, str]) -> list[str]:
    if not rows:
        return []
    changed = {row["name"] for row in rows if chosen.get(row["name"], row["default"]) != row["default"]}
    lines = ["options:" if changed else "# options:"]
    for row in rows:
        value = chosen.get(row["name"], row["default"])
        lines += _entry(
            row["name"], str(value), _meaning(row, f"one of {row['choices']}"), off=row["name"] not in changed
        )
    return ["", *lines]


def _requirements(rows: Sequence[Row], values: Mapping[str, str]) -> list[str]:
    must = [row["name"] for row in needed(rows)]
    first = [row for row in rows if row["name"] in must or row["name"] in values]
    lines = ["  # the duty: needed" if must else "  # the duty"]
    for row in first:
        lines += _entry(row["name"], values.get(row["name"], ""), _meaning(row, f"{_range(row)} {row['unit']}"))
    groups: dict[str, list[Row]] = {}
    for row in rows:
        if row not in first:
            groups.setdefault(row["group"], []).append(row)
    for group, others in groups.items():
        lines += ["", f"  # {group or 'others'}"]
        for row in others:
            value, follows = _default(row)
            lines += _entry(row["name"], value, _meaning(row, follows), off=True)
    return lines


def _entry(name: str, value: str, comment: str, indent: int = 2, off: bool = False) -> list[str]:
    """Return a line with its comment beside it, or above it where there is no room."""
    start = f"{' ' * indent}{'# ' if off else ''}{name}: {value}".rstrip()
    commented = f"{start:{COLUMN}}  # {comment}" if comment else start
    if len(commented) <= WIDTH:
        return [commented]
    lines, words = [""], comment.split()
    for word in words:
        if len(lines[-1]) + len(word) > WIDTH - indent - 4:
            lines.append("")
        lines[-1] += f" {word}"
    return [*(f"{' ' * indent}#{line}" for line in lines), start]


def _meaning(row: Row, more: str) -> str:
    if more.startswith(("by default", "not asked", "follows")) and "by default" in row["text"]:
        more = ""
    return "; ".join(text for text in (row["text"], more) if text)


def _range(row: Row) -> str:
    return " .. ".join(number_text(row[end], FULL_DIGITS) for end in ("lower", "upper") if math.isfinite(row[end]))


def _span(row: Row) -> str:
    return row["choices"] or f"{_range(row)} {row['unit']}".strip()


def _table(row: Row) -> str:
    return str(row["choices"]).split(" where ")[0]


def _example(row: Row) -> str:
    return f"... {row['unit']}" if row["kind"] == "variable" else "..."


def _default(row: Row) -> tuple[str, str]:
    """Default, as a value or in words."""
    unit = "" if row["unit"] in ("", "-") else f" {row['unit']}"
    if isinstance(row["default"], float):
        return f"{row['default']:.6g}{unit}", ""
    if row["default"] is None:
        return f"...{unit}", "not asked"
    formula = str(row["default"])
    return f"...{unit}", f"by default {formula}" if len(formula) < COLUMN else "follows from others"
