"""The addresses of the pages. What stands on them is asked of the interface by their scripts."""

from __future__ import annotations

import json
from collections.abc import Callable, Coroutine
from functools import cache
from importlib.metadata import version
from importlib.resources import files
from typing import Annotated, Any, NamedTuple
from urllib.parse import quote

from fastapi import APIRouter, Path, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse, RedirectResponse
from fastapi.routing import APIRoute
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from synth.queue.accounts import ADMIN, READ, SUBMIT, Principal
from synth.queue.job_table import BATCH
from synth.service.api.asking import OwnJob
from synth.service.api.result_routes import LARGEST_LINE
from synth.service.auth import Administrator, Reader
from synth.service.context import API
from synth.service.errors import ServiceError, not_found, request_id_of
from synth.service.pages.assets import EXPLORER_MODULE, assets, static_place
from synth.service.security import header

SIGN_IN = "/sign-in"
INTERFACE = f"/{API.split('/')[1]}/"  # below which programs ask, whatever the version
PACKAGE = files("synth.service.pages")


class Place(NamedTuple):
    """An entry of the navigation: where it leads, what it is called, and which scope it needs."""

    address: str
    name: str
    scope: str


PLACES = (
    Place("/", "Studies", READ),
    Place("/new", "New study", SUBMIT),
    Place("/batches/new", "Batch", SUBMIT),
    Place("/catalogues", "Catalogues", READ),
    Place("/families", "Families", READ),
    Place("/interface", "API", READ),
    Place("/tokens", "Tokens", ADMIN),
)


@cache
def _templates() -> Environment:
    return Environment(
        loader=FileSystemLoader(str(PACKAGE / "templates")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


@cache
def _first_examples() -> str:
    """Return the names of the examples that whoever has no study is offered."""
    found: list[str] = json.loads((PACKAGE / "first_examples.json").read_text(encoding="utf-8"))
    return ",".join(found)


def shown(
    template: str, title: str, place: str, principal: Principal | None, status: int = 200, **told: object
) -> HTMLResponse:
    """Return a page; ``told`` goes to its template, which escapes all of it."""
    scopes = frozenset[str]() if principal is None else principal.scopes
    text = (
        _templates()
        .get_template(f"{template}.html")
        .render(
            title=title,
            place=place,
            places=[entry for entry in PLACES if entry.scope in scopes],
            tenant="" if principal is None else principal.tenant_name,
            signed_in=principal is not None and principal.token is not None,
            may_submit=SUBMIT in scopes,
            static=static_place(),
            version=version("clutchsynth"),
            **told,
        )
    )
    return HTMLResponse(text, status)


class PageRoute(APIRoute):
    """Answers refusals as people read them: with a page, or with the way to sign in."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Handler of a request."""
        handler = super().get_route_handler()

        async def handle(request: Request) -> Response:
            try:
                return await handler(request)
            except ServiceError as error:
                if error.status == 401:
                    return RedirectResponse(f"{SIGN_IN}?next={quote(_here(request))}", 303)
                return _refused(request, error)
            except RequestValidationError:
                return _refused(request, not_found())

        return handle


def _here(request: Request) -> str:
    return request.url.path + (f"?{request.url.query}" if request.url.query else "")


def _refused(request: Request, error: ServiceError) -> Response:
    principal = request.scope["state"].get("principal")
    title = "Nothing here" if error.status == 404 else "Not allowed" if error.status == 403 else "Not now"
    page = shown("refusal", title, "", principal, error.status, message=error.message, number=request_id_of(request))
    page.headers.update(error.headers)
    return page


def unknown(request: Request) -> Response | None:
    """Return the page for an address where nothing stands; None where a program asks, or something of the interface."""
    if request.url.path.startswith(INTERFACE) or "text/html" not in header(request.scope, "accept"):
        return None
    return _refused(request, not_found("there is no page at this address"))


router = APIRouter(route_class=PageRoute, default_response_class=HTMLResponse)


@router.get("/")
async def studies(principal: Reader) -> HTMLResponse:
    """Show the studies."""
    return shown("studies", "Studies", "/", principal, examples=_first_examples())


@router.get("/new")
async def new_study(principal: Reader) -> HTMLResponse:
    """Show the form of a study."""
    return shown("new", "New study", "/new", principal)


@router.get("/batches/new")
async def new_batch(principal: Reader) -> HTMLResponse:
    """Show where a table is brought."""
    return shown("batch", "Batch", "/batches/new", principal)


@router.get("/catalogues")
async def catalogues(principal: Reader) -> HTMLResponse:
    """Show part tables of one's own."""
    return shown("catalogues", "Catalogues", "/catalogues", principal)


@router.get("/families")
async def families(principal: Reader) -> HTMLResponse:
    """Show the families."""
    return shown("families", "Families", "/families", principal, family="")


@router.get("/families/{name}")
async def family(name: Annotated[str, Path(pattern=r"^[a-z0-9_]{1,100}$")], principal: Reader) -> HTMLResponse:
    """Show what a family declares."""
    return shown("families", "Family", "/families", principal, family=name)


@router.get("/interface")
async def interface(principal: Reader) -> HTMLResponse:
    """Show the interface for programs."""
    return shown("interface", "API", "/interface", principal)


@router.get("/tokens")
async def tokens(principal: Administrator) -> HTMLResponse:
    """Show who may come in."""
    return shown("tokens", "Tokens", "/tokens", principal)


@router.get("/jobs/{job}")
async def job(found: OwnJob, principal: Reader) -> HTMLResponse:
    """Show a job: how it stands, and what it has found."""
    explorer = f"{static_place()}/{EXPLORER_MODULE}" if EXPLORER_MODULE in assets() else ""
    return shown("job", found.title, "", principal, job=found.id, explorer=explorer)


@router.get("/jobs/{job}/rows/{line}")
async def row(found: OwnJob, line: Annotated[int, Path(ge=1, le=LARGEST_LINE)], principal: Reader) -> HTMLResponse:
    """Show a row of a batch: what it asks, and the designs that it has found."""
    if found.kind != BATCH:
        raise not_found()
    return shown("row", f"Line {line} · {found.title}", "", principal, job=found.id, line=line)


@router.get(SIGN_IN)
async def sign_in() -> HTMLResponse:
    """Show where a browser tells its token."""
    return shown("sign_in", "Sign in", "", None)
