"""Form of the request of each kind of job, as JSON Schema: the keys that its module reads, and what the interface says.

What a module takes fits its schema, null apart, which counts as not stated; what fits may still be refused for what it
means. Light: the server describes its interface without an engine.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from synth.plugins import family_names
from synth.question.spec_keys import LARGEST_GAP, LEAST_GAP, OF_A_DESIGN, OWN
from synth.text.input_limits import INPUT_LIMITS

Schema = Mapping[str, Any]

REPORT_FORMATS = ("html", "explorer", "pdf", "xlsx", "json", "svg", "dxf")
REPORT_LENGTHS = ("summary", "normal", "full")
REFERENCE = r"[A-Za-z0-9_][A-Za-z0-9_.-]*@[1-9][0-9]*"  # of a table of one's own: my_linings@3
VARIED_ENDS = ("from", "to", "count")
# Of all rows of a batch, as a spec has them.
BATCH_KEYS = (
    "family",
    "objectives",
    "points",
    "gap",
    "grid",
    "seed",
    "time_limit",
    "parts",
    "limits",
    "fix",
    "catalogs",
)


# ---- parts of schemas -----------------------------------------------------------------------------------------------


def _some(*schemas: Schema) -> Schema:
    return {"anyOf": list(schemas)}


def _list(of: Schema, least: int = 0) -> Schema:
    return {"type": "array", "items": of, **({"minItems": least} if least else {})}


def _words(words: Iterable[str]) -> Schema:
    return {"type": "string", "enum": list(words)}


def _whole(least: int, most: int) -> Schema:
    return {"type": "integer", "minimum": least, "maximum": most}


def _names(of: Schema, **more: Any) -> Schema:
    """Object whose names mean something to the family that is asked."""
    return {"type": "object", "additionalProperties": of, **more}


def _told(text: str, schema: Schema) -> Schema:
    return {**schema, "description": text}


TEXT: Schema = {"type": "string", "minLength": 1}
FLAG: Schema = {"type": "boolean"}
NUMBER: Schema = {"type": "number"}
QUANTITY: Schema = {"type": ["string", "number"]}  # a text with a unit, or a number in the declared one
QUANTITIES = _some(QUANTITY, _list(QUANTITY))
TEXTS = _some(TEXT, _list(TEXT))
WORD: Schema = {"type": ["string", "integer"]}
LABEL: Schema = {"type": ["string", "number", "boolean"]}
ROW: Schema = {
    **_names(
        {"type": ["string", "number", "null"]},
        properties={
            **{key: {"type": "string"} for key in ("designation", "table", "hash")},
            "units": _names({"type": "string"}),
        },
    ),
    "required": ["designation", "table", "hash"],
}
LISTED = _whole(1, INPUT_LIMITS.listed)
RANK = _whole(1, INPUT_LIMITS.points)
# By key, as a spec has them.
SPEC: Mapping[str, Schema] = MappingProxyType(
    {
        "family": _told("Name of a family.", _words(family_names())),
        "options": _told("How the family is built, by option.", _names({"type": ["string", "boolean"]})),
        "requirements": _told("What is required, by name or symbol.", _names(QUANTITY)),
        "objectives": _told(
            "What is as good as can be.", _some(TEXT, _list({"type": "string"}), _names(_words(("min", "max"))))
        ),
        "limits": _told("Bounds of quantities: `<= 260 mm`.", _names(_some(TEXT, _list(QUANTITY, 1)))),
        "fix": _told("Values of variables, counts and choices that are given.", _names(QUANTITIES)),
        "parts": _told("Designations, or a condition on the columns of a part.", _names(TEXTS)),
        "catalogs": _told(
            "Tables of your own: `my_linings@3`, or `[+, my_linings@3]` beside the rows that are shipped.",
            {
                "type": "object",
                "additionalProperties": _some(
                    {"type": "string", "pattern": f"^{REFERENCE}$"},
                    _list({"type": "string", "pattern": rf"^(\+|{REFERENCE})$"}, 2),
                ),
            },
        ),
        "weights": _told("What an objective counts in the ranking.", _names({**NUMBER, "minimum": 0})),
        "robust": _told(
            "What scatters, with its range.",
            _names(
                {"type": "string"},
                properties={
                    "tolerance": _names({"type": "string"}),
                    "mode": _words(("limits", "rate")),
                    "samples": {"type": "integer"},
                    "seed": _whole(0, INPUT_LIMITS.seed),
                    "confidence": QUANTITY,
                    "scenarios": _names(_list(_list({**NUMBER, "minimum": 0, "maximum": 1}))),
                },
            ),
        ),
        "values": _told("Sizes of a design that is given.", _names(QUANTITY)),
        "rows": _told("Rows of own tables that a DESIGN.yaml has kept; the tables themselves count.", _names(ROW)),
        "points": _told("Designs of the front.", _whole(1, INPUT_LIMITS.points)),
        "gap": _told(
            "By how much a design that is not listed may be better.",
            {**NUMBER, "minimum": LEAST_GAP, "maximum": LARGEST_GAP},
        ),
        "grid": _told("Whether sizes are makeable ones.", FLAG),
        "seed": _told("What random choices begin with.", _whole(0, INPUT_LIMITS.seed)),
        "time_limit": _told("In s, or with a unit.", _some({"type": "number", "exclusiveMinimum": 0}, TEXT)),
        "workers": _told("Of a job always one.", {"const": 1}),
    }
)
OF_FRONT: Mapping[str, Schema] = MappingProxyType(
    {
        "of": _told("Id of a job that has found a front.", TEXT),
        "family": _told("Of a job that compares several: which front is meant.", TEXT),
    }
)


# ---- requests -------------------------------------------------------------------------------------------------------


def _request(text: str, keys: Mapping[str, Schema], *needed: str, either: Sequence[str] = ()) -> Schema:
    """Describe a request.

    Parameters
    ----------
    text : str
        What it asks.
    keys : mapping
    needed : str
        Keys that it cannot do without.
    either : sequence of str
        Keys of which it needs one.
    """
    return {
        "type": "object",
        "description": text,
        "properties": dict(keys),
        "additionalProperties": False,
        **({"required": list(needed)} if needed else {}),
        **({"anyOf": [{"required": [name]} for name in either]} if either else {}),
    }


def _question(text: str, *needed: str, **more: Schema) -> Schema:
    """Describe a request that is a spec, or an earlier job with the entries that change."""
    asked = {key: schema for key, schema in SPEC.items() if key not in OF_A_DESIGN}
    job = _told("Id of an earlier job, whose question is taken with the entries that stand here.", TEXT)
    return _request(text, {**asked, **more, "of": job}, *needed, either=("family", "of"))


def _of_front(text: str, **more: Schema) -> Schema:
    """Describe a request of a job that has found a front."""
    return _request(text, {**OF_FRONT, **more}, "of")


ONE_FAMILY = _request("A family, with what concerns it alone.", {key: SPEC[key] for key in OWN}, "family")
SEVERAL = _told(
    "Families that are compared: `any` for all, or a list of names, each perhaps with entries of its own.",
    _some({"const": "any"}, _list(_some(SPEC["family"], ONE_FAMILY), 1)),
)
VARY = _told(
    "One or two requirements, limits (`mass <=`), `weights.NAME`, `parts.SLOT`, `options.NAME` or `robust.NAME`, each "
    "with its values: a text such as `500:700:50 N*m`, a list, or two ends and a count.",
    _names(
        _some(
            TEXT,
            _list(_some(QUANTITY, _list(TEXT, 1)), 1),
            {
                "type": "object",
                "properties": {"from": QUANTITY, "to": QUANTITY, "count": _whole(2, INPUT_LIMITS.steps)},
                "required": list(VARIED_ENDS),
                "additionalProperties": False,
            },
        ),
        minProperties=1,
        maxProperties=2,
    ),
)
RANKS = _told("Ranks of designs; all where it is left out.", _some(RANK, _list(RANK, 1)))
SHARE = _some(NUMBER, TEXT)
DESIGN = _request("A design: a spec with `values` and the parts that are meant.", SPEC, "family", "values")
RATED = _of_front(
    "How designs of a front stand what scatters.", design=RANKS, robust=SPEC["robust"], time_limit=SPEC["time_limit"]
)
REQUESTS: Mapping[str, Schema] = MappingProxyType(
    {
        "synthesis": _question("A spec."),
        "compare": _question("A spec with several families.", family=SEVERAL),
        "whatif": _question(
            "A spec, and what varies.", "vary", vary=VARY, breaks=_told("Whether break points are searched.", FLAG)
        ),
        "explain": _question(
            "A spec of which nothing is feasible.", physics=_told("Whether laws of the model count as ways out.", FLAG)
        ),
        "prices": _of_front(
            "What a per cent of each requirement and limit costs.",
            design=RANKS,
            step=_told("By which share each is moved: `1 %`.", SHARE),
            time_limit=SPEC["time_limit"],
        ),
        "near_equals": _of_front(
            "Designs that are nearly as good as one.",
            design=_told("Its rank.", RANK),
            within=_told("By which share they may be worse: `2 %`.", SHARE),
            count=_told("How many.", _whole(1, INPUT_LIMITS.listed)),
            seed=SPEC["seed"],
            time_limit=SPEC["time_limit"],
        ),
        "rate": {"anyOf": [RATED, DESIGN]},
        "verify": _of_front("A front, or all of a comparison, that is checked.", time_limit=SPEC["time_limit"]),
        "report": _of_front(
            "How a front is reported.",
            design=_told("Ranks of the sheets, or `knee`.", _some(WORD, _list(WORD))),
            full=_told("Designs that are shown in full.", _whole(0, INPUT_LIMITS.points)),
            formats=_some(_words(REPORT_FORMATS), _list(_words(REPORT_FORMATS), 1)),
            length=_words(REPORT_LENGTHS),
            about=_told("Whom the report is for: `project`, `author` and the like.", _names(LABEL)),
        ),
        "batch": _request(
            "A table of requirements, and what is asked of all its rows.",
            {
                "upload": _told("Id of a file that was brought.", TEXT),
                "rows": _told("The rows, by names of requirements.", _list({"type": "object"}, 1)),
                "mapping": _told(
                    "What headings of your own mean: the name of a requirement, or `carry`.",
                    _names({"type": "string"}),
                ),
                **{key: SPEC[key] for key in BATCH_KEYS},
            },
            either=("upload", "rows"),
        ),
        "size_range": _request(
            "A few variants that serve all rows of a batch.",
            {
                "of": _told("Id of a batch that is done.", TEXT),
                "variants": _told("How many; as few as can be where it is left out.", LISTED),
                "objective": _told("The quantity that all variants together have least of.", {"type": "string"}),
                "per_row": _told("Variables that each row has a value of its own for.", _list({"type": "string"})),
                "candidates": _told("Designs that are chosen from.", LISTED),
                "gap": {**NUMBER, "minimum": 0, "exclusiveMaximum": 1},
                "time_limit": SPEC["time_limit"],
            },
            "of",
        ),
    }
)


def keys_of(kind: str) -> tuple[str, ...]:
    """Keys that a request of a kind may have."""
    return tuple(REQUESTS[kind]["properties"])
