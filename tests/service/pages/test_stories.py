"""What people do with the pages, in a browser, from the first start to the last row of a table."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from synth.service.api.schemas import EXAMPLES
from tests.reports.browser import DESKTOP, PHONE, needs_chromium
from tests.service.pages.visiting import Site, Visit, in_all_forms
from tests.service.working import BATCH, DUTY, FRONT, LONG, QUICK
from tests.waiting import until

pytestmark = [pytest.mark.slow, needs_chromium]
EVIL = "<img src=x onerror=alert(1)>"
TURNED = "\u202eהיפוך ימין לשמאל"  # no title may turn the direction of writing, but cells of a table may
HOSTILE = (
    EVIL,
    '"><script>alert(2)</script>',
    TURNED,
    "🛠️🚀 ' OR 1=1 --",
    "W" * 180,
    "javascript:alert(3)",
    "{{ 7 * 7 }} ${7*7} <!-- ",
)
TOO_SMALL = {
    "family": "cone_clutch",
    "requirements": {
        "load_torque": "200 N*m",
        "driver_speed": "700 1/min",
        "driven_inertia": "2 kg*m2",
        "engagements_per_hour": "30 1/h",
        "jerk_limit": "600 rad/s3",
        "outer_diameter_limit": "100 mm",
    },
    "parts": {"friction_pair": ["woven_dry"]},
    "points": 1,
}
TABLE = """\
Machine,load_torqe [N*m],Speed,driven_inertia [kg*m2],engagements_per_hour [1/h],jerk_limit [rad/s3],wear_life_min,fix
winch,400,26.6,30,50,18,200000,ramp_time = 2 s
crane,"6,5",26.6,30,50,18,200000,ramp_time = 2 s
hoist,600,26.6,30,50,18,200000,ramp_time = 2 s
"""

FOCUSED = """(() => {
  const one = document.activeElement, near = one.closest('label, .drop, .typed, p');
  const lit = (own, part) => own && getComputedStyle(own, part).outlineStyle !== 'none';
  window.seen ??= new Map();
  if (!seen.has(one)) seen.set(one, seen.size);
  const seenAt = [one, near, near?.querySelector('.button')].some((own) => lit(own)) || lit(one, '::after');
  return [seen.get(one), one.tagName, seenAt, one.outerHTML.slice(0, 80)];
})()"""


def typed(page: Any, name: str) -> Any:
    """Return the field of a requirement."""
    return page.locator(f"#f-requirements-{name}")


# ---- studies --------------------------------------------------------------------------------------------------------


def test_the_list_of_studies_waits_for_no_family(visited: Visit, site: Site) -> None:
    someone = site.tenant("waits")
    someone.submit("synthesis", QUICK)
    with visited(someone) as seen:
        held: list[Any] = []
        seen.page.route("**/api/v1/families", lambda route: held.append(route))
        seen.page.goto(f"{seen.address}/")
        seen.sees(".studies li .about", "multi plate clutch")  # by its name, while its title is not known
        held[0].continue_()
        seen.sees(".studies li .about", "Multi-plate clutch")


def test_a_first_start_leads_to_a_front_with_one_click(site: Site, visited: Visit) -> None:
    with visited(site.tenant("first")) as found:
        found.goes("/")
        offered = found.page.locator(".offers li")
        found.sees(".offers li")
        assert offered.count() == 3
        offered.first.get_by_role("button", name="Run it").click()
        found.page.wait_for_url("**/jobs/*")
        found.sees(".explored table.designs tbody tr")
        found.goes("/")
        assert found.sees(".studies li .badge").inner_text().endswith("Done")


def test_a_faulty_field_is_told_and_mended_and_the_study_watched_to_its_end(site: Site, visited: Visit) -> None:
    with visited(site.tenant("form")) as found:
        page = found.page
        found.goes("/new?example=hoist_multi_plate")
        torque = typed(page, "load_torque")
        torque.fill("6,5")
        told = found.sees("#f-requirements-load_torque-fault", "decimal")
        assert "expected a decimal point instead of a decimal comma" in told.inner_text()
        assert page.get_by_role("button", name="Find designs").is_disabled()
        page.locator(".checks a", has_text="load torque").click()
        found.sees("#f-requirements-load_torque:focus")
        assert torque.get_attribute("aria-invalid") == "true"
        assert "/new" in page.url
        torque.fill("0.6 kN*m")
        assert "600" in found.sees("#f-requirements-load_torque-read", "read as").inner_text()
        page.locator("#title").fill("Hoist, mended")
        page.locator("#points").fill("40")
        page.get_by_role("button", name="Find designs").click()
        page.wait_for_url("**/jobs/*")
        found.sees(".job-head .badge", "Running")
        page.reload()
        found.sees(".steps, .explored")
        found.sees(".explored table.designs tbody tr")
        assert page.locator("h1").first.inner_text() == "Hoist, mended"
        page.locator(".explored table.designs tbody tr").nth(1).click()
        assert page.locator(".explored .panel").first.is_visible()


def test_a_long_study_is_cancelled_and_can_go_on(site: Site, visited: Visit) -> None:
    who = site.tenant("cancel")
    job = who.submit("synthesis", LONG, title="Long one")
    with visited(who, PHONE, "dark") as found:
        found.goes(f"/jobs/{job}")
        found.sees(".job-head .badge", "Running")
        found.page.get_by_role("button", name="Cancel").click()
        found.sees(".job-head .badge", "Cancelled")
        assert found.page.get_by_role("button", name="Resume").is_visible()
        assert who.get(f"jobs/{job}")["state"] == "cancelled"
        found.page.get_by_role("button", name="Delete").click()
        found.sees("dialog").get_by_role("button", name="Delete").click()
        found.page.wait_for_url(f"{found.address}/")
        found.sees(".welcome")


def test_where_nothing_is_feasible_a_way_out_is_applied(site: Site, visited: Visit) -> None:
    who = site.tenant("ways")
    job = who.submit("synthesis", TOO_SMALL, title="Small cone")
    who.ended(job)
    with visited(who) as found:
        page = found.page
        found.goes(f"/jobs/{job}")
        found.sees(".job-head .badge", "Not feasible")
        page.get_by_role("button", name="Find ways out").click()
        way = found.sees(".ways li", "outer diameter limit")
        assert "nothing less would do" in way.inner_text()
        found.sees(".nothing h4", "enough")
        assert not re.search("[<>]=|_", page.locator(".nothing").inner_text())
        assert "outer diameter limit 100\xa0mm" in page.locator(".chip").all_inner_texts()
        way.get_by_role("link", name="Apply").click()
        page.wait_for_url("**/new?from=*")
        found.sees("#f-requirements-outer_diameter_limit")
        assert float(typed(page, "outer_diameter_limit").input_value().split()[0]) > 100
        page.get_by_role("button", name="Find designs").click()
        page.wait_for_url("**/jobs/*")
        found.sees(".explored table.designs tbody tr")


def test_a_front_is_asked_further_and_the_list_leaves_out_what_followed(site: Site, visited: Visit) -> None:
    who = site.tenant("further")
    front = who.submit("synthesis", FRONT, title="Lifting drive")
    who.ended(front)
    with visited(who) as found:
        page = found.page
        found.goes(f"/jobs/{front}")
        asks = page.locator(".ask-list button")
        assert "Rating" not in asks.all_inner_texts()  # nothing was said of what scatters
        page.locator(".explored table.designs tbody tr").nth(1).click()
        assert "Near equals of design 2" in asks.all_inner_texts()
        page.get_by_role("button", name="Near equals of design 2").click()
        found.sees(".followed li", "Done")
        with page.expect_response(lambda answer: answer.request.method == "POST") as again:
            page.get_by_role("button", name="Near equals of design 2").click()
        assert again.value.status == 200  # no second job
        (child,) = who.get(f"jobs?parent={front}")["jobs"]
        assert (child["kind"], child["title"]) == ("near_equals", "Near equals of design 2: Lifting drive")
        assert who.get(f"jobs/{child['id']}/request")["design"] == 2
        found.goes("/")
        assert page.locator(".studies .title").all_inner_texts() == ["Lifting drive"]
        page.get_by_role("button", name="Also what followed").click()
        found.sees(".studies .title", "Near equals of design 2")
        page.reload()
        found.sees(".studies .title", "Near equals of design 2").click()
        found.sees(".job-head a", "what it follows from")
    with visited(site.tenant("further", "read")) as found:
        found.goes(f"/jobs/{front}")
        assert found.page.locator(".ask-list").count() == 0
        found.sees(".followed a", "Near equals of design 2")


# ---- tables ---------------------------------------------------------------------------------------------------------


def test_a_table_is_understood_checked_asked_and_led_from_a_row_to_its_designs(site: Site, visited: Visit) -> None:
    with visited(site.tenant("batch")) as found:
        page = found.page
        found.goes("/batches/new?family=multi_plate_clutch")
        file = {"name": "duty.csv", "mimeType": "text/csv", "buffer": TABLE.encode()}
        page.set_input_files("#file", file)
        found.sees(".meanings .fault", "expected load_torque")
        found.expects(422)
        page.get_by_role("button", name="It means load torque").click()
        speed = page.get_by_label("What Speed means")
        found.sees("[role=status]", "none can be asked")
        until(lambda: found.sees("tr", "driver_speed").inner_text().startswith("2, 4"))
        speed.select_option("driver_speed")
        page.get_by_label("Unit of Speed").fill("furlong")
        found.sees(".meanings .fault", "furlong")
        found.expects(422)
        page.get_by_label("Unit of Speed").fill("rad/s")
        fault = found.sees("td.fault", "6,5")
        assert fault.locator("xpath=..").inner_text().split()[:2] == ["3", "load_torqe"]
        assert page.locator(".sheet td.wrong").text_content() == "faulty: 6,5"
        page.get_by_label("Designs for each row").fill("many")
        found.sees("#points-fault", "many")
        found.expects(422)
        page.get_by_label("Designs for each row").fill("3")
        page.get_by_label("length").uncheck()
        page.set_input_files("#file", {**file, "buffer": TABLE.replace('"6,5"', "500").encode()})
        found.sees("[role=status]", "all can be asked")
        assert speed.input_value() == "driver_speed"
        page.set_input_files("#file", file)
        page.get_by_role("button", name="Start 2 rows without the faulty").click()
        page.wait_for_url("**/jobs/*")
        found.sees(".job-head .badge", "Done")
        found.sees(".legend li", "2 optimal")
        page.get_by_role("button", name="1 faulty").click()
        found.sees("h2", "Rows: faulty")
        assert "expected a decimal point" in found.sees(".rows .best", "6,5").inner_text()
        assert page.locator(".rows tbody tr").count() == 1
        page.reload()
        found.sees("h2", "Rows: faulty")
        page.get_by_role("button", name="Show all rows").click()
        page.locator("tr", has=page.get_by_role("link", name="Line 4")).locator(".best a").click()
        found.sees("h1", "Line 4")
        assert page.url.endswith("/rows/4#design")
        assert "kg" in found.sees(".figures dd").inner_text()
        assert page.locator(".facts dd", has_text="hoist").is_visible()
        page.get_by_role("button", name="Open in the explorer").click()
        found.sees(".explored table.designs tbody tr")
        assert page.locator("h1").first.inner_text() == "Line 4: hoist"


# ---- who may --------------------------------------------------------------------------------------------------------


def test_somebody_signs_in_and_who_may_only_read_sees_nothing_to_ask_with(site: Site, visited: Visit) -> None:
    office = site.tenant("reading")
    job = office.submit("synthesis", QUICK, title="Somebody else asked")
    reader = site.tenant("reading", "read")
    with visited(None) as found:
        page = found.page
        page.goto(f"{found.address}/jobs/{job}")
        page.get_by_label("Token").fill("cs_wrong")
        page.get_by_role("button", name="Sign in").click()
        found.sees("#fault", "token")
        found.expects(401)
        page.get_by_label("Token").fill(reader.token)
        page.keyboard.press("Enter")
        page.wait_for_url(f"**/jobs/{job}")
        found.sees("h1", "Somebody else asked")
        assert page.locator(".job-head button").count() == 0
        assert page.locator("nav a").all_inner_texts() == ["Studies", "Catalogues", "Families", "API"]
        for path in ("/", "/new", "/batches/new", "/catalogues", "/families"):
            found.goes(path)
            assert page.get_by_role("link", name=re.compile("New study|Batch")).count() == 0, path
            assert page.get_by_role("button", name=re.compile("Start|Find designs|Keep as|Run it")).count() == 0, path
        page.get_by_role("button", name="Sign out").click()
        page.wait_for_url("**/sign-in")


def test_tokens_are_made_shown_once_and_revoked(site: Site, visited: Visit) -> None:
    with visited(site.tenant("tokens")) as found:
        page = found.page
        found.goes("/tokens")
        page.get_by_label("Name").fill("robot")
        page.get_by_label("Valid for").fill("soon")
        page.get_by_role("button", name="Make it").click()
        found.sees("#days-fault", "days")
        found.expects(422)
        page.get_by_label("Valid for").fill("30")
        page.get_by_role("button", name="Make it").click()
        assert found.sees("code.token").inner_text().startswith("cs_")
        line = page.locator("tr", has=page.locator("th", has_text="robot"))
        line.get_by_role("button").click()
        line.get_by_role("button", name="Revoke").click()
        found.sees("tr .badge", "revoked")
        page.reload()
        found.sees("tr .badge", "revoked")
        assert page.locator("code.token").count() == 0


def test_whoever_brings_a_part_table_sees_how_it_was_read(site: Site, visited: Visit) -> None:
    with visited(site.tenant("tables")) as found:
        page = found.page
        found.goes("/catalogues")
        page.locator("#name").fill("my_linings")
        page.locator("#table").select_option("friction_materials")
        page.locator("#csv").fill("designation;mu_dynamics [-]\nL1;0,12\n")
        page.get_by_role("button", name="Keep as a new version").click()
        found.sees("#kept li", "did you mean mu_dynamic?")
        page.locator("#kept a").click()
        page.wait_for_url("**/catalogues?own=my_linings%401")
        found.sees("table.sheet th", "mu dynamics")
        found.sees("table.sheet td", "0,12")


# ---- texts of others ------------------------------------------------------------------------------------------------


def test_texts_are_shown_and_nothing_of_them_is_done(site: Site, visited: Visit) -> None:
    who = site.tenant("hostile")
    head = [*DUTY, *HOSTILE[:2]]
    cells = [*map(str, DUTY.values()), HOSTILE[2], HOSTILE[3]]
    csv = "\n".join(",".join('"' + cell.replace('"', '""') + '"' for cell in line) for line in (head, cells)).encode()
    asked = {k: v for k, v in BATCH.items() if k != "rows"}
    upload = who.post("uploads", files={"file": (f"{HOSTILE[0]}.csv", csv)})["id"]
    table = who.post("batches", json={**asked, "upload": upload})["id"]
    rows = EXAMPLES["catalogue"]["csv"].replace("data sheet", f'"{EVIL}"')
    kept = who.post("catalogues", json={**EXAMPLES["catalogue"], "csv": rows, "note": HOSTILE[1]})
    titles = [text for text in HOSTILE if text != TURNED]
    jobs = [who.submit("synthesis", {**QUICK, "seed": k}, title=text) for k, text in enumerate(titles)]
    turned = who.ask("POST", "jobs", json={"kind": "synthesis", "request": QUICK, "title": TURNED})
    assert turned.status_code == 422
    made = site.administrator.ask("POST", "tokens", json={"name": HOSTILE[3], "scopes": ["read"]})
    assert made.status_code in (201, 422)
    who.ended(table)
    who.ended(jobs[-1])
    with visited(who, PHONE) as found:
        page = found.page

        def harmless() -> None:
            brought = "img:not(.drawing), main script, [onerror], a[href^='javascript']"
            assert page.locator(brought).count() == 0, page.url
            assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0], page.url

        found.goes("/")
        for text in titles:
            found.sees(".studies .title", text)
        harmless()
        for job in (jobs[0], jobs[2], jobs[4]):
            found.goes(f"/jobs/{job}")
            found.sees(".explored, .certificate")
            harmless()
        found.goes(f"/jobs/{table}")
        found.sees(".rows tbody tr")
        harmless()
        found.goes(f"/jobs/{table}/rows/2")
        found.sees("dt", HOSTILE[1])
        found.sees("dd", HOSTILE[2])
        harmless()
        found.goes(f"/catalogues?own={kept['reference']}")
        assert found.sees(".sheet td", EVIL).is_visible()
        harmless()
        found.goes("/catalogues")
        found.sees("td", HOSTILE[1])
        page.locator("#name").fill(EVIL)
        page.locator("#csv").fill(EVIL)
        page.get_by_role("button", name="Keep as a new version").click()
        found.sees("#name-fault", EVIL)
        found.expects(422)
        harmless()
        found.goes("/tokens")
        harmless()
        found.goes("/batches/new?family=multi_plate_clutch")
        page.set_input_files("#file", {"name": f"{EVIL}.csv", "mimeType": "text/csv", "buffer": csv})
        found.sees("th", HOSTILE[1])
        found.sees(".meanings li", EVIL)
        harmless()
        found.goes("/new?example=hoist_multi_plate")
        for text in HOSTILE:
            typed(page, "load_torque").fill(text)
            found.sees("#f-requirements-load_torque-fault", "expected")
        typed(page, "load_torque").fill("600")
        page.locator("#title").fill(EVIL)
        page.locator("summary", has_text="Parts").click()
        page.locator("input[id^=f-parts]").first.fill(EVIL)
        found.sees("[id^=f-parts][id$=-fault], .checks li", "img")
        harmless()


# ---- how pages look -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def shelf(site: Site) -> dict[str, str]:
    """Yield addresses of pages with something on them."""
    who = site.administrator
    front, table = who.submit("synthesis", FRONT, title="Lifting drive"), who.submit("batch", BATCH)
    none = who.submit("synthesis", TOO_SMALL, title="Small cone")
    for more in ("", "L2,0.4,data sheet,typical\n"):
        catalogue = who.post("catalogues", json={**EXAMPLES["catalogue"], "csv": EXAMPLES["catalogue"]["csv"] + more})
    for job in (front, table, none):
        who.ended(job)
    sizes = who.submit("size_range", {"of": table}, parent=table)
    who.ended(sizes)
    return {
        "studies": "/",
        "form": "/new?example=hoist_multi_plate",
        "table": "/batches/new?family=multi_plate_clutch",
        "front": f"/jobs/{front}",
        "nothing": f"/jobs/{none}",
        "batch": f"/jobs/{table}",
        "row": f"/jobs/{table}/rows/2",
        "faulty row": f"/jobs/{table}/rows/4",
        "sizes": f"/jobs/{sizes}",
        "catalogues": "/catalogues",
        "own": f"/catalogues?own={catalogue['reference']}",
        "shipped": "/catalogues?table=core_plates",
        "families": "/families",
        "family": "/families/multi_plate_clutch",
        "interface": "/interface",
        "tokens": "/tokens",
        "sign in": "/sign-in",
        "refusal": "/families/no_such_family",
    }


READY = {
    "front": ".explored table.designs tbody tr",
    "batch": ".rows, .plot",
    "sizes": ".sheet",
    "nothing": ".nothing .missing",
}
PAGES = (
    *("studies", "form", "table", "front", "nothing", "batch", "row", "faulty row", "sizes", "catalogues", "own"),
    *("shipped", "families", "family", "interface", "tokens", "sign in", "refusal"),
)


@pytest.mark.parametrize("name", PAGES)
def test_each_page_can_be_used_by_all_in_every_form(
    site: Site, shelf: dict[str, str], visited: Visit, name: str
) -> None:
    with visited(site.administrator) as found:
        page = found.page
        found.goes(shelf[name])
        if name in READY:
            found.sees(READY[name])
        if name == "table":
            page.set_input_files("#file", {"name": "d.csv", "mimeType": "text/csv", "buffer": TABLE.encode()})
            found.sees(".meanings .fault", "expected")
            found.expects(422)
        if name == "refusal":
            found.sees("h1", "No such family")
            found.expects(404)
        if name == "interface":
            for k in (3, 6):
                page.locator("summary").nth(k).click()
        assert page.locator("h1").count() == 1
        assert page.title().endswith("clutchsynth")
        if name != "interface":  # which tells what JSON may hold
            assert not re.findall(r"\b(?:null|undefined|NaN|object Object)\b", page.locator("main").inner_text())
        in_all_forms(page)


def test_everything_is_reached_by_keys_and_what_has_the_focus_is_seen(site: Site, visited: Visit) -> None:
    with visited(site.administrator) as found:
        page = found.page
        for path in ("/", "/batches/new", "/catalogues", "/interface", "/tokens"):
            found.goes(path)
            wanted = page.evaluate(
                "[...document.querySelectorAll('a[href], button:not(:disabled), input, select, textarea, summary')]"
                ".filter((one) => one.checkVisibility()).length"
            )
            reached = set()
            for _ in range(wanted + 5):
                page.keyboard.press("Tab")
                told = page.evaluate(FOCUSED)
                if told[1] == "BODY":
                    break
                reached.add(told[0])
                assert told[2], (path, told)
            assert len(reached) >= wanted, path


def test_what_is_printed_has_nothing_to_press(
    site: Site, shelf: dict[str, str], visited: Visit, tmp_path: Path
) -> None:
    with visited(site.administrator) as found:
        page = found.page
        for name in ("row", "batch", "front"):
            found.goes(shelf[name])
            if name in READY:
                found.sees(READY[name])
            page.emulate_media(media="print", color_scheme="dark")
            assert not page.locator("header.top").is_visible()
            assert (
                page.locator(".job-head button:visible, .heading button:visible, input[type=search]:visible").count()
                == 0
            )
            assert page.locator("h1").first.is_visible()
            for heading in page.locator("main th[scope=col]:visible").all():
                assert heading.inner_text().strip(), name
            ground = page.evaluate("getComputedStyle(document.querySelector('.card, .explored')).backgroundColor")
            assert ground in ("rgb(255, 255, 255)", "rgba(0, 0, 0, 0)"), ground
            page.emulate_media(media="screen", color_scheme="light")


def test_what_is_told_aloud_is_told_once(site: Site, shelf: dict[str, str], visited: Visit) -> None:
    with visited(site.administrator, DESKTOP) as found:
        found.goes(shelf["table"])
        found.page.set_input_files(
            "#file",
            {
                "name": "d.csv",
                "mimeType": "text/csv",
                "buffer": TABLE.replace("torqe", "torque").replace("Speed", "driver_speed").encode(),
            },
        )
        found.sees("[role=status]", "1 faulty")
        said = found.page.locator("[role=status], [role=alert], [aria-live]").all_inner_texts()
        assert [text for text in said if text.strip()] == ["3 rows: 1 faulty, the others can be asked."]


def test_standard_sizes_are_asked_with_a_field_of_the_verb(site: Site, visited: Visit) -> None:
    who = site.tenant("sizes")
    job = who.submit("batch", {**BATCH, "rows": BATCH["rows"][:1]})
    who.ended(job)
    with visited(who) as found:
        found.goes(f"/jobs/{job}")
        field = found.sees("#f-request-variants")
        assert "How many variants" in found.sees(".field:has(#f-request-variants) .note").inner_text()
        field.fill("0")
        found.page.get_by_role("button", name="Choose sizes").click()
        found.sees("#f-request-variants-fault", "expected a whole number")
        found.expects(422)
        assert field.get_attribute("aria-invalid") == "true"
        field.fill("1")
        found.page.get_by_role("button", name="Choose sizes").click()
        found.page.wait_for_url(lambda url: not url.endswith(job))
