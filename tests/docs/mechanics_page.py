"""The page of the formulas, docs/mechanics.md, from their docstrings: ``make mechanics`` writes it anew.

What stands above the first heading of a module is written by hand and kept.
"""

from __future__ import annotations

import importlib
import inspect
import re
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import synth.problems.mechanics

PAGE = Path(__file__).parents[2] / "docs" / "mechanics.md"
BEGIN = "<!-- What follows is written by `make mechanics`. -->\n"
SECTION = re.compile(r"\n+(Parameters|Returns|References|Examples|Raises|Notes)\n-{3,}\n")
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \w+)*) : (.+)$")
EQUATION = re.compile(r"^Equation(?: \((implicit|recursion)\))?: (.+)$", re.DOTALL)
UNIT = re.compile(r"\[([^\]]+)\]")
NUMBERS, ARRAYS, SYMBOLS = "numbers", "numbers, arrays", "numbers, arrays, symbols"


@dataclass(frozen=True)
class Entry:
    """What a docstring says of one argument, or of several that are told together."""

    names: tuple[str, ...]
    type: str
    text: str

    @property
    def takes(self) -> str:
        """What may stand for it, by the words of its type."""
        words = self.type.removesuffix(", optional")
        if words in ("scalar, array or symbol", "sequence of scalars, arrays or symbols"):
            return SYMBOLS
        return ARRAYS if words == "scalar or array" else NUMBERS

    @property
    def units(self) -> list[str]:
        return UNIT.findall(self.text)


@dataclass(frozen=True)
class Formula:
    """A public function, as its docstring tells it."""

    module: str
    function: Any
    meaning: str
    equation: str
    how: str  # of an equation: "" where it is the function, else implicit or recursion
    entries: tuple[Entry, ...]
    returns: str
    source: str
    examples: str

    @property
    def name(self) -> str:
        return str(self.function.__name__)

    @property
    def takes(self) -> str:
        """The most that any of its arguments takes."""
        found = {entry.takes for entry in self.entries}
        return next(kind for kind in (SYMBOLS, ARRAYS, NUMBERS) if kind in found)

    def entry_of(self, argument: str) -> Entry:
        return next(e for e in self.entries if argument in [n.lstrip("*") for n in e.names])


def modules() -> list[ModuleType]:
    """Return the modules that are promised."""
    names = [name for name in synth.problems.mechanics.__all__ if name != "Quantity"]
    return [importlib.import_module(f"synth.problems.mechanics.{name}") for name in names]


def sections(text: str) -> dict[str, str]:
    parts = SECTION.split(text)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def entries(text: str) -> tuple[Entry, ...]:
    found: list[list[str]] = []
    for line in text.strip().splitlines():
        if match := ENTRY.match(line):
            found.append([match[1], match[2], ""])
        else:
            found[-1][2] += " " + line.strip()
    return tuple(Entry(tuple(names.split(", ")), kind, told.strip()) for names, kind, told in found)


def formula(module: str, function: Any) -> Formula:
    """Read the docstring of a function."""
    told = sections(inspect.getdoc(function) or "")
    paragraphs = told[""].split("\n\n")
    equation = next((m for p in paragraphs[1:] if (m := EQUATION.match(" ".join(p.split())))), None)
    return Formula(
        module,
        function,
        paragraphs[0].replace("\n", " "),
        equation[2] if equation else "",
        (equation[1] or "") if equation else "",
        entries(told.get("Parameters", "")),
        " ".join(told.get("Returns", "").split("\n", 1)[-1].split()),
        " ".join(told.get("References", "").split()),
        told.get("Examples", ""),
    )


def formulas() -> list[Formula]:
    """Return all functions that are promised, in the order of the page."""
    found = []
    for module in modules():
        values = [getattr(module, name) for name in module.__all__]
        functions = sorted(filter(inspect.isfunction, values), key=lambda x: inspect.unwrap(x).__code__.co_firstlineno)
        found += [formula(module.__name__.rsplit(".", 1)[1], x) for x in functions]
    return found


def plain(text: str) -> str:
    """Return words of a docstring as words of a page."""
    text = re.sub(r":\w+:`([^`]+)`", lambda m: f"`{m[1].removeprefix('synth.problems.mechanics.')}`", text)
    return re.sub(r"\s+", " ", text.replace("``", "`")).replace("|", "\\|").strip()


def escaped(text: str) -> str:
    """Return words in which stars are stars, not emphasis."""
    return "".join(
        part if part.startswith("`") else part.replace("*", "\\*") for part in re.split(r"(`[^`]*`)", plain(text))
    )


def row(f: Formula) -> str:
    told = inspect.signature(f.function)
    signature = "(" + ", ".join(_parameter(p) for p in told.parameters.values()) + ")"
    arguments = "; ".join(f"`{', '.join(e.names)}` {escaped(e.text).rstrip('.')}" for e in f.entries)
    equation = f"`{plain(f.equation)}`" + (f" ({f.how})" if f.how else "")
    meaning = escaped(f.meaning) + ("" if f.takes == SYMBOLS else f" *Takes {f.takes}.*")
    cells = (f"`{f.name}{signature}`: {meaning}", equation, arguments, escaped(f.returns), escaped(f.source))
    return f"| {' | '.join(cells)} |"


def _parameter(p: inspect.Parameter) -> str:
    stars = {p.VAR_POSITIONAL: "*", p.VAR_KEYWORD: "**"}.get(p.kind, "")
    return stars + p.name + ("" if p.default is p.empty else f"={p.default!r}")


def generated() -> str:
    """Return the part of the page that follows from the docstrings."""
    found = formulas()
    lines = ["| module | functions | about |", "|---|---|---|"]
    for module in modules():
        name = module.__name__.rsplit(".", 1)[1]
        about = escaped((inspect.getdoc(module) or "").split("\n\n")[0])
        lines.append(f"| [{name}](#{name}) | {sum(f.module == name for f in found)} | {about} |")
    lines.append("")
    for module in modules():
        name = module.__name__.rsplit(".", 1)[1]
        lines += [f"## {name}", "", escaped((inspect.getdoc(module) or "").split("\n\n")[0]), ""]
        rows = [row(f) for f in found if f.module == name]
        if rows:
            lines += ["| function | equation | arguments | result | source |", "|---|---|---|---|---|", *rows, ""]
        records = [x for x in map(module.__dict__.get, module.__all__) if inspect.isclass(x)]
        for record in records:
            lines.append(f"- `{record.__name__}`: {escaped((inspect.getdoc(record) or '').split(chr(10) * 2)[0])}")
        constants = [n for n in module.__all__ if n.isupper()]
        lines += [f"- `{n} = {getattr(module, n)!r}`{_comment(module, n)}" for n in constants]
        lines += [""] if records or constants else []
    return "\n".join(lines).rstrip() + "\n"


def _comment(module: ModuleType, name: str) -> str:
    """Return what the source says beside a constant."""
    line = re.search(rf"^{name} = .*?  # (.*)$", inspect.getsource(module), re.MULTILINE)
    return f": {escaped(line[1])}" if line else ""


def page() -> str:
    """Return the page as it should be."""
    kept = PAGE.read_text(encoding="utf-8").split(BEGIN)[0]
    return kept + BEGIN + "\n" + generated()


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
