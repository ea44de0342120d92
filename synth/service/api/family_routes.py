"""What there is to ask, and what somebody wants to know while he types."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, Path, Query, Request, Response

from synth.errors import InputError
from synth.plugins import family_names
from synth.queue.accounts import Principal
from synth.queue.tenant_files import TenantFiles
from synth.service.api.asking import LONGEST, NOT_MODIFIED, tagged_json
from synth.service.api.schemas import EXAMPLES, CheckAnswer, DeclarationAnswer, ExampleList, FamilyList
from synth.service.auth import Reader
from synth.service.code_facts import declaration_asked
from synth.service.context import API, Context, ServiceContext, in_thread
from synth.service.errors import not_found
from synth.service.small_work import asker_of
from synth.service.wording import WORD
from synth.workers.engine_tasks import CHECK_TASK, DECLARATION_TASK, EVALUATE_TASK, EXAMPLES_TASK, FAMILIES_TASK

router = APIRouter(prefix=API, tags=["families"])
OPTIONS = "such as lubrication:dry,guide_model:cz"


def must_be_family(name: str) -> None:
    """Refuse the name of a family that there is not.

    Raises
    ------
    InputError
    """
    known = family_names()
    if name not in known:
        raise InputError("family", name, f"one of {', '.join(known)}", ("family",))


async def listed(request: Request, context: ServiceContext, principal: Principal, task: str, name: str) -> Response:
    """Answer with a list that depends on the code alone: what a task tells under a name."""
    found = await context.facts.get(asker_of(principal), task)
    return tagged_json(request, {name: found[name]}, found["code"])


@router.get("/families", response_model=FamilyList, responses=NOT_MODIFIED, summary="The families")
async def list_families(request: Request, principal: Reader, context: Context) -> Response:
    """Tell which families there are, with their options and the names of their examples."""
    return await listed(request, context, principal, FAMILIES_TASK, "families")


@router.get(
    "/families/{name}", response_model=DeclarationAnswer, responses=NOT_MODIFIED, summary="What a family declares"
)
async def read_family(
    request: Request,
    name: Annotated[str, Path(description="Name of a family.", examples=[EXAMPLES["spec"]["family"]])],
    principal: Reader,
    context: Context,
    options: Annotated[
        str | None, Query(max_length=LONGEST, pattern=WORD, description=f"Options that are chosen, {OPTIONS}.")
    ] = None,
) -> Response:
    """Tell what a form has to show: requirements, options, parts and objectives, with units, ranges and sources."""
    chosen = read_options(options)
    if name not in family_names():
        raise not_found()
    found = await context.facts.get(asker_of(principal), DECLARATION_TASK, declaration_asked(name, chosen))
    return tagged_json(request, found["declaration"], found["code"])


def read_options(stated: str | None) -> dict[str, str]:
    """Return options as an address states them.

    Raises
    ------
    InputError
        There is an entry without a name or a word.

    Examples
    --------
    >>> read_options("lubrication:dry, guide_model:cz")
    {'lubrication': 'dry', 'guide_model': 'cz'}
    """
    found: dict[str, str] = {}
    for entry in (stated or "").split(","):
        name, colon, word = (part.strip() for part in entry.partition(":"))
        if not entry.strip():
            continue
        if not (name and colon and word):
            raise InputError("options", stated, f"names and words, {OPTIONS}", ("options",))
        found[name] = word
    return found


@router.get("/examples", response_model=ExampleList, responses=NOT_MODIFIED, summary="The examples")
async def list_examples(request: Request, principal: Reader, context: Context) -> Response:
    """Give the examples of all families: specs to begin with."""
    return await listed(request, context, principal, EXAMPLES_TASK, "examples")


@router.post("/check", summary="Check a spec")
async def check(
    spec: Annotated[dict[str, Any], Body(openapi_examples={"incomplete": {"value": EXAMPLES["incomplete"]}})],
    principal: Reader,
    context: Context,
) -> CheckAnswer:
    """Tell everything that is wrong with a spec, which may be incomplete, and how it is understood.

    What is wrong in it is the answer, not a refusal.
    """
    return CheckAnswer.model_validate(await _asked(context, principal, CHECK_TASK, spec))


@router.post("/evaluate", summary="Evaluate a design", response_model=dict[str, Any])
async def evaluate(
    design: Annotated[dict[str, Any], Body(openapi_examples={"design": {"value": EXAMPLES["design"]}})],
    principal: Reader,
    context: Context,
) -> dict[str, Any]:
    """Compute one design that is stated with its sizes and parts: a spec with `values`."""
    found: dict[str, Any] = await _asked(context, principal, EVALUATE_TASK, design)
    return found


async def _asked(context: ServiceContext, principal: Principal, task: str, asked: dict[str, Any]) -> Any:
    sources = await in_thread(TenantFiles(context.store).sources, principal.tenant, asked)
    return await context.small.ask(asker_of(principal), task, {"request": asked, "sources": sources})
