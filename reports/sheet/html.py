"""Documents as one HTML file each: nothing is fetched, no script is needed, and it prints on A4."""

from __future__ import annotations

import base64
import hashlib
from functools import cache
from html import escape
from importlib.resources import files

from reports.formula.layout import Layout
from reports.formula.mathml import mathml
from reports.sheet.blocks import (
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
    State,
    StepBlock,
    Strong,
    TableBlock,
    TableRow,
)

SHORT = 14  # rows of a table that stays on one page


@cache
def asset(name: str) -> str:
    """Return a file that reports are made with."""
    return (files("reports") / "assets" / name).read_text(encoding="utf-8")


def html(document: Document) -> str:
    """Return a document as an HTML file.

    Where it holds data of all designs a script of ours shows any of them; all else is there without it.
    """
    script = asset("report.js") if document.data else ""
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
    safe = data.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    return (
        f'<section id="any-design" hidden aria-live="polite"></section>\n'
        f'<script type="application/json" id="all-designs">{safe}</script>\n'
    )


def _policy(script: str) -> str:
    """Return what the file may do: draw itself, and run the script that is meant."""
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
    """Return what stands in a cell or a paragraph."""
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
        told = "".join(f"<p>{escape(text)}</p>" for text in block.details)
        return f'<div class="state {block.level}" role="status"><p class="head">{escape(block.head)}</p>{told}</div>'
    if isinstance(block, TableBlock):
        return _table(block)
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
        told = "".join(_row(row, block.columns) for row in rows)
        bodies.append(f"<tbody{_marked('group' if label else '')}>{head}{told}</tbody>")
    total = sum(c.width for c in block.columns)
    kind = "scroll short" if sum(len(rows) for _, rows in block.groups) <= SHORT else "scroll"
    widths = "".join(f'<col style="width:{100 * c.width / total:.3g}%">' for c in block.columns)
    return (
        f'<div class="{kind}" tabindex="0" role="region" aria-label="{escape(block.caption)}"><table><caption>'
        f"{escape(block.caption)}</caption><colgroup>{widths}</colgroup><thead><tr>{heads}</tr></thead>"
        f"{''.join(bodies)}</table></div>"
    )


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
