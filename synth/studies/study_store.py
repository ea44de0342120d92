"""Where the finished steps of a study are kept, each with the fingerprint of what it answers."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.folders.files import read_bytes, read_json
from synth.folders.output_folder import save_file, settle
from synth.results import ParetoFront
from synth.results.front_record import record_text
from synth.results.loading import load_front
from synth.results.provenance import joined

STUDY_FORMAT = 1  # of the record of a study under way
RECORD = "study.json"
STEPS = "steps"
STEP = re.compile(r"step ([1-9][0-9]*)")  # its key in the record


class StudyStore:
    """Answers kept in a folder; without a folder nothing is kept.

    Parameters
    ----------
    folder : Path or None
    before : StudyStore, optional
        Of the folder in which another study stands; the steps that both have are taken from there.
    """

    def __init__(self, folder: Path | None, before: StudyStore | None = None) -> None:
        self.folder, self.before = folder, before
        self.record: dict[str, dict[str, Any]] = {}
        if folder is not None:
            settle(folder)
            self.record = self._read(folder / RECORD)

    @staticmethod
    def _read(path: Path) -> dict[str, dict[str, Any]]:
        """Return the record of an earlier run; a file that is none begins a new one."""
        try:
            content = read_json(path, "study", "a study that clutchsynth has written")
        except InputError:
            return {}
        known = content.get("known") if isinstance(content, dict) and content.get("format") == STUDY_FORMAT else None
        return known if isinstance(known, dict) else {}

    @classmethod
    def of(cls, folder: Path | None, fingerprints: Sequence[str]) -> StudyStore:
        """Return the store of a study whose steps have these fingerprints: its folder, or one beside another study."""
        here = cls(folder)
        expected = {f"step {number}": fingerprint for number, fingerprint in enumerate(fingerprints, start=1)}
        kept = {key: entry for key, entry in here.record.items() if STEP.fullmatch(key) and isinstance(entry, dict)}
        if folder is None or all(expected.get(key) == entry.get("fingerprint") for key, entry in kept.items()):
            return here
        return cls(folder / f"stopped_{joined(fingerprints)[:8]}", here)

    def get(self, number: int, fingerprint: str) -> ParetoFront | None:
        """Return the front of a step if it is kept, and whole."""
        entry = self.record.get(f"step {number}")
        if self.folder is None or not isinstance(entry, dict) or entry.get("fingerprint") != fingerprint:
            front = None if self.before is None else self.before.get(number, fingerprint)
            if front is not None and front.record is not None:
                self.put(number, fingerprint, front.record)
            return front
        try:
            front = load_front(self.folder / str(entry["file"]))
        except (InputError, KeyError):
            return None
        return front if front.record is not None and front.record["digest"] == entry.get("digest") else None

    def put(self, number: int, fingerprint: str, record: Mapping[str, object]) -> None:
        """Keep the front of a step, by the content of its front.json."""
        if self.folder is None:
            return
        name = f"{STEPS}/step_{number:04d}.json"
        save_file(self.folder / name, record_text(record))
        self._enter(f"step {number}", {"fingerprint": fingerprint, "file": name, "digest": record["digest"]})

    def value(self, key: str, fingerprint: str) -> Any:
        """Return something else that is kept; None where it is not, or of another question."""
        entry = self.record.get(key)
        return entry.get("value") if isinstance(entry, dict) and entry.get("fingerprint") == fingerprint else None

    def keep(self, key: str, fingerprint: str, value: object) -> None:
        """Keep something else, which JSON can hold."""
        if self.folder is not None:
            self._enter(key, {"fingerprint": fingerprint, "value": value})

    def files(self) -> dict[str, str]:
        """Return all that is kept: file name -> text."""
        if self.folder is None:
            return {}
        names = [RECORD, *(entry["file"] for key, entry in self.record.items() if STEP.fullmatch(key))]
        return {name: read_bytes(self.folder / name, "step").decode("utf-8") for name in names}

    def _enter(self, key: str, entry: dict[str, Any]) -> None:
        assert self.folder is not None
        self.record[key] = entry
        text = json.dumps({"format": STUDY_FORMAT, "known": self.record}, indent=1, allow_nan=False) + "\n"
        save_file(self.folder / RECORD, text)
