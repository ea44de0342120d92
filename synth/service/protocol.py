"""The wire: what uvicorn does with connections, bounded where it is not."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from synth.service.errors import JSON, code_of, error_body


class BoundedProtocol(HttpToolsProtocol):
    """One connection. Its heads must arrive whole, in time, and not too large; only so many connections may be idle.

    Who opens many connections and says nothing, or one letter at a time, closes his own: the one that has waited
    longest goes first.
    """

    header_timeout: float
    target_limit: int
    idle_connections: int
    waiting: dict[BoundedProtocol, None]  # connections without a request, the longest first; of the whole server

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Expect the first head."""
        super().connection_made(transport)
        self._head_bytes, self._timer = 0, None
        self._wait_for_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """Expect nothing more."""
        self._head_is_there()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take some bytes; of a head not too many."""
        if self.transport.is_closing():
            return
        if self in self.waiting:
            self._begin_timer()
            self._head_bytes += len(data)
            if self._head_bytes > self.target_limit + len(data):
                self.send_400_response("the first line and the headers are too large")
                return
        super().data_received(data)

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no request, in the form of all refusals, and hang up."""
        self._head_is_there()
        body = error_body(code_of(400), msg, "")
        head = f"HTTP/1.1 400 Bad Request\r\ncontent-type: {JSON}\r\ncontent-length: {len(body)}\r\n"
        self.transport.write(f"{head}connection: close\r\n\r\n".encode("ascii") + body)
        self.transport.close()

    def on_headers_complete(self) -> None:
        """Begin the request."""
        self._head_is_there()
        super().on_headers_complete()

    def on_response_complete(self) -> None:
        """Expect the next head."""
        super().on_response_complete()
        if not self.transport.is_closing() and self.cycle.response_complete:
            self._wait_for_head()

    # -- waiting -------------------------------------------------------------------------------

    _timer: asyncio.TimerHandle | None

    def _wait_for_head(self) -> None:
        self._head_bytes = 0
        self.waiting[self] = None
        while len(self.waiting) > self.idle_connections:
            next(iter(self.waiting))._give_up()
        if self.cycle is None:
            self._begin_timer()  # of a connection that has had a request, the server's own limit tells

    def _begin_timer(self) -> None:
        if self._timer is None:
            self._timer = self.loop.call_later(self.header_timeout, self._give_up)

    def _head_is_there(self) -> None:
        self.waiting.pop(self, None)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _give_up(self) -> None:
        self._head_is_there()
        self.transport.abort()


def bounded(header_timeout: float, target_limit: int, idle_connections: int) -> type[BoundedProtocol]:
    """Return the protocol of one server."""
    own: dict[str, Any] = {
        "header_timeout": header_timeout,
        "target_limit": target_limit,
        "idle_connections": idle_connections,
        "waiting": {},
    }
    return type("ServerProtocol", (BoundedProtocol,), own)
