"""Pages of jobs in a browser: sliders below a front, comparisons, and what other kinds of jobs have found."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from synth.folders.files import yaml_text
from tests.reports.browser import needs_chromium
from tests.service.pages.visiting import Site, Tenant, in_all_forms, visit
from tests.service.working import DUTY, FAMILY, FRONT, QUICK
from tests.terminal.entry import in_process
from tests.waiting import until

pytestmark = [pytest.mark.slow, needs_chromium]
HOLDS = "load_torque~540"
FEW = {"friction_pair": ["sinter_bronze_wet"], "inner_plate": ["core 1.8"], "outer_plate": ["core 1.8"]}
FIXED = {"ramp_time": "2 s", "ring_inner_diameter": "115 mm"}
ASKED = {**FRONT, "fix": FIXED, "parts": FEW, "limits": {"friction_surfaces": "14 .. 18"}, "gap": 0.05}
COMPARED = {
    "family": ["disc_clutch", {"family": FAMILY, "parts": {"friction_pair": ["paper_wet"], "inner_plate": ["core 2"]}}],
    "requirements": {"load_torque": "200 N*m", "driver_speed": "700 1/min", "driven_inertia": "2 kg*m2"},
    "objectives": ["mass", "outer_diameter"],
    "fix": {"ramp_time": "0.3 s"},
    "points": 3,
}


class Sliders:
    """Somebody with a front, and pages of it."""

    def __init__(self, site: Site, browser: Any) -> None:
        self.site, self.browser, self.who = site, browser, site.tenant("sliders")
        self.front = self.done("synthesis", ASKED, title="Lifting drive")

    def done(self, kind: str, request: dict[str, Any], **more: Any) -> str:
        """Ask for a job and wait for its end; return its id."""
        job = self.who.submit(kind, request, **more)
        assert self.who.ended(job)["state"] == "done"
        return job

    def children(self, kind: str) -> list[dict[str, Any]]:
        """Return the jobs that follow from the front, the latest first."""
        jobs: list[dict[str, Any]] = self.who.get(f"jobs?kind={kind}&parent={self.front}")["jobs"]
        return jobs

    @contextmanager
    def page(
        self, path: str, prepare: Callable[[Any], object] = lambda page: None, who: Tenant | None = None
    ) -> Iterator[Any]:
        """Open a page; nothing may be complained about, and nothing asked of another host."""
        with visit(self.browser, self.site, who or self.who) as found:
            prepare(found.page)
            found.page.goto(f"{found.address}{path}")
            yield found.page


@pytest.fixture(scope="module")
def sliders(site: Site, browser: Any) -> Sliders:
    return Sliders(site, browser)


def settled(page: Any) -> str:
    """Wait until the strip has an answer; return what it says."""
    page.wait_for_selector(".what-if[data-took]:not(.busy)")
    return str(page.locator(".what-if .told").inner_text())


def test_a_slider_asks_anew_and_the_front_as_asked_stays_as_outlines(sliders: Sliders, tmp_path: Path) -> None:
    with sliders.page(f"/jobs/{sliders.front}") as page:
        slider = page.locator(".knob input[type=range]")
        slider.focus()
        for _ in range(3):
            slider.press("ArrowLeft")  # one search is asked for after the last of them
        told = settled(page)
        page.wait_for_selector("img.drawing")
        assert re.match(r"With load torque 540 N·m against the front as asked: mass at the knee .* → .* kg \(−", told)
        assert page.locator(".scatter .ghost").count() == 3
        assert page.evaluate("document.activeElement.type") == "range"
        assert f"if={HOLDS}" in page.url
        (child,) = sliders.children("synthesis")
        assert page.locator(".what-if a").get_attribute("href") == f"/jobs/{child['id']}"
        assert (child["parent"], child["priority"]) == (sliders.front, 1)
        assert page.locator(".job-head b").inner_text() == "Shown with load torque 540 N·m"
        assert page.title().startswith("load torque 540 N·m: Lifting drive")
        assert page.locator(".chip.differs").all_inner_texts() == ["load torque 540\xa0N·m in place of 600\xa0N·m"]
        assert "driver speed 26.6 rad/s" in page.locator(".chip").all_inner_texts()  # as it was typed
        assert page.locator(".job-head a.button").get_attribute("href") == f"/new?from={child['id']}"
        page.locator(f".files-card a[href*='{child['id']}']").first.wait_for()
        assert page.locator(f".files-card a[href*='{sliders.front}']").count() == 0
        asked = {**ASKED, "requirements": {**DUTY, "load_torque": "540 N*m"}}
        (tmp_path / "spec.yaml").write_text(yaml_text(asked))
        assert in_process("run", str(tmp_path / "spec.yaml"), "-o", str(tmp_path / "out")).returncode == 0
        served_csv = sliders.who.ask("GET", f"jobs/{child['id']}/files/designs.csv", params={"raw": "1"}).content
        assert served_csv == (tmp_path / "out" / "designs.csv").read_bytes()
        page.wait_for_selector(".ticks line", state="attached")
        in_all_forms(page)


def test_the_address_brings_the_same_back_and_nothing_is_asked_twice(sliders: Sliders) -> None:
    with sliders.page(f"/jobs/{sliders.front}#if={HOLDS}") as page:
        told = settled(page)
        page.wait_for_selector(".ticks line", state="attached")
        asked = [len(sliders.children(kind)) for kind in ("synthesis", "whatif")]
        page.reload()
        assert settled(page) == told
        page.wait_for_selector(".ticks line", state="attached")
        assert [len(sliders.children(kind)) for kind in ("synthesis", "whatif")] == asked
        assert "It fits up to" in page.locator(".knob .unseen").inner_text()
        page.get_by_role("button", name="Back to what was asked").click()
        page.wait_for_selector(".scatter .ghost", state="detached")
        assert page.locator(".job-head b, .chip.differs").count() == 0
        page.locator(f".files-card a[href*='{sliders.front}']").first.wait_for()
        assert page.locator(".knob .typed input").input_value() == "600"
        assert "if=" not in page.url


def test_where_nothing_fits_the_ways_out_are_applied_in_place(sliders: Sliders) -> None:
    with sliders.page(f"/jobs/{sliders.front}") as page:
        field = page.locator(".knob .typed input")
        field.fill("many")
        field.press("Enter")
        assert "a number in N·m" in page.locator(".told .fault").inner_text()
        field.fill("700")
        field.press("Enter")
        assert settled(page).startswith("With load torque 700 N·m nothing meets all limits.")
        assert page.locator(".scatter .ghost").count() == 3
        page.wait_for_selector(".nothing ul.ways li")
        in_all_forms(page)
        page.locator(".nothing li", has_text="load torque").first.get_by_role("button", name="Apply").click()
        page.wait_for_selector(".panel")
        assert float(field.input_value()) < 700
        assert page.locator(".scatter .pt").count() > 0


def test_several_sliders_and_a_limit_on_what_was_found(sliders: Sliders) -> None:
    with sliders.page(f"/jobs/{sliders.front}") as page:
        page.get_by_role("button", name="Add another").click()
        offered = page.locator(".knob option").evaluate_all("all => all.map((one) => one.value)")
        assert set(DUTY) <= set(offered)  # in whatever unit they were asked
        second = page.locator(".knob").nth(1)
        second.locator("select").select_option("length<=")
        assert second.locator(".typed input").get_attribute("placeholder") == "no limit"
        slider = second.locator("input[type=range]")
        assert slider.get_attribute("aria-valuetext") == "no limit, as asked"
        slider.press("ArrowLeft")
        assert settled(page).startswith("With length at most ")
        (newest, *_) = sliders.children("synthesis")
        request = sliders.who.ask("GET", f"jobs/{newest['id']}/request").json()
        assert request["limits"]["length"].startswith("<= ")
        second.get_by_role("button", name="Remove this slider").click()
        page.wait_for_selector(".scatter .ghost", state="detached")


def test_whoever_may_only_look_has_no_slider(sliders: Sliders) -> None:
    with sliders.page(f"/jobs/{sliders.front}", who=sliders.site.tenant("sliders", "read")) as page:
        page.wait_for_selector(".explorer .scatter")
        page.wait_for_selector("main [aria-busy=true]", state="detached")
        assert page.locator(".what-if, .knob").count() == 0


def test_a_question_that_took_long_is_asked_as_a_job(sliders: Sliders) -> None:
    def as_slow(page: Any) -> None:
        def answered(route: Any) -> None:
            answer = route.fetch()
            job = answer.json()
            route.fulfill(response=answer, json={**job, "started": job["ended"] - 42.0})

        page.route(f"**/api/v1/jobs/{sliders.front}", answered)

    with sliders.page(f"/jobs/{sliders.front}", as_slow) as page:
        before = len(sliders.children("synthesis"))
        assert "took 42 s" in page.locator(".what-if .told").inner_text()
        page.locator(".knob input[type=range]").press("ArrowRight")
        page.get_by_role("button", name="Ask as a job").click()
        page.wait_for_url(lambda url: sliders.front not in url)
        assert len(sliders.children("synthesis")) == before + 1


def test_the_form_asks_several_families(sliders: Sliders) -> None:
    with sliders.page("/new?family=any") as page:
        page.wait_for_selector(".several")
        for box in page.locator(".several input").all():
            if box.get_attribute("value") not in ("disc_clutch", FAMILY):
                box.uncheck()
        for name, value in {"load_torque": "200", "driver_speed": "700", "driven_inertia": "2"}.items():
            page.locator(f"#f-requirements-{name}").fill(value)
        page.wait_for_selector(".several .good")
        page.wait_for_selector(".side h2.good")
        assert page.locator(".several .good").count() == 2
        assert "family: [disc_clutch, multi_plate_clutch]" in page.locator(".side pre").inner_text()
        in_all_forms(page)


def test_the_common_front_of_families_is_explored(sliders: Sliders) -> None:
    job = sliders.done("compare", COMPARED, title="Which clutch?")
    with sliders.page(f"/jobs/{job}") as page:
        page.wait_for_selector(".explorer .scatter .pt")
        assert page.locator(".certificate strong").inner_text().startswith("Proven")
        rows = page.locator(".outcomes tr")
        assert {"listed", "beaten"} >= {row.locator(".badge").inner_text() for row in rows.all()}
        assert page.locator(".what-if").count() == 0
        in_all_forms(page)
    page_of_one = sliders.who.ask("GET", f"jobs/{job}/files/explorer.html")
    assert page_of_one.status_code == 200
    assert '"families":[' in page_of_one.text


KINDS: dict[str, tuple[dict[str, Any], str, str]] = {
    "prices": ({"design": [1]}, ".found tbody tr", "1 % more"),
    "near_equals": ({}, ".verdict, .found", "within 2 %"),
    "rate": ({"design": 1, "robust": {"friction": "catalogue range"}}, ".used.bad", "does not hold"),
    "verify": ({}, ".verdict.good", "as saved"),
    "report": ({}, ".written a", "report.html"),
    "whatif": ({"vary": {"load_torque": ["560 N*m", "800 N*m"]}}, ".curve .barren", "It fits up to"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_what_kinds_of_jobs_have_found_is_shown(sliders: Sliders, kind: str) -> None:
    request, place, words = KINDS[kind]
    of = (
        {**QUICK, "points": None, "gap": 0.05, "fix": FIXED, "parts": FEW, **request}
        if kind == "whatif"
        else {"of": sliders.front, **request}
    )
    job = sliders.done(kind, {name: value for name, value in of.items() if value is not None})
    with sliders.page(f"/jobs/{job}") as page:
        page.wait_for_selector(place, state="attached")
        until(lambda: words in page.locator("main").inner_text())
        in_all_forms(page)
