"""Requests to a service, and what it refuses told in the words of the product."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from synth.errors import ExtraNeededError, InputError, SeveralErrors

if TYPE_CHECKING:
    import httpx

API = "/api/v1"
BAD_INPUT = 422
AGAIN = (429, 503)  # the service asks to come again


@dataclass(frozen=True, kw_only=True)
class ClientSettings:
    """How a service is asked.

    Parameters
    ----------
    timeout : float
        In s, for an answer to a request.
    patience : float
        In s, for which a service that does not answer is asked again: a restart of its machine.
    pause : float
        In s, between two tries, where the service does not say.
    silence : float
        In s, after which a stream without a sign of life counts as broken; the service gives one each 15 s.
    """

    timeout: float = 30.0
    patience: float = 120.0
    pause: float = 0.5
    silence: float = 45.0


CLIENT = ClientSettings()


class ServiceRefusedError(Exception):
    """What a service does not do.

    Parameters
    ----------
    status : int
        Of HTTP.
    code, message : str
        What the service says: for programs and for people.
    location : str
        The address of what there is instead; empty where there is nothing.
    """

    def __init__(self, status: int, code: str, message: str, location: str = "") -> None:
        super().__init__(f"{message} ({code})")
        self.status, self.code, self.location = status, code, location


class Transport:
    """One service, over HTTP.

    Parameters
    ----------
    url : str
    token : str, optional
    settings : ClientSettings

    Raises
    ------
    InputError
        The address is none.
    ExtraNeededError
        What speaks HTTP is not installed.
    """

    def __init__(self, url: str, token: str | None, settings: ClientSettings) -> None:
        try:
            import httpx
        except ImportError:
            raise ExtraNeededError("connect", "client") from None
        if not isinstance(url, str) or not url.startswith(("http://", "https://")):
            raise InputError("url", url, "the address of a service, such as http://127.0.0.1:8350", ("url",))
        headers = {} if token is None else {"Authorization": f"Bearer {token}"}
        self.settings = settings
        self._lost = (httpx.TransportError,)
        self._http = httpx.Client(base_url=url.rstrip("/") + API, headers=headers, timeout=settings.timeout)

    def close(self) -> None:
        """Let go of the connections."""
        self._http.close()

    def ask(self, method: str, path: str, **more: Any) -> httpx.Response:
        """Return the answer to a request; a service that is not there for now is asked again.

        Raises
        ------
        InputError
            Something in the request is wrong.
        ServiceRefusedError
            The service refuses it for another reason, or is not reached.
        """
        deadline = time.monotonic() + self.settings.patience
        while True:
            try:
                answer = self._http.request(method, path, **more)
            except self._lost as error:
                if time.monotonic() > deadline:
                    raise ServiceRefusedError(0, "not_reached", f"the service does not answer: {error}") from error
                time.sleep(self.settings.pause)
                continue
            if answer.status_code in AGAIN and time.monotonic() < deadline:
                time.sleep(_pause(answer, self.settings.pause))
                continue
            if answer.is_success:
                return answer
            raise _refusal(answer)

    def events(self, path: str, after: str | None = None) -> Iterator[tuple[str, str, str]]:
        """Yield what a stream says, one event at a time: its number, its kind, its data; until the stream ends."""
        import httpx

        headers = {"Accept": "text/event-stream", **({} if after is None else {"Last-Event-ID": after})}
        patient = httpx.Timeout(self.settings.timeout, read=self.settings.silence)
        with self._http.stream("GET", path, headers=headers, timeout=patient) as stream:
            if not stream.is_success:
                stream.read()
                raise _refusal(stream)
            number, kind, data = "", "message", list[str]()
            for line in stream.iter_lines():
                name, _, value = line.partition(":")
                value = value.removeprefix(" ")
                if not line and data:
                    yield number, kind, "\n".join(data)
                    kind, data = "message", []
                elif name == "id":
                    number = value
                elif name == "event":
                    kind = value
                elif name == "data":
                    data.append(value)

    def is_lost(self, error: Exception) -> bool:
        """True if an error says that the connection broke, and nothing about what was asked."""
        return isinstance(error, self._lost)


def _pause(answer: httpx.Response, usual: float) -> float:
    stated = answer.headers.get("Retry-After", "")
    return float(stated) if stated.isdigit() else usual


def _refusal(answer: httpx.Response) -> Exception:
    """Error for a refusal of a service."""
    try:
        told: Mapping[str, Any] = answer.json()["error"]
    except (ValueError, KeyError, TypeError):
        return ServiceRefusedError(answer.status_code, "no_service", "this is no answer of a clutchsynth service")
    problems = told.get("problems") or []
    if answer.status_code == BAD_INPUT and problems:
        return told_input_error(problems)
    location = answer.headers.get("Location", "")
    return ServiceRefusedError(answer.status_code, str(told["code"]), str(told["message"]), location)


def told_input_error(problems: Sequence[Mapping[str, Any]]) -> InputError:
    """Error that the search itself would have raised, from what a service says of the input."""
    found = [_input_error(problem) for problem in problems]
    return SeveralErrors(found) if len(found) > 1 else found[0]


def _input_error(problem: Mapping[str, Any]) -> InputError:
    field = str(problem["message"]).split(": got ", 1)[0].split(": is missing", 1)[0]
    error = InputError(field, problem.get("value"), str(problem["expected"]), tuple(problem["path"]))
    error.args = (str(problem["message"]),)  # in the words of the service: a value has gone through JSON
    return error
