"""Who asks: by a token, by the cookie of a browser that has shown one, or as anybody at this machine."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from sqlalchemy.exc import DBAPIError

from synth.jobs.accounts import ADMIN, READ, SUBMIT, Principal
from synth.service.context import Context, ServiceContext, in_thread
from synth.service.errors import ServiceError, again
from synth.service.recording import log
from synth.service.security import header, session_cookie

SCHEME = "bearer "
ASK = {"WWW-Authenticate": 'Bearer realm="clutchsynth"'}


def address_of(request: Request) -> str:
    """Return where a request comes from, as far as trusted proxies tell."""
    return request.client.host if request.client else ""


DESCRIBED = HTTPBearer(auto_error=False, scheme_name="token", description="A token, cs_...")
Described = Annotated[HTTPAuthorizationCredentials | None, Depends(DESCRIBED)]


async def principal_of(request: Request, context: Context, described: Described = None) -> Principal:
    """Return who asks; ``described`` is for the description of the interface alone.

    Raises
    ------
    ServiceError
        401 without a valid token; 429 where it is wrong, and too many wrong ones came from there before.
    """
    principal = await _recognised(request, context)
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
        raise ServiceError(401, "this needs a token: Authorization: Bearer cs_...", headers=ASK)
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
    """Note that a token is used; where the database is busy the next request does."""
    try:
        context.accounts.note_use(token)
    except DBAPIError:
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
