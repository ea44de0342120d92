"""What routes share: jobs by their ids, places in lists, digests that clients send back, and texts in addresses."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import time
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from fastapi import Depends, Path, Query, Request, Response
from fastapi import params as fastapi_params
from fastapi.dependencies.models import Dependant
from fastapi.dependencies.utils import get_flat_params
from sqlalchemy.exc import DBAPIError

from synth.errors import InputError
from synth.queue.job_table import LIVE
from synth.queue.models import Job
from synth.service.auth import Anybody, principal_of
from synth.service.context import Context, ServiceContext, in_thread
from synth.service.errors import JSON, ServiceError, not_found
from synth.service.recording import log
from synth.service.security import header
from synth.service.wording import WORD

ID = re.compile(r"[0-9A-Za-z_]{1,64}")
LONGEST = 200
LARGEST = 2**53  # that JSON tells exactly, everywhere
CHECKED = 16  # digits of a place in a list that tell whether it belongs to the list
NOT_MODIFIED: dict[int | str, dict[str, Any]] = {304: {"description": "It is as you know it (If-None-Match)."}}
ENDED: dict[int | str, dict[str, Any]] = {409: {"description": "The job is not in a state in which this can be done."}}


def word(description: str | None = None, longest: int = LONGEST, examples: list[Any] | None = None) -> Any:
    """Parameter of an address that is a short text."""
    return Query(max_length=longest, pattern=WORD, description=description, examples=examples)


Limit = Annotated[int | None, Query(ge=1, description="Entries at most.")]
Cursor = Annotated[str | None, word("Of the page before: what it calls `next`.", 2 * LONGEST)]
State = Literal["open", "running", "done", "cancelled", "failed", "stopped"]
Word = Annotated[str | None, word()]
JobId = Annotated[str, Path(description="Id of a job.", examples=["0j3k5m7n9pqrstvwxyz0123456"])]


async def own_job(job: JobId, principal: Anybody, context: Context) -> Job:
    """Return a job of whoever asks.

    Raises
    ------
    ServiceError
        404 where there is none, or it is another tenant's: nobody learns which.
    """
    found = await context.read(context.store.job, job, principal.tenant) if ID.fullmatch(job) else None
    if found is None:
        raise not_found()
    await note_use(context, found)
    return found


async def note_use(context: ServiceContext, job: Job) -> None:
    """Note that a job is used, which keeps it; not each time."""
    settings = context.settings
    keep = settings.keep_seconds
    if job.expires is None or keep is None or job.expires > time.time() + keep - min(settings.use_note, keep / 2):
        return
    try:
        await in_thread(context.store.note_use, [job.id], keep)
    except (DBAPIError, OSError):  # busy, or without room: nobody is kept from reading by that
        log("not_noted", job=job.id)


OwnJob = Annotated[Job, Depends(own_job)]


async def known_query(request: Request, context: Context) -> None:
    """Refuse what an address asks that its route does not know: a filter that is misspelt would filter nothing.

    Raises
    ------
    InputError
        There is such a parameter.
    ServiceError
        There is one, and whoever asks may not ask here at all: that is told first.
    """
    dependant: Dependant = request.scope["route"].dependant
    fields = get_flat_params(dependant)
    known = [field.alias for field in fields if isinstance(field.field_info, fastapi_params.Query)]
    unknown = [name for name in request.query_params if name not in known]
    if unknown:
        if _asks_who(dependant):
            await principal_of(request, context)
        right = f"one of {', '.join(known)}" if known else "an address without parameters"
        raise InputError("parameter", unknown[0], right, (unknown[0],))


def _asks_who(dependant: Dependant) -> bool:
    return dependant.call is principal_of or any(map(_asks_who, dependant.dependencies))


def refuse_live(job: Job) -> None:
    """Refuse what needs a job that has ended.

    Raises
    ------
    ServiceError
        409 where it has not.
    """
    if job.state in LIVE:
        raise ServiceError(409, f"the job is {job.state}; this is there when it has ended", "not_ended")


# ---- pages of lists -------------------------------------------------------------------------------------------------


def entries(context: Context, limit: int | None) -> int:
    """Number of entries of a page.

    Raises
    ------
    InputError
        More are asked for than a page may have.
    """
    settings = context.settings
    if limit is not None and limit > settings.page_limit:
        raise InputError("limit", limit, f"at most {settings.page_limit}", ("limit",))
    return min(settings.page, settings.page_limit) if limit is None else limit


def cursor_of(place: Sequence[Any], scope: Sequence[Any]) -> str:
    """Return a place in a list as clients hand it back; ``scope`` says which list it is."""
    text = json.dumps([*place, _check(place, scope)], separators=(",", ":"))
    return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")


def place_of(cursor: str | None, scope: Sequence[Any], kinds: Sequence[type]) -> list[Any] | None:
    """Return the place in a list that a client hands back, of values of these kinds; None where it hands back none.

    Raises
    ------
    InputError
        It is none, or one of another list.
    """
    if cursor is None:
        return None
    place: list[Any] = []
    try:
        *place, check = json.loads(base64.b64decode(cursor + "=" * (-len(cursor) % 4), b"-_", validate=True))
        right = check == _check(place, scope) and [*map(type, place)] == [*kinds] and all(map(_is_place, place))
    except (ValueError, TypeError, RecursionError):
        right = False
    if not right:
        raise InputError("cursor", cursor, "what the page before of the same list calls next", ("cursor",))
    return place


def _is_place(value: str | int) -> bool:
    return bool(ID.fullmatch(value)) if isinstance(value, str) else 0 <= value <= LARGEST


def _check(place: Sequence[Any], scope: Sequence[Any]) -> str:
    text = json.dumps([place, scope], separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:CHECKED]


# ---- what clients know already --------------------------------------------------------------------------------------


def knows(request: Request, etag: str) -> bool:
    """True if a client has said that it has this version."""
    stated = header(request.scope, "if-none-match")
    known = [entry.strip().removeprefix("W/") for entry in stated.split(",")]
    return etag.removeprefix("W/") in known or known == ["*"]


def tagged(
    request: Request, content: bytes, media: str, etag: str, headers: Mapping[str, str] | None = None
) -> Response:
    """Return an answer with the tag of its version, or 304 where the client has it."""
    more = {"ETag": etag, **(headers or {})}
    if knows(request, etag):
        return Response(status_code=304, headers=more)
    return Response(content, media_type=media, headers=more)


def tagged_json(request: Request, told: object, version: str) -> Response:
    """Answer that depends on the code or the tables of this server alone, with their digest as the tag."""
    content = json.dumps(told, ensure_ascii=False, allow_nan=False).encode()
    return tagged(request, content, JSON, f'"{version}"')


def tag_of(content: bytes) -> str:
    """Return the tag of a content."""
    return f'"{hashlib.sha256(content).hexdigest()[:32]}"'


def accepts_gzip(request: Request) -> bool:
    """True if a client takes an answer that is packed with gzip.

    Examples
    --------
    >>> from starlette.requests import Request
    >>> def asked(text):
    ...     return Request({"type": "http", "headers": [(b"accept-encoding", text.encode())]})
    >>> [accepts_gzip(asked(text)) for text in ("gzip, br", "br;q=1.0, gzip;q=0", "*", "identity")]
    [True, False, False, False]
    """
    for entry in header(request.scope, "accept-encoding").split(","):
        name, _, weight = entry.partition(";")
        if name.strip().lower() == "gzip":
            return not re.fullmatch(r"q=0(\.0*)?", weight.replace(" ", ""))
    return False
