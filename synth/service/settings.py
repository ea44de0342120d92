"""The numbers and places that the service goes by: from one TOML file, from variables, or as they are here.

What is stated later wins: the file, then variables ``CLUTCHSYNTH_...`` (the same names in capitals), then flags.
"""

from __future__ import annotations

import ipaddress
import tomllib
import types
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import Any, get_args, get_type_hints

from synth.errors import InputError
from synth.system.operating_system import cores, data_home
from synth.text.numbers import typed_number

FILE = "clutchsynth.toml"  # read from the folder in which the service starts, where there is one
PREFIX = "CLUTCHSYNTH_"
CLOSE = 0.8  # likeness of a name to a key, from which on it is one that was misspelt
JOBS_FILE = "jobs.sqlite"
TRUE, FALSE = ("1", "true", "yes", "on"), ("0", "false", "no", "off")
WORDS: Mapping[type, str] = types.MappingProxyType(
    {int: "a whole number", float: "a number", bool: "true or false", str: "a text", Path: "the name of a folder"}
)


def _own_folder() -> Path:
    """Folder in which programs of this user keep what they must not lose."""
    return data_home() / "clutchsynth"


def _within(default: object, least: float, most: float) -> Any:
    """Return a field that is a number between two others."""
    return field(default=default, metadata={"least": least, "most": most})


@dataclass(frozen=True, kw_only=True)
class ServiceSettings:
    """All that can be set of the service. Times are in s, sizes in bytes.

    Parameters
    ----------
    host : str
        Address to listen on. Other than loopback it needs a token in the database before it starts.
    port : int
        Port to listen on; 0 takes one that is free.
    data : Path
        Folder of the database, unless ``database`` names another.
    database : str
        Where the jobs are: ``sqlite:///FILE`` or ``postgresql://USER@HOST/NAME``; empty is ``jobs.sqlite`` in ``data``.
    hosts : list of str
        Names under which the service is reached, beside those of loopback: of a proxy in front, or of the machine.
    proxies : list of str
        Addresses of proxies whose ``X-Forwarded-For`` and ``X-Forwarded-Proto`` are believed.
    workers : int
        Jobs that this machine works at, by a supervisor that the server starts; 0 for none.
    engines : int
        Processes that answer small questions at once, such as checks of what is being typed.
    file_engines : int
        Processes that read and make files, and check tables; they are started when the first is needed.
    small_deadline : float
        In which a small question is answered; after it the client is asked to come again, and the work goes on.
    file_deadline : float
        The same of a file of a job that is made, or of rows that were brought and are read and checked.
    small_limit : float
        Of a processor, that a small question may take in all; then its process is replaced.
    file_limit : float
        The same of files.
    queue_wait : float
        That a request waits for its turn: among those under way, among files that are brought, and for a process.
    tenant_share : float
        Of requests at a time, of files that are brought and of processes, that a tenant has at most; one at least.
    token_share : float
        The same of a token, and of an address without one.
    remembered : int
        Declarations with options chosen that a server remembers; those as they are by default it has from its start.
    log : bool
        Whether each request is told on standard error, as one line of JSON.
    body_limit : int
        Of a request's body: the largest spec that makes sense has a few kilobytes.
    upload_limit : int
        Of a file that is brought.
    upload_entries : int
        Files in a workbook that is brought; one of a spreadsheet program has some dozens.
    upload_unpacked : int
        Of all that is packed in a workbook.
    upload_ratio : int
        By which a workbook may be packed; sheets full of the same are packed by fifty.
    upload_shown : int
        Rows of a file that are shown to whoever has brought it.
    tenant_uploads : int
        Files of a tenant that are kept at a time.
    json_depth : int
        Levels of brackets in a body; a spec has six.
    json_keys : int
        Keys in a body; a spec with limits for everything has some hundreds.
    target_limit : int
        Of the first line and the headers of a request: browsers send less than a tenth of it.
    header_timeout : float
        For the first line and the headers of a request to arrive.
    uploads_at_once : int
        Files at a time that are arriving or being looked at: each is held in memory.
    body_timeout : float
        For the body to arrive: an upload of 20 MB over a slow line.
    body_grace : float
        In which nothing of a body need arrive.
    body_rate : int
        Bytes per s of a body that must have arrived on average after that.
    send_timeout : float
        For a client to take the next part of an answer.
    idle_timeout : int
        After which a connection without a request is closed.
    idle_connections : int
        Connections that wait for a request at a time; of more, the one that waits longest is closed.
    requests_at_once : int
        Requests at a time, event streams among them; more wait, and are asked to come again.
    retry_after : int
        After which whoever was asked to come again may do so.
    shutdown_timeout : int
        For requests that are under way when the service ends.
    failed_tokens : int
        Wrong tokens from one address within ``failed_window``, after which further wrong ones are answered 429.
    failed_window : float
        In which wrong tokens are counted.
    addresses : int
        Addresses whose wrong tokens are counted; of more, the oldest is forgotten.
    token_note : float
        Between two notes that a token was used: a note is a write, a request mostly a read.
    token_days : int
        For which a token is valid where its maker says nothing.
    session_hours : float
        For which a browser stays signed in: a working day.
    streams : int
        Event streams that a token may hold open: a person has a few windows.
    stream_queue : int
        Events that wait for a slow listener, before it is told to read the state anew.
    stream_tail : float
        Between two looks for new events, by one reader for all listeners: nobody sees a fifth of a second.
    stream_margin : float
        For which it is looked again for events that have come late: a transaction that takes longer shows them late.
    stream_comment : float
        Between signs of life in a stream: proxies close what is silent for half a minute.
    stream_retry : int
        After which a browser whose stream has ended comes back.
    stream_jobs : int
        Jobs in one stream: a page of a list.
    page : int
        Entries of a list, where the client does not say.
    page_limit : int
        Entries of a list at most.
    points_limit : int
        Designs that may be asked for over HTTP, half of what the command line allows.
    steps_limit : int
        Values of a study that may be asked for over HTTP.
    tenant_open_jobs : int
        Jobs of a new tenant that may be open at a time.
    tenant_running : int
        Jobs of a new tenant that are worked at at a time.
    tenant_seconds_limit : float
        Time limit of a job of a new tenant, at most.
    tenant_rows : int
        Rows of a batch of a new tenant.
    keep_days : float
        That a job is kept after it was used last, unless it is pinned; 0 keeps all.
    use_note : float
        Between two notes that a job was used.
    upload_hours : float
        That a file is kept that was brought for a batch.
    prune_interval : float
        Between two rounds in which what is too old is removed.
    prune_most : int
        Jobs that a round removes in one transaction: others wait for as long.
    database_patience : float
        That a request waits for a database that is busy.
    ready_database : float
        In which the database must answer for the service to be ready.
    ready_space : int
        That must be free where a SQLite file is for the service to be ready.
    ready_write : float
        Between two looks whether the database can be written to.
    ready_worker : float
        In which a worker must have given a sign of life for the service to be ready.
    worker_restart : float
        Before a supervisor that has died is started again, and twice as long each time it dies at once.
    worker_restart_most : float
        Before that at most.
    worker_patience : float
        For a supervisor to end by itself when the service does.
    """

    host: str = "127.0.0.1"
    port: int = _within(8350, 0, 65535)
    data: Path = field(default_factory=_own_folder)
    database: str = ""
    hosts: tuple[str, ...] = ()
    proxies: tuple[str, ...] = ()
    workers: int = field(default_factory=cores, metadata={"least": 0, "most": 256})
    engines: int = _within(2, 1, 64)
    file_engines: int = _within(2, 1, 64)
    small_deadline: float = _within(5.0, 0.1, 60.0)
    file_deadline: float = _within(30.0, 0.1, 600.0)
    small_limit: float = _within(20.0, 0.1, 600.0)
    file_limit: float = _within(60.0, 0.1, 3_600.0)
    queue_wait: float = _within(5.0, 0.01, 60.0)
    tenant_share: float = _within(0.5, 0.01, 1.0)
    token_share: float = _within(0.25, 0.01, 1.0)
    remembered: int = _within(200, 1, 100_000)
    log: bool = True
    body_limit: int = _within(1_000_000, 1_000, 100_000_000)
    upload_limit: int = _within(20_000_000, 1_000, 1_000_000_000)
    upload_entries: int = _within(200, 10, 100_000)
    upload_unpacked: int = _within(100_000_000, 1_000, 1_000_000_000)
    upload_ratio: int = _within(100, 2, 10_000)
    upload_shown: int = _within(5, 1, 1_000)
    tenant_uploads: int = _within(50, 1, 1_000_000)
    json_depth: int = _within(20, 6, 200)
    json_keys: int = _within(2_000, 100, 1_000_000)
    target_limit: int = _within(65_536, 4_096, 1_048_576)
    header_timeout: float = _within(10.0, 0.1, 600.0)
    uploads_at_once: int = _within(8, 1, 1_000)
    body_timeout: float = _within(60.0, 0.1, 3_600.0)
    body_grace: float = _within(5.0, 0.0, 600.0)
    body_rate: int = _within(10_000, 1, 1_000_000_000)
    send_timeout: float = _within(60.0, 0.1, 3_600.0)
    idle_timeout: int = _within(5, 1, 600)
    idle_connections: int = _within(100, 1, 10_000)
    requests_at_once: int = _within(200, 1, 10_000)
    retry_after: int = _within(2, 1, 3_600)
    shutdown_timeout: int = _within(3, 0, 600)
    failed_tokens: int = _within(10, 1, 10_000)
    failed_window: float = _within(60.0, 1.0, 86_400.0)
    addresses: int = _within(10_000, 1, 1_000_000)
    token_note: float = _within(60.0, 0.0, 86_400.0)
    token_days: int = _within(365, 1, 36_500)
    session_hours: float = _within(12.0, 0.01, 8_760.0)
    streams: int = _within(20, 1, 10_000)
    stream_queue: int = _within(1_000, 1, 100_000)
    stream_tail: float = _within(0.2, 0.01, 10.0)
    stream_margin: float = _within(5.0, 0.0, 600.0)
    stream_comment: float = _within(15.0, 0.1, 300.0)
    stream_retry: int = _within(2, 1, 300)
    stream_jobs: int = _within(50, 1, 1_000)
    page: int = _within(50, 1, 1_000)
    page_limit: int = _within(200, 1, 10_000)
    points_limit: int = _within(500, 1, 1_000)
    steps_limit: int = _within(200, 1, 1_000)
    tenant_open_jobs: int = _within(20, 1, 1_000_000)
    tenant_running: int = _within(2, 1, 10_000)
    tenant_seconds_limit: float = _within(600.0, 1.0, 1_000_000.0)
    tenant_rows: int = _within(100_000, 1, 10_000_000)
    keep_days: float = _within(30.0, 0.0, 36_500.0)
    use_note: float = _within(3_600.0, 0.0, 86_400.0)
    upload_hours: float = _within(24.0, 0.01, 8_760.0)
    prune_interval: float = _within(3_600.0, 1.0, 86_400.0)
    prune_most: int = _within(100, 1, 10_000)
    database_patience: float = _within(5.0, 0.1, 600.0)
    ready_database: float = _within(1.0, 0.01, 60.0)
    ready_space: int = _within(50_000_000, 0, 1_000_000_000_000)
    ready_write: float = _within(5.0, 0.0, 3_600.0)
    ready_worker: float = _within(30.0, 1.0, 3_600.0)
    worker_restart: float = _within(1.0, 0.01, 60.0)
    worker_restart_most: float = _within(60.0, 0.01, 3_600.0)
    worker_patience: float = _within(3.0, 0.1, 60.0)

    def __post_init__(self) -> None:
        for own in fields(self):
            _check_range(own.name, own.name, getattr(self, own.name))
        if not self.host.strip():
            raise InputError("host", self.host, "an address to listen on, such as 127.0.0.1 or 0.0.0.0", ("host",))

    @property
    def database_url(self) -> str:
        """The address of the database."""
        if self.database:
            return self.database
        from synth.queue.database import file_url  # costly to import

        return file_url(self.data.absolute() / JOBS_FILE).render_as_string()

    @cached_property
    def is_public(self) -> bool:
        """Whether others than people at this machine can reach the service: it listens to them, or a proxy does."""
        return not is_loopback(self.host) or bool(self.hosts)

    @property
    def keep_seconds(self) -> float | None:
        """For how long a job is kept after it was used last; None for ever."""
        return 86_400.0 * self.keep_days or None

    @property
    def tenant_limits(self) -> dict[str, float]:
        """What a new tenant may have, by the names of :attr:`synth.queue.models.Tenant.limits`."""
        return {
            "open_jobs": self.tenant_open_jobs,
            "running": self.tenant_running,
            "seconds_limit": self.tenant_seconds_limit,
            "rows": self.tenant_rows,
        }


def is_loopback(host: str) -> bool:
    """True if an address is one of this machine alone.

    Examples
    --------
    >>> [is_loopback(host) for host in ("localhost", "127.0.0.2", "::1", "[::1]", "0.0.0.0", "example.com")]
    [True, True, True, True, False, False]
    """
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


# ---- reading --------------------------------------------------------------------------------------------------------


def read_settings(
    file: Path | None = None,
    environment: Mapping[str, str] = types.MappingProxyType({}),
    stated: Mapping[str, object] = types.MappingProxyType({}),
) -> ServiceSettings:
    """Return the settings that a file, variables and flags state together.

    Parameters
    ----------
    file : Path, optional
        By default what ``CLUTCHSYNTH_CONFIG`` names, or ``clutchsynth.toml`` where the folder has one.
    environment : mapping
        Variables, as of ``os.environ``.
    stated : mapping
        Values by key, as flags state them; None says nothing.

    Raises
    ------
    InputError
        A key or a value is wrong, or the file cannot be read.
    """
    if file is None:
        named = environment.get("CLUTCHSYNTH_CONFIG")
        file = Path(named) if named else Path(FILE)
        file = file if named or file.exists() else None
    found: dict[str, Any] = {}
    for key, value in ({} if file is None else _of_file(file)).items():
        found[key] = _read(f"{file}: {key}", key, value)
    for name, text in sorted(environment.items()):
        key = name.removeprefix(PREFIX).lower()
        if name.startswith(PREFIX) and (key in FIELDS or get_close_matches(key, FIELDS, 1, CLOSE)):
            found[key] = _read(name, key, text, spoken=True)  # variables of other programs are none of ours
    for key, value in stated.items():
        if value is not None:
            found[key] = _read(f"--{key}", key, value)
    return ServiceSettings(**found)


def _of_file(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError("--config", str(file), f"a file that can be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError("--config", str(file), f"TOML, lines such as port = 8350 ({error})") from error


KINDS: Mapping[str, Any] = types.MappingProxyType(get_type_hints(ServiceSettings))
FIELDS = types.MappingProxyType({own.name: own for own in fields(ServiceSettings)})


def _check_range(where: str, key: str, value: Any) -> None:
    limits = FIELDS[key].metadata
    if limits and not limits["least"] <= value <= limits["most"]:
        raise InputError(where, value, f"{typed_number(limits['least'])} to {typed_number(limits['most'])}", (key,))


def _read(where: str, key: str, value: object, spoken: bool = False) -> Any:
    """Return a value as its field has it; ``spoken`` values are texts, whatever they stand for."""
    if key not in FIELDS:
        raise InputError(where, value, f"one of the keys {', '.join(FIELDS)}", (key,))
    found = _several(where, value, spoken) if get_args(KINDS[key]) else _one(where, key, value, spoken)
    _check_range(where, key, found)
    return found


def _one(where: str, key: str, value: object, spoken: bool) -> Any:
    kind = KINDS[key]
    right = InputError(where, value, WORDS[kind], (key,))
    if spoken and kind is bool:
        if str(value).lower() not in (*TRUE, *FALSE):
            raise right
        return str(value).lower() in TRUE
    if (isinstance(value, bool) is not (kind is bool)) or (kind in (str, Path) and not isinstance(value, (str, Path))):
        raise right
    if kind is int and not spoken and not isinstance(value, int):
        raise right
    if kind in (int, float) and not spoken and not isinstance(value, (int, float)):
        raise right
    try:
        return kind(value)
    except (ValueError, OverflowError):
        raise right from None


def _several(where: str, value: object, spoken: bool) -> tuple[str, ...]:
    if spoken:
        return tuple(part.strip() for part in str(value).split(",") if part.strip())
    if not isinstance(value, (list, tuple)) or not all(isinstance(part, str) for part in value):
        raise InputError(where, value, "a list of texts")
    return tuple(value)
