"""The verbs of ``synth``, done by a service: :func:`connect`."""

from __future__ import annotations

import uuid
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from synth.batches.entries import RowSource
from synth.batches.row_table import ROWS, read_table
from synth.client.remote_job import Progress, RemoteJob, job_of
from synth.client.transport import CLIENT, ClientSettings, ServiceRefusedError, Transport
from synth.errors import InputError
from synth.folders.files import csv_text, read_bytes
from synth.question.arguments import DesignValues, Families, Objectives, Requirements, Scatter, Value, Variations
from synth.question.count_domain import stated_value
from synth.results import ParetoFront
from synth.tables.table_file import table_file

if TYPE_CHECKING:
    import pandas as pd

    from synth.model.problem import DesignProblem


Source = ParetoFront | RemoteJob | str  # a front of a job, the job, or its id


def connect(url: str, token: str | None = None, *, settings: ClientSettings = CLIENT) -> ServiceClient:
    """Return a service that does what ``synth`` does, by the same verbs.

    Parameters
    ----------
    url : str
        Its address: ``http://127.0.0.1:8350``.
    token : str, optional
        That it knows; a service on the same machine may need none.
    settings : ClientSettings, optional

    Raises
    ------
    InputError
        The address is none, or the extra is not installed: ``pip install 'clutchsynth[client]'``.
    ServiceRefusedError
        The service is not there, or does not take the token.
    """
    # Who has mistyped an address learns so at once; patience is for jobs that are under way.
    first = ServiceClient(Transport(url, token, replace(settings, patience=0.0)))
    with first:
        first.version()
    return ServiceClient(Transport(url, token, settings))


class ServiceClient:
    """A service of clutchsynth; made by :func:`connect`.

    Its verbs take what those of ``synth`` take, apart from what belongs to one machine: workers, folders, paths of
    tables. ``catalogs`` names tables that the service has: ``{"friction_materials": "my_linings@3"}``, see
    :meth:`add_catalogue`. A search returns the same ``ParetoFront``; every other verb returns its job, done, with
    :meth:`RemoteJob.result` and :meth:`RemoteJob.frame`.

    Parameters
    ----------
    transport : Transport
    """

    def __init__(self, transport: Transport) -> None:
        self._transport = transport
        self._fronts: dict[int, str] = {}  # of a front in memory, by its identity: the job that has found it

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the connections."""
        self._transport.close()

    # -- what there is -------------------------------------------------------------------------

    def version(self) -> dict[str, str]:
        """Return the versions of the service, of its interface and of its database."""
        found: dict[str, str] = self._transport.ask("GET", "/version").json()
        return found

    def families(self) -> list[str]:
        """Return the names of the families that the service knows."""
        return [str(family["name"]) for family in self._transport.ask("GET", "/families").json()["families"]]

    def describe(self, p: str | DesignProblem) -> pd.DataFrame:
        """Requirements, decisions and quantities of a family, one row per quantity."""
        import pandas as pd  # costly to import

        family, options = _family(p)
        query = {"options": ",".join(f"{name}:{label}" for name, label in options.items())} if options else {}
        return pd.DataFrame(self._transport.ask("GET", f"/families/{family}", params=query).json()["rows"])

    def job(self, id: str) -> RemoteJob:
        """Return a job by its id.

        Raises
        ------
        InputError
            It is no id.
        ServiceRefusedError
            The service has no such job, or it is another tenant's.
        """
        found = RemoteJob(self._transport, job_of(id))
        found.status()
        return found

    def jobs(self, **filters: Any) -> list[dict[str, Any]]:
        """Return the latest jobs as listed; filters are ``state``, ``kind``, ``family``, ``q``, ``limit``."""
        found: list[dict[str, Any]] = self._transport.ask("GET", "/jobs", params=filters).json()["jobs"]
        return found

    def submit(self, kind: str, request: Mapping[str, object], **more: Any) -> RemoteJob:
        """Ask for a job of any kind without waiting for it.

        Parameters
        ----------
        kind : str
            synthesis, compare, whatif, explain, prices, near_equals, rate, verify, report, batch or size_range.
        request : mapping
            As the interface of the service takes it.
        **more
            ``title``, ``parent``, ``priority``, ``seconds_limit``.

        Raises
        ------
        InputError
            Something in the request is wrong.
        """
        body = {"kind": kind, "request": _plain(request), **_given(**more)}
        once = {"Idempotency-Key": uuid.uuid4().hex}  # asked again after a broken connection, it makes no second job
        answer = self._transport.ask("POST", "/jobs", json=body, headers=once)
        return RemoteJob(self._transport, str(answer.json()["id"]))

    # -- verbs ---------------------------------------------------------------------------------

    def synthesize(
        self,
        p: str | DesignProblem,
        requirements: Requirements,
        objectives: Objectives = None,
        points: int | None = None,
        *,
        progress: Progress | None = None,
        **asked: Any,
    ) -> ParetoFront:
        """Find the ranked Pareto designs: as ``synth.synthesize``.

        Parameters
        ----------
        p, requirements, objectives, points, progress
        **asked
            ``catalogs``, ``parts``, ``limits``, ``fix``, ``weights``, ``gap``, ``grid``, ``seed``, ``time_limit``,
            ``robust``.

        Raises
        ------
        InputError
            Something in the question is wrong.
        """
        spec = _spec(p, requirements, objectives=objectives, points=points, **asked)
        return self._front(self.submit("synthesis", spec).wait(progress))

    def compare(
        self,
        families: Families,
        requirements: Requirements,
        objectives: Objectives = None,
        points: int | None = None,
        *,
        progress: Progress | None = None,
        **asked: Any,
    ) -> RemoteJob:
        """Ask several families the same: as ``synth.compare``; ``"any"`` asks all."""
        named = families if isinstance(families, str) else list(families)
        stated = _given(objectives=objectives, points=points, **asked)
        spec = {"family": named, "requirements": dict(requirements), **stated}
        return self.submit("compare", spec).wait(progress)

    def whatif(
        self,
        p: str | DesignProblem,
        requirements: Requirements,
        vary: Variations,
        objectives: Objectives = None,
        points: int | None = None,
        *,
        progress: Progress | None = None,
        **asked: Any,
    ) -> RemoteJob:
        """Answer a question at many values: as ``synth.whatif``."""
        spec = _spec(p, requirements, vary=vary, objectives=objectives, points=points, **asked)
        return self.submit("whatif", spec).wait(progress)

    def explain(
        self, p: str | DesignProblem, requirements: Requirements, *, progress: Progress | None = None, **asked: Any
    ) -> RemoteJob:
        """Tell why nothing is feasible, and what would make it so: as ``synth.explain``."""
        return self.submit("explain", _spec(p, requirements, **asked)).wait(progress)

    def prices(
        self,
        front: Source,
        design: int | Sequence[int] | None = None,
        step: Value | None = None,
        *,
        progress: Progress | None = None,
        **asked: Any,
    ) -> RemoteJob:
        """Tell what a per cent of everything costs: as ``synth.prices``."""
        return self._of("prices", front, progress, design=design, step=step, **asked)

    def near_equals(
        self,
        front: Source,
        design: int,
        within: Value | None = None,
        *,
        count: int | None = None,
        progress: Progress | None = None,
        **asked: Any,
    ) -> RemoteJob:
        """Find designs of other parts that are nearly as good: as ``synth.near_equals``."""
        return self._of("near_equals", front, progress, design=design, within=within, count=count, **asked)

    def rate(
        self, front: Source, robust: Scatter | None = None, *, progress: Progress | None = None, **asked: Any
    ) -> RemoteJob:
        """Tell how designs stand what scatters: as ``synth.rate``."""
        return self._of("rate", front, progress, robust=robust, **asked)

    def verify(self, front: Source, time_limit: float | None = None, *, progress: Progress | None = None) -> RemoteJob:
        """Check a front again without the search: as ``synth.verify``."""
        return self._of("verify", front, progress, time_limit=time_limit)

    def report(self, front: Source, *, progress: Progress | None = None, **asked: Any) -> RemoteJob:
        """Write the report of a front, as ``ParetoFront.report`` does.

        Parameters
        ----------
        front : ParetoFront, RemoteJob or str
        progress : callable, optional
        **asked
            ``design``, ``full``, ``formats``, ``length``, ``about``.
        """
        return self._of("report", front, progress, **asked)

    def batch(self, p: str | None, table: RowSource, *, progress: Progress | None = None, **asked: Any) -> RemoteJob:
        """Find the designs for every row of a table: as ``synth.batch``; ``frame("designs.csv")`` returns them.

        Parameters
        ----------
        p : family name, optional
            Of rows that name none.
        table : path, DataFrame or list of mappings
        progress : callable, optional
        **asked
            ``mapping``, ``objectives``, ``points``, ``catalogs``, ``parts``, ``limits``, ``fix``, ``gap``, ``grid``,
            ``seed``, ``time_limit``.
        """
        return self.submit("batch", {**_given(family=p, **asked), "upload": self.upload(table)}).wait(progress)

    def size_range(
        self,
        batch: RemoteJob | str,
        variants: int | None = None,
        objective: str | None = None,
        *,
        progress: Progress | None = None,
        **asked: Any,
    ) -> RemoteJob:
        """Choose standard variants that serve all rows of a batch: as ``synth.size_range``."""
        return self._of("size_range", batch, progress, variants=variants, objective=objective, **asked)

    def evaluate(
        self,
        p: str | DesignProblem,
        requirements: Requirements,
        *,
        values: DesignValues | None = None,
        parts: Mapping[str, str] | None = None,
        **asked: Any,
    ) -> dict[str, Any]:
        """Return the record of a given design: every quantity and limit of it."""
        spec = _spec(p, requirements, values=values, parts=parts, **asked)
        found: dict[str, Any] = self._transport.ask("POST", "/evaluate", json=spec).json()
        return found

    # -- what is brought -----------------------------------------------------------------------

    def upload(self, table: RowSource) -> str:
        """Bring a table of rows to the service; return its id there, which is good for a day.

        Parameters
        ----------
        table : path, DataFrame or list of mappings

        Raises
        ------
        InputError
            It is none of these, or cannot be read.
        """
        if isinstance(table, (str, Path)):
            named = table_file(Path(table))
            name, content = named.path.name, read_bytes(named.path, "rows", ROWS)
            how = {"encoding": named.encoding, "visible": named.visible}
        else:
            rows = read_table(table)
            name, content = f"{rows.name}.csv", csv_text(rows.header(), [cells for _, cells in rows.lines()]).encode()
            how = {}
        answer = self._transport.ask("POST", "/uploads", files={"file": (name, content)}, params=how)
        return str(answer.json()["id"])

    def add_catalogue(self, table: str, source: str | Path, name: str | None = None, note: str = "") -> str:
        """Bring rows for a part table to the service; return the reference by which ``catalogs`` names them.

        Parameters
        ----------
        table : str
            The table of the families, ``friction_materials``.
        source : path
            A CSV file.
        name : str, optional
            By which it is known; that of the file if not given. The same text keeps its version.
        note : str
        """
        text = read_bytes(source, "source", "a CSV file").decode("utf-8-sig")
        body = {"name": name or Path(source).stem, "table": table, "csv": text, **_given(note=note or None)}
        try:
            told = self._transport.ask("POST", "/catalogues", json=body).json()
        except ServiceRefusedError as refusal:
            if refusal.code != "same_content":
                raise
            told = dict(zip(("name", "version"), refusal.location.rsplit("/", 2)[1:], strict=True))
        return f"{told['name']}@{told['version']}"

    # -- inside --------------------------------------------------------------------------------

    def _front(self, job: RemoteJob) -> ParetoFront:
        front = job.front()
        self._fronts[id(front)] = job.id
        weakref.finalize(front, self._fronts.pop, id(front), None)
        return front

    def _of(self, kind: str, source: Source, progress: Progress | None, **asked: Any) -> RemoteJob:
        """Ask for something about an earlier job, or about a front that came from one."""
        named = self._fronts.get(id(source), source) if isinstance(source, ParetoFront) else source
        return self.submit(kind, {"of": job_of(named), **_given(**asked)}).wait(progress)


def _family(p: str | DesignProblem) -> tuple[str, dict[str, str]]:
    """Return the name of a family and its options; a service knows no problem of one's own."""
    if isinstance(p, str):
        return p, {}
    name, options = getattr(p, "name", None), getattr(p, "options", None)
    if isinstance(p, type) or not isinstance(name, str) or not isinstance(options, Mapping):
        right = "the name of a family, or synth.load(name, option=...)"
        raise InputError("family", getattr(p, "__name__", type(p).__name__), right, ("family",))
    return name, {str(key): str(label) for key, label in options.items()}


def _spec(p: str | DesignProblem, requirements: Requirements, **asked: Any) -> dict[str, Any]:
    family, options = _family(p)
    return {"family": family, "requirements": dict(requirements), **_given(options=options or None, **asked)}


def _given(**asked: Any) -> dict[str, Any]:
    """Request as a mapping: None is nothing."""
    return {name: value for name, value in asked.items() if value is not None}


def _plain(value: object) -> Any:
    """Request as JSON holds it: numbers of NumPy as numbers, tuples as lists."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (str, bytes)) or value is None:
        return value
    if isinstance(value, Sequence):
        return [_plain(entry) for entry in value]
    return stated_value(value)
