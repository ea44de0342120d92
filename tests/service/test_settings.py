"""Settings: one file, variables, flags; each wrong key and value is told in a sentence."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import InputError
from synth.service.settings import FIELDS, KINDS, ServiceSettings, is_loopback, read_settings
from tests.repetitions import repetitions

ROOT = Path(__file__).parents[2]


def file_of(folder: Path, text: str) -> Path:
    file = folder / "service.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_what_is_stated_later_wins(tmp_path: Path) -> None:
    file = file_of(tmp_path, 'port = 1\nworkers = 1\nbody_limit = 5000\nhosts = ["a", "b"]\n')
    found = read_settings(file, {"CLUTCHSYNTH_PORT": "2", "CLUTCHSYNTH_WORKERS": "2"}, {"port": 3, "host": None})
    assert (found.port, found.workers, found.body_limit, found.hosts) == (3, 2, 5000, ("a", "b"))
    assert found.host == "127.0.0.1"


def test_a_file_is_found_by_its_name_or_by_a_variable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert read_settings().port == 8350
    (tmp_path / "clutchsynth.toml").write_text("port = 1\n")
    assert read_settings().port == 1
    assert read_settings(environment={"CLUTCHSYNTH_CONFIG": str(file_of(tmp_path, "port = 2"))}).port == 2


def test_variables_that_stand_for_other_things_are_let_alone() -> None:
    others = {"CLUTCHSYNTH_NATIVE": "0", "CLUTCHSYNTH_DEBUG": "1", "CLUTCHSYNTH_SERVICE_HOST": "10.0.0.1", "PORT": "x"}
    assert read_settings(environment=others) == read_settings()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("prot = 1", r"service.toml: prot: got 1; expected one of the keys host, port, .*"),
        ('port = "8350"', r"service.toml: port: got '8350'; expected a whole number"),
        ("port = 1.5", r"service.toml: port: got 1.5; expected a whole number"),
        ("port = true", r"service.toml: port: got true; expected a whole number"),
        ("port = 70000", r"service.toml: port: got 70000; expected 0 to 65535"),
        ("body_timeout = nan", r"service.toml: body_timeout: got nan; expected 0.1 to 3600"),
        ("log = 1", r"service.toml: log: got 1; expected true or false"),
        ('hosts = "a"', r"service.toml: hosts: got 'a'; expected a list of texts"),
        ('host = ""', r"host: got ''; expected an address to listen on.*"),
        ("data = 1", r"service.toml: data: got 1; expected the name of a folder"),
        ("[server]\nport = 1", r"service.toml: server: got .*; expected one of the keys .*"),
        ("port", r"--config: got '.*service.toml'; expected TOML, lines such as port = 8350 .*"),
    ],
)
def test_what_is_wrong_in_a_file_is_told_in_a_sentence(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(InputError) as wrong:
        read_settings(file_of(tmp_path, text))
    assert re.fullmatch(told, str(wrong.value).replace(f"{tmp_path}/", ""))


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("CLUTCHSYNTH_PORT", "tcp://10.0.0.1:80", "CLUTCHSYNTH_PORT: got 'tcp://10.0.0.1:80'; expected a whole number"),
        ("CLUTCHSYNTH_PORTS", "1", "CLUTCHSYNTH_PORTS: got '1'; expected one of the keys host, port, "),
        ("CLUTCHSYNTH_LOG", "maybe", "CLUTCHSYNTH_LOG: got 'maybe'; expected true or false"),
        ("CLUTCHSYNTH_WORKERS", "-1", "CLUTCHSYNTH_WORKERS: got -1; expected 0 to 256"),
        ("CLUTCHSYNTH_CONFIG", "nothing.toml", "--config: got 'nothing.toml'; expected a file that can be read"),
    ],
)
def test_what_is_wrong_in_a_variable_is_told_in_a_sentence(name: str, value: str, told: str) -> None:
    with pytest.raises(InputError) as wrong:
        read_settings(environment={name: value})
    assert str(wrong.value).startswith(told)


def values(key: str) -> st.SearchStrategy[Any]:
    limits, kind = FIELDS[key].metadata, KINDS[key]
    if kind is bool:
        return st.booleans()
    if kind is int:
        return st.integers(limits["least"], limits["most"])
    if kind is float:
        return st.floats(limits["least"], limits["most"])
    words = st.text("abc./-_0", min_size=1, max_size=9)
    return st.lists(words).map(tuple) if get_args(kind) else words.map(kind)


@settings(max_examples=repetitions(100, 5_000), deadline=None, derandomize=True)
@given(data=st.data(), key=st.sampled_from(sorted(FIELDS)))
def test_every_key_is_read_from_a_variable_as_it_is_meant(data: st.DataObject, key: str) -> None:
    value = data.draw(values(key))
    text = ",".join(value) if isinstance(value, tuple) else str(value)
    found = read_settings(environment={f"CLUTCHSYNTH_{key.upper()}": text})
    assert getattr(found, key) == value
    assert dataclasses.replace(found, **{key: getattr(ServiceSettings(), key)}) == ServiceSettings()


def test_a_default_is_within_its_own_limits_and_every_number_has_some() -> None:
    for key, own in FIELDS.items():
        assert bool(own.metadata) is (KINDS[key] in (int, float)), key
    with pytest.raises(InputError, match="port: got -1; expected 0 to 65535"):
        dataclasses.replace(ServiceSettings(), port=-1)


def test_the_database_is_a_file_in_the_folder_unless_another_is_named(tmp_path: Path) -> None:
    assert ServiceSettings(data=tmp_path).database_url == f"sqlite:///{tmp_path}/jobs.sqlite"
    assert ServiceSettings(data=tmp_path, database="postgresql://a@b/c").database_url == "postgresql://a@b/c"


def test_only_loopback_is_this_machine_alone() -> None:
    assert not ServiceSettings().is_public
    assert ServiceSettings(host="0.0.0.0").is_public
    assert ServiceSettings(hosts=("clutch.example",)).is_public
    assert not is_loopback("127.0.0.1.evil.example")


def documented() -> list[tuple[str, str]]:
    """Return what the record says of each key: the text of its docstring."""
    text = ServiceSettings.__doc__ or ""
    found = re.findall(r"^    (\w+) : [^\n]*\n((?:        [^\n]*\n)+)", text, re.MULTILINE)
    return [(key, " ".join(told.split())) for key, told in found]


def table() -> str:
    """Return the table of the page about the service."""
    own = {"data": "`~/.local/share/clutchsynth`", "workers": "one per core"}
    lines = ["| key | default | what it is |", "|---|---|---|"]
    for key, told in documented():
        value = getattr(ServiceSettings(), key)
        shown = own.get(key) or (f"`{value}`" if value not in ("", ()) else "none")
        lines.append(f"| `{key}` | {shown} | {told.replace('``', '`')} |")
    return "\n".join(lines)


def test_every_key_is_documented_where_it_stands_and_on_the_page() -> None:
    assert [key for key, _ in documented()] == list(FIELDS)
    page = (ROOT / "docs" / "service.md").read_text(encoding="utf-8")
    assert table() in page, f"docs/service.md lacks this table:\n{table()}"
