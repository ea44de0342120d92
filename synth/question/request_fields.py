"""The fields of requests: what each means and may hold, in a file, in a flag or in the body of a request."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from numbers import Real
from types import MappingProxyType
from typing import Any, TypeGuard

from synth.errors import Described, InputError, at, whole_number
from synth.text.input_limits import INPUT_LIMITS

Schema = Mapping[str, Any]
Reader = Callable[[str, Any], Any]

LEAST_GAP, LARGEST_GAP = 1e-6, 0.5
GAP_EXPECTED = "a fraction from 1e-6 to 0.5, for example 0.001"
ROW_EXPECTED = "a row of a table as clutchsynth has written it"
REFERENCE = r"[A-Za-z0-9_][A-Za-z0-9_.-]*@[1-9][0-9]*"  # of a table of one's own: my_linings@3


@dataclass(frozen=True)
class ValueKind:
    """A kind of value: its JSON Schema, and what reads it.

    Parameters
    ----------
    schema : mapping, or callable that returns one
        What it accepts, null apart. What fits may still be refused by its reader. A callable looks for what is
        installed, which no command should do when it starts.
    read : callable
        Value as stated -> value as used; the first argument names the field in messages.
    option : type, optional
        Of its option on the command line; without one it has none.
    """

    schema: Schema | Callable[[], Schema]
    read: Reader
    option: Any = None


@dataclass(frozen=True)
class TypedForm:
    """Option of the command line for a value that is typed in another form than requests state it.

    Parameters
    ----------
    flag : str
    metavar : str, optional
    help : str
        One sentence.
    option : type
    read : callable
        Value as typed -> value as requests state it; the first argument names the option in messages.
    """

    flag: str
    metavar: str | None
    help: str
    option: Any
    read: Reader


@dataclass(frozen=True)
class RequestField:
    """A field of requests; command line, JSON schema and documentation take it from here.

    Parameters
    ----------
    name : str
    value : ValueKind
    help : str
        One sentence.
    unit : str
        Of a number without one; "-" where numbers have none.
    usual : object
        Default; None where there is none.
    examples : tuple
        Accepted values; none where the schema lists all.
    flag : str
        Spelling on the command line where it is not the name.
    metavar : str, optional
        Placeholder for its value on the command line.
    needed : str
        What is expected where it is missing; empty where it may be.
    typed : TypedForm, optional
        Its option on the command line, where that is not ``value.option``.
    """

    name: str
    value: ValueKind
    help: str
    _: KW_ONLY
    unit: str = "-"
    usual: Any = None
    examples: tuple[Any, ...] = ()
    flag: str = ""
    metavar: str | None = None
    needed: str = ""
    typed: TypedForm | None = None

    @property
    def option(self) -> Any:
        """Type of its option on the command line; None where it has none."""
        return self.value.option if self.typed is None else self.typed.option

    def read(self, where: str, value: object, typed: bool = False) -> Any:
        """Value as it is used; ``where`` names the field in messages, ``typed`` is its form on the command line.

        Raises
        ------
        InputError
            It is not of its kind.
        """
        with at(self.name):
            return self.value.read(where, self.typed.read(where, value) if typed and self.typed else value)

    def schema(self) -> dict[str, Any]:
        """JSON Schema of the field."""
        schema = self.value.schema
        return {**(schema() if callable(schema) else schema), "description": self.help}


# ---- readers --------------------------------------------------------------------------------------------------------


def is_gap(value: object) -> TypeGuard[float]:
    """True if something can be the gap of a question: by how much a design may be better that is not excluded."""
    return is_number(value) and LEAST_GAP <= value <= LARGEST_GAP


def is_number(value: object) -> TypeGuard[float]:
    """Whether something is a number that a float holds, of any type; words and truth values are none."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number of hundreds of digits
        return False


def shown_kind(value: object) -> Any:
    """Excerpt of a value that is of the wrong kind."""
    if value is None:
        return Described("nothing")
    if isinstance(value, Mapping):
        return Described("a mapping" if value else "an empty mapping")
    if isinstance(value, (list, tuple)):
        return Described("a list" if len(value) else "an empty list")
    return value


def text(right: str = "a name") -> Reader:
    """Reader of a text that is not empty; ``right`` is what messages expect."""

    def read(where: str, value: object) -> str:
        if not isinstance(value, str) or not value.strip():
            raise InputError(where, shown_kind(value), right)
        return value

    return read


def pair(where: str, text: str) -> tuple[str, str]:
    """Name and value in ``name=value``.

    Raises
    ------
    InputError
        One of them is missing.
    """
    name, sign, value = text.partition("=")
    if not sign or not name.strip() or not value.strip():
        raise InputError(where, text, "name=value")
    return name.strip(), value.strip()


_name = text()


def _family(where: str, value: object) -> Any:
    """Return a name, or several: names, and mappings with what concerns one family alone."""
    if not isinstance(value, (list, tuple)):
        return _name(where, value)
    if not value:
        raise InputError(where, shown_kind(value), "a name, 'any', or a list with at least one name")
    entries = []
    for k, entry in enumerate(value):
        with at(k):
            entries.append(_one_family(f"{where}, entry {k + 1}", entry))
    return tuple(entries)


def _one_family(where: str, entry: object) -> Any:
    if not isinstance(entry, Mapping):
        return _name(where, entry)
    for key in entry:
        if key not in OWN:
            raise InputError(f"{where}: key", key, f"one of {', '.join(OWN)}", (str(key),))
    if entry.get("family") is None:
        raise InputError(f"{where}: family", None, "the name of a family", ("family",))
    checked = {}
    for key, value in entry.items():
        with at(key):
            named = f"{where}: {key}"
            checked[key] = _name(where, value) if key == "family" else FIELDS[key].value.read(named, value)
    return MappingProxyType(checked)


def _mapping(example: str) -> Callable[[str, Any], Mapping[str, Any]]:
    def check(where: str, value: object) -> Mapping[str, Any]:
        if value is None:
            return MappingProxyType({})  # a key with nothing under it: all its lines are commented out
        if not isinstance(value, Mapping):
            raise InputError(where, shown_kind(value), f"a mapping, for example '{example}'")
        for key in value:
            if not isinstance(key, str):
                right = "names on the left of the colons (in quotes if YAML takes them for a number)"
                raise InputError(where, key, right, (str(key),))
        return MappingProxyType(dict(value))

    return check


def _options(where: str, value: object) -> Mapping[str, str]:
    options = dict(_mapping("guide_model: cz")(where, value))
    for name, chosen in options.items():
        if isinstance(chosen, bool):
            options[name] = "yes" if chosen else "no"  # YAML reads a bare yes or no as a truth value
        elif not isinstance(chosen, str):
            right = "one of its words, as the family declares them"
            raise InputError(f"{where}: {name}", shown_kind(chosen), right, (name,))
    return MappingProxyType(options)


def _scalars(example: str, sets: bool = False) -> Callable[[str, Any], Mapping[str, Any]]:
    """Return a check of names with one value; ``sets``: or a list of numbers and texts."""

    def check(where: str, value: object) -> Mapping[str, Any]:
        checked = _mapping(example)(where, value)
        for name, entry in checked.items():
            if sets and isinstance(entry, (list, tuple)):
                _check_set(where, name, entry)
            elif isinstance(entry, (Mapping, list, tuple)):
                raise InputError(f"{where}: {name}", shown_kind(entry), f"one value, for example '{example}'", (name,))
        return checked

    return check


def _check_set(where: str, name: str, entries: Sequence[Any]) -> None:
    for k, entry in enumerate(entries):
        if not isinstance(entry, str) and not is_number(entry):
            right = "a finite number, or text such as '2 mm'"
            raise InputError(f"{where}: {name}, entry {k + 1}", shown_kind(entry), right, (name, k))


def _lists(example: str, sets: bool = False) -> Callable[[str, Any], Mapping[str, Any]]:
    """Return a check of names with a text or a list of texts; ``sets``: numbers may stand in lists as well."""

    def check(where: str, value: object) -> Mapping[str, Any]:
        checked = _mapping(example)(where, value)
        for name, entry in checked.items():
            listed = isinstance(entry, (list, tuple))
            entries = entry if listed else [entry]
            if sets and listed and entries:
                _check_set(where, name, entry)
            elif not entries or not all(isinstance(x, str) for x in entries):
                right = f"text or a list of texts, for example '{example}'"
                raise InputError(f"{where}: {name}", shown_kind(entry), right, (name,))
        return checked

    return check


def _objectives(where: str, value: object) -> Any:
    example = "names, for example '[mass, actuation_force]', or names with min or max, for example '{mass: min}'"
    if value is None:
        return None
    if isinstance(value, str):
        value = [value]
    if isinstance(value, Mapping):
        if not all(isinstance(k, str) and isinstance(v, str) for k, v in value.items()):
            raise InputError(where, shown_kind(value), example)
        return MappingProxyType(dict(value))
    if not isinstance(value, (list, tuple)) or not all(isinstance(x, str) for x in value):
        raise InputError(where, shown_kind(value), example)
    return tuple(value)


def _typed_objectives(where: str, texts: list[str]) -> list[str] | dict[str, str]:
    """Objectives from repeated options: names, or names with min or max."""
    if not any("=" in text for text in texts):
        return texts
    pairs = [pair(where, text) if "=" in text else (text, "") for text in texts]
    unsaid = next((name for name, sense in pairs if not sense), None)
    if unsaid is not None:
        raise InputError(where, unsaid, f"{unsaid}=min or {unsaid}=max: all objectives with a sense, or none")
    return dict(pairs)


def _catalogs(where: str, value: object) -> Any:
    if value is None or isinstance(value, str):
        return value
    expected = "a folder, or a mapping such as 'friction_materials: my_materials.csv' or 'core_plates: [+, more.csv]'"
    if not isinstance(value, Mapping):
        raise InputError(where, shown_kind(value), expected)
    for table, source in value.items():
        entries = source if isinstance(source, (list, tuple)) else [source]
        if not isinstance(table, str) or not all(isinstance(x, str) for x in entries):
            raise InputError(f"{where}: {table}", shown_kind(source), expected, (str(table),))
    return MappingProxyType(dict(value))


def _rows(where: str, value: object) -> Mapping[str, Mapping[str, Any]]:
    """Return rows of tables as a design has kept them, in SI: TABLE/DESIGNATION -> column -> number or text."""
    rows = _mapping("units/B: {designation: B, table: units, mass: 4.0, hash: ...}")(where, value)
    for name, row in rows.items():
        told = isinstance(row, Mapping) and all(
            isinstance(row.get(key), str) for key in ("designation", "table", "hash")
        )
        cells = [x for column, x in row.items() if column != "units"] if told else []
        units = row.get("units", {}) if told else {}
        told &= isinstance(units, Mapping) and all(isinstance(x, str) for x in units.values())
        if not told or not all(x is None or isinstance(x, str) or is_number(x) for x in cells):
            raise InputError(f"{where}: {name}", shown_kind(row), ROW_EXPECTED, (name,))
    return rows


def _weights(where: str, value: object) -> Mapping[str, float]:
    weights = _mapping("mass: 2")(where, value)
    for name, weight in weights.items():
        if not is_number(weight) or weight < 0:
            raise InputError(f"{where}: {name}", shown_kind(weight), "a number, zero or more", (name,))
    return weights


def _gap(where: str, value: object) -> float | None:
    if value is None:
        return None
    if not is_gap(value):
        raise InputError(where, shown_kind(value), GAP_EXPECTED)
    return float(value)


def _grid(where: str, value: object) -> bool | None:
    if value is None or isinstance(value, bool):
        return value
    raise InputError(where, shown_kind(value), "true (makeable sizes) or false")


def _seconds(where: str, value: object) -> float | None:
    if value is None:
        return None
    if isinstance(value, str):
        from synth.units import parse_quantity  # NumPy comes with it; --help does without

        value = parse_quantity(value, "s", where)
    if not is_number(value) or value <= 0:
        raise InputError(where, shown_kind(value), "a time above zero, in seconds or with a unit such as '2 min'")
    return float(value)


# ---- kinds of values ------------------------------------------------------------------------------------------------


def some(*schemas: Schema) -> Schema:
    """Schema of what fits one of several."""
    return {"anyOf": list(schemas)}


def listed(of: Schema, least: int = 0) -> Schema:
    """Schema of a list with at least so many entries."""
    return {"type": "array", "items": of, **({"minItems": least} if least else {})}


def one_of(words: Iterable[str]) -> Schema:
    """Schema of a word among some."""
    return {"type": "string", "enum": list(words)}


def by_name(of: Schema, **more: Any) -> Schema:
    """Schema of an object whose names mean something to the family."""
    return {"type": "object", "additionalProperties": of, **more}


def whole_schema(least: int, most: int) -> Schema:
    """Schema of a whole number between two bounds."""
    return {"type": "integer", "minimum": least, "maximum": most}


def whole(least: int, most: int) -> ValueKind:
    """Whole number between two bounds."""

    def read(where: str, value: object) -> int | None:
        return None if value is None else whole_number(shown_kind(value), where, most, least)

    return ValueKind(whole_schema(least, most), read, int)


TEXT: Schema = {"type": "string", "minLength": 1}
NUMBER: Schema = {"type": "number"}
QUANTITY: Schema = {"type": ["string", "number"]}  # a text with a unit, or a number in the declared one
QUANTITIES = some(QUANTITY, listed(QUANTITY))
TEXTS = some(TEXT, listed(TEXT))
ROW: Schema = {
    **by_name(
        {"type": ["string", "number", "null"]},
        properties={
            **{key: {"type": "string"} for key in ("designation", "table", "hash")},
            "units": by_name({"type": "string"}),
        },
    ),
    "required": ["designation", "table", "hash"],
}
TABLES: Schema = {
    "type": "object",
    "additionalProperties": some(
        {"type": "string", "pattern": f"^{REFERENCE}$"},
        listed({"type": "string", "pattern": rf"^(\+|{REFERENCE})$"}, 2),
    ),
}


def family_schema() -> Schema:
    """Schema of the name of a registered family."""
    from synth.plugins import family_names  # importlib.metadata comes with it; --help does without

    return one_of(family_names())


RANK = whole(1, INPUT_LIMITS.points)
LISTED = whole(1, INPUT_LIMITS.listed)
SEED = whole(0, INPUT_LIMITS.seed)
GAP = ValueKind({**NUMBER, "minimum": LEAST_GAP, "maximum": LARGEST_GAP}, _gap, float)
SECONDS = ValueKind(some({"type": "number", "exclusiveMinimum": 0}, TEXT), _seconds, str)
GRID = ValueKind({"type": "boolean"}, _grid, bool)
SPREAD: Schema = by_name(
    {"type": "string"},
    properties={
        "tolerance": by_name({"type": "string"}),
        "mode": one_of(("limits", "rate")),
        "samples": {"type": "integer"},
        "seed": whole_schema(0, INPUT_LIMITS.seed),
        "confidence": QUANTITY,
        "scenarios": by_name(listed(listed({**NUMBER, "minimum": 0, "maximum": 1}))),
    },
)


# ---- the fields of a spec -------------------------------------------------------------------------------------------


def _by_name(*fields: RequestField) -> Mapping[str, RequestField]:
    return MappingProxyType({field.name: field for field in fields})


OBJECTIVE_HELP = "An objective, name or name=min or name=max; repeat it."
FIELDS: Mapping[str, RequestField] = _by_name(
    RequestField("family", ValueKind(family_schema, _family), "Name of a family."),
    RequestField(
        "options",
        ValueKind(by_name({"type": ["string", "boolean"]}), _options),
        "How the family is built, by option.",
        examples=({"practice": "off"},),
    ),
    RequestField(
        "requirements",
        ValueKind(by_name(QUANTITY), _scalars("load_torque: 600 N*m")),
        "The duty, by name or symbol of the requirement.",
        unit="that of the requirement",
        examples=({"load_torque": "600 N*m"}, {"load_torque": 600}),
    ),
    RequestField(
        "objectives",
        ValueKind(some(TEXT, listed({"type": "string"}), by_name(one_of(("min", "max")))), _objectives),
        "What is minimised or maximised; by default what the family names.",
        examples=(["mass", "actuation_force"], {"mass": "min"}, "mass"),
        typed=TypedForm("--objective", "NAME[=SENSE]", OBJECTIVE_HELP, list[str], _typed_objectives),
    ),
    RequestField(
        "limits",
        ValueKind(by_name(some(TEXT, listed(QUANTITY, 1))), _lists("outer_diameter: '<= 260 mm'", sets=True)),
        "Bounds of quantities: `<= 260 mm`.",
        unit="that of the quantity",
        examples=({"outer_diameter": "<= 260 mm"}, {"outer_diameter": [">= 200 mm", "<= 260 mm"]}),
    ),
    RequestField(
        "fix",
        ValueKind(by_name(QUANTITIES), _scalars("ramp_time: 2 s", sets=True)),
        "Values of variables, counts and choices that are given.",
        unit="that of the quantity",
        examples=({"ramp_time": "2 s"}, {"friction_surfaces": [8, 10]}),
    ),
    RequestField(
        "parts",
        ValueKind(by_name(TEXTS), _lists("friction_pair: [designation]")),
        "Designations, or a condition on the columns of a part.",
        examples=({"friction_pair": ["designation"]}, {"friction_pair": "friction >= 0.1"}),
    ),
    RequestField(
        "catalogs",
        ValueKind(TABLES, _catalogs),
        "Tables of your own: `my_linings@3`, or `[+, my_linings@3]` beside the rows that are shipped.",
        examples=({"friction_materials": "my_linings@3"}, {"friction_materials": ["+", "my_linings@3"]}),
    ),
    RequestField(
        "weights",
        ValueKind(by_name({**NUMBER, "minimum": 0}), _weights),
        "Weights of the objectives in the ranking.",
        examples=({"mass": 2},),
    ),
    RequestField(
        "robust",
        ValueKind(SPREAD, _mapping("friction: catalogue range")),
        "What scatters, with its range.",
        unit="that of the quantity",
        examples=({"friction": "catalogue range"}, {"load_torque": "+-10 %", "mode": "rate"}),
    ),
    RequestField(
        "values",
        ValueKind(by_name(QUANTITY), _scalars("friction_surfaces: 10")),
        "Sizes, counts and choices of a given design.",
        unit="that of the quantity",
        examples=({"friction_surfaces": 10, "ramp_time": "2 s"},),
    ),
    RequestField(
        "rows",
        ValueKind(by_name(ROW), _rows),
        "Rows of own tables that a DESIGN.yaml has kept; the tables themselves count.",
        unit="SI",
        examples=({"units/B": {"designation": "B", "table": "units", "hash": "0", "mass": 4.0}},),
    ),
    RequestField("points", RANK, "At most this many designs.", usual=30, examples=(3,)),
    RequestField("gap", GAP, "How far from proven a design may be, as a fraction.", usual=1e-3, examples=(0.01,)),
    RequestField("grid", GRID, "Makeable sizes only.", usual=True, examples=(False,), flag="--grid/--no-grid"),
    RequestField("seed", SEED, "Seed of the random starts.", usual=0, examples=(1,)),
    RequestField(
        "time_limit", SECONDS, "Stop after this time, in seconds or such as '2 min'.", unit="s", examples=(60, "2 min")
    ),
    RequestField(
        "workers",
        whole(1, INPUT_LIMITS.workers),
        "Threads of the kernels; the result is the same for any number.",
        usual=1,
        examples=(1,),
    ),
)

# What is asked, how it is searched, and what may concern one family of several alone.
SEARCHED = ("points", "gap", "seed", "time_limit", "workers")
OF_A_DESIGN = ("values", "rows")  # stand only in a DESIGN.yaml
ASKED = tuple(key for key in FIELDS if key not in (*OF_A_DESIGN, *SEARCHED))
OWN = ("family", "options", "requirements", "limits", "fix", "parts", "robust")
