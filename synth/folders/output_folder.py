"""Folders of results: one job at a time, files that change together or not at all, what a stopped run leaves beside.

A result is several files that belong together. They are written into a folder of their own inside the target, which is
renamed when it is complete: from then on the result is the new one, and whoever opens the folder next moves what a
process that was killed has left to move. Until then it is the old one, also on a full disk.
"""

from __future__ import annotations

import errno
import json
import os
import shutil
import socket
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import TextIO

from synth.errors import InputError
from synth.folders.files import read_json, write_atomically
from synth.system.file_locks import is_at, unlock
from synth.system.interrupts import held_back
from synth.system.operating_system import OPEN_FILES_CAN_GO, SAFELY, is_held, lock, put_in_place, sync_folder
from synth.text.plain_text import file_text

LOCK = ".clutchsynth.lock"  # who works for the folder
MOVING = ".clutchsynth.moving.lock"  # who exchanges its files at the moment
NEW, READY = ".clutchsynth.new", ".clutchsynth.ready"  # a result under way, and one that is complete
MANIFEST = "manifest.json"
STOPPED = "stopped"  # the folder beside an earlier result, for what a stopped run has
MOVE_PATIENCE = 30.0  # seconds to wait for another process that exchanges files; it takes far less than one
JOIN_PATIENCE = 1.0  # seconds for another process of the same job to say which job it is
PAUSE = 0.02  # seconds between two tries at a lock


# ---- kinds of results -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ResultKind:
    """A result that a command writes into a folder.

    ``command`` is what writes it, ``marks`` the files that tell that there is one, ``owned`` patterns of all its
    files: what an earlier result has of them, and a new one has not, goes with the earlier one. ``content_keys`` are
    the keys of a mark that hold solutions; where all are empty, and it was stopped, there is no result yet.
    """

    command: str
    marks: tuple[str, ...]
    owned: tuple[str, ...]
    content_keys: tuple[str, ...] = ()


# What `report` makes of a front: it says what the front says, and goes with it.
REPORT_FILES = (
    "report.html",
    "report.pdf",
    "designs.xlsx",
    "design_*_sheet.html",
    "design_*_sheet.pdf",
    "design_*_sheet.json",
    "design_*_live.xlsx",
)
EXPLANATION_TEXT = "explanation.txt"
FRONT = ResultKind(
    "run",
    ("front.json", "comparison.json"),
    (
        "designs.csv",
        "front.json",
        "calculation.json",
        "offered.json",
        "design_*.yaml",
        "robust.csv",
        EXPLANATION_TEXT,
        "comparison.json",
        "families.csv",
        "front.svg",
        *REPORT_FILES,
    ),
    ("designs",),
)
NEAR_EQUALS = ResultKind(
    "near-equals", ("near_equals.json",), ("near_equals.csv", "near_equals.json", "design_*.yaml"), ("found",)
)
RATING = ResultKind("rate", ("rating.json",), ("rating.csv", "robust.csv", "rating.json"), ("designs",))
PRICES = ResultKind("prices", ("prices.csv",), ("prices.csv", "prices.json"))
EXPLANATION = ResultKind(
    "explain", ("explanation.json",), ("explanation.csv", "explanation.json"), ("ways", "conflict")
)
STUDY = ResultKind("whatif", ("whatif.csv",), ("whatif.csv", "breaks.csv", "whatif.svg", "fronts.svg"))
# What `report` makes of a batch: it goes when the batch is written anew, as it says how far that was.
BATCH_REPORTS = ("report.html", "report.pdf", "batch.xlsx")
BATCH = ResultKind("batch", ("batch.json",), ("designs.csv", "rows.csv", "batch.json", *BATCH_REPORTS))
SIZE_RANGE = ResultKind(
    "size-range",
    ("size_range.json",),
    ("variants.csv", "assignment.csv", "unserved.csv", "curve.csv", "curve.svg", "size_range.json"),
)
KINDS = (FRONT, NEAR_EQUALS, RATING, PRICES, EXPLANATION, STUDY, BATCH, SIZE_RANGE)


def holds(folder: Path, kind: ResultKind) -> bool:
    """True if a folder holds a result of this kind; a search stopped before its first solution left none."""
    return any((folder / mark).exists() and not _is_empty(folder / mark, kind) for mark in kind.marks)


def _is_empty(record: Path, kind: ResultKind) -> bool:
    """True if the record is of a search that was stopped before its first solution."""
    if not kind.content_keys:
        return False
    try:
        content = read_json(record, "result", "a result that clutchsynth has written")
        return bool(content["interrupted"]) and not any(content[key] for key in kind.content_keys)
    except (ValueError, KeyError, TypeError):
        return False


def check_kind(folder: Path, kind: ResultKind) -> None:
    """Refuse a folder in which another command has files of the same names.

    Raises
    ------
    InputError
    """
    for other in KINDS:
        shared = sorted(set(other.owned) & set(kind.owned))
        if other is not kind and shared and holds(folder, other):
            right = f"another folder: {', '.join(shared)} of clutchsynth {other.command} would be lost"
            raise InputError("output", str(folder), right)


def check_not_held(folder: Path, kind: ResultKind) -> None:
    """Refuse a folder with a file of an earlier result that a program of Windows has open, such as a table in Excel.

    Raises
    ------
    InputError
    """
    if not OPEN_FILES_CAN_GO and folder.is_dir():
        _refuse_held(folder, _earlier_files(folder, kind), "it would be replaced")


def save_result(
    folder: str | Path,
    files: Mapping[str, str] | Callable[[Path], Mapping[str, str]],
    kind: ResultKind,
    stopped: bool,
    supersedes: bool = False,
    drop: Iterable[str] = (),
) -> Path:
    """Write a result: in the place of an earlier one if it is finished, beside it if it was stopped.

    Parameters
    ----------
    folder : path
    files : mapping
        File name -> text; a name may lie in a folder below. A function returns them for the folder they will stand in.
    kind : ResultKind
    stopped : bool
        Whether it was stopped before it was finished.
    supersedes : bool
        Whether it contains everything that the earlier one has, so that it may take its place although it was stopped.
    drop : iterable of str
        Further files of the earlier result.

    Returns
    -------
    Path
        Where it stands: the folder, or one below it that is called ``stopped``.

    Raises
    ------
    InputError
        The folder cannot be written (then nothing has changed), or others write into it.
    """
    target = Path(folder)
    with claimed(target):
        check_kind(target, kind)
        settle(target)
        if stopped and not supersedes:
            target = place_for_stopped(target, kind)
        texts = files(target) if callable(files) else files
        with replaced(target) as new:
            for name, text in texts.items():
                new.write(name, text)
            new.drop([*_earlier_files(target, kind), *drop])
    return target


def loses_nothing(folder: Path, files: Mapping[str, str], names: Iterable[str], but: str = "") -> bool:
    """True if every line of these tables stands in the new ones too, but for those that contain a text."""
    for name in names:
        try:
            earlier = (folder / name).read_text(encoding="utf-8").splitlines()
        except OSError:
            continue
        except UnicodeDecodeError:
            return False
        known = set(files.get(name, "").splitlines())
        if any(line not in known and not (but and but in line) for line in earlier):
            return False
    return True


def save_files(folder: str | Path, files: Mapping[str, str | bytes], drop: Iterable[str] = ()) -> Path:
    """Write files that belong together, all or none, and take others away with what they replace; return the folder.

    Raises
    ------
    InputError
        The folder cannot be written (then nothing has changed), or others write into it.
    """
    target = Path(folder)
    with claimed(target), replaced(target) as new:
        for name, content in files.items():
            new.write(name, content)
        new.drop(drop)
    return target


def save_file(path: Path, text: str) -> None:
    """Write one file into a folder of results, whole or not at all.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    with _as_input_error(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, text)


def place_for_stopped(folder: Path, kind: ResultKind) -> Path:
    """Place for the result of a run that is stopped: the folder, or one beside an earlier result in it."""
    if not holds(folder, kind):
        return folder
    number = 1
    while (place := folder / (STOPPED if number == 1 else f"{STOPPED}_{number}")).exists():
        number += 1
    return place


def _earlier_files(folder: Path, kind: ResultKind) -> list[str]:
    """Files of an earlier result of a kind, those of the families of a comparison among them."""
    names = [path.name for pattern in kind.owned for path in folder.glob(pattern)]
    if kind is FRONT:
        for family in _families(folder / "comparison.json"):
            names += [f"{family}/{p.name}" for pattern in FRONT.owned for p in (folder / family).glob(pattern)]
    return names


def _families(path: Path) -> list[str]:
    """Folders that an earlier comparison has made; none where its record cannot be read."""
    try:
        folders = [entry["folder"] for entry in read_json(path, "comparison", "a comparison")["families"]]
    except (ValueError, KeyError, TypeError):
        return []
    return [name for name in folders if isinstance(name, str) and _is_inside(name) and "/" not in name]


# ---- files that change together -------------------------------------------------------------------------------------


class Replacement:
    """Files that are about to take the place of others."""

    def __init__(self, staging: Path) -> None:
        self.staging = staging
        self.names: list[str] = []
        self.dropped: list[str] = []

    def write(self, name: str, content: str | bytes) -> None:
        """Write a file from its text, or from its bytes."""
        if isinstance(content, bytes):
            path = self._place(name)
            with path.open("wb") as binary:
                binary.write(content)
                binary.flush()
                os.fsync(binary.fileno())
            self.names.append(name)
            return
        with self.open(name) as file:
            file.write(file_text(name, content))

    def _place(self, name: str) -> Path:
        """Path at which a file is written, below its folder."""
        if not _is_inside(name):
            raise ValueError(name)
        path = self.staged(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    @contextmanager
    def open(self, name: str) -> Iterator[TextIO]:
        """Give a file to write into; it is on the disk when the block ends."""
        path = self._place(name)
        with path.open("w", encoding="utf-8", newline="") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        self.names.append(name)

    def staged(self, name: str) -> Path:
        """Path of a file that has been written."""
        return self.staging / "files" / name

    def drop(self, names: Iterable[str]) -> None:
        """Take files away together with those that are replaced."""
        self.dropped += names


@contextmanager
def replaced(folder: Path) -> Iterator[Replacement]:
    """Give a place for new files of a folder; when the block ends they take their places, all or none.

    Raises
    ------
    InputError
        The folder cannot be written; then nothing has changed.
    """
    # What a stopped run has is saved although its user presses Ctrl-C again.
    with held_back(), _as_input_error(folder), _present(folder), _moving(folder):
        _move(folder)
        new = Replacement(folder / NEW)
        shutil.rmtree(new.staging, ignore_errors=True)  # of a process that was killed: this one holds the lock
        try:
            (new.staging / "files").mkdir(parents=True)
            yield new
            _complete(folder, new)
            put_in_place(new.staging, folder / READY)  # from here on the result is the new one
        except BaseException:
            shutil.rmtree(new.staging, ignore_errors=True)
            raise
        sync_folder(folder)
        _move(folder)


def settle(folder: Path) -> None:
    """Finish what a process that was killed has left half done in a folder.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    if (folder / READY).is_dir():
        with held_back(), _as_input_error(folder), _moving(folder):
            _move(folder)


def _complete(folder: Path, new: Replacement) -> None:
    """Write what is to be moved and taken away; refuse what could not be moved later."""
    for name in new.names:
        place = folder / name
        if place.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(place))
        place.parent.mkdir(parents=True, exist_ok=True)
    dropped = sorted(set(new.dropped) - set(new.names))
    text = json.dumps({"files": new.names, "dropped": dropped})
    with (new.staging / MANIFEST).open("w", encoding="utf-8", newline="\n") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    for inner, _, _ in os.walk(new.staging):
        sync_folder(Path(inner))


def _move(folder: Path) -> None:
    """Move a complete result to its place; files moved before an interruption are skipped."""
    ready = folder / READY
    try:
        manifest = json.loads((ready / MANIFEST).read_text(encoding="utf-8"))
        files = [str(name) for name in manifest["files"]]
        dropped = [str(name) for name in manifest["dropped"]]
    except FileNotFoundError:
        shutil.rmtree(ready, ignore_errors=True)  # all was moved: the manifest goes last
        return
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError("output", str(folder), f"a folder of ours; what stands in {READY} is not") from error
    if not all(_is_inside(name) for name in (*files, *dropped)):
        raise InputError("output", str(folder), f"a folder of ours; what stands in {READY} is not")
    _refuse_held(
        folder, (*files, *dropped), f"the new result stands complete in {READY}, and moves when this is said again"
    )
    for name in files:
        if (ready / "files" / name).exists():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            put_in_place(ready / "files" / name, folder / name)
    for name in dropped:
        (folder / name).unlink(missing_ok=True)
        if "/" in name:
            with suppress(OSError):  # other files are in it
                (folder / name).parent.rmdir()
    sync_folder(folder)
    (ready / MANIFEST).unlink()
    shutil.rmtree(ready, ignore_errors=True)


def _refuse_held(folder: Path, names: Iterable[str], then: str) -> None:
    """Refuse to exchange files of which a program of Windows has one open: all are exchanged, or none."""
    held = next((folder / name for name in names if is_held(folder / name)), None)
    if held is not None:
        raise InputError("output", str(held), f"a file that no other program has open; {then}")


def _is_inside(name: str) -> bool:
    """True if a name is one of a file in a folder or below it."""
    path = PureWindowsPath(name)  # knows drives and both strokes; where they mean nothing, no name of ours has them
    return bool(path.parts) and ".." not in path.parts and not path.anchor and "\\" not in name and "\0" not in name


@contextmanager
def _as_input_error(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError("output", str(folder), f"a folder that can be written ({error.strerror})") from error


# ---- who writes -----------------------------------------------------------------------------------------------------

_claims: dict[tuple[str, int], int] = {}  # folder and thread -> how often it is claimed


@contextmanager
def claimed(folder: Path, job: str = "") -> Iterator[None]:
    """Keep other programs out of a folder as long as results are made for it; what is empty afterwards goes.

    Parameters
    ----------
    folder : Path
        It is made where it is not there.
    job : str
        The name of a job that several processes may work at; they share the folder.

    Raises
    ------
    InputError
        Others write into it, or it cannot be written.
    """
    key = (str(folder.resolve()), threading.get_ident())
    if key in _claims:
        _claims[key] += 1
        try:
            yield
        finally:
            _claims[key] -= 1
        return
    with _present(folder):
        with _as_input_error(folder):
            handle = _lock(folder / LOCK, job, 0.0)
        if handle is None:
            right = f"a folder that nobody writes into at the moment{_who(folder / LOCK)}"
            raise InputError("output", str(folder), right)
        _claims[key] = 1
        try:
            yield
        finally:
            del _claims[key]
            unlock(folder / LOCK, handle)


@contextmanager
def _present(folder: Path) -> Iterator[None]:
    """Make a folder where it is not there; what is still empty in the end goes again."""
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    if folder.exists() and not folder.is_dir():
        raise InputError("output", str(folder), "a folder; this is a file")
    with _as_input_error(folder):
        folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    finally:
        for place in missing:
            with suppress(OSError):  # there are results in it
                place.rmdir()


@contextmanager
def _moving(folder: Path) -> Iterator[None]:
    """Wait for others that exchange files of the folder, and keep them out."""
    handle = _lock(folder / MOVING, "", MOVE_PATIENCE)
    if handle is None:
        raise InputError("output", str(folder), f"a folder that nobody writes into{_who(folder / MOVING)}")
    try:
        yield
    finally:
        unlock(folder / MOVING, handle)


def _lock(path: Path, job: str, patience: float) -> int | None:
    """Handle of a locked file; None where another process holds it.

    The lock goes with its process, however that ends; the file alone means nothing.
    """
    begin = time.monotonic()
    while True:
        try:
            handle = os.open(path, os.O_RDWR | os.O_CREAT | SAFELY, 0o666)
        except PermissionError:
            _take_away(path)
            handle = os.open(path, os.O_RDWR | os.O_CREAT | SAFELY, 0o666)
        try:
            locked = lock(handle, shared=False)
            if locked:
                _sign(handle, job)
            if job:
                locked = lock(handle, shared=True)
            # The former holder removed the file, or another job came between.
            if locked and is_at(handle, path) and (not job or _signed(handle) == job):
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)
        if not locked or job:
            if time.monotonic() - begin >= (JOIN_PATIENCE if job else patience):
                return None
            time.sleep(PAUSE)


def _take_away(path: Path) -> None:
    """Take away what somebody else has left whose program is gone; it is in the way where one cannot write into it."""
    handle = os.open(path, os.O_RDONLY | SAFELY)
    try:
        if lock(handle, shared=False) and is_at(handle, path):
            path.unlink()
    finally:
        os.close(handle)


def _sign(handle: int, job: str) -> None:
    """Say who has the lock; where others may share it they must find the job."""
    try:
        os.ftruncate(handle, 0)
        os.lseek(handle, 0, os.SEEK_SET)
        os.write(handle, f"{job}\nprocess {os.getpid()} on {socket.gethostname()}\n".encode())
    except OSError:
        if job:
            raise


def _signed(handle: int) -> str:
    os.lseek(handle, 0, os.SEEK_SET)
    return os.read(handle, 200).decode(errors="replace").split("\n")[0]


def _who(path: Path) -> str:
    """Return in words who has a lock; nothing where that is not said."""
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            lines = file.read(200).splitlines()
    except OSError:
        return ""
    return f" ({lines[1]} does)" if len(lines) > 1 else ""
