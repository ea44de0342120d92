"""``synth.connect``: the same verbs, done by a server process with its worker."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
import yaml

import synth
from synth.client.connection import ServiceClient
from synth.client.transport import ClientSettings, ServiceRefusedError
from tests.waiting import PATIENCE

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
COMMAND = [sys.executable, "-c", "from synth.terminal.cli import main; main()"]
HOIST: dict[str, Any] = yaml.safe_load((ROOT / "examples" / "hoist_multi_plate.yaml").read_text(encoding="utf-8"))
FIX: dict[str, Any] = HOIST["fix"]
DUTY: dict[str, str] = HOIST["requirements"]
FAMILY = "multi_plate_clutch"


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Yield the address of a service."""
    folder = tmp_path_factory.mktemp("service")
    words = ["serve", "--data", str(folder), "--port", "0", "--workers", "1"]
    process = subprocess.Popen(
        [*COMMAND, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "CLUTCHSYNTH_LOG": "false"},
    )
    assert process.stdout is not None
    try:
        yield process.stdout.readline().split()[-1]
    finally:
        process.terminate()
        process.communicate(timeout=PATIENCE)


@pytest.fixture
def client(address: str) -> Iterator[ServiceClient]:
    with synth.connect(address) as found:
        yield found


def test_a_search_returns_the_front_that_synth_returns(client: ServiceClient) -> None:
    told: list[Any] = []
    front = client.synthesize(FAMILY, DUTY, ["mass", "length"], 5, fix=FIX, progress=told.append)
    here = synth.synthesize(FAMILY, DUTY, ["mass", "length"], 5, fix=FIX)
    assert isinstance(front, synth.ParetoFront)
    assert front.to_frame().equals(here.to_frame())
    assert front.certificate == here.certificate
    assert told
    assert all(isinstance(state, dict) for state in told)
    checked = client.verify(front)
    assert checked.status()["state"] == "done"
    priced = client.prices(front, 1)
    assert priced.result()
    assert len(priced.frame("prices.csv")) > 0
    near = client.near_equals(front, 1, "5 %", count=3)
    assert near.result()


def test_studies_explanations_and_comparisons_are_jobs_that_are_done(client: ServiceClient, tmp_path: Path) -> None:
    study = client.whatif(FAMILY, DUTY, {"load_torque": ["500 N*m", "600 N*m"]}, objectives=["mass"], points=1, fix=FIX)
    assert [step["status"] for step in study.result()["steps"]] == ["optimal", "optimal"]
    assert len(study.frame("whatif.csv")) == 2
    with pytest.raises(
        synth.InputError, match=r"name: got 'study.json'; expected a CSV file of the job: .*whatif\.csv"
    ):
        study.frame("study.json")
    study.save(tmp_path / "out", "whatif.csv", "study.json")
    assert sorted(path.name for path in (tmp_path / "out").iterdir() if path.name[0] != ".") == [
        "study.json",
        "whatif.csv",
    ]
    drive = {"load_torque": "200 N*m", "driver_speed": "700 1/min", "driven_inertia": "2 kg*m2"}
    disc = {"family": "disc_clutch", "parts": {"friction_pair": ["moulded_dry"]}}
    cone_parts = {"friction_pair": ["moulded_dry"], "cone_layout": ["outer_spring"]}
    cone = {"family": "cone_clutch", "parts": cone_parts}
    room = {**drive, "outer_diameter_limit": "60 mm"}
    small = client.explain("cone_clutch", room, parts=cone_parts, fix={"ramp_time": "0.3 s"})
    assert small.status()["outcome"] == "infeasible"
    several = client.compare([disc, cone], drive, ["mass"], 2, fix={"ramp_time": "0.3 s"})
    assert {family["family"] for family in several.result()["families"]} == {"disc_clutch", "cone_clutch"}


def test_batches_give_the_bytes_of_synth_batch(client: ServiceClient, tmp_path: Path) -> None:
    rows = [{**DUTY, "load_torque": torque} for torque in ("400 N*m", "500 N*m", "much")]
    asked: dict[str, Any] = {"objectives": ["mass"], "points": 1, "fix": FIX}
    done = client.batch(FAMILY, pd.DataFrame(rows), **asked)
    here = synth.batch(FAMILY, pd.DataFrame(rows), tmp_path / "out", **asked)
    assert done.file("designs.csv") == (here.folder / "designs.csv").read_bytes()
    assert done.status()["summary"]["status"] == {"bad_input": 1, "optimal": 2}
    again = client.batch(FAMILY, rows, **asked)
    assert len(again.frame("rows.csv")) == 3
    few = client.size_range(done)
    assert few.result()["variants"] >= 1


def test_what_is_wrong_is_said_as_synth_says_it(client: ServiceClient) -> None:
    with pytest.raises(synth.InputError) as here:
        synth.synthesize(FAMILY, {**DUTY, "load_torque": "much"})
    with pytest.raises(synth.InputError) as there:
        client.synthesize(FAMILY, {**DUTY, "load_torque": "much"})
    assert there.value.path == here.value.path == ("requirements", "load_torque")
    assert "load_torque" in str(there.value)
    assert "much" in str(there.value)
    with pytest.raises(synth.InputError, match="multi_plate_clutch"):
        client.synthesize("multi_plate_cluch", DUTY)
    with pytest.raises(ServiceRefusedError) as refused:
        client.job("nothing")
    assert (refused.value.status, refused.value.code) == (404, "not_found")
    with pytest.raises(synth.InputError, match="a job of this service"):
        client.job(5)  # type: ignore[arg-type]
    with pytest.raises(synth.InputError) as several:
        client.synthesize(FAMILY, {**DUTY, "load_torque": "much", "driver_speed": "fast"})
    assert [fault.path[-1] for fault in several.value.every()] == ["load_torque", "driver_speed"]
    with pytest.raises(synth.InputError, match="objectives: got an empty list; expected at least one of"):
        client.synthesize(FAMILY, DUTY, [])


def test_a_job_is_cancelled_resumed_and_removed(client: ServiceClient) -> None:
    request = {**HOIST, "objectives": ["mass", "length", "friction_work"], "points": 200}
    job = client.submit("synthesis", request)
    job.cancel()
    assert job.status()["state"] == "cancelled"
    job.cancel()  # what has ended stays as it is
    with pytest.raises(ServiceRefusedError, match="cancelled"):
        job.wait()
    ended = threading.Timer(0.4, job.cancel)
    ended.start()
    with pytest.raises(ServiceRefusedError, match="cancelled"):
        job.resume().wait()
    ended.join()
    job.delete()
    assert job.id not in {listed["id"] for listed in client.jobs()}


def test_tables_are_brought_and_named_by_version(client: ServiceClient, tmp_path: Path) -> None:
    shipped = next((ROOT / "catalogs").glob("friction_materials.csv"))
    own = tmp_path / "my_linings.csv"
    own.write_text(shipped.read_text(encoding="utf-8"), encoding="utf-8")
    reference = client.add_catalogue("friction_materials", own)
    assert reference == "my_linings@1"
    assert client.add_catalogue("friction_materials", own) == reference
    front = client.synthesize(FAMILY, DUTY, ["mass"], 1, fix=FIX, catalogs={"friction_materials": reference})
    assert front.designs
    with pytest.raises(synth.InputError):
        client.synthesize(FAMILY, DUTY, ["mass"], 1, fix=FIX, catalogs={"friction_materials": str(own)})


def test_families_and_designs_are_described(client: ServiceClient) -> None:
    assert client.families() == synth.families()
    assert "load_torque" in set(client.describe(FAMILY)["name"])
    dry = set(client.describe(synth.load(FAMILY, lubrication="dry"))["name"])
    assert dry != set(client.describe(FAMILY)["name"])


def test_a_service_that_is_not_there_is_told_in_a_sentence() -> None:
    hurried = ClientSettings(patience=0.0)
    with pytest.raises(ServiceRefusedError, match="does not answer"):
        synth.connect("http://127.0.0.1:9", settings=hurried)
    with pytest.raises(synth.InputError, match="http://127"):
        synth.connect("127.0.0.1:8350")
