"""Folders of tables, the shipped ones among them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from synth.errors import InputError, at
from synth.plugins import installed
from synth.tables.reading import (
    OF_RECORD,
    is_frame,
    load_table,
    table_from_frame,
    table_name,
    table_of_rows,
    table_of_text,
)
from synth.tables.schema import SCHEMA_SUFFIX, Schema, load_schema, schema_of_text
from synth.tables.table import Table, perhaps_meant
from synth.tables.table_file import read_as
from synth.tables.table_text import TableText
from synth.tables.workbook import is_workbook, split_sheet
from synth.text.row_cells import Cell
from synth.units import typed_quantity

if TYPE_CHECKING:
    import pandas as pd

TableSource: TypeAlias = "str | Path | TableText | pd.DataFrame"  # of the rows of a table

# By table: rows as a record has kept them, cells in SI with their designation, hash and units.
KeptRows: TypeAlias = Mapping[str, Sequence[Mapping[str, Any]]]

ENTRY_POINTS = "clutchsynth.catalogs"
OPEN = "~$"  # what a file begins with that Excel keeps beside a workbook while that is open


# ---- catalogues -----------------------------------------------------------------------------------------------------


def shipped_folders() -> tuple[Path, ...]:
    """Folders of the installed catalogue packages.

    Each entry point of the group ``clutchsynth.catalogs`` names a package whose folder holds CSV files and their
    schemas. The packages are found, not imported.

    Returns
    -------
    tuple of Path
        Folders, each once.

    Raises
    ------
    InputError
        An entry point names a package that is not there.
    """
    folders: dict[Path, None] = {}
    for point in installed(ENTRY_POINTS):
        try:
            spec = find_spec(point.value)
        except (ImportError, ValueError):
            spec = None
        if spec is None or not spec.submodule_search_locations:
            raise InputError(f"entry point {point.name}", point.value, "an installed package with CSV files")
        for location in spec.submodule_search_locations:
            folders[Path(location).resolve()] = None
    return tuple(folders)


@lru_cache(maxsize=256)
def _shipped_table(path: Path, stamps: tuple[int, ...]) -> Table:
    return load_table(path)


@lru_cache(maxsize=256)
def _shipped_schema(path: Path, stamp: int) -> Schema:
    return load_schema(path)


def _user_files(folder: Path) -> dict[str, Path]:
    """Return the tables of a user's folder by name.

    Raises
    ------
    InputError
        A table stands there twice.
    """
    files = _csv_files(folder)
    for path in sorted(p for p in folder.iterdir() if is_workbook(p) and not p.name.startswith(OPEN)):
        name = table_name(path)
        if name in files:
            right = f"one file of each table; there is {files[name].name} as well"
            raise InputError("catalogs", str(path), right, ("catalogs",))
        files[name] = path
    return files


def with_reading_options(spec: object, base: Path, encoding: str | None, visible: bool) -> Any:
    """User tables as a spec names them, with encoding and visibility for files that do not name theirs.

    Parameters
    ----------
    spec : str, Path or mapping
    base : Path
        Folder that relative paths start from.
    encoding : str, optional
        Of CSV files.
    visible : bool
        Whether hidden and filtered rows of workbooks are left out.
    """
    if isinstance(spec, (str, Path)) and (base / spec).is_dir():
        spec = {name: str(path) for name, path in _user_files((base / spec).resolve()).items()}
    if not isinstance(spec, Mapping):
        return spec

    def named(source: object) -> Any:
        if isinstance(source, (list, tuple)):
            return [named(one) for one in source]
        return read_as(source, encoding, visible) if isinstance(source, str) and source != "+" else source

    return {name: named(source) for name, source in spec.items()}


def _changes(table: Table, index: int, kept: Mapping[str, Cell]) -> Iterator[str]:
    """Yield which cells of a row are not as a record has kept them: what they were, and what they are."""
    now = table.row(index)
    for name in dict.fromkeys([*now, *kept]):
        if name not in OF_RECORD and now.get(name) != kept.get(name):
            unit = table.columns[name].unit if name in table.columns else None
            was, is_now = (_cell_text(cells.get(name), unit) for cells in (kept, now))
            yield f"{name} {was}, now {is_now}"


def _cell_text(cell: Cell, unit: str | None) -> str:
    """Return a cell in words, with all its digits."""
    if cell is None:
        return "empty"
    return repr(cell) if isinstance(cell, str) else typed_quantity(cell, unit or "-", None)


def _csv_files(folder: Path) -> dict[str, Path]:
    return {p.name.removesuffix(".csv"): p for p in sorted(folder.glob("*.csv")) if not p.name.endswith(SCHEMA_SUFFIX)}


class Catalogs:
    """The tables a problem may use: the shipped ones, replaced or extended by a user's own.

    Parameters
    ----------
    spec : str, Path or mapping, optional
        A folder, whose CSV and .xlsx files replace the tables of their names; or table name to a path, a DataFrame, a
        TableText, or a list ``["+", more, ...]`` of these whose rows are appended to the shipped ones.
    folders : sequence of str or Path, optional
        Folders of shipped tables instead of those of the installed packages.
    base : str or Path, optional
        Folder that relative paths start from; by default the working directory.
    kept : mapping, optional
        Table -> rows that a record has kept of it, in SI, with their ``hash``: they stand in for a file that is away,
        and tell which rows of a file are others now.

    Attributes
    ----------
    user_tables : tuple of str
        Tables of `spec`.
    added : tuple of str
        Tables of `spec` that no shipped table is called.

    Raises
    ------
    InputError
        The specification is not one of these.
    """

    def __init__(
        self,
        spec: object = None,
        folders: Sequence[str | Path] | None = None,
        *,
        base: str | Path | None = None,
        kept: KeptRows | None = None,
    ) -> None:
        self._kept = dict(kept or {})
        self._base = Path() if base is None else Path(base)
        self._shipped: dict[str, Path] = {}
        for folder in shipped_folders() if folders is None else folders:
            for name, path in _csv_files(Path(folder)).items():
                if name in self._shipped:
                    raise InputError(f"table {name}", str(path), f"one shipped table of a name ({self._shipped[name]})")
                self._shipped[name] = path
        self._spec = self._read_spec(spec)
        self.user_tables = tuple(sorted(self._spec))
        self.added = tuple(sorted(set(self._spec) - set(self._shipped)))
        self._cache: dict[str, Table] = {}

    def _path(self, path: str | Path) -> Path:
        return self._base / path

    def _read_spec(self, spec: object) -> dict[str, tuple[bool, list[TableSource]]]:
        """Table name to (extend the shipped rows?, sources)."""
        if spec is None:
            return {}
        right = "a folder, or a mapping of table names to a CSV path, a DataFrame or ['+', more]"
        if isinstance(spec, (str, Path)):
            folder = self._path(spec)
            try:
                files = _user_files(folder) if folder.is_dir() else None
            except InputError:
                raise
            except (OSError, ValueError):
                files = None
            if files is None:
                raise InputError("catalogs", str(spec), "a folder that exists", ("catalogs",))
            if not files:
                expected = "a folder with CSV files (or .xlsx) named like the tables they replace"
                raise InputError("catalogs", str(spec), expected, ("catalogs",))
            return {name: (False, [path]) for name, path in files.items()}
        if not isinstance(spec, Mapping):
            raise InputError("catalogs", spec, right, ("catalogs",))
        sources: dict[str, tuple[bool, list[TableSource]]] = {}
        for name, value in spec.items():
            if not isinstance(name, str):
                raise InputError("catalogs", name, "the name of a table", ("catalogs", str(name)))
            where = f"catalogs: {name}"
            with at("catalogs", name):
                if isinstance(value, (list, tuple)):
                    if len(value) < 2 or value[0] != "+":
                        raise InputError(where, value, "a list such as ['+', 'more.csv'] to extend the shipped table")
                    if name not in self._shipped:
                        raise InputError(
                            where, name, f"a shipped table to extend, {perhaps_meant(name, self._shipped)}"
                        )
                    sources[name] = (True, list(value[1:]))
                else:
                    sources[name] = (False, [value])
                for source in sources[name][1]:
                    if not isinstance(source, (str, Path, TableText)) and not is_frame(source):
                        raise InputError(where, source, "a CSV path, a DataFrame or ['+', more]")
        return sources

    def files(self) -> dict[str, Any]:
        """Return the user's own tables that can be named, as a spec states them: absolute paths, and references."""
        result: dict[str, Any] = {}
        for name, (extends, sources) in self._spec.items():
            named = [self._named(s) for s in sources if isinstance(s, (str, Path, TableText))]
            if len(named) == len(sources):
                result[name] = ["+", *named] if extends else named[0]
        return result

    def _named(self, source: str | Path | TableText) -> str:
        return source.reference if isinstance(source, TableText) else str(self._path(source).resolve())

    def readings(self) -> tuple[str, ...]:
        """Dialects of the user's own files that differ from the expected one, a sentence for each.

        Of a file that cannot be read nothing is told: whoever asks for its table learns what is wrong.
        """
        sentences: dict[str, None] = {}
        for name in self._spec:
            with suppress(InputError):
                sentences.update(dict.fromkeys(self.table(name).readings))
        return tuple(sentences)

    def away(self) -> dict[str, str]:
        """Return the user's own tables of which a file is away, so that rows kept stand in for it: name -> file."""
        missing = {}
        for name, (_, sources) in self._spec.items():
            gone = [str(s) for s in sources if isinstance(s, (str, Path)) and self._is_away(name, s)]
            if gone:
                missing[name] = ", ".join(gone)
        return missing

    def differences(self) -> tuple[str, ...]:
        """Differences from a record: files that are away, and rows that have changed."""
        sentences = [
            f"table {name}: {file} is not there; the rows kept with the designs are taken"
            for name, file in self.away().items()
        ]
        for name in self._spec.keys() & self._kept.keys() - self.away().keys():
            table = self.table(name)
            hashes = dict(zip(table.designations, table.hashes, strict=False))
            for row in self._kept[name]:
                designation = str(row["designation"])
                row_named = f"table {name}: row {designation}"
                if designation not in hashes:
                    sentences.append(f"{row_named} is gone since the designs were saved")
                elif hashes[designation] != row["hash"]:
                    changes = "; ".join(_changes(table, table.row_index(designation), row))
                    sentences.append(f"{row_named} has changed since the designs were saved: {changes}")
        return tuple(sorted(sentences))

    def _is_away(self, name: str, source: str | Path) -> bool:
        """Whether rows kept stand in for a file."""
        return bool(self._kept.get(name)) and not split_sheet(self._path(source))[0].is_file()

    def all_files(self) -> dict[str, Any]:
        """Return the user's own tables as :meth:`files`, all of them.

        Raises
        ------
        InputError
            When one is in memory.
        """
        files = self.files()
        for name in self._spec:
            if name not in files:
                right = "a file that can be named"
                raise InputError(f"catalogs: {name}", "a table in memory", right, ("catalogs", name))
        return files

    def digest(self) -> str:
        """SHA-256 of everything in these tables: shipped files byte by byte, a user's own row by row."""
        total = hashlib.sha256()
        for name, path in sorted(self._shipped.items()):
            schema = path.with_name(name + SCHEMA_SUFFIX)
            for file in (path, schema):
                total.update(file.name.encode() + b"\0" + (file.read_bytes() if file.is_file() else b"") + b"\0")
        for name in sorted(self._spec):
            total.update(json.dumps([name, *self.table(name).hashes]).encode())
        return total.hexdigest()

    def names(self) -> tuple[str, ...]:
        """Names of all tables, sorted."""
        return tuple(sorted({*self._shipped, *self._spec}))

    def schema(self, name: str) -> Schema | None:
        """Give the schema of a shipped table; None where no shipped table has that name."""
        path = self._shipped.get(name)
        if path is None:
            return None
        schema_file = path.with_name(name + SCHEMA_SUFFIX)
        return _shipped_schema(schema_file, _stamp(schema_file))

    def table(self, name: str) -> Table:
        """Give a table as this set of catalogues has it.

        Parameters
        ----------
        name : str
            Name of the table.

        Returns
        -------
        Table
            The shipped, replaced or extended table.

        Raises
        ------
        InputError
            There is no such table, or something in a user's table is not right.
        """
        if name not in self._cache:
            self._cache[name] = self._load(name)
        return self._cache[name]

    def _load(self, name: str) -> Table:
        if name not in self._spec:
            if name not in self._shipped:
                right = f"a known table, one of {', '.join(self.names())}"
                raise InputError("table", name, right, ("catalogs", name))
            return self._shipped_table(name)
        extend, sources = self._spec[name]
        with at("catalogs", name):
            tables = [self._user_table(name, source) for source in sources]
        if not extend:
            return tables[0]
        table = self._shipped_table(name)
        with at("catalogs", name):
            for more in tables:
                table = table.extended(more)
        return table

    def _shipped_table(self, name: str) -> Table:
        path = self._shipped[name]
        return _shipped_table(path, (_stamp(path), _stamp(path.with_name(name + SCHEMA_SUFFIX))))

    def _user_table(self, name: str, source: TableSource) -> Table:
        schema = self.schema(name)
        if isinstance(source, (str, Path)) and self._is_away(name, source):
            shipped = set(self._shipped_table(name).designations) if self._spec[name][0] else set()
            rows = [row for row in self._kept[name] if row["designation"] not in shipped]
            table = table_of_rows(rows, schema, name, str(source))
        elif isinstance(source, (str, Path)):
            path = self._path(source)
            schema_file = path.with_name(table_name(path) + SCHEMA_SUFFIX)
            if schema_file.is_file():
                described = load_schema(schema_file)
                schema = described if schema is None else schema.extended(described)
            table = load_table(path, schema, name=name, shipped=False)
        elif isinstance(source, TableText):
            if source.schema:
                described = schema_of_text(source.schema, source.reference + SCHEMA_SUFFIX)
                schema = described if schema is None else schema.extended(described)
            table = table_of_text(source, schema, name)
        else:
            table = table_from_frame(source, schema, name=name)
        must_have_designation(table.columns, schema, table.origin)
        return table


def must_have_designation(columns: Container[str], schema: Schema | None, origin: str) -> None:
    """Refuse a user's table whose rows have no names, unless its schema does without.

    Raises
    ------
    InputError
    """
    if "designation" not in columns and (schema is None or schema.get("designation") is not None):
        raise InputError(f"{origin}, header", None, "a column designation with a unique name in every row")


def _stamp(path: Path) -> int:
    """Change time of a file, so that an edited one is read again."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
