"""Pages without a browser: who gets them, what they carry, and that nothing of another tenant is on them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from synth.queue.job_table import NewJob
from synth.service.pages.assets import assets, static_place
from synth.service.security import POLICY
from tests.service.calling import Service, bearer, code_of

ROOT = Path(__file__).parents[3]
PAGES = ROOT / "synth" / "service" / "pages"
ADDRESSES = ("/", "/new", "/batches/new", "/catalogues", "/families", "/families/any_name", "/interface", "/tokens")
EVIL = "<img src=x onerror=alert(1)></script><script>alert(2)</script>"


def job_of(service: Service, tenant: int, title: str) -> str:
    new = NewJob(kind="synthesis", title=title, request={}, fingerprint="f" * 64, code="c", tenant=tenant)
    return service.store.submit(new)[0]


@pytest.mark.slow
@pytest.mark.parametrize("address", [*ADDRESSES, "/sign-in"])
def test_every_page_is_there_with_a_strict_policy_and_nothing_inline(service: Service, address: str) -> None:
    answer = service("GET", address)
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/html")
    assert answer.headers["content-security-policy"] == POLICY
    assert "unsafe" not in POLICY
    assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\bstyle=|\son\w+=|https?://(?!www\.w3\.org/)", answer.text)
    for link in re.findall(r'(?:src|href)="(/static/[^"]*)"', answer.text):
        assert service("GET", link).status_code == 200, link


def test_pages_need_a_token_as_soon_as_there_is_one(service: Service) -> None:
    token = service.token("read")
    for address in ADDRESSES:
        answer = service("GET", address)
        assert (answer.status_code, answer.headers["location"]) == (303, f"/sign-in?next={address}")
    assert service("GET", "/sign-in").status_code == 200
    for address in ADDRESSES:
        shown = service("GET", address, headers=bearer(token))
        assert shown.status_code == (403 if address == "/tokens" else 200), address
        assert 'href="/tokens"' not in shown.text
        assert shown.headers["content-security-policy"] == POLICY


def test_a_browser_that_has_signed_in_sees_pages(service: Service) -> None:
    token = service.token("read", "submit")
    signed = service("POST", "/api/v1/session", headers=bearer(token))
    assert service("GET", "/new", cookies=dict(signed.cookies)).status_code == 200


def test_jobs_of_others_are_not_there(service: Service) -> None:
    own, other = service.token(), service.token(tenant="other")
    job = job_of(service, service.accounts.tenant("other", service.settings.tenant_limits), "Secret drive")
    assert service("GET", f"/jobs/{job}", headers=bearer(other)).status_code == 200
    foreign = service("GET", f"/jobs/{job}", headers=bearer(own))
    missing = service("GET", "/jobs/nothing", headers=bearer(own))
    assert foreign.status_code == missing.status_code == 404
    assert "Secret" not in foreign.text
    assert foreign.headers["content-type"].startswith("text/html")
    assert foreign.headers["content-security-policy"] == POLICY


def test_rows_are_those_of_batches(service: Service) -> None:
    study = job_of(service, 1, "Hoist")
    new = NewJob(kind="batch", title=EVIL, request={}, fingerprint="b" * 64, code="c", tenant=1)
    batch = service.store.submit(new)[0]
    shown = service("GET", f"/jobs/{batch}/rows/2")
    assert (shown.status_code, EVIL in shown.text) == (200, False)
    assert 'data-line="2"' in shown.text
    for address in (f"/jobs/{study}/rows/2", f"/jobs/{batch}/rows/0", f"/jobs/{batch}/rows/x", "/jobs/nothing/rows/2"):
        assert service("GET", address).status_code == 404, address


def test_a_title_is_text_whatever_stands_in_it(service: Service) -> None:
    job = job_of(service, 1, EVIL)
    text = service("GET", f"/jobs/{job}").text
    assert EVIL not in text
    assert "<img" not in text
    assert "&lt;img src=x onerror=alert(1)&gt;&lt;/script&gt;" in text


@pytest.mark.slow
@pytest.mark.parametrize("address", ["/families/..%2f..%2fetc", "/families/A-B", "/jobs/%00", "/static/x/../app.py"])
def test_what_is_no_page_is_not_found(service: Service, address: str) -> None:
    assert service("GET", address).status_code == 404


BROWSER = {"accept": "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"}


@pytest.mark.slow
@pytest.mark.parametrize("address", ["/nothing", "/jobs", "/a/<b>/c", "/api"])
def test_a_browser_is_shown_a_page_where_none_is(service: Service, address: str) -> None:
    for headers in ({}, bearer(service.token())):
        shown = service("GET", address, headers={**BROWSER, **headers})
        assert shown.status_code == 404
        assert shown.headers["content-type"].startswith("text/html")
        assert shown.headers["content-security-policy"] == POLICY
        assert "There is no page at this address." in shown.text
        assert 'href="/"' in shown.text
        assert "<b>" not in shown.text
    told = service("GET", address)
    assert (told.status_code, code_of(told)) == (404, "not_found")


def test_programs_are_told_in_their_way_whatever_they_take(service: Service) -> None:
    for address in ("/api/v1/nothing", "/api/nothing", "/api/v1/jobs/x"):
        told = service("GET", address, headers=BROWSER)
        assert (told.status_code, code_of(told)) == (404, "not_found"), address


def test_static_files_are_kept_by_browsers_and_change_their_address_with_their_content(service: Service) -> None:
    place = f"{static_place()}/base.css"
    first = service("GET", place)
    assert first.headers["cache-control"].endswith("immutable")
    assert service("GET", place, headers={"if-none-match": first.headers["etag"]}).status_code == 304
    earlier = service("GET", "/static/0123456789abcdef/base.css")
    assert (earlier.status_code, earlier.headers["cache-control"]) == (200, "private, no-cache")
    assert service("GET", f"{static_place()}/nothing.js").status_code == 404


def test_answers_of_the_interface_are_as_before(service: Service) -> None:
    service.token()
    answer = service("GET", "/api/v1/jobs/nothing")
    assert answer.status_code == 401
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["cache-control"] == "private, no-cache"


def test_scripts_make_no_markup_of_texts_and_load_nothing_from_elsewhere() -> None:
    scripts = sorted((PAGES / "static").glob("*.js"))
    assert len(scripts) > 10
    for path in scripts:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function", text), (
            path
        )
        assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", text), path
        assert len(text.splitlines()) < 400, path
        for module in re.findall(r'from "\./([^"]+)"', text):
            assert module in assets(), f"{path.name}: {module}"


def test_everything_that_pages_need_is_packed() -> None:
    packed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]["synth"]
    found = {path for pattern in packed for path in (ROOT / "synth").glob(pattern)}
    wanted = {path for path in PAGES.rglob("*") if path.suffix in (".html", ".js", ".css", ".svg", ".json")}
    assert wanted <= found
