"""A family in a package of its own is in forms, answers and the explorer, and no line of the service knows it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.reports.browser import chromium, needs_chromium
from tests.service.pages.visiting import Site, site_in, visit

FAMILY = '''
import synth


class Bracket(synth.DesignProblem):
    """A cantilever of flat steel."""

    name, title, sources = "flat_bracket", "Flat bracket", ("beam theory",)

    def declare(self, d):
        load = d.requirement("load", "N", lower=1, upper=1e5, symbol="F", source="beam theory, load at the end")
        reach = d.requirement("reach", "mm", 200, lower=10, upper=2000, symbol="L")
        height = d.variable("height", "mm", 5, 100, grid=1, symbol="h")
        plates = d.count("plates", 1, 4, symbol="n")
        d.derive("mass", "kg", 7850 * 0.02 * plates * height * reach, symbol="m")
        d.derive("deflection", "mm", 4 * load * reach**3 / (210e9 * 0.02 * plates * height**3), symbol="f")
        d.at_most("stress", 6 * load * reach / (0.02 * plates * height**2), 120e6, "N/mm2")
        d.objective("mass")
        d.objective("deflection")
'''
POINTS = "[clutchsynth.problems]\nflat_bracket = flat_bracket_family:Bracket\n"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """Begin a server beside which a package with a family is installed."""
    folder = tmp_path_factory.mktemp("own-family")
    info = folder / "installed" / "flat_bracket_family-1.0.dist-info"
    info.mkdir(parents=True)
    (folder / "installed" / "flat_bracket_family.py").write_text(FAMILY)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: flat-bracket-family\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(POINTS)
    with site_in(folder, folder / "installed") as found:
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
        rows.first.wait_for(timeout=60_000)
        assert rows.count() > 3
        rows.nth(1).click()
        assert seen.page.locator(".panel h2").first.inner_text() == "Design 2"
        seen.goes("/families/flat_bracket")
        seen.sees("main", "beam theory, load at the end")
