"""Lists of families and requests in README, docs and examples: ``make lists``.

The page of a family tells what stands in the lists, in a comment below its heading::

    <!-- lists
    duty: what it is for, in README
    page: what its page shows, in docs/index.md
    example: hoist_multi_plate
    drawing: what the drawing of that example shows, in docs/drawings.md; neither line where a family does not draw
    -->
"""

from __future__ import annotations

import re
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

import synth
from synth.question.request_fields import RequestField
from synth.text.numbers import typed_number
from synth.verbs.requests import VERBS, Verb
from tests.shipped import FAMILIES

ROOT = Path(__file__).parents[2]
WIDTH = 120
COMMENT = re.compile(r"^<!-- lists\n(.*?)^-->$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Entry:
    """What lists say of a family."""

    name: str
    title: str
    duty: str
    page: str
    example: str = ""
    drawing: str = ""


def entry(name: str) -> Entry:
    """Entry of a family, from its class and its page."""
    page = f"docs/{name}.md"
    found = COMMENT.search((ROOT / page).read_text(encoding="utf-8"))
    assert found, f"{page} has no comment for lists"
    told = dict(line.split(": ", 1) for line in found[1].splitlines())
    return Entry(name, synth.load(name).title, **told)


def names() -> str:
    """The names as a list of Python, in lines as it is shown."""
    return textwrap.fill(str(sorted(FAMILIES)), WIDTH, subsequent_indent=" ") + "\n"


@dataclass(frozen=True)
class Written:
    """Text of a page between two marks."""

    page: str
    begin: str
    end: str
    text: str

    def content(self) -> str:
        """Whole page with the text."""
        before, begin, after = (ROOT / self.page).read_text(encoding="utf-8").partition(self.begin)
        assert begin, f"{self.page} has no {self.begin!r}"
        return before + begin + self.text + self.end + after.partition(self.end)[2]


def lists() -> list[Written]:
    """All lists of families in pages."""
    entries = [entry(name) for name in sorted(FAMILIES)]
    begin, end = "<!-- families: written by `make lists` -->\n", "<!-- end of families -->\n"
    wide = max(len(e.name) for e in entries)
    pictures = "\n".join(
        f"## {e.title}\n\n`examples/{e.example}.yaml`: {e.drawing}.\n\n![{e.title}](pictures/drawing_{e.name}.svg)\n"
        for e in entries
        if e.drawing
    )
    duties = "".join(f"| [{e.title}](docs/{e.name}.md) | {e.duty} |\n" for e in entries)
    pages = "".join(f"| [{e.title}]({e.name}.md) | {e.page} |\n" for e in entries)
    return [
        Written("README.md", begin, end, f"| family | duty |\n|---|---|\n{duties}"),
        Written("docs/index.md", begin, end, f"| family | its page |\n|---|---|\n{pages}"),
        Written("docs/drawings.md", begin, end, f"\n{pictures}"),
        Written("docs/python.md", ">>> synth.families()\n", "\n```", names()),
        Written(
            "docs/commands.md",
            "$ clutchsynth families\n",
            "$ ",
            "".join(f"{e.name:{wide}s}  {e.title}\n" for e in entries),
        ),
        requests(),
    ]


def requests() -> Written:
    """Table of the requests of jobs, from the records of the verbs."""
    rows = [f"| `{verb.name}` | {verb.about.value} | {taken(verb)} |\n" for verb in VERBS.values()]
    begin, end = "<!-- requests: written by `make lists` -->\n", "<!-- end of requests -->\n"
    return Written("docs/rest.md", begin, end, "| kind | about | takes |\n|---|---|---|\n" + "".join(rows))


def taken(verb: Verb) -> str:
    """What a verb takes beside its subject, with defaults."""
    fields = [one for one in verb.request.fields().values() if one.name not in ("upload", "rows")]
    return (
        "; ".join(f"`{one.name}`{defaulted(one)}: {one.help[0].lower()}{one.help[1:-1]}" for one in fields)
    ) or "nothing more"


def defaulted(record: RequestField) -> str:
    """Default of a field in brackets, where there is one."""
    if record.usual is None:
        return ""
    usual = record.usual
    shown = ", ".join(usual) if isinstance(usual, tuple) else str(usual).lower()
    if isinstance(usual, float):
        shown = typed_number(usual)
    return f" ({shown}{'' if record.unit == '-' else f' {record.unit}'})"


def links() -> dict[Path, str]:
    """Links of ``examples/`` to the specs beside the models, with their targets."""
    specs = sorted((ROOT / "problems").glob("*/*.yaml"))
    return {ROOT / "examples" / spec.name: f"../{spec.relative_to(ROOT).as_posix()}" for spec in specs}


def write() -> None:
    """Write all lists anew."""
    for written in lists():
        (ROOT / written.page).write_text(written.content(), encoding="utf-8", newline="\n")
    for link, target in links().items():
        if not link.is_symlink():
            link.symlink_to(target)


if __name__ == "__main__":
    if sys.argv[1:] == ["gallery"]:
        print(*(f"{e.example}={e.name}" for e in map(entry, sorted(FAMILIES)) if e.drawing))
    else:
        write()
