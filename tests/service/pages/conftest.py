"""One server for all pages that a process of the tests opens, and a browser for each file.

A browser that is steered keeps the loop of its process to itself: it is closed before tests with a loop of their own.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.reports.browser import chromium
from tests.service.pages.visiting import Site, Tenant, Visit, site_in, visit


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    with site_in(tmp_path_factory.mktemp("pages")) as found:
        yield found


@pytest.fixture
def visited(browser: Any, site: Site) -> Visit:
    def begin(who: Tenant | None, *form: Any) -> Any:
        return visit(browser, site, who, *form)

    return begin
