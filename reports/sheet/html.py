"""Documents as one HTML file each: nothing is fetched, no script is needed, and it prints on A4."""

from __future__ import annotations

import base64
import hashlib
import json
import math
from functools import cache
from html import escape
from importlib.resources import files
from itertools import islice

from synth.text.numbers import page_text
from synth.text.plain_text import escaped
from synth.ui import as_script

from ..formula.layout import Layout
from ..formula.mathml import mathml
from .blocks import (
    Block,
    Bullets,
    Cell,
    Code,
    Column,
    Document,
    Figure,
    Heading,
    Inline,
    Link,
    Listing,
    Paragraph,
    RowsBlock,
    State,
    StepBlock,
    Strong,
    TableBlock,
    TableRow,
)

SHORT = 14  # rows of a table that stays on one page
AT_A_TIME = 200  # of many rows, as rows.js shows them as well
ONE_LINE = 2.0  # width of a column of many rows from which its texts take one line, however long: rows stay low


@cache
def asset(name: str) -> str:
    """Return a file that reports are made with."""
    return (files("synth.reports") / "assets" / name).read_text(encoding="utf-8")


def html(document: Document) -> str:
    """Return a document as an HTML file.

    Where it holds data of all designs, or many rows, a script of ours shows any of them; all else is there without it.
    """
    script = asset("report.js") if document.data else ""
    script += asset("rows.js") if any(isinstance(block, RowsBlock) for block in document.blocks) else ""
    script = as_script("numbers.js") + script if script else ""
    body = "\n".join(block_html(block) for block in document.blocks)
    facts = "".join(f"<dt>{escape(label)}</dt><dd>{escape(text)}</dd>" for label, text in document.facts)
    logo = f'<img src="{escape(document.logo)}" alt="">' if document.logo else ""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_policy(script)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="{escape(document.program)}">
<title>{escape(document.title)}: {escape(document.kind.lower())}</title>
<style>{asset("report.css")}</style>
</head>
<body>
<a class="skip" href="#main">Skip to the content</a>
<header>
<div><p class="kind">{escape(document.kind)}</p><h1>{escape(document.title)}</h1>
{f'<dl class="facts">{facts}</dl>' if facts else ""}</div>
{logo}
</header>
<main id="main">
{body}
{_data(document.data)}</main>
<footer>{escape(document.kind)}, computed by {escape(document.program)}</footer>
{f"<script>{script}</script>" if script else ""}</body>
</html>
"""


def _data(data: str) -> str:
    """Return the data of all designs, and the place where one is shown; no text in it can end the element."""
    if not data:
        return ""
    return (
        f'<section id="any-design" hidden aria-live="polite"></section>\n'
        f'<script type="application/json" id="all-designs">{_inert(data)}</script>\n'
    )


def _inert(data: str) -> str:
    """Return JSON that can end no element."""
    return escaped(data).replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _policy(script: str) -> str:
    """Policy of the file: it may draw itself, and run its own script."""
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    scripts = f" script-src 'sha256-{digest}';" if script else ""
    return f"default-src 'none'; style-src 'unsafe-inline'; img-src data:;{scripts} base-uri 'none'; form-action 'none'"


def inline_html(part: Inline) -> str:
    """Return a piece of a line."""
    if isinstance(part, str):
        return escape(part)
    if isinstance(part, Code):
        return f"<code>{escape(part.text)}</code>"
    if isinstance(part, Strong):
        return f"<strong>{escape(part.text)}</strong>"
    if isinstance(part, Link):
        return f'<a href="{escape(part.target)}">{escape(part.text)}</a>'
    return f"<math>{mathml(part)}</math>"


def cell_html(cell: Cell) -> str:
    """Markup of a cell or a paragraph."""
    return "".join(map(inline_html, cell)) if isinstance(cell, tuple) else inline_html(cell)


def block_html(block: Block) -> str:
    """Return a block."""
    if isinstance(block, Heading):
        level = block.level + 1
        anchor = f' id="{escape(block.anchor)}"' if block.anchor else ""
        return f"<h{level}{anchor}>{escape(block.text)}</h{level}>"
    if isinstance(block, Paragraph):
        return f"<p{_marked('small' if block.small else '')}>{cell_html(block.text)}</p>"
    if isinstance(block, State):
        details = "".join(f"<p>{escape(text)}</p>" for text in block.details)
        return f'<div class="state {block.level}" role="status"><p class="head">{escape(block.head)}</p>{details}</div>'
    if isinstance(block, TableBlock):
        return _table(block)
    if isinstance(block, RowsBlock):
        return _rows(block)
    if isinstance(block, StepBlock):
        return _step(block)
    if isinstance(block, Bullets):
        return f"<ul>{''.join(f'<li>{cell_html(item)}</li>' for item in block.items)}</ul>"
    if isinstance(block, Figure):
        caption = f"<figcaption>{escape(block.caption)}</figcaption>" if block.caption else ""
        return f'<figure role="group" aria-label="{escape(block.alt)}">{block.svg}{caption}</figure>'
    assert isinstance(block, Listing)
    return f"<pre><code>{escape(block.text)}</code></pre>"


def _table(block: TableBlock) -> str:
    heads = "".join(f'<th scope="col"{_number(c)}>{escape(c.title)}</th>' for c in block.columns)
    bodies = []
    for label, rows in block.groups:
        head = f'<tr><th scope="colgroup" colspan="{len(block.columns)}">{escape(label)}</th></tr>' if label else ""
        body = "".join(_row(row, block.columns) for row in rows)
        bodies.append(f"<tbody{_marked('group' if label else '')}>{head}{body}</tbody>")
    total = sum(c.width for c in block.columns)
    kind = "scroll short" if sum(len(rows) for _, rows in block.groups) <= SHORT else "scroll"
    widths = "".join(f'<col style="width:{100 * c.width / total:.3g}%">' for c in block.columns)
    return (
        f'<div class="{kind}" tabindex="0" role="region" aria-label="{escape(block.caption)}"><table><caption>'
        f"{escape(block.caption)}</caption><colgroup>{widths}</colgroup><thead><tr>{heads}</tr></thead>"
        f"{''.join(bodies)}</table></div>"
    )


def _rows(block: RowsBlock) -> str:
    """Return many rows: the first of them as they are without a script, and all as data for it."""
    ints = [bool(block.rows) and all(isinstance(row[k], int) for row in block.rows) for k in range(len(block.columns))]
    rows = [[_number_in_json(cell) for cell in row] for row in block.rows]
    content = {"whole": ints, "rows": rows, "kind": block.kind, "most": AT_A_TIME}
    data = json.dumps(content, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    kinds = ["n" if c.number else "long" if c.width >= ONE_LINE else "" for c in block.columns]
    heads = "".join(
        f'<th scope="col"{_marked(kind)}>{escape(c.title)}</th>' for c, kind in zip(block.columns, kinds, strict=True)
    )
    body = "".join(
        f"<tr>{''.join(f'<td{_marked(k)}>{_cell_text(cell)}</td>' for k, cell in zip(kinds, row, strict=True))}</tr>"
        for row in islice(block.rows, AT_A_TIME)
    )
    more = len(block.rows) - AT_A_TIME
    hint = f"The first {AT_A_TIME} rows; a browser with scripts shows the others." if more > 0 else ""
    return (
        f'<div class="browse screen" id="many-rows"><div class="tools" role="group" aria-label="Choose rows" hidden>'
        f'<label>State <select></select></label><label>Text <input type="search" autocomplete="off"></label>'
        f'<span role="status" class="counted"></span><span class="turn">'
        f'<button type="button" class="before">Rows before</button>'
        f'<button type="button" class="after">Rows after</button></span></div>'
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(block.caption)}"><table>'
        f"<thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table></div>"
        f'<p class="small hint">{hint}</p>'
        f'<script type="application/json" id="all-rows">{_inert(data)}</script></div>'
        f'<p class="paper">{escape(block.on_paper)}</p>'
    )


def _cell_text(cell: str | float | None) -> str:
    known = _number_in_json(cell)
    return escape(known) if isinstance(known, str) else str(known) if isinstance(known, int) else page_text(known)


def _number_in_json(cell: str | float | None) -> str | float | None:
    """Cell with its number in seven digits; None for what JSON does not know."""
    if cell is None or isinstance(cell, (str, int)):
        return cell
    return float(f"{cell:.7g}") if math.isfinite(cell) else None


def _row(row: TableRow, columns: tuple[Column, ...]) -> str:
    cells = []
    for column, cell in zip(columns, row.cells, strict=True):
        bar = ""
        if row.used is not None and column.title == "used":
            width = 100 * min(1.0, max(0.0, row.used))
            bar = f'<span class="bar" aria-hidden="true"><i style="width:{width:.3g}%"></i></span>'
        cells.append(f"<td{_number(column)}>{cell_html(cell)}{bar}</td>")
    anchor = f' id="{escape(row.anchor)}"' if row.anchor else ""
    return f"<tr{anchor}{_marked(row.mark)}>{''.join(cells)}</tr>"


def _marked(kind: str) -> str:
    """Return the attribute of what is of a kind."""
    return f' class="{kind}"' if kind else ""


def _number(column: Column) -> str:
    return _marked("n" if column.number else "")


def _step(block: StepBlock) -> str:
    rows: list[str] = []
    for position, lines in enumerate(block.equal):
        mark = "result" if position == len(block.equal) - 1 else ""
        for place, line in enumerate(lines):
            rows.append(_line(mathml(block.symbol) if not rows else "", line, mark, continues=place > 0))
    notes = "".join(f'<p class="notes">{cell_html(note)}</p>' for note in block.notes)
    source = f'<span class="src">{escape(block.source)}</span>' if block.source else ""
    return (
        f'<div class="step" id="{escape(block.anchor)}"><span class="no">{block.number}</span>'
        f'<p class="what"><span>{escape(block.meaning)} <code>{escape(block.name)}</code></span>{source}</p>'
        f'<div class="lines"><math display="block" style="text-align:left"><mtable displaystyle="true">{"".join(rows)}'
        f"</mtable></math></div>{notes}</div>"
    )


def _line(symbol: str, line: Layout, mark: str, continues: bool) -> str:
    sign = "" if continues else "<mo>=</mo>"
    return f"<mtr><mtd>{symbol}</mtd><mtd>{sign}</mtd><mtd{_marked(mark)}>{mathml(line)}</mtd></mtr>"
