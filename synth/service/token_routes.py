"""Tokens, browsers that sign in with one, and what this is."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from synth.errors import InputError
from synth.queue.accounts import ADMIN, NAME, NAME_PATTERN, TokenEntry
from synth.queue.database import HEAD
from synth.service.auth import Administrator, Anybody
from synth.service.context import API, Context, in_thread
from synth.service.errors import ServiceError, not_found
from synth.service.security import SESSION_COOKIES, session_cookie

router = APIRouter(prefix=API, tags=["tokens"])
LARGEST_NUMBER = 2**31 - 1  # of a key in the database
COOKIE = {"Set-Cookie": {"description": "By which the browser is known from now on.", "schema": {"type": "string"}}}
SIGNED_IN: dict[int | str, dict[str, Any]] = {
    201: {"description": "The browser is signed in.", "headers": COOKIE},
    409: {"description": "Nobody needs to sign in here: there are no tokens."},
}


class VersionAnswer(BaseModel):
    """What this is."""

    version: str
    interface: str
    database: str
    python: str


class TokenAnswer(BaseModel):
    """A token as lists show it. Times are seconds since 1970."""

    id: int
    name: str
    prefix: str
    tenant: str
    scopes: list[str]
    created: float
    expires: float | None
    used: float | None
    revoked: float | None


class TokenList(BaseModel):
    """All tokens."""

    tokens: list[TokenAnswer]


class TokenRequest(BaseModel):
    """What a new token is for."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"name": "office", "scopes": ["read", "submit"], "days": 90}]}
    )

    name: str = Field(max_length=NAME, pattern=NAME_PATTERN, description="Whom or what it is for.")
    tenant: str | None = Field(
        None,
        max_length=NAME,
        pattern=NAME_PATTERN,
        description="By default your own; a new one is named by letters, digits, `-`, `_` and `.`.",
    )
    scopes: list[Literal["read", "submit", "admin"]] = Field(["read", "submit"], min_length=1, max_length=3)
    days: float | None = Field(None, gt=0, le=36_500, description="For which it is valid.")


class MadeToken(BaseModel):
    """A new token; `value` is shown this once."""

    id: int
    prefix: str
    value: str


class SessionAnswer(BaseModel):
    """Who you are."""

    tenant: str
    scopes: list[str]


@router.get("/version", summary="Which versions these are")
async def what_this_is() -> VersionAnswer:
    """Tell versions, of programs and of tables."""
    return VersionAnswer(
        version=version("clutchsynth"), interface="v1", database=HEAD, python=platform.python_version()
    )


@router.get("/tokens", summary="All tokens")
async def list_tokens(principal: Administrator, context: Context) -> TokenList:
    """List all tokens, also those that are not valid any more."""
    return TokenList(tokens=[_entry(token) for token in await context.read(context.accounts.tokens)])


@router.post("/tokens", status_code=201, summary="Make a token")
async def make_token(asked: TokenRequest, principal: Administrator, context: Context) -> MadeToken:
    """Make a token, and its tenant where that is a new one.

    The first one needs the scope admin: from then on nobody comes in without a token, and without such a one nobody
    could make another here.
    """
    accounts, settings = context.accounts, context.settings
    if principal.token is None and ADMIN not in asked.scopes:
        right = f"{ADMIN} as well: this is the first token, and without it nobody could make another one here"
        raise InputError("scopes", ", ".join(asked.scopes), right, ("scopes",))
    tenant = principal.tenant
    if asked.tenant is not None:
        tenant = await in_thread(accounts.tenant, asked.tenant, settings.tenant_limits)
    days = settings.token_days if asked.days is None else asked.days
    made = await in_thread(accounts.make_token, asked.name, tenant, asked.scopes, days)
    return MadeToken(id=made.id, prefix=made.prefix, value=made.value)


@router.delete("/tokens/{token}", status_code=204, summary="Revoke a token")
async def revoke_token(
    token: Annotated[int, Path(ge=1, le=LARGEST_NUMBER)], principal: Administrator, context: Context
) -> None:
    """Revoke a token; whoever uses it is nobody from now on."""
    if not await in_thread(context.accounts.revoke, token):
        raise not_found()


@router.get("/session", summary="Who you are")
async def who_am_i(principal: Anybody) -> SessionAnswer:
    """Tell who you are, and what you may do."""
    return SessionAnswer(tenant=principal.tenant_name, scopes=sorted(principal.scopes))


@router.post("/session", status_code=201, responses=SIGNED_IN, summary="Sign a browser in")
async def sign_in(request: Request, response: Response, principal: Anybody, context: Context) -> SessionAnswer:
    """Let a browser keep who it is: show a token once, get a cookie.

    There is no body: the token is shown as in every other request, by `Authorization: Bearer cs_...`.
    """
    if principal.token is None:
        raise ServiceError(409, "nobody needs to sign in here: there are no tokens")
    value = await in_thread(context.accounts.sign_in, principal.token, context.settings.session_hours)
    secure = context.settings.is_public
    response.set_cookie(
        SESSION_COOKIES[secure],
        value,
        max_age=round(3600 * context.settings.session_hours),
        path="/",
        secure=secure,
        httponly=True,
        samesite="strict",
    )
    return SessionAnswer(tenant=principal.tenant_name, scopes=sorted(principal.scopes))


@router.delete("/session", status_code=204, summary="Sign a browser out")
async def sign_out(request: Request, response: Response, context: Context) -> None:
    """Forget this browser."""
    cookie = session_cookie(request.scope, context.settings)
    if cookie:
        await in_thread(context.accounts.sign_out, cookie)
    secure = context.settings.is_public
    response.delete_cookie(SESSION_COOKIES[secure], path="/", secure=secure, httponly=True, samesite="strict")


def _entry(token: TokenEntry) -> TokenAnswer:
    return TokenAnswer.model_validate(token, from_attributes=True)
