"""Writes the types of the service's answers for the JavaScript of its pages: ``make answers``."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from synth.service.context import API
from synth.service.errors import JSON
from synth.verbs.requests import VERBS, Subject
from tests.service.calling import Service

ANSWERS = Path(__file__).parents[2] / "synth" / "service" / "pages" / "static" / "answers.d.ts"
RECORDS = ANSWERS.with_name("records.d.ts")
HEAD = "// What the service answers, made of its description: `make answers`. Read by the checks only.\n"
REF = "#/components/schemas/"
# What the description leaves open, by the name of its type in records.d.ts.
OPEN = {
    "family": "string",  # one of those that are installed
    "JobAnswer.progress": "Progress | null",
    "JobAnswer.summary": "Summary | null",
    "DeclarationAnswer.rows": "DeclarationRow[]",
    "ExampleAnswer.spec": "Spec",
    "RowRecord.question": "Question | null",
    "RowRecord.faults": "TableFault[]",
    "DesignPage.designs": "FlatDesign[]",
    "RowRecord.designs": "FlatDesign[]",
    "get /jobs/${string}/request": "Spec",
}
OF_RESULTS = (Subject.FRONT, Subject.BATCH)
PLAIN = {"string": "string", "integer": "number", "number": "number", "boolean": "boolean", "null": "null"}
VALUES = {"string": str, "number": (int, float), "boolean": bool, "null": type(None)}


def described() -> dict[str, Any]:
    """Description of the interface."""
    with tempfile.TemporaryDirectory() as folder, Service(Path(folder)) as service:
        found: dict[str, Any] = service.app.openapi()
        return found


def type_of(schema: Mapping[str, Any]) -> str:
    """Type of what a schema accepts; an object without declared keys holds what is not known here."""
    if "$ref" in schema:
        return str(schema["$ref"]).removeprefix(REF)
    if "anyOf" in schema:
        return " | ".join(type_of(one) for one in schema["anyOf"])
    kind = schema.get("type")
    if "enum" in schema:
        return " | ".join(f'"{word}"' for word in schema["enum"])
    if isinstance(kind, list):
        return " | ".join(type_of({"type": one}) for one in kind)
    if kind == "array":
        entry = type_of(schema["items"])
        return f"({entry})[]" if " " in entry and "<" not in entry else f"{entry}[]"
    if kind == "object":
        inner = schema.get("additionalProperties", True)
        return f"Record<string, {'unknown' if inner is True else type_of(inner)}>"
    return PLAIN[kind] if isinstance(kind, str) else "unknown"


def interface(name: str, schema: Mapping[str, Any], needed: Collection[str] | None = None) -> str:
    """Interface of an object; every key of an answer is there, of a request those that it needs."""
    kinds = {key: OPEN.get(f"{name}.{key}", OPEN.get(key, type_of(one))) for key, one in schema["properties"].items()}
    keys = (f"  {key}{'' if needed is None or key in needed else '?'}: {kind};\n" for key, kind in kinds.items())
    return f"export interface {name} {{\n{''.join(keys)}}}\n"


def routes(api: Mapping[str, Any], method: str) -> Iterator[tuple[str, str]]:
    """Addresses below the interface, as types of texts, with what they answer; the longest first."""
    paths = [path for path in api["paths"] if method in api["paths"][path]]
    for path in sorted(paths, key=lambda path: (-path.count("/"), "{" in path, path)):
        found = [answer for code, answer in api["paths"][path][method]["responses"].items() if code.startswith("2")]
        place = re.sub(r"{[^}]*}", "${string}", path.removeprefix(API))
        schema = found[0].get("content", {}).get(JSON, {}).get("schema", {})
        yield place, OPEN.get(f"{method} {place}", "unknown" if schema.get("type") == "object" else type_of(schema))


def names_in(schemas: Mapping[str, Any], kind: str) -> Iterator[str]:
    """Names of the objects of which a type is made."""
    for name in re.findall(r"\b[A-Z]\w+", kind):
        if name in schemas:
            yield name
            for one in schemas[name]["properties"].values():
                yield from names_in(schemas, type_of(one))


def answers_text() -> str:
    """Text of the types."""
    api = described()
    schemas = api["components"]["schemas"]
    chosen = {"get": list(routes(api, "get")), "post": list(routes(api, "post"))}
    kinds = ["RefusalBody", *(kind for found in chosen.values() for _, kind in found)]
    used = sorted({name for kind in kinds for name in names_in(schemas, kind)})
    records = sorted(set(re.findall(r"[A-Z]\w+", " ".join(OPEN.values()))) - set(schemas))
    head = f'{HEAD}\nimport type {{ {", ".join(records)} }} from "./records.js";\n'
    texts = [head, *(interface(name, schemas[name]) for name in used)]
    for method, found in chosen.items():
        cases = "".join(f"  P extends `{path}` | `{path}?${{string}}` ? {kind} :\n" for path, kind in found)
        texts.append(
            f"/** Answer to {method.upper()} of an address. */\n"
            f"export type {method.capitalize()}Answer<P extends string> =\n{cases}  unknown;\n"
        )
    asked = {
        name: f"{name.title().replace('_', '')}Question" for name, verb in VERBS.items() if verb.about in OF_RESULTS
    }
    texts += [interface(kind, schemas[kind], schemas[kind]["required"]) for kind in asked.values()]
    kinds = "".join(f"  {name}: {kind};\n" for name, kind in asked.items())
    texts.append(f"/** Requests about the result of a job, by kind. */\nexport interface Requests {{\n{kinds}}}\n")
    return "\n".join(texts)


def members(name: str) -> dict[str, tuple[str, bool]]:
    """Keys of an interface with their types, and whether they may be missing."""
    found = re.search(
        rf"^export interface {name}\b[^\n]*{{\n(.*?)^}}", RECORDS.read_text("utf-8"), re.MULTILINE | re.DOTALL
    )
    assert found is not None, name
    keys = re.findall(r"^  (\w+)(\??): (.*);$", found[1], re.MULTILINE)
    return {key: (kind, bool(optional)) for key, optional, kind in keys}


def fits(value: object, kind: str) -> bool:
    """Whether a value is of a type; what types of their own hold is not looked at."""
    if isinstance(value, list):
        return "[]" in kind or kind == "unknown"
    if isinstance(value, dict):
        return bool(re.search(r"Record|{|[A-Z]\w+$|unknown", kind))
    return any(isinstance(value, VALUES[word]) for word in kind.split(" | ") if word in VALUES) or kind in (
        "Cell",
        "unknown",
    )


def holds(name: str, record: Mapping[str, Any]) -> set[str]:
    """Check a record against its interface; its keys that the interface names."""
    for key, (kind, optional) in members(name).items():
        assert optional or key in record, (name, key)
        assert key not in record or fits(record[key], kind), (name, key, record[key], kind)
    return set(members(name)) & set(record)


if __name__ == "__main__":
    ANSWERS.write_text(answers_text(), encoding="utf-8")
