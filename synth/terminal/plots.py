"""The picture of a front that ``run --plot`` shows."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from synth.results.drawings import report

if TYPE_CHECKING:
    from rich.console import Console

    from synth.results import Design


def show_plot(
    designs: Sequence[Design], objectives: Mapping[str, str], console: Console, families: Sequence[str] = ()
) -> None:
    """Draw a front on the terminal, or say why there is nothing to draw."""
    draw = report("terminal_plot")
    if draw is None:
        console.print("no plot: reports are not installed")
    else:
        # The console of a machine without windows has too few characters for braille, whatever its encoding.
        plain = console.is_terminal and os.environ.get("TERM") == "linux"
        draw(designs, objectives, console, families, False if plain else None)
