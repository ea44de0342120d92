"""The whole specification, asked by a machine that makes up requests from it, such as fit it and such as do not."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import schemathesis
import sqlalchemy as sa
from hypothesis import HealthCheck, given, settings
from hypothesis.errors import Unsatisfiable
from schemathesis import GenerationMode

from synth.queue.models import Token
from synth.workers.engine_process import Engines
from tests.repetitions import repetitions
from tests.service.calling import bearer
from tests.service.working import API, BATCH, FRONT, Client, listened, working

pytestmark = pytest.mark.slow
EXAMPLES = 3  # of each route, and of each way
# Where a schema says all, what fits it is taken; of what stands in a spec or a file it says little.
TAKEN = {
    "checks": {"positive_data_acceptance": {"expected-statuses": ["2xx", "401", "403", "404", "409", "415", "422"]}}
}
FORMS = ("POST /api/v1/uploads",)  # a form holds texts: nothing in it is of a wrong type
OWN = 1_000_000  # number of the token that asks: a machine revokes the first ones
FEW = settings(
    max_examples=repetitions(EXAMPLES, 200),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)


Interface = tuple[Any, dict[str, str], list[str]]
OTHERS = {
    f"{API}/jobs/{{job}}/files/{{name}}": {"name": "designs.csv"},
    f"{API}/jobs/{{job}}/rows/{{line}}": {"line": 2},
}


@pytest.fixture(scope="module")
def interface(engines: Engines, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Interface]:
    """Yield the specification of a service that listens, the header that opens it, and two jobs that have ended."""
    folder = tmp_path_factory.mktemp("service")
    with working(folder, engines, called=False, failed_tokens=10_000) as service, listened(service) as address:
        headers = bearer(service.token("read", "submit", "admin"))
        with service.store.engine.begin() as connection:
            connection.execute(sa.update(Token).values(id=OWN))
        client = Client(service, headers["Authorization"].split()[1])
        jobs = [client.submit("synthesis", FRONT), client.submit("batch", BATCH)]
        for job in jobs:
            client.ended(job)
        config = schemathesis.Config.from_dict(TAKEN)
        yield (
            schemathesis.openapi.from_url(f"{address}{API}/openapi.json", headers=headers, config=config),
            headers,
            jobs,
        )


@pytest.mark.parametrize("mode", list(GenerationMode), ids=lambda mode: mode.value)
def test_answers_are_as_described(interface: Interface, mode: GenerationMode) -> None:
    specification, headers, jobs = interface
    wrong: list[str] = []
    for found in specification.get_all_operations():
        operation = found.ok()
        if mode is GenerationMode.NEGATIVE and operation.label in FORMS:
            continue
        ways: list[dict[str, Any]] = [{}]
        if "{job}" in operation.path and operation.method != "delete":
            ways += [{"path_parameters": {"job": job, **OTHERS.get(operation.path, {})}} for job in jobs]
        for way in ways:
            wrong += faults(operation, operation.as_strategy(generation_mode=mode, **way), headers)
    assert not wrong, "\n\n".join(wrong)


def faults(operation: Any, cases: Any, headers: dict[str, str]) -> list[str]:
    """Return what is wrong with the answers to some cases."""

    @FEW
    @given(cases)
    def asked(case: Any) -> None:
        case.call_and_validate(headers=headers)

    try:
        asked()
    except Unsatisfiable:
        return []  # nothing can be wrong in such a request
    except BaseExceptionGroup as failures:
        return [f"{operation.label}: {failure}" for failure in failures.exceptions]
    except Exception as failure:
        return [f"{operation.label}: {failure}"]
    return []
