"""Where the figures of the service are read: by whoever is at this machine, or has a token."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST

from synth.queue.accounts import ADMIN, READ
from synth.service.auth import address_of, principal_of
from synth.service.context import Context, in_thread
from synth.service.errors import ServiceError
from synth.service.security import header, host_name
from synth.service.settings import is_loopback

router = APIRouter(tags=["health"])
FORWARDED = ("x-forwarded-for", "forwarded", "x-real-ip")


@router.get("/metrics")
async def figures(request: Request, context: Context) -> Response:
    """Tell the figures of the service, as Prometheus reads them."""
    if not is_local(request):
        principal = await principal_of(request, context)
        if not principal.scopes & {READ, ADMIN}:
            raise ServiceError(403, f"this needs a token with the scope {READ} or {ADMIN}", "scope")
    return Response(await in_thread(context.metrics.text), media_type=CONTENT_TYPE_LATEST)


def is_local(request: Request) -> bool:
    """True if a request was made at this machine, and not through a proxy that runs on it."""
    own = is_loopback(address_of(request)) and is_loopback(host_name(header(request.scope, "host")))
    return own and not any(header(request.scope, name) for name in FORWARDED)
