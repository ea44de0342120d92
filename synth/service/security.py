"""What a request must pass before anything of it is looked at, and what every answer carries.

All of it wraps the application as plain ASGI, so that event streams pass through as they come.
"""

from __future__ import annotations

import asyncio
import ipaddress
import itertools
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any
from urllib.parse import urlsplit

from starlette.exceptions import HTTPException
from starlette.requests import cookie_parser
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from synth.errors import Described, InputError, SeveralErrors
from synth.service.context import API
from synth.service.errors import ServiceError, again, error_response, refusal_of
from synth.service.metrics import ServiceMetrics
from synth.service.settings import ServiceSettings, is_loopback
from synth.service.shares import Asker, FairShares, NoPlaceError
from synth.service.wording import place_in_words
from synth.text.numbers import typed_number

JOBS, REQUEST = f"{API}/jobs", "request"  # where a spec does not stand alone, and its key there
MOST_TOLD = 20  # faults of a body that are told one by one
SAFE = ("GET", "HEAD", "OPTIONS")
PROBES = ("/healthz", "/readyz", "/metrics")  # whoever watches the service must see it when it is busy, too
JSON_BODY, FILE_BODY = "application/json", "multipart/form-data"
TAKEN = f"{JSON_BODY}, or {FILE_BODY} where a file is brought"
SESSION_COOKIES = ("clutchsynth_session", "__Host-clutchsynth_session")  # on loopback, and over TLS
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "base-uri 'none'; frame-ancestors 'none'; form-action 'self'"
)
HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"x-frame-options", b"DENY"),
    (b"cache-control", b"private, no-cache"),
)


def header(scope: Scope, name: str) -> str:
    """Return a header of a request; empty where there is none."""
    wanted = name.encode()
    return next((value.decode("latin-1") for key, value in scope["headers"] if key == wanted), "")


def session_cookie(scope: Scope, settings: ServiceSettings) -> str:
    """Return the cookie by which a browser is signed in; empty where there is none."""
    return cookie_parser(header(scope, "cookie")).get(SESSION_COOKIES[settings.is_public], "")


def has_body(scope: Scope) -> bool:
    """Whether a request says that it has a body."""
    return header(scope, "content-length") not in ("", "0") or bool(header(scope, "transfer-encoding"))


def is_probe(scope: Scope) -> bool:
    """Whether a request is one of whoever watches the service, which is answered at once."""
    return scope["path"] in PROBES and not has_body(scope)


async def refuse(scope: Scope, receive: Receive, send: Send, error: ServiceError) -> None:
    """Answer with a refusal; where a body comes, the connection is closed, and the body is not waited for."""
    if has_body(scope):
        error = ServiceError(
            error.status, error.message, error.code, error.problems, {**error.headers, "Connection": "close"}
        )
    await error_response(error, scope["state"].get("request_id", ""))(scope, receive, send)


class AnswerHeaders:
    """Adds to every answer what keeps browsers from doing more with it than show it."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                own = {key.lower() for key, _ in message["headers"]}
                message["headers"] = [*message["headers"], *(pair for pair in HEADERS if pair[0] not in own)]
            await send(message)

        await self.app(scope, receive, sent)


def no_place(error: NoPlaceError, what: str, settings: ServiceSettings) -> ServiceError:
    """Return the refusal of what has found no place in time."""
    status, whose = (429, "of yours ") if error.own else (503, "")
    return ServiceError(
        status, f"too many {what} {whose}are under way; please come again", headers=again(settings.retry_after)
    )


class RequestLimit:
    """Lets requests wait for their turn where too many are under way; leaves clients that take no answer."""

    def __init__(self, app: ASGIApp, settings: ServiceSettings, shares: FairShares, metrics: ServiceMetrics) -> None:
        self.app, self.settings, self.shares, self.metrics = app, settings, shares, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, when it is its turn."""
        if scope["type"] != "http" or is_probe(scope):
            await self.app(scope, receive, send)
            return
        asker: Asker = scope["state"]["asker"]

        async def sent(message: Message) -> None:
            async with asyncio.timeout(self.settings.send_timeout):
                await send(message)

        try:
            async with self.shares.place(asker, self.settings.queue_wait):
                await self.app(scope, receive, sent)
        except NoPlaceError as error:  # raised before the application is called: it refuses its own
            self.metrics.refused_places.labels("own" if error.own else "all").inc()
            await refuse(scope, receive, send, no_place(error, "requests", self.settings))


class HostCheck:
    """Refuses names that are not the service's own.

    A page from elsewhere can let its name mean this machine, and would then be of the same origin. Numbers are no
    names: whoever can let them mean something else needs no browser.
    """

    def __init__(self, app: ASGIApp, settings: ServiceSettings) -> None:
        self.app, self.settings = app, settings
        self.names = {name.lower() for name in settings.hosts}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, if it is meant for this service."""
        if scope["type"] == "http" and not self.is_ours(header(scope, "host")):
            wrong = ServiceError(421, "this service is not known by that name; see hosts in its settings")
            await refuse(scope, receive, send, wrong)
            return
        await self.app(scope, receive, send)

    def is_ours(self, host: str) -> bool:
        """True if a host, as the header has it, is this service."""
        name = host_name(host)
        if name in self.names or is_loopback(name):
            return True
        return self.settings.is_public and _is_address(name)


def host_name(host: str) -> str:
    """Return the name in a header ``Host``, without its port."""
    if host.startswith("["):
        return host[: host.find("]") + 1].lower()
    return host.rsplit(":", 1)[0].lower() if host.count(":") == 1 else host.lower()


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True


class CrossSiteCheck:
    """Refuses what a page from elsewhere wants to change in the name of whoever looks at it.

    Browsers say where a request comes from, programs do not. Who is signed in by a cookie must be a browser that says
    so; on loopback, where nobody needs to sign in, everything that comes from a page elsewhere is refused as well.
    """

    def __init__(self, app: ASGIApp, settings: ServiceSettings) -> None:
        self.app, self.settings = app, settings

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, unless it changes something and comes from elsewhere."""
        if scope["type"] == "http" and scope["method"] not in SAFE and not self.is_own(scope):
            foreign = ServiceError(403, "this comes from a page of another site", "cross_site")
            await refuse(scope, receive, send, foreign)
            return
        await self.app(scope, receive, send)

    def is_own(self, scope: Scope) -> bool:
        """True if a request comes from a page of this service, or from a program."""
        site, origin = header(scope, "sec-fetch-site"), header(scope, "origin")
        if site and site not in ("same-origin", "none"):
            return False
        if origin:
            return _authority(origin) == header(scope, "host").lower()
        return bool(site) or not session_cookie(scope, self.settings)


def _authority(origin: str) -> str:
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return ""


class BodyCheck:
    """Bounds bodies while they arrive, whatever they say of themselves; JSON must be JSON of a reasonable form."""

    def __init__(self, app: ASGIApp, settings: ServiceSettings, uploads: FairShares) -> None:
        self.app, self.settings, self.uploads = app, settings, uploads
        self.most = {JSON_BODY: settings.body_limit, FILE_BODY: settings.upload_limit}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with a body that can be read."""
        if scope["type"] != "http" or not has_body(scope):
            await self.app(scope, receive, send)
            return
        media = header(scope, "content-type").split(";")[0].strip().lower()
        try:
            most = self._most(media, header(scope, "content-length"))
            if media == FILE_BODY:
                await self._file(scope, self._bounded(receive, most), send)
                return
            within = REQUEST if scope["path"] == JOBS else ""
            body = await self._json(self._bounded(receive, most), within)
        except HTTPException as error:  # raised while the body arrived
            await refuse(scope, receive, send, ServiceError(error.status_code, error.detail))
            return
        except ServiceError as error:
            await refuse(scope, receive, send, error)
            return
        await self.app(scope, self._again(body, receive), send)

    async def _file(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on that brings a file, when it is its turn: files are held in memory."""
        asker: Asker = scope["state"]["asker"]
        try:
            async with self.uploads.place(asker, self.settings.queue_wait):
                await self.app(scope, receive, send)
        except NoPlaceError as error:
            await refuse(scope, receive, send, no_place(error, "files", self.settings))

    def _most(self, media: str, length: str) -> int:
        """Largest size of a body of a kind; one that announces more is refused."""
        most = self.most.get(media)
        if most is None:
            raise ServiceError(415, f"the body is {media or 'of no stated kind'}; expected {TAKEN}")
        if length.isdigit() and int(length) > most:
            raise _too_large(most)
        return most

    def _bounded(self, receive: Receive, most: int) -> Receive:
        """Receiver of a body that ends where it is too large, or too slow.

        Its errors are those of the framework: readers of forms let them through, and no others.
        """
        settings, loop = self.settings, asyncio.get_running_loop()
        begun = loop.time()
        arrived = 0

        async def counted() -> Message:
            nonlocal arrived
            due = min(settings.body_timeout, settings.body_grace + arrived / settings.body_rate)
            try:
                async with asyncio.timeout_at(begun + due):
                    message = await receive()
            except TimeoutError:
                right = f"{settings.body_rate} bytes per s, and all of it in {typed_number(settings.body_timeout)} s"
                raise HTTPException(408, f"the body arrives too slowly; expected {right}") from None
            arrived += len(message.get("body", b""))
            if arrived > most:
                raise HTTPException(413, _too_large(most).message)
            return message

        whole = False

        async def received() -> Message:
            nonlocal whole
            if whole:
                return await receive()  # that the client has gone
            message = await counted()
            whole = message["type"] != "http.request" or not message.get("more_body")
            return message

        return received

    async def _json(self, receive: Receive, within: str) -> bytes:
        parts: list[bytes] = []
        while True:
            message = await receive()
            if message["type"] != "http.request":
                raise HTTPException(400, "the client has gone")
            parts.append(message.get("body", b""))
            if not message.get("more_body"):
                break
        body = b"".join(parts)
        check_json(body, self.settings.json_depth, self.settings.json_keys, within)
        return body

    @staticmethod
    def _again(body: bytes, receive: Receive) -> Receive:
        """Receiver that gives a body that was read already, and then what follows."""
        waiting = [body]

        async def received() -> Message:
            if waiting:
                return {"type": "http.request", "body": waiting.pop(), "more_body": False}
            return await receive()

        return received


def _too_large(most: int) -> ServiceError:
    return ServiceError(413, f"the body is larger than {most} bytes")


def check_json(body: bytes, depth: int, keys: int, within: str = "") -> None:
    """Refuse what is not JSON, nests too deeply, has too many keys, one twice, or what cannot be kept or computed with.

    Parameters
    ----------
    body : bytes
    depth, keys : int
    within : str
        The key under which a spec stands: paths within it begin with its own keys, as those of a check do.

    Raises
    ------
    ServiceError
        With 400 where it is no JSON, and 422 where it is.
    """
    odd: list[_Odd] = []
    try:
        read = json.loads(body, **_hooks(odd))
    except RecursionError:
        raise _bad_body("more levels of brackets", f"at most {depth}") from None
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise ServiceError(400, f"the body is not JSON: see {place}", "not_json") from None
    except ValueError:  # of its letters
        raise ServiceError(400, "the body is not JSON: it is no text in UTF-8", "not_json") from None
    level, counted = [read], 0
    for nested in itertools.count():
        below: list[Any] = []
        for value in level:
            if isinstance(value, dict):
                counted += len(value)
                _check_texts(value)
                below += value.values()
            elif isinstance(value, list):
                below += value
            elif isinstance(value, str):
                _check_texts((value,))
        if counted > keys:
            raise _bad_body(f"{counted} keys", f"at most {keys}")
        if nested >= depth and any(isinstance(value, (dict, list)) for value in level):
            raise _bad_body("more levels of brackets", f"at most {depth}")
        if not below:
            break
        level = below
    if odd:
        raise _told(read, within)


def _check_texts(texts: Iterable[str]) -> None:
    for text in texts:
        if "\0" in text or any("\ud800" <= letter <= "\udfff" for letter in text):
            raise _bad_body("a text with the character 0 or half a letter", "texts of whole letters")


def _bad_body(got: str, expected: str) -> ServiceError:
    return refusal_of(InputError("body", Described(got), expected))


@dataclass(frozen=True, eq=False)
class _Odd:
    """Stands in JSON that was read for what readers of JSON do not agree upon."""

    value: Any
    right: str


def _hooks(odd: list[_Odd]) -> dict[str, Any]:
    """Reader of JSON that notes each oddity and keeps its place."""

    def noted(value: object, right: str) -> _Odd:
        odd.append(_Odd(value, right))
        return odd[-1]

    def constant(text: str) -> Any:
        return noted(text, "a finite number")

    def number(text: str, kind: type[float] | type[int] = float) -> Any:
        return kind(text) if math.isfinite(float(text)) else constant(text)

    def members(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            names = [name for name, _ in pairs]
            twice = next(name for name in names if names.count(name) > 1)
            found[twice] = noted(Described("several values"), "each key once")
        return found

    return {
        "parse_constant": constant,
        "parse_float": number,
        "parse_int": partial(number, kind=int),
        "object_pairs_hook": members,
    }


def _told(read: object, within: str) -> ServiceError:
    """Return the refusal of what is odd in JSON: all that is still in its place."""
    waiting: list[tuple[tuple[str | int, ...], Any]] = [((), read)]
    faults: list[InputError] = []
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, _Odd):
            in_spec = len(path) > 1 and path[0] == within
            own = path[1:] if in_spec else path
            faults.append(InputError(place_in_words(path), value.value, value.right, own))
        elif isinstance(value, (dict, list)):
            entries = value.items() if isinstance(value, dict) else enumerate(value)
            waiting += reversed([((*path, key), entry) for key, entry in entries])
    return refusal_of(SeveralErrors(faults[:MOST_TOLD]))
