"""The records of the verbs: what command line, Python, JSON schema and documentation have from them."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import typer.main

import synth
from synth.errors import InputError
from synth.question.request_fields import FIELDS, RequestField
from synth.question.settings import SearchSettings
from synth.terminal.cli import app
from synth.terminal.options import flag_of
from synth.verbs.requests import VERBS, BatchRequest, NearEqualsRequest, PricesRequest, Verb
from tests.waiting import PATIENCE

ROOT = Path(__file__).parents[2]
COMMANDS: dict[str, Any] = typer.main.get_command(app).commands  # type: ignore[attr-defined]
CALLED = {"synthesis": "synthesize"}  # in Python, where it is not the name of the verb
COMMAND = {"synthesis": "run", "compare": "run"}


def every_field() -> Iterator[RequestField]:
    yield from FIELDS.values()
    for verb in VERBS.values():
        yield from verb.fields().values()


def test_every_field_has_a_sentence_a_unit_and_examples_that_are_accepted() -> None:
    for record in every_field():
        assert record.name.isidentifier()
        assert record.help.endswith("."), record.name
        assert record.unit, record.name
        examples = record.examples or record.schema()["enum"]
        assert examples, record.name
        for example in examples:
            jsonschema.validate(example, record.schema())
            record.read(record.name, example)
        if record.usual is not None:
            assert record.read(record.name, record.usual) == record.usual


def test_schemas_are_schemas() -> None:
    for verb in VERBS.values():
        jsonschema.Draft202012Validator.check_schema(verb.schema())


# Python takes them in another form: designs and tables themselves.
OTHERWISE = {"rate": {"robust", "design"}, "batch": {"upload", "rows", "family"}, "compare": {"family"}}


def options(verb: Verb) -> dict[str, RequestField]:
    """Fields that are options of the command of a verb."""
    searched = {name: FIELDS[name] for name in ("points", "gap", "grid", "seed", "time_limit", "workers", "objectives")}
    fields = {**(searched if verb.name in ("synthesis", "compare", "whatif") else {}), **verb.request.fields()}
    return {name: one for name, one in fields.items() if one.option is not None}


SEARCHED = "points gap grid seed time_limit workers objectives"
OPTIONS = {
    "synthesis": SEARCHED,
    "compare": SEARCHED,
    "whatif": f"{SEARCHED} vary breaks",
    "explain": "physics",
    "prices": "design step time_limit",
    "near_equals": "design within count seed time_limit",
    "rate": "robust samples confidence seed time_limit",
    "verify": "time_limit",
    "report": "design full length",
    "batch": "family objectives points gap grid seed time_limit",
    "size_range": "variants objective per_row candidates gap time_limit",
}


def test_no_option_is_lost() -> None:
    assert {name: " ".join(options(verb)) for name, verb in VERBS.items()} == OPTIONS


@pytest.mark.parametrize("verb", VERBS.values(), ids=list(VERBS))
def test_the_command_line_takes_what_the_record_says(verb: Verb) -> None:
    params = {one.name: one for one in COMMANDS[COMMAND.get(verb.name, verb.name.replace("_", "-"))].params}
    for name, record in options(verb).items():
        assert (record.flag or flag_of(record)).split("/")[0] in params[name].opts, name
        if record.typed is not None:
            assert (params[name].help, params[name].metavar) == (record.typed.help, record.typed.metavar), name
        if params[name].default is not None:
            assert record.read(name, params[name].default) == record.usual, name


# Of the command line: files, screens and machines, which no request names.
OF_COMMANDS = (
    "--output --csv --quiet --all --more --plot --encoding --visible-rows --verbose --mapping --catalogs --workers"
)
OF_COMMANDS += " --scheduler --database --row --explorer --pdf --xlsx --drawing --dxf --step --json --about --font-path"
# A table is worked off first; its options are those of a batch.
FIRST = {"size_range": BatchRequest.fields()}


@pytest.mark.parametrize("verb", VERBS.values(), ids=list(VERBS))
def test_the_command_line_has_no_words_of_its_own_for_a_request(verb: Verb) -> None:
    fields = {**FIRST.get(verb.name, {}), **verb.fields()}
    for one in COMMANDS[COMMAND.get(verb.name, verb.name.replace("_", "-"))].params:
        if one.param_type_name == "option" and not set(one.opts) & set(OF_COMMANDS.split()):
            assert one.name in fields, f"{verb.name} {one.opts[0]} is not in the record of the verb"
            assert set(one.opts) <= set((fields[one.name].flag or flag_of(fields[one.name])).split("/"))


def test_pages_write_no_field_of_a_verb_by_hand() -> None:
    written = {
        name
        for path in (ROOT / "synth" / "service" / "pages" / "static").glob("*.js")
        for name in re.findall(r"""h\("(?:input|select)", {[^}]*\bid: "(\w+)\"""", path.read_text(encoding="utf-8"))
    }
    assert {"points", "family", "title"} <= written
    own = {name for verb in VERBS.values() for name in verb.request.fields() if name not in FIELDS}
    assert not written & own


TYPED = {
    "vary": (
        ["load_torque=500:700:50 N*m", "mass <= 40,50 kg"],
        {"load_torque": "500:700:50 N*m", "mass <=": "40,50 kg"},
    ),
    "robust": (["friction=catalogue range"], {"friction": "catalogue range"}),
    "design": ("1, 3,knee", ["1", "3", "knee"]),
    "objectives": (["mass=min", "length=max"], {"mass": "min", "length": "max"}),
}


def test_what_is_typed_in_another_form_is_a_value_of_its_field() -> None:
    typed = [(verb.name, one) for verb in VERBS.values() for one in options(verb).values() if one.typed is not None]
    assert {one.name for _, one in typed} == set(TYPED)
    for where, one in typed:
        stated, value = TYPED[one.name]
        assert one.typed is not None
        assert one.typed.read(where, stated) == value
        jsonschema.validate(value, one.schema())
        one.read(where, value)


@pytest.mark.parametrize("verb", VERBS.values(), ids=list(VERBS))
def test_python_takes_what_the_record_says(verb: Verb) -> None:
    verb_called = (
        synth.ParetoFront.report if verb.name == "report" else getattr(synth, CALLED.get(verb.name, verb.name))
    )
    parameters = inspect.signature(verb_called).parameters
    for name, record in verb.request.fields().items():
        if name not in OTHERWISE.get(verb.name, ()):
            default = parameters[name].default
            assert default in (None, inspect.Parameter.empty) or record.read(name, default) == record.usual, name


def test_settings_of_a_search_are_those_of_the_fields() -> None:
    usual = SearchSettings()
    for name in ("points", "gap", "seed", "workers", "time_limit"):
        assert getattr(usual, name) == FIELDS[name].usual


def test_all_that_is_wrong_is_said_at_once_and_by_the_name_that_was_typed() -> None:
    with pytest.raises(InputError) as caught:
        NearEqualsRequest.read({"count": 0, "seed": -1, "within": "2 %"}, "--{}".format)
    assert [fault.path for fault in caught.value.every()] == [("count",), ("seed",)]
    assert str(caught.value).startswith("--count: got 0; expected a whole number")


def test_a_request_is_stored_as_it_is_read() -> None:
    asked = PricesRequest.read({"design": [1, 2], "step": "2 %", "time_limit": "1 min"})
    assert asked.to_json() == {"design": [1, 2], "step": "2 %", "time_limit": 60.0}
    assert PricesRequest.read(asked.to_json()).to_json() == asked.to_json()


def test_records_load_nothing_heavy() -> None:
    heavy = "casadi", "numpy", "pandas", "cvxpy", "scipy", "yaml", "importlib.metadata"
    code = f"import sys, synth.verbs.requests; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=PATIENCE)
    assert done.stdout.strip() == "[]"
