"""The server process: one address, one database, engine processes for small questions, and a worker beside it."""

from __future__ import annotations

import asyncio
import errno
import logging
import signal
import socket
import sys
import threading
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import FrameType

import sqlalchemy as sa
import uvicorn
from fastapi import FastAPI
from sqlalchemy.exc import ArgumentError

from synth.batches.store import Store
from synth.errors import InputError
from synth.queue.accounts import Accounts
from synth.queue.database import refuse_damaged
from synth.queue.log_lines import json_lines
from synth.queue.settings import StoreSettings
from synth.service.app import create_app
from synth.service.context import ServiceContext
from synth.service.protocol import bounded
from synth.service.recording import LOG
from synth.service.settings import ServiceSettings
from synth.service.supervisor import Supervisor, worker_command
from synth.system.file_locks import is_locked, locked, unlock
from synth.system.operating_system import ENDING, private_file, private_folder
from synth.workers.engine_process import Engines
from synth.workers.settings import INTERACTIVE

ADDRESS = "an address of this machine"
BACKLOG = 128  # connections that the system holds until they are looked at


class ServiceServer(uvicorn.Server):
    """A server that ends in time: what waits, as event streams do, is told first.

    Parameters
    ----------
    config : uvicorn.Config
    context : ServiceContext
    ready, ending : callable
        Called when requests are answered, and when the end is wished for.
    """

    def __init__(
        self, config: uvicorn.Config, context: ServiceContext, ready: Callable[[], None], ending: Callable[[], None]
    ) -> None:
        super().__init__(config)
        self._context, self._ready, self._ending = context, ready, ending
        self._loop: asyncio.AbstractEventLoop | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to answer, and say so."""
        self._loop = asyncio.get_running_loop()
        await super().startup(sockets)
        if self.started:
            self._ready()

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Let streams end, then the server."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._context.ending.set)
        self._ending()
        super().handle_exit(sig, frame)

    @contextmanager
    def capture_signals(self) -> Generator[None, None, None]:
        """Hear Ctrl-C and SIGTERM: both are how this program is meant to end, and nothing that happened to it."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.signal(number, self.handle_exit) for number in (signal.SIGINT, *ENDING)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def serve(settings: ServiceSettings, say: Callable[[str], None]) -> None:
    """Serve until Ctrl-C or SIGTERM.

    Parameters
    ----------
    settings : ServiceSettings
    say : callable
        Told the address, once requests are answered.

    Raises
    ------
    InputError
        The address cannot be listened to, the database cannot be opened or has a server already, or others can reach
        the service and there is no token that would let them in.
    """
    with ExitStack() as opened:
        opened.enter_context(json_lines())
        _prepare_log(settings.log)
        if not settings.database:
            private_folder(settings.data)
        opened.enter_context(only_server(settings.database_url))
        store = opened.enter_context(
            Store(settings.database_url, settings=StoreSettings(patience=settings.database_patience))
        )
        refuse_damaged(store.engine)
        refuse_open_door(settings, Accounts(store))
        listener = opened.enter_context(listening(settings.host, settings.port))
        engines = Engines(settings.engines, INTERACTIVE)
        opened.callback(engines.close)
        file_engines = Engines(settings.file_engines, INTERACTIVE, at_once=0)  # many servers make few files
        opened.callback(file_engines.close)
        app = create_app(settings, store, engines, file_engines)
        context: ServiceContext = app.state.context
        supervisor = Supervisor(
            worker_command(settings),
            {"CLUTCHSYNTH_DATABASE": store.engine.url.render_as_string(hide_password=False)},
            settings,
            context.metrics.worker_starts.inc,
        )
        end = lambda: None  # noqa: E731
        if settings.workers:
            supervisor.start()
            opened.callback(supervisor.stop)
            end = supervisor.tell_end
        server = ServiceServer(
            server_config(app, settings), context, lambda: say(f"clutchsynth serves {address_of(listener)}"), end
        )
        server.run([listener])


def server_config(app: FastAPI, settings: ServiceSettings) -> uvicorn.Config:
    """Configuration with which uvicorn runs the application."""
    return uvicorn.Config(
        app,
        http=bounded(settings.header_timeout, settings.target_limit, settings.idle_connections),
        ws="none",
        loop="asyncio",
        lifespan="on",
        log_config=None,
        log_level="critical",
        access_log=False,
        server_header=False,
        proxy_headers=bool(settings.proxies),
        forwarded_allow_ips=list(settings.proxies),
        backlog=BACKLOG,
        timeout_keep_alive=settings.idle_timeout,
        timeout_graceful_shutdown=settings.shutdown_timeout,
    )


@contextmanager
def only_server(url: str) -> Iterator[None]:
    """Keep other servers from a SQLite file for the block; workers and commands may use it all the same.

    Raises
    ------
    InputError
        Another server serves it.
    """
    file = file_of(url)
    handle = None
    if file is not None:
        lock = file.with_name(f"{file.name}.server")
        private_folder(file.parent)
        with suppress(OSError):  # whoever opens the database tells what cannot be written there
            private_file(lock)
        handle = locked(lock)
        if handle is None and is_locked(lock):  # else nothing can be written there, which whoever opens it tells
            right = "a file that no other server serves: on SQLite there is one, PostgreSQL has room for several"
            raise InputError("--database", str(file), right)
    try:
        yield
    finally:
        if file is not None and handle is not None:
            unlock(lock, handle)


def file_of(url: str) -> Path | None:
    """Return the file of a database, whichever way leads to it; None where it is on a server, or no address at all."""
    try:
        address = sa.make_url(url)
    except ArgumentError:
        return None
    named = address.database
    if address.get_backend_name() != "sqlite" or named in (None, "", ":memory:"):
        return None
    return Path(str(named)).resolve()


def refuse_open_door(settings: ServiceSettings, accounts: Accounts) -> None:
    """Refuse to let others in without tokens.

    Raises
    ------
    InputError
        Others can reach the service, and no token is valid.
    """
    if settings.is_public and not accounts.any_valid():
        field, value = ("--host", settings.host) if not settings.hosts else ("hosts", ", ".join(settings.hosts))
        raise InputError(
            field, value, "a token in the database first, as others can reach it: clutchsynth token create NAME"
        )


def listening(host: str, port: int) -> socket.socket:
    """Return a socket that listens.

    Raises
    ------
    InputError
        It cannot.
    """
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listener = socket.create_server((host, port), family=family, backlog=BACKLOG)
    except OSError as error:
        taken = error.errno in (errno.EADDRINUSE, errno.EACCES)
        field, value, right = ("--port", port, f"a port that is free at {host}") if taken else ("--host", host, ADDRESS)
        raise InputError(field, value, f"{right} ({error.strerror})") from error
    # Else an answer waits 40 ms for the client to confirm its first packet. Connections inherit it.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listener


def address_of(listener: socket.socket) -> str:
    """Return the address that a browser takes."""
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}/" if ":" in host else f"http://{host}:{port}/"


def _prepare_log(wanted: bool) -> None:
    """Let lines of the log go to standard error, as they are."""
    LOG.handlers = [logging.StreamHandler(sys.stderr) if wanted else logging.NullHandler()]
    LOG.setLevel(logging.INFO)
    LOG.propagate = False
