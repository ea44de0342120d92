"""What a drive asks of a clutch or coupling, in the words that all families share."""

from __future__ import annotations

from .cooling import COOLING
from .drive import WORDS, Drive, Start, refuse_contradictions, sized_by_load

__all__ = ["COOLING", "WORDS", "Drive", "Start", "refuse_contradictions", "sized_by_load"]
