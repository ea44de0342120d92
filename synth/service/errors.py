"""One form of refusal for everything: what is wrong, for programs and for people, and the number of the request.

    {"error": {"code": "bad_input", "message": "...", "problems": [{"path", "value", "expected", "message"}],
               "request_id": "..."}}

Codes are stable; messages are for people. A fault of the service itself tells its number alone: what happened may hold
what somebody else has asked.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from http import HTTPStatus
from types import MappingProxyType
from typing import Any

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, Field
from sqlalchemy.exc import InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from synth.errors import ExtraNeededError, InputError
from synth.queue.database import DISK_FULL
from synth.queue.job_table import KeyInUseError, QueueFullError
from synth.service.addresses import Addresses
from synth.service.small_work import BusyError, LateError
from synth.service.wording import fault_of
from synth.system.operating_system import OUT_OF_SPACE
from synth.workers.engine_process import EngineCrashedError, EngineFailedError, EngineTimeoutError

JSON = "application/json"
NO_SPACE_SENTENCE = "there is no room on the disk of the service; nothing was kept, whoever runs it has to make room"
DATABASE_FLAG = "--database"  # the field of what is wrong with a database
FAILED = "something went wrong in the program that computes; please tell the request_id"
NO_HEADERS: Mapping[str, str] = MappingProxyType({})
CODES: Mapping[int, str] = MappingProxyType(
    {
        400: "bad_request",
        401: "not_signed_in",
        403: "forbidden",
        404: "not_found",
        405: "method_not_allowed",
        408: "too_slow",
        409: "conflict",
        413: "too_large",
        415: "unsupported_media",
        421: "wrong_host",
        422: "bad_input",
        429: "too_many",
        500: "internal",
        501: "not_installed",
        503: "unavailable",
        507: "no_room",
    }
)


class Problem(BaseModel):
    """One thing that is wrong in the input."""

    path: list[str | int] = Field(
        description="Keys and positions: of a spec its own, also where it stands under `request`; of all else those of "
        "the body, or the name of a parameter. Empty for the body as a whole."
    )
    value: Any = None
    expected: str
    message: str


class RequestRefusal(BaseModel):
    """Why a request cannot be answered."""

    code: str
    message: str
    problems: list[Problem]
    request_id: str


class RefusalBody(BaseModel):
    """The body of every answer that is none."""

    error: RequestRefusal


# What every route may answer, for the description of the interface.
REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": RefusalBody, "description": sentence}
    for status, sentence in {
        400: "The request cannot be read.",
        401: "There is no token, or it is not valid.",
        403: "The token may not do this.",
        404: "It is not there, or not yours.",
        405: "The address is there, but cannot be asked this way; Allow tells how.",
        408: "The body did not arrive in time.",
        413: "The body is too large.",
        415: "The body is of a kind that is not taken.",
        421: "The service is not known by the name in Host.",
        422: "Something in the input is wrong; problems tell what, where and what would be right.",
        429: "Too much at a time; Retry-After tells when to come again.",
        500: "Something went wrong here; request_id tells which line of the log says more.",
        503: "Something is not there for now; Retry-After tells when to come again.",
        507: "There is no room on the disk; nothing of the request is kept.",
    }.items()
}


class ServiceError(Exception):
    """What a request cannot have.

    Parameters
    ----------
    status : int
        Of HTTP.
    message : str
        One sentence for people.
    code : str, optional
        For programs; by default that of the status.
    problems : sequence, optional
        What is wrong in the input, place by place, as ``InputError.told`` tells it.
    headers : mapping, optional
    """

    def __init__(
        self,
        status: int,
        message: str,
        code: str = "",
        problems: Sequence[Mapping[str, object]] = (),
        headers: Mapping[str, str] = NO_HEADERS,
    ) -> None:
        super().__init__(message)
        self.status, self.message, self.code = status, message, code or code_of(status)
        self.problems, self.headers = problems, headers


NO_SPACE = ServiceError(507, NO_SPACE_SENTENCE, "no_room")


def code_of(status: int) -> str:
    """Return the code that goes with a status."""
    return CODES.get(status) or CODES[400 if status < 500 else 500]


def not_found(what: str = "there is nothing here, or it is not yours") -> ServiceError:
    """Return the refusal of what is not there, or belongs to another tenant: nobody learns which."""
    return ServiceError(404, what)


def refusal_of(error: InputError) -> ServiceError:
    """Return the refusal of a request whose input is wrong."""
    return ServiceError(422, str(error), problems=[fault.told() for fault in error.every()])


def error_body(code: str, message: str, request_id: str, problems: Sequence[Mapping[str, object]] = ()) -> bytes:
    """Return the body of a refusal."""
    told = {"code": code, "message": message, "problems": list(problems), "request_id": request_id}
    return json.dumps({"error": told}, ensure_ascii=True, allow_nan=False).encode("ascii")


def error_response(error: ServiceError, request_id: str) -> Response:
    """Return a refusal as it is sent."""
    body = error_body(error.code, error.message, request_id, error.problems)
    return Response(body, error.status, dict(error.headers), JSON)


def again(seconds: float) -> dict[str, str]:
    """Return the header that says when to come again."""
    return {"Retry-After": str(max(1, round(seconds)))}


def database_away(retry_after: float) -> ServiceError:
    """Return the refusal of what needs a database that does not answer."""
    message = "the database does not answer; nothing is lost, please come again"
    return ServiceError(503, message, headers=again(retry_after))


def register_errors(
    app: FastAPI, retry_after: float, addresses: Addresses, page: Callable[[Request], Response | None]
) -> None:
    """Let every refusal have the one form.

    Parameters
    ----------
    app : FastAPI
    retry_after : float
        In s, after which whoever met a passing hindrance may come again.
    addresses : Addresses
        How each address may be asked.
    page : callable
        Returns what a browser is shown at an address where nothing stands; None where it is no browser that asks.
    """

    def told(kind: type[Exception], make: Callable[[Any], ServiceError]) -> None:
        async def handle(request: Request, error: Exception) -> Response:
            refusal: ServiceError = make(error)
            if refusal.status >= 500:
                request.scope["state"]["failure"] = _for_the_log(error)
            return error_response(refusal, request_id_of(request))

        app.add_exception_handler(kind, handle)

    async def of_http(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        shown = page(request) if error.status_code == 404 else None
        if shown is not None:
            return shown
        allowed = addresses.methods(request.scope["path"]) if error.status_code == 405 else ()
        return error_response(_of_http(error, allowed), request_id_of(request))

    def later(message: str) -> Any:
        return lambda _: ServiceError(503, message, headers=again(retry_after))

    def away(_: Exception) -> ServiceError:
        return database_away(retry_after)

    told(ServiceError, lambda error: error)
    app.add_exception_handler(HTTPException, of_http)
    told(RequestValidationError, _of_validation)
    told(InputError, _of_input)
    told(ExtraNeededError, lambda error: ServiceError(501, _lacking(error)))
    told(KeyInUseError, lambda _: ServiceError(409, "the Idempotency-Key was used for another request", "key_taken"))
    told(QueueFullError, lambda error: ServiceError(429, _full(error), "queue_full", headers=again(retry_after)))
    told(EngineTimeoutError, later("this takes longer than it may; please ask for less, or ask it as a job"))
    told(LateError, later("this takes longer than usual and goes on here; please ask the same again"))
    told(BusyError, later("others are being answered; please come again"))
    told(EngineFailedError, lambda _: ServiceError(500, FAILED, "engine_failed"))
    told(EngineCrashedError, later("the process that computes has ended; please come again"))
    told(OSError, _of_system)
    told(OperationalError, lambda error: NO_SPACE if _is_full(error) else away(error))
    told(InterfaceError, away)
    told(PoolTimeoutError, away)


def _for_the_log(error: Exception) -> dict[str, Any]:
    """Log fields of an error: of one in another process where it was raised there."""
    if isinstance(error, EngineFailedError):
        return {"error": error.failure.kind, "where": list(error.failure.where)}
    return {"error": type(error).__name__}


def request_id_of(request: Request) -> str:
    """Return the number of a request."""
    return str(request.scope.get("state", {}).get("request_id", ""))


def _of_system(error: OSError) -> ServiceError:
    """Return the refusal of what needs room that is not there; all else is a fault of the service."""
    if error.errno in OUT_OF_SPACE:
        return NO_SPACE
    raise error


def _is_full(error: OperationalError) -> bool:
    return getattr(error.orig, "sqlstate", None) == DISK_FULL


def _lacking(error: ExtraNeededError) -> str:
    install = f"pip install 'clutchsynth[{error.extra}]'"
    return f"this server lacks the extra {error.extra}; whoever runs it can add it: {install}"


def _full(error: QueueFullError) -> str:
    return f"{error.most} jobs are open, as many as you may have; please wait for one to end, or cancel one"


def _of_input(error: InputError) -> ServiceError:
    """Return the refusal of an input; what is wrong with the database itself is nobody's input over HTTP."""
    return ServiceError(503, "the database cannot be used") if error.field == DATABASE_FLAG else refusal_of(error)


def _of_http(error: HTTPException, methods: Collection[str] = ()) -> ServiceError:
    """Answer to what the framework refuses; where a path cannot be asked so, the methods by which it can.

    The framework itself knows those of the first route that has the path.
    """
    headers = dict(error.headers or NO_HEADERS)
    if methods:
        headers["Allow"] = ", ".join(sorted(methods))
    allowed = headers.get("Allow", "")
    sentences = {
        404: "there is nothing here, or it is not yours",
        405: "this cannot be done here" + (f"; expected {allowed}" if allowed else ""),
    }
    message = sentences.get(error.status_code) or str(error.detail) or HTTPStatus(error.status_code).phrase
    return ServiceError(error.status_code, message, headers=headers)


def _of_validation(error: RequestValidationError) -> ServiceError:
    """Refusal by a schema: where, and what would be right; JSON that cannot be read is no input."""
    found = error.errors()
    if any(fault["type"] == "json_invalid" for fault in found):
        return ServiceError(400, "the body is not JSON", "not_json")
    if any(isinstance(fault.get("input"), bytes) for fault in found):
        return ServiceError(415, "the body is not JSON; expected application/json here")
    problems = [fault_of(told).told() for told in found]
    return ServiceError(422, str(problems[0]["message"]), problems=problems)
