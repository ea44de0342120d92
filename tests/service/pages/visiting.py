"""The service as people see it: a server with workers, and somebody with a browser who has signed in."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import httpx

from synth.batches.store import Store
from synth.queue.accounts import Accounts
from synth.queue.database import file_url
from synth.service.settings import ServiceSettings
from tests.reports.browser import DESKTOP, FORMS, PHONE, Opened, serious
from tests.service.calling import bearer
from tests.service.served import Served, served
from tests.service.working import LIVE, QUICK
from tests.waiting import PATIENCE, until

ALL = ("read", "submit", "admin")
READ_ALOUD = ((DESKTOP, "light"), (PHONE, "dark"))  # forms in which axe looks: both sizes, both themes
CLIENT = httpx.Client(timeout=PATIENCE, verify=False)  # a new one for each request takes longer than the answer


class Tenant:
    """Somebody with a token, who sees nothing of what others ask."""

    def __init__(self, server: Served, token: str) -> None:
        self.server, self.token = server, token

    def ask(self, method: str, path: str, **asked: Any) -> httpx.Response:
        """Ask something of the interface."""
        where = path if path.startswith("/") else f"/api/v1/{path}"
        return CLIENT.request(method, f"{self.server.address}{where}", headers=bearer(self.token), **asked)

    def get(self, path: str) -> Any:
        """Ask for something that is there."""
        answer = self.ask("GET", path)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def post(self, path: str, **asked: Any) -> Any:
        """Ask for something that is taken."""
        answer = self.ask("POST", path, **asked)
        assert answer.status_code in (201, 202), answer.text
        return answer.json()

    def submit(self, kind: str, request: dict[str, Any], **more: Any) -> str:
        """Ask for a job; return its id."""
        return str(self.post("jobs", json={"kind": kind, "request": request, **more})["id"])

    def ended(self, job: str) -> dict[str, Any]:
        """State of a job that has ended."""
        return dict(until(lambda: self.get(f"jobs/{job}"), lambda found: found["state"] not in LIVE))


class Site:
    """A server with workers, and a way to new tenants."""

    def __init__(self, server: Served, token: str) -> None:
        self.server, self.administrator = server, Tenant(server, token)

    def tenant(self, name: str, *scopes: str) -> Tenant:
        """Make somebody who has asked nothing yet."""
        asked = {"name": name, "tenant": name, "scopes": list(scopes or ALL), "days": 1}
        return Tenant(self.server, self.administrator.post("tokens", json=asked)["value"])


@contextmanager
def site_in(folder: Path, installed: Path | None = None) -> Iterator[Site]:
    """Begin a server that has a token from the start, and wait until it answers; packages may stand beside it."""
    (folder / "data").mkdir()
    with Store(file_url(folder / "data" / "jobs.sqlite")) as store:
        accounts = Accounts(store)
        number = accounts.tenant("office", ServiceSettings().tenant_limits)
        token = accounts.make_token("first", number, ALL, 1).value
    beside = {} if installed is None else {"PYTHONPATH": str(installed)}
    with served(folder, "--workers", "2", environment=beside) as server:
        site = Site(server, token)
        until(lambda: site.administrator.ask("POST", "check", json=QUICK).status_code == 200)
        yield site


# Where a page shows as words what is not there.
NOTHING_AS_TEXT = """() => {
  const texts = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT), found = [];
  for (let text = texts.nextNode(); text; text = texts.nextNode())
    if (["null", "undefined"].includes(text.data.trim())) found.push(text.parentElement.outerHTML.slice(0, 200));
  return found;
}"""


class Visitor(Opened):
    """A page of the service that is open."""

    def __init__(self, page: Any, address: str) -> None:
        super().__init__(page)
        self.address = address

    def goes(self, path: str) -> None:
        """Open a page and wait until it has loaded what it shows."""
        self.page.goto(f"{self.address}{path}")
        self.loaded()

    def loaded(self) -> None:
        """Wait until nothing on the page is busy."""
        self.page.wait_for_selector("main [aria-busy=true]", state="detached")
        assert self.page.evaluate(NOTHING_AS_TEXT) == []

    def sees(self, selector: str, text: str = "") -> Any:
        """Wait until something is seen, and return it."""
        found = self.page.locator(selector, has_text=text) if text else self.page.locator(selector)
        found.first.wait_for(state="visible")
        return found.first

    def expects(self, status: int) -> None:
        """Take note of a refusal that the page has shown: browsers call each one an error."""
        said = f"error: Failed to load resource: the server responded with a status of {status} "
        found = next((fault for fault in self.faults if fault.startswith(said)), None)
        assert found is not None, (status, self.faults)
        self.faults.remove(found)


def in_all_forms(page: Any) -> None:
    """Look at a page in all forms: nothing is wider than it, and nobody is left out."""
    for size, theme in FORMS:
        page.set_viewport_size({"width": size[0], "height": size[1]})
        page.emulate_media(color_scheme=theme)
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0], (size, theme)
        if (size, theme) in READ_ALOUD:
            assert serious(page) == [], (size, theme)


Visit = Callable[..., AbstractContextManager[Visitor]]


@contextmanager
def visit(
    browser: Any, site: Site, who: Tenant | None, size: tuple[int, int] = DESKTOP, theme: str = "light"
) -> Iterator[Visitor]:
    """Open a browser of somebody who has signed in; nothing may go wrong in it, nobody else may be asked."""
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, color_scheme=theme)
    context.set_default_timeout(1000.0 * PATIENCE)
    try:
        if who is not None:
            signed = context.request.post(f"{who.server.address}/api/v1/session", headers=bearer(who.token))
            assert signed.status == 201, signed.text()
        found = Visitor(context.new_page(), site.server.address)
        yield found
        assert found.faults == []
        assert found.strangers(site.server.address) == []
    finally:
        context.close()
