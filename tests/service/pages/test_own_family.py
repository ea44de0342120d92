"""A family in a package of its own is in forms, answers and the explorer, and no line of the service knows it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.installed_beside import installed_beside
from tests.reports.browser import chromium, needs_chromium
from tests.service.pages.visiting import Site, site_in, visit


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """Begin a server beside which a package with a family is installed."""
    folder = tmp_path_factory.mktemp("own-family")
    with site_in(folder, installed_beside(folder / "installed")) as found:
        yield found


@pytest.mark.slow
def test_the_interface_knows_it(site: Site) -> None:
    who = site.tenant("interface")
    assert "flat_bracket" in [family["name"] for family in who.get("families")["families"]]
    named = {row["name"]: row for row in who.get("families/flat_bracket")["rows"]}
    assert (named["load"]["unit"], named["load"]["symbol"]) == ("N", "F")
    job = who.submit("synthesis", {"family": "flat_bracket", "requirements": {"load": "800 N"}, "points": 6})
    assert who.ended(job)["summary"]["certificate"] == "global"


@pytest.mark.slow
@needs_chromium
def test_its_form_is_filled_in_and_its_front_explored(site: Site) -> None:
    with chromium() as browser, visit(browser, site, site.tenant("pages")) as seen:
        seen.goes("/new?family=flat_bracket")
        seen.page.get_by_label("load").first.fill("80 kg")
        seen.sees(".fault", "Got '80 kg'")
        seen.page.get_by_label("load").first.fill("800 N")
        seen.page.get_by_role("button", name="Find designs").click()
        rows = seen.page.locator("table.designs tbody tr")
        rows.first.wait_for()
        assert rows.count() > 3
        rows.nth(1).click()
        assert seen.page.locator(".panel h2").first.inner_text() == "Design 2"
        seen.goes("/families/flat_bracket")
        seen.sees("main", "beam theory, load at the end")
