"""A job of a service: waited for, cancelled, and its results fetched."""

from __future__ import annotations

import io
import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from synth.client.transport import ServiceRefusedError, Transport, told_input_error
from synth.errors import InputError
from synth.folders.output_folder import save_files
from synth.results.loading import front_of_record

if TYPE_CHECKING:
    import pandas as pd

    from synth.results import ParetoFront

CSV = ".csv"
ENDED = ("done", "failed", "cancelled", "stopped")
Progress = Callable[[Mapping[str, Any]], None]


class RemoteJob:
    """A job of a service, under its id.

    Parameters
    ----------
    transport : Transport
    id : str
    """

    def __init__(self, transport: Transport, id: str) -> None:
        self._transport, self.id = transport, id

    def __repr__(self) -> str:
        return f"RemoteJob({self.id!r})"

    # -- how it is -----------------------------------------------------------------------------

    def status(self) -> dict[str, Any]:
        """Record of the job from the service: state, outcome, progress, summary, times."""
        found: dict[str, Any] = self._transport.ask("GET", self._path()).json()
        return found

    def wait(self, progress: Progress | None = None) -> RemoteJob:
        """Wait until the job has ended, and return it. Ctrl-C cancels it.

        Parameters
        ----------
        progress : callable, optional
            Told how far the job is, as the verbs of ``synth`` tell it.

        Raises
        ------
        InputError
            The work has found that something is wrong in the question.
        ServiceRefusedError
            The job has failed, or was cancelled.
        """
        try:
            self._follow(progress)
        except KeyboardInterrupt:
            self.cancel()
            raise
        found = self.status()
        if found["state"] in ("failed", "cancelled"):
            raise _failure(found)
        return self

    def _follow(self, progress: Progress | None) -> None:
        """Hear the events of the job until it has ended; a stream that breaks is opened again."""
        last: str | None = None
        deadline = time.monotonic() + self._transport.settings.patience
        while True:
            try:
                for number, kind, data in self._transport.events(self._path("events"), last):
                    last = number or last
                    deadline = time.monotonic() + self._transport.settings.patience
                    told = json.loads(data)
                    state = told if kind == "progress" else told.get("progress") if kind == "snapshot" else None
                    if state and progress is not None:
                        progress(state)
                    if kind == "end" or told.get("state") in ENDED:
                        return
            except ServiceRefusedError as refusal:
                if refusal.status not in (0, 429, 503):
                    raise
            except Exception as error:
                if not self._transport.is_lost(error) or time.monotonic() > deadline:
                    raise
            if self.status()["state"] in ENDED:
                return
            time.sleep(self._transport.settings.pause)

    # -- what is done with it ------------------------------------------------------------------

    def cancel(self) -> None:
        """Cancel the job, if it has not ended."""
        try:
            self._transport.ask("POST", self._path("cancel"))
        except ServiceRefusedError as refusal:
            if refusal.code != "conflict" and refusal.status != 409:
                raise

    def resume(self) -> RemoteJob:
        """Let a job go on that was cancelled or has failed; return it."""
        self._transport.ask("POST", self._path("resume"))
        return self

    def delete(self) -> None:
        """Remove the job with its results."""
        self._transport.ask("DELETE", self._path())

    # -- what came out -------------------------------------------------------------------------

    def result(self) -> dict[str, Any]:
        """Return the main record of the job."""
        found: dict[str, Any] = self._transport.ask("GET", self._path("result")).json()
        return found

    def front(self) -> ParetoFront:
        """Return the front that a synthesis has found, as ``synth.synthesize`` returns it.

        Raises
        ------
        InputError
            The job has found no front.
        """
        return front_of_record(self.result(), Path("front.json"))

    def files(self) -> list[str]:
        """Return the names of the files of the job, those that are made on request among them."""
        return [str(file["name"]) for file in self._transport.ask("GET", self._path("files")).json()["files"]]

    def file(self, name: str, **options: str) -> bytes:
        """Return one file of the job.

        Parameters
        ----------
        name : str
            One of :meth:`files`.
        **options
            Of reports, as query of the address.
        """
        return self._transport.ask("GET", self._path("files", name), params=options).content

    def frame(self, name: str) -> pd.DataFrame:
        """Return a CSV file of the job as a table.

        Raises
        ------
        InputError
            It is no CSV file of the job.
        """
        if not name.endswith(CSV):
            there = ", ".join(known for known in self.files() if known.endswith(CSV))
            raise InputError(
                "name", name, f"a CSV file of the job: {there}" if there else "a job with CSV files", ("name",)
            )
        import pandas as pd  # costly to import

        return pd.read_csv(io.BytesIO(self.file(name, raw="1")))

    def save(self, folder: str | Path, *names: str) -> Path:
        """Write the files of the job that are named to a folder, all or none; return the folder."""
        return save_files(folder, {Path(name).name: self.file(name) for name in names})

    def _path(self, *more: str) -> str:
        return "/".join(("/jobs", quote(self.id, safe=""), *more))


def _failure(found: Mapping[str, Any]) -> Exception:
    """Reason why a job has no result, as an error of ours."""
    error = found.get("error") or {}
    problems = error.get("problems") or []
    if problems:
        return told_input_error(problems)
    message = str(error.get("message") or f"the job was {found['state']}")
    return ServiceRefusedError(200, str(error.get("code") or found["state"]), message)


def job_of(value: object) -> str:
    """Return the id of a job that is given as one, or by its id.

    Raises
    ------
    InputError
        It is neither.
    """
    if isinstance(value, RemoteJob):
        return value.id
    if isinstance(value, str):
        return value
    raise InputError("of", type(value).__name__, "a job of this service, or a front that it has returned", ("of",))
