"""A service without a wire: the application called directly, and engine processes that answer what tests want."""

from __future__ import annotations

import asyncio
import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

import httpx
from fastapi import FastAPI

from synth.batches.store import Store
from synth.queue.accounts import Accounts
from synth.queue.database import file_url
from synth.service.app import create_app
from synth.service.context import ServiceContext
from synth.service.settings import ServiceSettings
from synth.service.small_work import EngineCalls
from tests.queue.databases import empty_file

HOME = "http://127.0.0.1:8350"


class Answering:
    """Stands in for engine processes: answers by a function."""

    def __init__(self, answer: Callable[[str, Any], Any] = lambda task, payload: payload) -> None:
        self.answer = answer

    def call(self, task: str, payload: Any, limit: float) -> Any:
        return self.answer(task, payload)


class Service:
    """An application with an empty database, and whoever calls it from an address."""

    def __init__(
        self,
        folder: Path,
        answering: EngineCalls | None = None,
        database: str = "",
        files: EngineCalls | None = None,
        **numbers: Any,
    ) -> None:
        self.file = folder / "jobs.sqlite"
        if not database:
            self.file.write_bytes(empty_file())
        self.store = Store(database or file_url(self.file))
        self.settings = dataclasses.replace(ServiceSettings(data=folder), **numbers)
        self.app: FastAPI = create_app(self.settings, self.store, answering or Answering(), files)
        self.context: ServiceContext = self.app.state.context
        self.accounts = Accounts(self.store)
        self.runner = asyncio.Runner()

    def token(self, *scopes: str, tenant: str = "local", days: float | None = None) -> str:
        """Make a token; return its value."""
        number = self.accounts.tenant(tenant, self.settings.tenant_limits)
        return self.accounts.make_token("test", number, scopes or ("read", "submit"), days).value

    def __call__(self, method: str, path: str, *, address: str = "127.0.0.1", **asked: Any) -> httpx.Response:
        """Ask something."""
        return self.runner.run(self.ask(method, path, address=address, **asked))

    async def ask(self, method: str, path: str, *, address: str = "127.0.0.1", **asked: Any) -> httpx.Response:
        """Ask something, as one of several."""
        transport = httpx.ASGITransport(app=self.app, client=(address, 50_000))
        cookies = asked.pop("cookies", None)
        async with httpx.AsyncClient(transport=transport, base_url=HOME, cookies=cookies) as client:
            return await client.request(method, path, **asked)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.runner.close()
        self.store.close()


def bearer(token: str) -> dict[str, str]:
    """Return the header that shows a token."""
    return {"Authorization": f"Bearer {token}"}


def code_of(answer: httpx.Response) -> str:
    """Return the code of a refusal, which must have the one form."""
    (error,) = answer.json().values()
    assert set(error) == {"code", "message", "problems", "request_id"}
    assert error["message"]
    assert error["request_id"] == answer.headers["x-request-id"]
    for problem in error["problems"]:
        assert set(problem) == {"path", "value", "expected", "message"}
    return str(error["code"])
