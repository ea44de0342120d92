"""Writes screens of pages anew by running their commands: ``make screens``, or ``python -m tests.docs.redraw PAGE``.

Screens of a search are drawn anew always, other outputs and results of Python where the test of the page would fail.
What ``...`` leaves out stays left out. What cannot be drawn anew is told, to be changed by hand.
"""

from __future__ import annotations

import doctest
import io
import os
import re
import sys
import tempfile
from collections.abc import Sequence
from difflib import SequenceMatcher
from pathlib import Path

from tests.docs.screens import ANYTHING, FIGURE, figures, same, shows_a_search
from tests.docs.test_docs import COMPARE, PAGES, Alike, Block, Reader, blocks, commands, marked_figures

CUT = re.compile(rf"({FIGURE.pattern})(\.\.\.)?")


def by_hand(where: str, why: str) -> None:
    """Tell what has to be changed by hand."""
    sys.stderr.write(f"{where}: {why}\n")


def redrawn(shown: str, got: str) -> str:
    """A screen as it is now, without what the one shown leaves out.

    >>> redrawn("2 designs\\n...\\n#1 7 kg\\n\\n", "3 designs\\na\\nb\\n#1 8 kg\\n")
    '3 designs\\n...\\n#1 8 kg\\n\\n'
    """
    old, new = shown.rstrip().splitlines(), [line.rstrip() for line in got.rstrip().splitlines()]
    keys = [" ".join(FIGURE.sub("0", line).split()) for line in new]
    wanted = [next((key for key in keys if same(" ".join(FIGURE.sub("0", line).split()), key)), line) for line in old]
    wanted = [ANYTHING if line.strip() == ANYTHING else key for line, key in zip(old, wanted, strict=True)]
    lines: list[str] = []
    for what, i, j, a, b in SequenceMatcher(None, wanted, keys, autojunk=False).get_opcodes():
        if what == "equal":
            lines += [o if ANYTHING in o else n for o, n in zip(old[i:j], new[a:b], strict=True)]
        elif ANYTHING in wanted[i:j]:
            head = wanted[i:j].index(ANYTHING)
            tail = wanted[i:j][::-1].index(ANYTHING)
            left_out = [ANYTHING] if b - a > head + tail else []
            lines += [*new[a : min(a + head, b)], *left_out, *new[max(b - tail, min(a + head, b)) : b]]
        else:
            lines += new[a:b]
    return "\n".join(lines) + shown[len(shown.rstrip()) :]


def retold(want: str, got: str) -> str | None:
    """A result of Python as it is now, with as many digits as are shown; None where its words have changed.

    >>> retold("[('mass', 14.2...), 7]\\n", "[('mass', 15.4321), 8]\\n"), retold("a ... b", "c")
    ("[('mass', 15.4...), 8]\\n", None)
    """
    if ANYTHING not in want:
        return "".join(f"{line.rstrip()}\n" for line in got.splitlines())
    plain = CUT.sub("0", want)
    if plain != FIGURE.sub("0", got):
        return None
    found = iter(FIGURE.findall(got))
    return CUT.sub(lambda m: next(found)[: len(m[1])] + m[2] if m[2] else next(found), want)


class Redrawer(Reader):
    """Follows a page, and keeps what its blocks show now."""

    def __init__(self, page: Path, folder: Path) -> None:
        super().__init__(page, folder)
        self.outputs: list[str] = []

    def run(self, command: str, shown: str, may_fail: bool, where: str, marks: Sequence[str] = ()) -> None:
        """Run a command and keep its output."""
        if command == "echo $?":
            self.outputs.append(f"{self.code}{shown[len(shown.rstrip()) :]}")
            return
        got = self.screen(command, may_fail, where)
        anew = bool(shown) and (shows_a_search(shown) or not same(shown, got))
        text = redrawn(shown, got) if anew else shown
        self.outputs.append(text)
        if anew and not (same(text, got) and text.count(ANYTHING) == shown.count(ANYTHING)):
            by_hand(where, f"$ {command}")
        if shows_a_search(text) and (lost := set(marked_figures(marks)) - set(figures(text))):
            by_hand(where, f"marked figures {lost} are not on the screen of $ {command}")

    def drawn(self, block: Block) -> str:
        """Text of a block as it is now."""
        where = f"{self.page.name}, line {block.line}"
        if block.language == "python" and ">>>" in block.text:
            return self._told(block, where)
        self.outputs = []
        try:
            self.follow(block)
        except AssertionError as fault:
            by_hand(where, str(fault))
            return block.text
        if block.language != "console":
            return block.text
        typed = [command for command, _ in commands(block.text)]
        return "".join(f"$ {command}\n{output}" for command, output in zip(typed, self.outputs, strict=True))

    def _told(self, block: Block, where: str) -> str:
        results: list[tuple[doctest.Example, str]] = []

        class Runner(doctest.DocTestRunner):
            def report_failure(self, out: object, test: doctest.DocTest, example: doctest.Example, got: str) -> None:
                results.append((example, got))

        test = doctest.DocTestParser().get_doctest(block.text, {}, where, where, block.line)
        test.globs = self.module.__dict__
        Runner(Alike(), optionflags=COMPARE).run(test, out=io.StringIO().write, clear_globs=False)
        lines = block.text.splitlines(keepends=True)
        for example, got in reversed(results):
            text = retold(example.want, got)
            if text is None or CUT.sub("0", example.want) != FIGURE.sub("0", got):
                by_hand(where, f"{example.source}{got}")
            if text is None:
                continue
            begin = example.lineno + example.source.count("\n")
            lines[begin : begin + example.want.count("\n")] = [text]
        return "".join(lines)


def redraw(page: Path) -> None:
    """Write a page with the screens that its commands show."""
    content = page.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        before = Path.cwd()
        os.chdir(folder)
        try:
            reader = Redrawer(page, Path(folder))
            for block in blocks(page):
                content = content.replace(f"\n{block.text}```", f"\n{reader.drawn(block)}```", 1)
        finally:
            os.chdir(before)
    page.write_text(content, encoding="utf-8")


if __name__ == "__main__":
    for path in [Path(name).resolve() for name in sys.argv[1:]] or PAGES:
        redraw(path)
