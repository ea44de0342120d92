"""The report of several families for one requirement sheet: which serves best, and why others lost."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from synth.results.ratings import DesignRating
from synth.results.report_request import ComparisonRequest
from synth.text.numbers import page_text
from synth.text.plain_text import words

from .front_plot import front_file
from .numbers import in_its_unit, printed
from .sheet.blocks import Block, Column, Document, Figure, Heading, Link, Paragraph, State, TableBlock, TableRow
from .sheet.design_sheet import program_name

CLASS = re.compile(r' class="[a-z]+"')
LEVELS = {"global": "good", "exhaustive": "open", "heuristic": "open"}
FAMILY_COLUMNS = (Column("family", width=1.6), Column("outcome", width=0.9), Column("why", width=3.6))


def comparison_report(request: ComparisonRequest) -> Document:
    """Report of a comparison."""
    content, fronts, links, about = request.content, request.fronts, request.links, request.how.about
    designs: Sequence[Mapping[str, Any]] = content["designs"]
    verdict = str(content["sentence"])
    sentence = verdict[:1].upper() + verdict[1:] + "."
    blocks: list[Block] = [_state(content, sentence)]
    if designs:
        blocks.append(Heading("The common front", anchor="designs"))
        blocks += [*_drawn(request, designs), _ranked(request, designs)]
    rows = [
        TableRow(
            (
                Link(str(x["title"]), links[x["family"]]) if x["family"] in links else str(x["title"]),
                str(x["outcome"]),
                str(x["why"]),
            )
        )
        for x in content["families"]
    ]
    blocks += [Heading("The families", anchor="families"), TableBlock.of("What became of each", FAMILY_COLUMNS, rows)]
    if fronts:
        blocks.append(
            Paragraph(
                "Each family has a report of its own with task, designs, limits and certificate; objectives are "
                "measured as each family defines them.",
                small=True,
            )
        )
    first = next(iter(fronts.values()), None)
    count = f"{len(designs)} designs" if len(designs) != 1 else "one design"
    searched = f"{len(fronts)} families searched" if len(fronts) != 1 else "one family searched"
    return Document(
        kind="Comparison of families",
        title=about.title or f"{searched}: {count}",
        facts=about.facts(),
        blocks=tuple(blocks),
        program=program_name(first),
        logo=about.logo,
    )


def _state(content: Mapping[str, Any], sentence: str) -> State:
    kind = content["certificate"]["kind"]
    if not content["designs"]:
        proven = "NOT FEASIBLE, proven: no family meets the task" if kind == "global" else "NO DESIGN FOUND, not proven"
        return State("bad", proven, (sentence,))
    if content["interrupted"]:
        return State(
            "open", "The search was stopped: NOT PROVEN to the end", (sentence, f"Stopped: {content['interrupted']}.")
        )
    head = "Proven over all families searched" if kind == "global" else "NOT PROVEN: better designs may exist"
    return State(LEVELS[kind], head, (sentence,))


def _drawn(request: ComparisonRequest, designs: Sequence[Mapping[str, Any]]) -> list[Block]:
    """Drawing of the common front; nothing where there is none to draw."""
    content, fronts = request.content, request.fronts
    titles = {x["family"]: str(x["title"]) for x in content["families"]}
    ranked = [replace(fronts[x["family"]].designs[x["own_rank"] - 1], rank=x["rank"], note=x["note"]) for x in designs]
    families = [titles[x["family"]] for x in designs]
    svg = front_file(ranked, content["objectives"], "Common front", families=families)
    if not svg:
        return []
    caption = f"{len(ranked)} designs of {', '.join(dict.fromkeys(families))}; the table below lists them"
    unstyled = CLASS.sub("", svg.partition("\n")[2])  # on white paper of its own, whatever the page is like
    return [Figure(unstyled, caption, "Each point is a design, its shape and colour the family.")]


def _ranked(request: ComparisonRequest, designs: Sequence[Mapping[str, Any]]) -> TableBlock:
    content, fronts, links = request.content, request.fronts, request.links
    units = {name: unit for front in fronts.values() for name, unit in front.frame.units.items()}
    titles = {x["family"]: str(x["title"]) for x in content["families"]}
    columns = [
        Column("rank", number=True, width=0.5),
        Column("score", number=True, width=0.7),
        Column("family", width=2),
    ]
    columns += [Column(name.replace("_", " "), number=True, width=1.2) for name in content["objectives"]]
    rated = any(x.get("robust") for x in designs)
    columns += [Column("over the range", width=1)] if rated else []
    columns.append(Column("note", width=0.8))
    rows = []
    for x in designs:
        family = x["family"]
        line = fronts[family].designs[x["own_rank"] - 1].group or x["own_rank"]
        place = f"{links[family]}#design-{line}"
        named = Link(f"{titles[family]} #{x['own_rank']}", place)
        score = page_text(x["score"])
        values = [printed(in_its_unit(float(x["objectives"][n]), units.get(n, "-"))) for n in content["objectives"]]
        verdict = [str(DesignRating.from_json(x.get("robust") or {}).verdict or "not rated")] if rated else []
        rows.append(TableRow((f"#{x['rank']}", score, named, *values, *verdict, words(str(x.get("note") or "")))))
    return TableBlock.of("Designs of all families that no other one beats, the best rank first", columns, rows)
