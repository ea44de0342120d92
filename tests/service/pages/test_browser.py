"""Stories in a browser: a form with a fault, watching, a result; cancelling; nothing feasible and a way out."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

from synth.jobs.engine_process import Engines
from tests.service.working import DUTY, FAMILY, LONG, QUICK, listened, working

pytestmark = pytest.mark.slow
CHROMIUM = shutil.which("chromium")
playwright = pytest.importorskip("playwright.sync_api", reason="stories in a browser need playwright")
if CHROMIUM is None:
    pytest.skip("stories in a browser need chromium", allow_module_level=True)

PATIENCE = 60_000.0  # ms
EVIL = '<img src="x" onerror="alert(1)"></script>'
REFUSED = {**QUICK, "requirements": {**DUTY, "outer_diameter_limit": "100 mm"}}


@pytest.fixture(scope="module")
def engines() -> Iterator[Engines]:
    found = Engines(1)
    yield found
    found.close()


@pytest.fixture(scope="module")
def home(engines: Engines, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("pages")
    with working(folder, engines, called=False, small_deadline=60.0) as service, listened(service) as address:
        yield address


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as found:
        opened = found.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(params=[(1440, "light"), (390, "dark")], ids=["desktop", "phone"])
def page(browser: Any, home: str, request: pytest.FixtureRequest) -> Iterator[Any]:
    """Yield a page; whatever it complains of, or asks of others, is a failure."""
    wide, scheme = request.param
    context = browser.new_context(viewport={"width": wide, "height": 900}, color_scheme=scheme, base_url=home)
    shown = context.new_page()
    shown.set_default_timeout(PATIENCE)
    wrong: list[str] = []
    shown.on("console", lambda said: wrong.append(said.text) if said.type in ("error", "warning") else None)
    shown.on("pageerror", lambda error: wrong.append(str(error)))
    shown.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
    shown.on("request", lambda asked: None if asked.url.startswith(home) else wrong.append(asked.url))
    yield shown
    assert not wrong
    assert shown.evaluate("document.documentElement.scrollWidth <= innerWidth")
    context.close()


def asked(page: Any, home: str, request: dict[str, Any], title: str) -> str:
    body = {"kind": "synthesis", "request": request, "title": title}
    answer = page.request.post(f"{home}/api/v1/jobs", data=body)
    assert answer.status == 202
    return str(answer.json()["id"])


def test_a_fault_is_told_at_its_field_and_mended_and_the_search_ends_as_a_result(page: Any) -> None:
    page.goto(f"/new?family={FAMILY}")
    page.get_by_label("load torque").fill("6,5")
    page.get_by_text("expected a decimal point instead of a decimal comma").wait_for()
    for name, value in DUTY.items():
        page.locator(f"#f-requirements-{name}").fill(str(value))
    page.get_by_text("read as 254.01 1/min").wait_for()
    page.locator("summary", has_text="Sizes that are given").click()
    page.locator("#f-fix-ramp_time").fill("2")
    page.get_by_label("Designs at most").fill("3")
    page.get_by_role("heading", name="Ready").wait_for()
    page.get_by_label("Title").fill(EVIL)
    page.get_by_role("button", name="Find designs").click()
    page.wait_for_url("**/jobs/*")
    page.reload()
    page.get_by_text("proven").first.wait_for()
    page.get_by_role("link", name="Designs, CSV").wait_for()
    assert page.get_by_role("heading", level=1).inner_text() == EVIL
    page.goto("/")
    page.get_by_role("link", name=EVIL).first.wait_for()
    assert page.locator("img").count() == 0


def test_a_search_is_cancelled(page: Any, home: str) -> None:
    page.goto(f"/jobs/{asked(page, home, {**LONG, 'gap': 1e-6, 'points': 500}, 'long')}")
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("The job was cancelled").wait_for()
    page.get_by_role("button", name="Resume").wait_for()


def test_where_nothing_is_feasible_a_way_out_becomes_a_new_study(page: Any, home: str) -> None:
    page.goto(f"/jobs/{asked(page, home, REFUSED, 'too small')}")
    page.get_by_role("heading", name="Nothing is feasible").wait_for()
    page.get_by_role("button", name="Find ways out").click()
    page.get_by_role("link", name="Apply").first.click()
    page.wait_for_url("**/new?from=*")
    page.get_by_role("heading", name="Ready").wait_for()
    assert page.locator("#f-requirements-outer_diameter_limit").input_value() != "100"
