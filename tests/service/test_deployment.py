"""What deploys the service, read as far as it can be without a container engine."""

from __future__ import annotations

import configparser
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from synth.service.settings import read_settings

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
KNOWN = {"FROM", "WORKDIR", "RUN", "COPY", "ENV", "USER", "VOLUME", "EXPOSE", "STOPSIGNAL", "HEALTHCHECK"}
KNOWN |= {"ENTRYPOINT", "CMD"}


def stages() -> list[list[tuple[str, str]]]:
    """Return the instructions of a Containerfile, stage by stage."""
    text = re.sub(r"\\\n", " ", (DEPLOY / "Containerfile").read_text(encoding="utf-8"))
    found: list[list[tuple[str, str]]] = []
    for line in text.splitlines():
        if line.strip() and not line.startswith("#"):
            name, _, rest = line.partition(" ")
            assert name in KNOWN, line
            if name == "FROM":
                found.append([])
            found[-1].append((name, rest.strip()))
    return found


def named(stage: list[tuple[str, str]], name: str) -> list[str]:
    return [rest for own, rest in stage if own == name]


def test_the_image_has_two_stages_of_one_python() -> None:
    build, final = stages()
    (first,), (second,) = named(build, "FROM"), named(final, "FROM")
    assert first == f"{second} AS build"
    assert re.fullmatch(r"docker\.io/library/python:3\.\d+-slim", second)


def test_what_is_copied_is_there_and_let_through() -> None:
    build, final = stages()
    sources = [source for line in named(build, "COPY") for source in line.split()[:-1]]
    assert len(sources) > 5
    allowed = re.findall(r"^!(.*)$", (DEPLOY / "Containerfile.dockerignore").read_text(), re.MULTILINE)
    assert set(sources) == set(allowed)
    for source in sources:
        assert (ROOT / source).exists(), source
    assert named(final, "COPY") == ["--from=build /opt/clutchsynth /opt/clutchsynth"]
    inside = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-dir"]
    assert {"synth", *inside.values()} <= set(sources)


def test_packages_are_those_that_are_locked() -> None:
    build, _ = stages()
    (install,) = [line for line in named(build, "RUN") if "--require-hashes" in line]
    lock = (ROOT / install.split()[-1]).read_text()
    extra = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]["service"]
    for package in extra:
        assert re.search(rf"^{re.split('[>=]', package)[0]}==", lock, re.MULTILINE), package
    assert re.search(r"^psycopg==", lock, re.MULTILINE)


def test_the_image_runs_as_nobody_in_particular_and_says_how_it_is() -> None:
    _, final = stages()
    assert named(final, "USER") == ["10001:10001"]
    (end,) = named(final, "STOPSIGNAL")
    assert end == "SIGTERM"
    (health,) = named(final, "HEALTHCHECK")
    assert "/readyz" in health
    assert named(final, "VOLUME") == ["/data"]
    names = [name for name, _ in final]
    assert names.index("USER") > max(k for k, name in enumerate(names) if name in ("RUN", "COPY"))
    code = re.search(r'"-c", "([^"]*)"', health)
    assert code
    compile(code.group(1), "health", "exec")


def test_what_the_image_sets_are_settings() -> None:
    _, final = stages()
    pairs = dict(pair.split("=", 1) for line in named(final, "ENV") for pair in line.split())
    found = read_settings(environment={name: value for name, value in pairs.items() if "CLUTCHSYNTH" in name})
    assert (found.host, str(found.data)) == ("0.0.0.0", "/data")
    assert f"127.0.0.1:{found.port}/" in str(named(final, "HEALTHCHECK"))
    assert named(final, "EXPOSE") == [str(found.port)]


def unit() -> configparser.ConfigParser:
    reader = configparser.ConfigParser(strict=False, interpolation=None)
    reader.optionxform = str  # type: ignore[method-assign,assignment]
    reader.read(DEPLOY / "clutchsynth.service")
    return reader


def test_the_unit_keeps_the_service_in_its_place() -> None:
    own = unit()["Service"]
    wanted = {
        "DynamicUser": "yes",
        "StateDirectory": "clutchsynth",
        "ProtectSystem": "strict",
        "ProtectHome": "yes",
        "PrivateTmp": "yes",
        "NoNewPrivileges": "yes",
        "RestrictAddressFamilies": "AF_INET AF_INET6 AF_UNIX",
        "MemoryMax": "80%",
        "CPUWeight": "50",
        "Restart": "on-failure",
        "TimeoutStopSec": "15",
    }
    assert {key: own[key] for key in wanted} == wanted
    assert own["ExecStart"].split()[1:3] == ["serve", "--data"]


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="NO SYSTEMD: systemd-analyze is not there")
def test_systemd_understands_the_unit(tmp_path: Path) -> None:
    text = (DEPLOY / "clutchsynth.service").read_text()
    program = text.split("ExecStart=")[1].split()[0]
    file = tmp_path / "clutchsynth.service"
    file.write_text(text.replace(program, sys.executable))  # it looks whether the program is there
    done = subprocess.run(["systemd-analyze", "verify", str(file)], capture_output=True, text=True, check=False)
    told = [line for line in done.stderr.splitlines() if "clutchsynth" in line]
    assert not told
    safe = subprocess.run(
        ["systemd-analyze", "security", "--offline=true", "--threshold=40", str(file)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert safe.returncode == 0, safe.stdout
