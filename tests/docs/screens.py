"""Screens of the documentation beside those of the program.

What a search shows is compared in its structure: words, the columns of its tables, and marked figures. So a search that
finds a little better designs, or others, rewrites no page.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

ANYTHING = "..."
AS_MARKED = 5e-3  # relative; a proven front is within 0.1 % of the best
AS_SHOWN = 1e-2  # relative; of figures in results of Python
FIGURE = re.compile(r"\d+(?: \d{3})*(?:\.\d+)?(?:·10⁻?[⁰¹²³⁴-⁹]+)?")
RULER = re.compile(r"^─+$")
OF_A_DESIGN = re.compile(r"#\d+: ")


def same(shown: str, got: str) -> bool:
    """Whether a text is as shown, where ``...`` stands for anything, and white space counts as one blank.

    >>> same("a ...\\nb ...", "a  b"), same("a ... b", "b a"), same("a", "a b")
    (True, False, False)
    """
    text = " ".join(got.split())
    first, *middle = (" ".join(piece.split()) for piece in shown.split(ANYTHING))
    if not middle:
        return text == first
    *middle, last = middle
    place = len(first) if text.startswith(first) else -1
    for piece in middle:
        at = text.find(piece, place) if place >= 0 else -1
        place = at + len(piece) if at >= 0 else -1
    return 0 <= place <= len(text) - len(last) and text.endswith(last)


def figures(text: str) -> list[float]:
    """Figures in a text, without powers of ten."""
    return [float(figure.split("·")[0].replace(" ", "")) for figure in FIGURE.findall(text)]


def near(a: float, b: float, share: float) -> bool:
    """Whether two figures are the same but for a share."""
    return abs(a - b) <= share * max(abs(a), abs(b))


@dataclass(frozen=True)
class Outline:
    """A screen without its figures, the rows of its designs, and what is said of single ones."""

    columns: frozenset[str]  # words above the tables of designs
    text: str

    @classmethod
    def of(cls, screen: str) -> Outline:
        """Outline of a screen.

        >>> found = Outline.of('''2 designs
        ...
        ...         mass   outer
        ... rank    [kg]   diameter
        ... ───────────────────────
        ...   #1   5.899   35
        ...   #2   5.426   38
        ...
        ... all of these: friction pair paper_wet
        ...
        ... #1: nearest to the best
        ...     remark: hot
        ... proven: over all 52 920 combinations''')
        >>> sorted(found.columns), found.text
        (['[kg]', 'diameter', 'mass', 'outer'], '0 designs\\nproven: over all 0 combinations')
        """
        lines, columns = list[str](), set[str]()
        for paragraph in re.split(r"\n\s*\n", screen):
            own = [line.rstrip() for line in paragraph.splitlines()]
            ruler = next((k for k, line in enumerate(own) if RULER.match(line)), None)
            if ruler and own[ruler - 1].startswith("rank"):
                columns |= set(" ".join(own[:ruler]).split()) - {"rank"}
                own = [line for line in own[ruler + 1 :] if line and not line.startswith(" ")]
            lines += own
        return cls(frozenset(columns), "\n".join(FIGURE.sub("0", line) for line in _of_all(lines)))


def _of_all(lines: list[str]) -> list[str]:
    """Lines that tell of all designs."""
    kept, of_one = list[str](), False
    for k, line in enumerate(lines):
        if OF_A_DESIGN.match(line) or line.startswith("all of these: "):
            of_one = True
        elif of_one and line == ANYTHING:
            following = lines[k + 1] if k + 1 < len(lines) else ""
            of_one = following.startswith(" ") or OF_A_DESIGN.match(following) is not None
        elif not line.startswith(" "):
            of_one = False
        if not of_one:
            kept.append(line)
    return kept


def alike(shown: str, got: str, marked: list[float]) -> bool:
    """Whether a screen has the structure of the one that is shown, and its marked figures."""
    page, screen, found = Outline.of(shown), Outline.of(got), figures(got)
    left_out = ANYTHING in shown.splitlines()
    columns = page.columns <= screen.columns if left_out else page.columns == screen.columns
    return columns and same(page.text, screen.text) and all(any(near(m, f, AS_MARKED) for f in found) for m in marked)


def shows_a_search(screen: str) -> bool:
    """Whether a screen shows a whole table of designs.

    >>> shows_a_search("rank    [kg]\\n───────\\n  #1   5.9"), shows_a_search("name   value\\n───────\\nmass   5.9")
    (True, False)
    """
    return re.search(r"^rank .*\n─+\n +#\d+ ", screen, re.MULTILINE) is not None


def told_alike(want: str, got: str) -> bool:
    """Whether a result of Python is as shown, but for small shares of its figures.

    >>> told_alike("[('mass', 14.2...), 7]", "[('mass', 14.25), 7]")
    True
    >>> told_alike("[('mass', 14.2), 7]", "[('mass', 14.2), 8]"), told_alike("[14.2]", "(14.2)")
    (False, False)
    """
    want = re.sub(r"(?<=\d)\.\.\.", "", want)
    shown, found = figures(want), figures(got)
    together = len(shown) == len(found) and all(near(a, b, AS_SHOWN) for a, b in zip(shown, found, strict=True))
    return together and same(FIGURE.sub("0", want), FIGURE.sub("0", got))
