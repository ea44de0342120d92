"""Where things are on a sheet: its texts with their places, and corners of boxes."""

from __future__ import annotations

from synth.reports.drawing.paper import PaperSheet, Text


def texts_of(sheet: PaperSheet) -> list[tuple[str, Text]]:
    """All texts with the place that they belong to."""
    texts = [("sheet", text) for text in sheet.texts]
    for k, placed in enumerate(sheet.views):
        place = placed.view.name + (f" {placed.detail.letter}" if placed.detail else "")
        texts += [(f"{k} {place}", m.text) for m in placed.measures]
        texts += [(f"{k} {place}", c.text) for c in placed.callouts]
        texts += [(f"{k} {place}", placed.heading)] if placed.heading else []
    return texts


def corners_of(box: tuple[float, float, float, float]) -> list[tuple[float, float]]:
    """Corners of a box."""
    return [(box[0], box[1]), (box[2], box[1]), (box[2], box[3]), (box[0], box[3])]
