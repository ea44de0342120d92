"""Description of the interface: what the framework derives from routes, and the form of requests of jobs."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI

from synth.service.context import API
from synth.service.errors import JSON
from synth.verbs.requests import VERBS, design_schema


class DescribedService(FastAPI):
    """Application whose description tells what each kind of job takes as its request."""

    def openapi(self) -> dict[str, Any]:
        """Describe the interface."""
        told = super().openapi()
        schemas = told["components"]["schemas"]
        schemas |= {_name(name): verb.schema() for name, verb in VERBS.items()} | {"Design": design_schema()}
        schemas["JobRequest"]["anyOf"] = [
            {"properties": {"kind": {"const": kind}, "request": _ref(_name(kind))}} for kind in VERBS
        ]
        batch = _ref(_name("batch"))
        bodies = {
            # A check answers whatever it is asked.
            "check": {"anyOf": [_ref(_name("synthesis")), _ref(_name("compare")), {"type": "object"}]},
            "evaluate": _ref("Design"),
            "batches": batch,
            "batches/check": batch,
        }
        for path, schema in bodies.items():
            told["paths"][f"{API}/{path}"]["post"]["requestBody"]["content"][JSON]["schema"] = schema
        return told


def _name(kind: str) -> str:
    """Name of the schema of requests of a kind."""
    return "".join(word.capitalize() for word in kind.split("_")) + "Question"


def _ref(name: str) -> dict[str, str]:
    return {"$ref": f"#/components/schemas/{name}"}
