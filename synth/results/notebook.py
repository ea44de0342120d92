"""How results show themselves in notebooks: static HTML, every text escaped, no script."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from synth.text.numbers import page_text

MOST_ROWS = 30
LEVELS = {"good": "#14663b", "open": "#7a4d00", "bad": "#9b1c1c", "": "inherit"}


@dataclass(frozen=True)
class NotebookFrame:
    """HTML that a notebook shows as it is, and that can be kept: a frame that is closed off from the notebook."""

    html: str

    def _repr_html_(self) -> str:
        return self.html

    def __repr__(self) -> str:
        return f"NotebookFrame({len(self.html)} letters of HTML)"


def notebook_html(
    title: str,
    sentences: Iterable[str] = (),
    columns: Sequence[str] = (),
    rows: Sequence[Sequence[Any]] = (),
    level: str = "",
    drawing: str = "",
) -> str:
    """Return a result as HTML for a notebook.

    Parameters
    ----------
    title : str
    sentences : list of str
        What is to be known first.
    columns, rows : list
        A table; numbers are shown in five digits, at most 30 rows.
    level : {"good", "open", "bad", ""}
        Colour of the first sentence, which says the same in words.
    drawing : str
        SVG of ours.

    Examples
    --------
    >>> notebook_html("A <title>")
    '<div><p><b>A &lt;title&gt;</b></p></div>'
    """
    paragraphs = []
    for number, sentence in enumerate(x for x in sentences if x):
        colour = f' style="color:{LEVELS[level]}"' if not number and level else ""
        paragraphs.append(f"<p{colour}>{escape(sentence)}</p>")
    table = _table(columns, rows) if columns and rows else ""
    more = f"<p>{len(rows) - MOST_ROWS} more rows</p>" if len(rows) > MOST_ROWS else ""
    picture = f'<div style="max-width:40em;background:#fff">{drawing}</div>' if drawing else ""
    return f"<div><p><b>{escape(title)}</b></p>{''.join(paragraphs)}{picture}{table}{more}</div>"


def _table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    heads = "".join(f'<th scope="col">{escape(str(column))}</th>' for column in columns)
    bodies = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows[:MOST_ROWS])
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{bodies}</tbody></table>"


def _cell(value: object) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "<td></td>"
    if isinstance(value, float):
        return f'<td style="text-align:right">{page_text(value)}</td>'
    return f"<td>{escape(str(value))}</td>"
