"""The explorer in a browser: what people see, point at and type, in both themes, on a desk and on a phone."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest
import yaml
from synth.reports.explorer.page import explorer_files, explorer_frame, explorer_page

from tests.reports.browser import DESKTOP, FORMS, PHONE, Opened, chromium, needs_chromium, opened, serious
from tests.reports.explorer_records import HOSTILE, empty_record, grown, hostile_record, small_front, small_record

pytestmark = [pytest.mark.slow, needs_chromium]
Shown = Callable[..., AbstractContextManager[Opened]]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture
def shown(browser: Any, tmp_path: Path) -> Shown:
    def show(record: dict[str, Any], size: tuple[int, int] = DESKTOP, theme: str = "light") -> Any:
        path = tmp_path / "explorer.html"
        path.write_text(explorer_page(record), encoding="utf-8")
        return opened(browser, path, size, theme)

    return show


def one(kind: str) -> dict[str, Any]:
    if kind == "empty":
        return empty_record()
    record = small_record()
    if kind == "single":
        return record | {"designs": record["designs"][:1]}
    if kind == "many":
        return grown(200)
    return record


@pytest.mark.parametrize(
    ("kind", "size", "theme"),
    [
        *(("front", *form) for form in FORMS),
        *((kind, *form) for kind in ("single", "empty", "many") for form in ((DESKTOP, "light"), (PHONE, "dark"))),
    ],
)
def test_each_form_is_quiet_fits_and_can_be_used_by_all(shown: Shown, kind: str, size: tuple[int, int], theme: str):
    with shown(one(kind), size, theme) as found:
        assert found.page.locator("h1").inner_text() == "Multi-plate clutch"
        for summary in found.page.locator("summary").all():
            if summary.is_visible():
                summary.click()
        assert serious(found.page) == []
        assert found.page.evaluate("document.documentElement.scrollWidth") <= size[0]
        assert found.faults == []
        assert found.strangers() == []


def test_hostile_texts_are_only_read(shown: Shown):
    record = hostile_record()
    with shown(record) as found:
        page = found.page
        for row in range(2):
            page.locator("table.designs tbody tr").nth(row).click()
            page.locator(".panel button", has_text="Compare").click()
        page.locator(".tray input").check()
        page.locator("svg.scatter").hover()
        for summary in page.locator("summary").all():
            if summary.is_visible():
                summary.click()
        assert found.faults == []
        assert found.strangers() == []
        assert page.locator("img[onerror], img[src='x'], a[href^='javascript']").count() == 0
        assert page.locator("a", has_text="Sheet").first.get_attribute("href") == "design_01_sheet.html"
        told = page.locator("body").inner_text()
        assert HOSTILE.split("\u202e")[0] in told
        assert "[U+202E]" in told
        assert "\u202e" not in told


def test_nothing_is_rebuilt_while_one_points(shown: Shown):
    with shown(grown(100)) as found:
        page = found.page
        page.evaluate(
            "window.changed = []; new MutationObserver((all) => window.changed.push(...all.map((m) => m.type)))"
            ".observe(document.querySelector('.explorer'), {childList: true, subtree: true})"
        )
        for place in (
            ".pt >> nth=3",
            ".pt >> nth=40",
            "table.designs tbody tr >> nth=2",
            "svg.parallel",
            "table.designs tbody tr >> nth=5",
        ):
            page.locator(place).first.hover(force=True)
        assert page.locator("tr.hovered").count() == 1
        assert page.evaluate("window.changed") == []


def test_pointing_marks_the_same_design_everywhere(shown: Shown):
    with shown(small_record()) as found:
        page = found.page
        page.locator("table.designs tbody tr").nth(2).hover()
        assert page.locator(".ring.hover.on").count() == 1
        assert page.locator(".line.hover").get_attribute("d")
        option = page.locator(".pt").nth(0)
        option.hover(force=True)
        rank = str(option.get_attribute("aria-label")).split(",")[0].split(":")[0]
        assert page.locator(".tip.on b").inner_text().split(",")[0] == rank


def drag(page: Any, place: str, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag over an element, from and to shares of its sides."""
    area = page.locator(place).bounding_box()
    points = [(area["x"] + u * area["width"], area["y"] + v * area["height"]) for u, v in (start, end)]
    page.mouse.move(*points[0])
    page.mouse.down()
    page.mouse.move(*points[1], steps=4)
    page.mouse.up()


def visible_rows(page: Any) -> int:
    return int(page.evaluate("document.querySelectorAll('table.designs tbody tr:not([hidden])').length"))


def test_brush_ranges_and_legend_filter_all_views(shown: Shown):
    with shown(grown(60)) as found:
        page = found.page
        count = page.locator(".count")
        place = page.locator("svg.scatter").bounding_box()
        assert count.inner_text() == "60 designs"
        drag(page, "svg.scatter", (0.12, 0.12), (0.5, 0.85))
        rows = visible_rows(page)
        assert 0 < rows < 60
        assert count.inner_text() == f"{rows} of 60 designs"
        assert page.locator("svg.scatter").bounding_box() == place  # nothing moves that was not moved
        assert page.locator(".pt.out").count() == page.locator(".parallel .line.out").count() == 60 - rows
        assert page.locator(".filter").count() == 3
        page.locator(".filter", has_text="all filters").click()
        assert visible_rows(page) == 60
        page.locator(".ranges summary").click()
        field = page.locator(".fields input").first
        field.fill("0")
        field.press("Tab")
        assert page.locator(".filter").count() == 1
        page.locator(".filter").click()
        page.locator(".legend button").first.click()
        assert page.locator(".legend button[aria-pressed=false]").count() == 1
        assert 0 < visible_rows(page) < 60
        assert found.faults == []


def test_an_axis_of_the_parallel_view_keeps_a_range(shown: Shown):
    with shown(grown(60)) as found:
        page = found.page
        width = page.locator("svg.parallel").bounding_box()["width"]
        drag(page, "svg.parallel", (58 / width, 0.3), (58 / width, 0.6))
        assert page.locator(".filter").count() == 1
        assert 0 < visible_rows(page) < 60
        assert page.locator(".keep.on").count() == 1


def test_the_keyboard_does_all(shown: Shown):
    with shown(small_record()) as found:
        page = found.page
        page.locator("svg.scatter").focus()
        for key in ("Home", " ", "ArrowRight", " ", "End"):
            page.keyboard.press(key)
        assert page.locator(".tray h2").inner_text() == "Compare 2 designs"
        option = page.locator("svg.scatter").get_attribute("aria-activedescendant")
        assert page.locator(f"#{option}").get_attribute("aria-selected") == "true"
        assert page.locator(".panel h2").inner_text() in page.locator(f"#{option}").get_attribute("aria-label")
        page.locator("table.designs tbody tr:not(.pinned) button").first.focus()
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowUp")
        focused = page.evaluate("document.activeElement.getAttribute('aria-label')")
        assert focused == page.locator(".panel h2").inner_text()
        page.keyboard.press(" ")
        assert page.locator(".tray h2").inner_text() == "Compare 3 designs"
        page.locator("thead button").nth(1).press("Enter")
        assert page.locator("th[aria-sort=ascending]").count() == 1
        page.keyboard.press("Enter")
        masses = [float(x) for x in page.locator("table.designs tbody td:nth-child(2)").all_inner_texts()]
        assert masses == sorted(masses, reverse=True)


def test_comparing_marks_what_differs_and_stops_at_four(shown: Shown):
    with shown(small_record()) as found:
        page = found.page
        for row in range(5):
            page.locator("table.designs tbody tr").nth(row).click()
            page.locator(".panel button", has_text="Compare").click()
        assert page.locator(".compare thead th").count() == 4
        mass = page.locator(".compare tr", has_text="mass").first
        assert "differs" in str(mass.get_attribute("class"))
        assert mass.locator(".badge").inner_text() == "best"
        page.locator(".tray button", has_text="Close").click()
        assert page.locator(".tray").is_hidden()


def test_what_is_chosen_stands_in_the_address(shown: Shown, browser: Any):
    with shown(small_record()) as found:
        page = found.page
        page.locator("table.designs tbody tr").nth(3).click()
        page.locator("select[data-field=x]").select_option("ring_outer_diameter")
        address = page.url
        page.goto("about:blank")
        page.goto(address)
        assert page.locator(".panel h2").inner_text() == "Design 4"
        assert page.locator("select[data-field=x]").input_value() == "ring_outer_diameter"


def test_a_design_taken_along_reads_back_and_the_table_is_safe(shown: Shown):
    with shown(small_record()) as found:
        page = found.page
        page.locator("table.designs tbody tr").nth(1).click()
        with page.expect_download() as taken:
            page.locator(".panel button", has_text="DESIGN.yaml").click()
        told = yaml.safe_load(Path(taken.value.path()).read_text(encoding="utf-8"))
        assert told == small_front().designs[1].to_spec()
        with page.expect_download() as taken:
            page.locator("button", has_text="CSV").click()
        rows = list(csv.reader(io.StringIO(Path(taken.value.path()).read_text(encoding="utf-8-sig"))))
        assert rows[0][:3] == ["rank", "note", "mass [kg]"]
        assert len(rows) == 1 + len(small_front().designs)


def test_a_notebook_frame_works_closed_off(browser: Any, tmp_path: Path):
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html><title>n</title>{explorer_frame(small_record(), 700)}", encoding="utf-8")
    with opened(browser, path) as found:
        frame = found.page.frame_locator("iframe")
        frame.locator("table.designs tbody tr").nth(2).click()
        assert frame.locator(".panel h2").inner_text() == "Design 3"
        assert found.faults == []
        assert found.strangers() == []


def test_modules_work_as_a_service_serves_them(browser: Any, tmp_path: Path):
    policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'"
    start = (
        'import { mount } from "./explorer.js"; const told = []; window.told = told;\n'
        'const record = JSON.parse(document.getElementById("record").textContent);\n'
        'window.handle = mount(document.getElementById("here"), record, { heading: false, downloads: (d) => '
        '[{ label: "DXF", href: `/jobs/1/design_${d.rank}.dxf` }, { label: "Again", run: (e) => told.push(e.rank) }],\n'
        'whatIf: (slot) => slot.append("slider"), onSelect: (d) => told.push(d.rank) });\n'
    )
    record = json.dumps(small_record()).replace("<", "\\u003c")
    page = (
        '<!doctype html><html lang="en"><head><title>Job</title><link rel="stylesheet" href="/static/explorer.css">'
        f'</head><body><main id="here"></main><script type="application/json" id="record">{record}</script>'
        '<script type="module" src="/static/start.js"></script></body></html>'
    )
    served = {f"/static/{name}": text for name, text in explorer_files().items()}
    served |= {"/static/start.js": start, "/job": page}
    kinds = {"js": "text/javascript", "css": "text/css"}

    def answer(route: Any) -> None:
        name = "/" + route.request.url.split("/", 3)[3]
        kind = kinds.get(name.rpartition(".")[2], "text/html")
        headers = {"Content-Security-Policy": policy, "Content-Type": f"{kind}; charset=utf-8"}
        route.fulfill(status=200 if name in served else 404, headers=headers, body=served.get(name, ""))

    context = browser.new_context()
    context.route("**/*", answer)
    found = Opened(context.new_page())
    try:
        found.page.goto("http://service.test/job")
        found.page.locator(".panel button", has_text="Again").click()
        assert found.page.locator(".panel a", has_text="DXF").get_attribute("href").startswith("/jobs/1/design_")
        assert found.page.locator(".what-if").inner_text() == "slider"
        assert found.page.locator("h1").count() == 0
        found.page.evaluate("handle.select(4); handle.compareWith(JSON.parse(record.textContent))")
        assert found.page.locator(".scatter .ghost").count() == len(small_record()["designs"])
        found.page.evaluate("handle.update(JSON.parse(record.textContent))")
        assert found.page.locator(".panel h2").inner_text() == "Design 4"
        assert found.page.evaluate("told").count(4) >= 1
        assert found.faults == []
    finally:
        context.close()


def test_a_phone_has_targets_for_fingers(shown: Shown):
    with shown(small_record(), PHONE) as found:
        small = found.page.evaluate(
            "[...document.querySelectorAll('.explorer :is(button.small, .button.small, select, .legend button)')]"
            ".filter((e) => e.offsetHeight && e.offsetHeight < 40).map((e) => e.textContent)"
        )
        assert small == []


def test_a_long_table_shows_the_rest_when_asked(shown: Shown):
    with shown(grown(230)) as found:
        assert visible_rows(found.page) == 200
        found.page.locator("button", has_text="Show all 230 designs").click()
        assert visible_rows(found.page) == 230
        assert found.page.locator("button.more").is_hidden()


def test_a_column_has_as_many_decimals_everywhere_and_words_are_whole(shown: Shown):
    record = small_record()
    with shown(record) as found:
        page = found.page
        cells = page.locator("table.designs tbody tr td:nth-child(2)").all_inner_texts()
        assert len({len(text.partition(".")[2]) for text in cells}) == 1
        masses = sorted(design["v"][0] for design in record["designs"])
        assert sorted(map(float, cells)) == pytest.approx(masses, rel=1e-3)
        words = page.locator("svg.parallel text.word").all_text_contents()
        assert words
        assert set(words) <= {part["name"] for part in record["parts"].values()}


def test_what_goes_on_beyond_an_edge_has_a_shadow_there(shown: Shown):
    with shown(small_record(), PHONE) as found:
        place = found.page.locator(".card.table .scroll")
        assert place.evaluate("one => one.scrollWidth > one.clientWidth")
        assert place.evaluate("one => getComputedStyle(one).backgroundAttachment").count("scroll") >= 4


def test_print_has_all_designs_and_no_controls(shown: Shown):
    with shown(grown(60)) as found:
        found.page.emulate_media(media="print")
        assert found.page.locator(".controls").is_hidden()
        assert found.page.locator(".panel button").first.is_hidden()
        box = found.page.locator(".card.table .scroll")
        assert box.evaluate("(e) => e.scrollHeight <= e.clientHeight + 1")
