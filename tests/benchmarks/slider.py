"""How soon the front follows a slider.

``python -m tests.benchmarks.slider [MOVES]`` starts the service as its users do, asks the hoist example, drags sliders
of its page in Chromium to values that nobody has asked before (30 unless told), and measures from their release until
the new front and its sentence stand on the page. Tracks are filled meanwhile, as they are for users. Before that it
measures how soon a first start leads to a front.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import httpx

from tests.benchmarks.service import ended, served, spec, submit
from tests.reports.browser import CHROMIUM, DESKTOP, MISSING, chromium

MOVES = 30
KNOBS = ("load_torque", "driver_speed", "driven_inertia")  # below what was asked of each there are designs
FIRST = 2  # position of the slider; what was asked stands at a third of the track, half of it at the left end
PAUSE = 700  # ms of a person between two moves
PATIENCE = 60_000  # ms
MEASURE = """() => {
  const strip = document.querySelector('.what-if'), told = strip.querySelector('.told');
  window.moves = [];
  let begun = null;
  strip.addEventListener('change', (event) => { if (event.target.type === 'range') begun = performance.now(); }, true);
  const looks = new MutationObserver(() => {
    if (begun === null || strip.classList.contains('busy') || !told.textContent.startsWith('With ')) return;
    const from = begun;
    begun = null;
    requestAnimationFrame(() => setTimeout(() => window.moves.push(performance.now() - from))); // it is painted
  });
  looks.observe(strip, {subtree: true, childList: true, attributes: true, attributeFilter: ['class']});
}"""
MOVED = """([count, patience]) => new Promise((done, fail) => {
  setTimeout(() => fail(new Error('no front in time')), patience);
  const look = () => (window.moves.length >= count ? done() : setTimeout(look, 20));
  look();
})"""  # the page allows no evaluation of text, which waiting for functions needs


def choose(page: Any, name: str) -> None:
    """Let the one slider vary something else, from the front as asked."""
    back = page.get_by_role("button", name="Back to what was asked")
    if back.is_visible():
        back.click()
    page.locator(".knob select").select_option(name)


def drag(page: Any, position: int) -> None:
    """Drag the slider to one of its positions, and let it go."""
    slider = page.locator(".knob input[type=range]")
    slider.scroll_into_view_if_needed()
    area = slider.bounding_box()
    now, most = slider.evaluate("one => [Number(one.value), Number(one.max)]")
    place = [area["x"] + 9 + k / most * (area["width"] - 18) for k in (now, position)]  # 9 is half of what one holds
    page.mouse.move(place[0], area["y"] + area["height"] / 2)
    page.mouse.down()
    page.mouse.move(place[1], area["y"] + area["height"] / 2, steps=8)
    page.mouse.up()


def measured(page: Any, moves: int) -> list[float]:
    """Return the seconds of each move."""
    each = -(-moves // len(KNOBS))
    page.evaluate(MEASURE)
    for k in range(moves):
        knob, place = divmod(k, each)
        if place == 0:
            choose(page, KNOBS[knob])
        drag(page, FIRST + place)
        page.evaluate(MOVED, [k + 1, PATIENCE])
        page.wait_for_timeout(PAUSE)
    return [ms / 1000 for ms in page.evaluate("window.moves")]


def first_start(page: Any, url: str) -> tuple[float, float]:
    """Return the seconds until the first page of a new service is there, and from a click there to its front."""
    begun = time.perf_counter()
    page.goto(url)
    page.wait_for_selector(".offers li")
    clicked = time.perf_counter()
    page.locator(".offers li").first.get_by_role("button", name="Run it").click()
    page.wait_for_selector(".explored table.designs tbody tr")
    return clicked - begun, time.perf_counter() - clicked


def main(moves: int) -> None:
    """Print the figures."""
    if CHROMIUM is None:
        sys.exit(MISSING)
    with served() as service, httpx.Client(base_url=service.url, timeout=30.0) as client, chromium() as browser:
        page = browser.new_page(viewport={"width": DESKTOP[0], "height": DESKTOP[1]})
        opened, first = first_start(page, service.url)
        front = submit(client, spec())
        ended(client, front)
        page.goto(f"{service.url}/jobs/{front}")
        page.wait_for_selector(".knob input[type=range]")
        page.wait_for_selector("main [aria-busy=true]", state="detached")
        times = sorted(measured(page, moves))
    middle, late = times[len(times) // 2], times[min(len(times) - 1, int(0.95 * len(times)))]
    print(f"first page {opened:.2f} s, from a click there to its front {first:.2f} s")
    print(f"{len(times)} moves: p50 {middle:.2f}, p95 {late:.2f}, slowest {times[-1]:.2f} s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else MOVES)
