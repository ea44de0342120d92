"""How long the explorer takes to draw, and to follow the pointer.

``python -m tests.benchmarks.explorer [COUNT ...]`` draws made fronts of so many designs (20, 200, 1000 unless told) in
Chromium: from the record to the laid out page, a mark at a move of the pointer, and a filter; the median of five each.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from statistics import median
from typing import Any

from synth.reports.explorer.page import explorer_page

from tests.reports.browser import CHROMIUM, MISSING, chromium, opened
from tests.reports.explorer_records import grown

TIMES = 5
POINT = """() => {
  const rows = document.querySelectorAll('table.designs tbody tr');
  const start = performance.now();
  for (let k = 0; k < 20; k += 1) {
    rows[k % rows.length].dispatchEvent(new PointerEvent('pointerover', {bubbles: true}));
    document.body.offsetHeight;
  }
  return (performance.now() - start) / 20;
}"""
FILTER = """() => {
  const start = performance.now();
  document.querySelector('.legend button').click();
  document.body.offsetHeight;
  return performance.now() - start;
}"""


def measured(browser: Any, path: Path) -> tuple[float, float, float]:
    """Return milliseconds to draw and lay out, to follow the pointer, and to filter."""
    with opened(browser, path) as found:
        page = found.page
        drawn = float(page.evaluate("Number(document.documentElement.dataset.drawn)"))
        assert not found.faults
        return drawn, float(page.evaluate(POINT)), float(page.evaluate(FILTER))


def main(counts: list[int]) -> None:
    """Print a line for each count of designs."""
    if CHROMIUM is None:
        sys.exit(MISSING)
    print(f"{'designs':>8} {'draw ms':>9} {'point ms':>9} {'filter ms':>9}")
    with chromium() as browser, tempfile.TemporaryDirectory() as folder:
        for count in counts:
            path = Path(folder) / f"{count}.html"
            path.write_text(explorer_page(grown(count)), encoding="utf-8")
            told = [measured(browser, path) for _ in range(TIMES)]
            draw, point, some = (median(row[k] for row in told) for k in range(3))
            print(f"{count:8d} {draw:9.0f} {point:9.2f} {some:9.1f}")


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or [20, 200, 1000])
