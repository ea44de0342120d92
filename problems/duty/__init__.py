"""What a drive asks of a clutch or coupling, in the words that all families share."""

from __future__ import annotations

from .drive import WORDS, Drive, Start, refuse_contradictions, sized_by_load

__all__ = ["WORDS", "Drive", "Start", "refuse_contradictions", "sized_by_load"]
