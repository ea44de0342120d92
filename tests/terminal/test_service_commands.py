"""The commands of the service: tokens, the database, what is missing."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import sqlalchemy as sa

from synth.batches.store import Store
from synth.queue.accounts import Accounts, TenantLimits
from synth.queue.database import file_url
from synth.queue.job_table import DONE, Ending, NewJob
from synth.queue.models import Job, moment
from synth.terminal import service_commands
from tests.terminal.entry import at_once


def store_in(folder: Path) -> Store:
    return Store(file_url(folder / "data" / "jobs.sqlite"))


def test_a_token_is_made_listed_and_revoked(tmp_path: Path) -> None:
    made = at_once("token", "create", "office", "--data", "data", folder=tmp_path)
    assert made.returncode == 0, made.stderr
    value = made.stdout.strip()
    assert re.fullmatch(r"cs_[\w-]{43}", value)
    assert value not in made.stderr
    other = ("token", "create", "robot", "--tenant", "acme", "--scopes", "read, submit,admin", "--days", "0")
    assert at_once(*other, "--data", "data", folder=tmp_path).returncode == 0
    with store_in(tmp_path) as store:
        principal = Accounts(store).recognise(value)
        assert principal is not None
        assert principal.scopes == {"read", "submit"}
    shown = at_once("token", "list", "--data", "data", folder=tmp_path).stdout
    head, first, second = shown.splitlines()
    assert head.split() == ["token", "begins", "tenant", "scopes", "created", "used", "expires", "name"]
    assert first.split()[:4] == ["1", value[:11], "local", "read,submit"]
    assert second.split()[2:4] == ["acme", "read,submit,admin"]
    assert second.split()[6] == "-"
    assert value not in shown
    gone = at_once("token", "revoke", value[:9], "--data", "data", folder=tmp_path)
    assert gone.stdout == "token 1 (office): revoked\n"
    assert at_once("token", "revoke", "1", "--data", "data", folder=tmp_path).returncode == 2
    assert "revoked" in at_once("token", "list", "--data", "data", folder=tmp_path).stdout
    with store_in(tmp_path) as store:
        assert Accounts(store).recognise(value) is None


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("token", "create", "a", "--scopes", "write"), "scopes: got 'write'; expected one or more of read"),
        (("token", "create", ""), "name: got ''; expected a name"),
        (("token", "create", "a", "--days", "-1"), "--days: got -1.0; expected 0 or more"),
        (("token", "revoke", "7"), "--data: got"),
        (("token", "list"), "--data: got"),
        (("database", "check"), "--data: got"),
        (("serve", "--workers", "2", "--no-workers"), "--no-workers: got 2; expected either"),
        (("serve", "--port", "70000"), "--port: got 70000; expected 0 to 65535"),
        (("serve", "--config", "nothing.toml"), "--config: got 'nothing.toml'; expected a file that can be read"),
    ],
)
def test_what_is_wrong_is_told_in_a_sentence(tmp_path: Path, words: tuple[str, ...], told: str) -> None:
    done = at_once(*words, "--data", "data", folder=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith(f"clutchsynth: {told}")
    assert done.stderr.count("\n") == 1


def test_limits_of_a_tenant_are_shown_and_changed(tmp_path: Path) -> None:
    place = ("--data", "data")
    assert at_once("token", "create", "robot", "--tenant", "acme", *place, folder=tmp_path).returncode == 0
    shown = at_once("tenant", "list", *place, folder=tmp_path).stdout.splitlines()
    assert shown[0].split() == ["tenant", "open-jobs", "running", "seconds-limit", "rows", "created"]
    assert shown[1].split()[:5] == ["local", "none", "none", "none", "none"]
    assert shown[2].split()[:5] == ["acme", "20", "2", "600", "100000"]
    done = at_once("tenant", "limit", "acme", "--running", "4", "--rows", "none", *place, folder=tmp_path)
    assert done.stdout == "acme: open-jobs 20, running 4, seconds-limit 600, rows none\n"
    with store_in(tmp_path) as database:
        entry = Accounts(database).tenants()[1]
    assert (entry.name, entry.limits) == ("acme", TenantLimits(open_jobs=20, running=4, seconds_limit=600.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("local",), "limits: is missing; expected at least one of --open-jobs, --running, --seconds-limit, --rows"),
        (("local", "--rows", "0"), "--rows: got '0'; expected a whole number above 0, or none"),
        (("local", "--running", "1.5"), "--running: got '1.5'; expected a whole number above 0, or none"),
        (("local", "--seconds-limit", "nan"), "--seconds-limit: got 'nan'; expected a number above 0, or none"),
        (("acmee", "--rows", "5"), "tenant: got 'acmee'; expected one of local"),
    ],
)
def test_what_is_no_limit_is_told_in_a_sentence(tmp_path: Path, words: tuple[str, ...], told: str) -> None:
    assert at_once("database", "migrate", "--data", "data", folder=tmp_path).returncode == 0
    done = at_once("tenant", "limit", *words, "--data", "data", folder=tmp_path)
    assert done.returncode == 2
    assert " ".join(done.stderr.split()).startswith(f"clutchsynth: {told}")


def test_a_folder_without_a_database_is_told_by_the_flag_that_names_it(tmp_path: Path) -> None:
    for words in (("token", "list"), ("tenant", "list"), ("jobs", "prune"), ("database", "check")):
        done = at_once(*words, "--data", "nowhere", folder=tmp_path)
        assert (done.returncode, done.stderr.split(": ")[1]) == (2, "--data"), done.stderr
        named = at_once(*words, "--database", "sqlite:///nowhere.sqlite", folder=tmp_path)
        assert (named.returncode, named.stderr.split(": ")[1]) == (2, "--database"), named.stderr


def test_a_missing_extra_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service_commands, "find_spec", lambda name: None)
    done = at_once("serve", "--data", tmp_path, folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr == (
        "clutchsynth: the package fastapi: is missing; expected the extra of the service: "
        "pip install 'clutchsynth[service]'\n"
    )


def test_a_database_is_checked_copied_and_brought_up(tmp_path: Path) -> None:
    assert at_once("database", "migrate", "--data", "data", folder=tmp_path).stdout.startswith("tables of version ")
    assert at_once("database", "migrate", "--data", "data", folder=tmp_path).stdout.endswith(", as before\n")
    checked = at_once("database", "check", "--data", "data", folder=tmp_path)
    assert checked.returncode == 0
    assert ": whole, tables of version " in checked.stdout
    assert at_once("database", "backup", "copy", "--data", "data", folder=tmp_path).stdout == "written to copy\n"
    assert at_once("database", "check", "--database", "sqlite:///copy", folder=tmp_path).returncode == 0
    assert at_once("database", "backup", "copy", "--data", "data", folder=tmp_path).returncode == 2
    with store_in(tmp_path) as store, store.engine.begin() as connection:
        connection.execute(sa.text("UPDATE batch_version SET version_num = '1'"))
    old = at_once("database", "check", "--data", "data", folder=tmp_path)
    assert old.returncode == 1
    assert "clutchsynth database migrate" in old.stdout


def test_a_place_is_stated_by_file_variable_and_flag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "clutchsynth.toml").write_text('data = "of_file"\n')
    assert at_once("database", "migrate", folder=tmp_path).returncode == 0
    monkeypatch.setenv("CLUTCHSYNTH_DATABASE", "sqlite:///of_variable.sqlite")
    assert at_once("database", "migrate", folder=tmp_path).returncode == 0
    assert at_once("database", "migrate", "--data", "of_flag", folder=tmp_path).returncode == 0
    assert at_once("database", "migrate", "--database", "sqlite:///of_flag.sqlite", folder=tmp_path).returncode == 0
    made = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.sqlite")}
    assert made == {"of_file/jobs.sqlite", "of_variable.sqlite", "of_flag/jobs.sqlite", "of_flag.sqlite"}


def test_jobs_whose_time_is_over_are_removed(tmp_path: Path) -> None:
    with Store(file_url(tmp_path / "jobs.sqlite")) as store:
        for pinned in (False, True):
            new = NewJob(kind="synthesis", title="", request={}, fingerprint="f", code="c", keep=1.0)
            name, _ = store.submit(new)
            store.end(name, Ending(state=DONE))
            store.change(name, pinned=pinned)
        with store.engine.begin() as connection:
            connection.execute(sa.update(Job).values(expires=moment() - 1.0))
    assert at_once("jobs", "prune", "--data", ".", folder=tmp_path).stdout == "1 job removed\n"
    assert at_once("jobs", "prune", "--data", ".", folder=tmp_path).stdout == "0 jobs removed\n"


def test_the_command_line_begins_without_what_the_service_needs() -> None:
    code = (
        "import sys, synth.terminal.cli; print([m for m in ('fastapi', 'uvicorn', 'sqlalchemy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
