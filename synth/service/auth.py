"""Who asks: by a token, by the cookie of a browser that has shown one, or as anybody at this machine."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from starlette.types import ASGIApp, Receive, Scope, Send

from synth.errors import InputError
from synth.queue.accounts import ADMIN, READ, SUBMIT, Principal
from synth.service.attempts import network_of
from synth.service.context import Context, ServiceContext, in_thread
from synth.service.errors import ServiceError, again, database_away
from synth.service.recording import log
from synth.service.security import has_body, header, is_probe, refuse, session_cookie
from synth.service.shares import Asker
from synth.service.small_work import asker_of

SCHEME = "bearer "
NEEDED = "this needs a token: Authorization: Bearer cs_..."
ASK = {"WWW-Authenticate": 'Bearer realm="clutchsynth"'}


def address_of(request: Request) -> str:
    """Address of a request, as far as trusted proxies state it."""
    return request.client.host if request.client else ""


@dataclass(frozen=True)
class Caller:
    """Who has sent a request, as far as that is known.

    Parameters
    ----------
    principal : Principal or None
    refusal : Exception or None
        Why nobody was recognised: raised where a route needs to know.
    asker : Asker
        Whose share the request counts to.
    """

    principal: Principal | None
    refusal: Exception | None
    asker: Asker


class Callers:
    """Finds out who asks before anything of a body is read; of nobody no body is."""

    def __init__(self, app: ASGIApp, context: ServiceContext) -> None:
        self.app, self.context = app, context

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, unless a body comes from nobody."""
        if scope["type"] == "http" and not is_probe(scope):
            caller = await caller_of(Request(scope), self.context)
            scope["state"]["asker"] = caller.asker
            if caller.refusal is not None and has_body(scope):
                away = database_away(self.context.settings.retry_after)
                refusal = caller.refusal if isinstance(caller.refusal, ServiceError) else away
                await refuse(scope, receive, send, refusal)
                return
        await self.app(scope, receive, send)


async def caller_of(request: Request, context: ServiceContext) -> Caller:
    """Return who has sent a request; nobody is asked for twice."""
    state = request.scope["state"]
    if "caller" not in state:
        try:
            principal = await _recognised(request, context)
            state["caller"] = Caller(principal, None, asker_of(principal))
        except (ServiceError, SQLAlchemyError, InputError, OSError) as refusal:
            state["caller"] = Caller(None, refusal, Asker(None, network_of(address_of(request))))
    found: Caller = state["caller"]
    return found


DESCRIBED = HTTPBearer(auto_error=False, scheme_name="token", description="A token, cs_...")
Described = Annotated[HTTPAuthorizationCredentials | None, Depends(DESCRIBED)]


async def principal_of(request: Request, context: Context, described: Described = None) -> Principal:
    """Return who asks; ``described`` is for the description of the interface alone.

    Raises
    ------
    ServiceError
        401 without a valid token; 429 where it is wrong, and too many wrong ones came from there before.
    """
    caller = await caller_of(request, context)
    if caller.principal is None:
        raise caller.refusal or ServiceError(401, NEEDED, headers=ASK)
    principal = caller.principal
    request.scope["state"]["principal"] = principal
    if principal.token is not None and (principal.used is None or principal.used > context.settings.token_note):
        await in_thread(_note_use, context, principal.token)
    return principal


async def _recognised(request: Request, context: ServiceContext) -> Principal:
    accounts = context.accounts
    if not context.settings.is_public and not await context.read(accounts.any_token):
        return await context.read(accounts.local)
    stated = header(request.scope, "authorization")
    if stated[: len(SCHEME)].lower() == SCHEME:
        return await _by_token(request, context, stated[len(SCHEME) :].strip())
    cookie = session_cookie(request.scope, context.settings)
    found = await context.read(accounts.browser, cookie) if cookie else None
    if found is None:  # a browser that was signed in for long enough has guessed nothing
        raise ServiceError(401, NEEDED, headers=ASK)
    return found


async def _by_token(request: Request, context: ServiceContext, token: str) -> Principal:
    found = await context.read(context.accounts.recognise, token)
    if found is not None:
        return found  # whoever else has guessed at the same address: a whole office may stand behind one
    address = address_of(request)
    wait = context.failed_tokens.wait(address)
    if wait > 0:
        raise ServiceError(429, "too many wrong tokens came from there; please come again later", headers=again(wait))
    context.failed_tokens.failed(address)
    context.metrics.refused_tokens.inc()
    log("wrong_token", address=address, request_id=request.scope["state"].get("request_id"))
    raise ServiceError(401, "the token is wrong, too old or revoked", headers=ASK)


def _note_use(context: ServiceContext, token: int) -> None:
    """Note that a token is used; where that cannot be written the next request does."""
    try:
        context.accounts.note_use(token)
    except (DBAPIError, OSError):  # busy, or without room: nobody is kept from reading by that
        log("not_noted", token=token)


def needs(scope: str) -> Callable[[Principal], Awaitable[Principal]]:
    """Return the dependency of routes that need a scope."""

    async def allowed(principal: Annotated[Principal, Depends(principal_of)]) -> Principal:
        if scope not in principal.scopes:
            raise ServiceError(403, f"this needs a token with the scope {scope}", "scope")
        return principal

    return allowed


Anybody = Annotated[Principal, Depends(principal_of)]
Reader = Annotated[Principal, Depends(needs(READ))]
Submitter = Annotated[Principal, Depends(needs(SUBMIT))]
Administrator = Annotated[Principal, Depends(needs(ADMIN))]
