"""The whole specification, asked by a machine that makes up requests from it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, settings
from schemathesis.config import GenerationConfig, ProjectConfig, ProjectsConfig, SchemathesisConfig

from synth.jobs.engine_process import Engines
from tests.repetitions import repetitions
from tests.service.calling import bearer
from tests.service.working import API, listened, working

pytestmark = pytest.mark.slow
EXAMPLES = 8  # of each route


@pytest.fixture(scope="module")
def interface(engines: Engines, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    folder = tmp_path_factory.mktemp("service")
    with working(folder, engines, called=False) as service, listened(service) as address:
        token = service.token("read", "submit", "admin")
        generation = GenerationConfig(deterministic=True, max_examples=repetitions(EXAMPLES, 200))
        config = SchemathesisConfig(
            projects=ProjectsConfig(default=ProjectConfig(headers=bearer(token), generation=generation))
        )
        yield schemathesis.openapi.from_url(f"{address}{API}/openapi.json", headers=bearer(token), config=config)


schema = schemathesis.pytest.from_fixture("interface")


@schema.parametrize()
@settings(
    max_examples=repetitions(EXAMPLES, 200),
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
)
def test_answers_are_as_described(case: Any) -> None:
    case.call_and_validate()
