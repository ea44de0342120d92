"""What is kept of a request: its number, one line of the log, and counts. Never what it says, nor who proves what.

An error that nobody has foreseen ends here: the client learns the number of the request, the log what kind of error it
was and where.
"""

from __future__ import annotations

import logging
import os
import secrets
import time
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from synth.errors import shortened, where_raised
from synth.queue.log_lines import log_line
from synth.service.errors import ServiceError, error_response
from synth.service.metrics import ServiceMetrics

LOG = logging.getLogger("clutchsynth.service")
UNKNOWN_ROUTE = "none"  # of requests that mean nothing here


def log(event: str, **told: Any) -> None:
    """Write a line of the log: JSON, with what has happened and when."""
    LOG.info(log_line(event, **told))


class Recorder:
    """Numbers, times, counts and logs requests, and answers where everything else has failed."""

    def __init__(self, app: ASGIApp, metrics: ServiceMetrics) -> None:
        self.app, self.metrics = app, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and record it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        number = secrets.token_hex(8)
        scope.setdefault("state", {})["request_id"] = number
        begun, status = time.perf_counter(), 0

        async def sent(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                message["headers"] = [*message["headers"], (b"x-request-id", number.encode())]
            await send(message)

        failed: Exception | None = None
        try:
            await self.app(scope, receive, sent)
        except Exception as error:
            failed = error
            if not status:
                internal = ServiceError(500, f"something went wrong here; please tell the number {number}")
                await error_response(internal, number)(scope, receive, sent)
        finally:
            self._record(scope, number, status, time.perf_counter() - begun, failed)
        if failed is not None and os.environ.get("CLUTCHSYNTH_DEBUG") == "1":
            raise failed

    def _record(self, scope: Scope, number: str, status: int, seconds: float, failed: Exception | None) -> None:
        route = str(getattr(scope.get("route"), "path", UNKNOWN_ROUTE))
        self.metrics.requested(scope["method"], route, status, seconds)
        told: dict[str, Any] = {
            "request_id": number,
            "method": scope["method"],
            "path": shortened(scope["path"]),
            "status": status,
            "seconds": round(seconds, 4),
        }
        principal = scope["state"].get("principal")
        if principal is not None:
            told |= {"tenant": principal.tenant, "token": principal.token}
        if failed is None and "failure" in scope["state"]:
            told |= scope["state"]["failure"]
        if failed is not None:
            told |= {"error": type(failed).__name__, "where": where_raised(failed)}
        log("request", **told)
