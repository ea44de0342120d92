"""The server process: begun, listened to, ended; and the worker that it keeps."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from synth.batches.store import Store
from synth.errors import InputError
from synth.queue.accounts import Accounts
from synth.service.serve import address_of, file_of, listening, only_server, serve
from synth.service.settings import ServiceSettings
from synth.service.supervisor import Supervisor
from synth.system.file_locks import is_locked
from tests.terminal.entry import COMMAND, ROOT, at_once
from tests.waiting import PATIENCE, until

pytestmark = pytest.mark.slow
SILENT: dict[str, Any] = {"stderr": subprocess.DEVNULL, "stdout": subprocess.PIPE}
STREAMING = (sys.executable, "-m", "tests.service.streaming")


@contextmanager
def started(*command: str, **how: Any) -> Iterator[subprocess.Popen[str]]:
    """Run a program; it ends with the block, whatever happens there."""
    process = subprocess.Popen(command, text=True, **how)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def is_there(pid: int) -> bool:
    """Tell whether a process lives; one that nobody has buried yet does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


# ---- the wire -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def streaming(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """Yield the port of a server with a stream that lasts."""
    with started(*STREAMING, str(tmp_path_factory.mktemp("streaming")), cwd=ROOT, **SILENT) as process:
        assert process.stdout is not None
        yield int(process.stdout.readline())


def opened(port: int, text: str = "") -> socket.socket:
    """Return a connection on which something was said."""
    connection = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
    connection.sendall(text.encode())
    return connection


def is_closed(connection: socket.socket, seconds: float) -> bool:
    """Tell whether the other side hangs up within a time."""
    connection.settimeout(seconds)
    try:
        while connection.recv(1_000_000):
            pass
    except TimeoutError:
        return False
    except OSError:
        return True
    return True


def heard(connection: socket.socket, wanted: bytes) -> None:
    """Wait for what the other side says, in however many parts."""
    told = b""
    while wanted not in told:
        part = connection.recv(10_000)
        assert part, told
        told += part


def version(port: int) -> float:
    """Return how long it takes to be told the version."""
    begun = time.monotonic()
    assert httpx.get(f"http://127.0.0.1:{port}/api/v1/version", timeout=PATIENCE).status_code == 200
    return time.monotonic() - begun


def test_who_says_nothing_or_one_letter_at_a_time_holds_up_nobody(streaming: int) -> None:
    head = "GET /api/v1/version HTTP/1.1\r\nHost: 127.0.0.1\r\n"
    slow = [opened(streaming, head if k % 2 else "") for k in range(300)]
    assert version(streaming) < 5.0
    for _ in range(5):
        for connection in slow[-40:]:
            try:
                connection.sendall(b"X-A: b\r\n")
            except OSError:
                continue
        assert version(streaming) < 5.0
        time.sleep(0.25)
    assert all(is_closed(connection, 10.0) for connection in slow)
    for connection in slow:
        connection.close()


def test_a_head_without_end_is_refused(streaming: int) -> None:
    with closing(opened(streaming, "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n")) as connection:
        try:
            for _ in range(1_000):
                connection.sendall(b"X-A: " + b"b" * 1_000 + b"\r\n")
        except OSError:
            pass  # it has hung up already
    with closing(opened(streaming, f"GET /{'a' * 200_000} HTTP/1.1\r\n")) as connection:
        connection.settimeout(5.0)
        try:
            answer = connection.recv(10_000)
        except ConnectionResetError:
            answer = b""
    assert answer == b"" or answer.startswith(b"HTTP/1.1 400 ")
    assert version(streaming) < 5.0


def test_what_is_no_request_is_refused_in_the_one_form(streaming: int) -> None:
    with closing(opened(streaming, "nonsense\r\n\r\n")) as connection:
        connection.settimeout(5.0)
        head, _, body = connection.recv(10_000).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 400 ")
    assert json.loads(body)["error"]["code"] == "bad_request"


def test_a_connection_serves_many_requests_also_piled_up(streaming: int) -> None:
    one = "GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
    last = "GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"
    with closing(opened(streaming, one + one)) as connection:
        time.sleep(0.3)
        connection.sendall((one + last).encode())
        told = b""
        while part := connection.recv(100_000):
            told += part
    assert told.count(b"HTTP/1.1 200 ") == 4


def test_a_server_with_open_streams_ends_at_once(tmp_path: Path) -> None:
    with started(*STREAMING, str(tmp_path), cwd=ROOT, **SILENT) as process:
        assert process.stdout is not None
        port = int(process.stdout.readline())
        asked = "GET /stream HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
        streams = [opened(port, asked) for _ in range(20)]
        for stream in streams:
            heard(stream, b"begun")
        process.terminate()
        assert process.wait(PATIENCE) == 0
        for stream in streams:
            heard(stream, b"retry: 2000")
            stream.close()


# ---- the command ----------------------------------------------------------------------------------------------------


def test_it_serves_says_so_in_one_line_and_ends_well(tmp_path: Path) -> None:
    words = ["serve", "--data", str(tmp_path / "data"), "--port", "0", "--workers", "1"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with started(*COMMAND, *words, cwd=tmp_path, **pipes) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = line.split()[-1]
        assert line == f"clutchsynth serves {address}\n"
        until(lambda: httpx.get(f"{address}readyz").status_code == 200)
        process.send_signal(signal.SIGINT)
        rest, told = process.communicate(timeout=PATIENCE)
    assert (process.returncode, rest) == (0, "")
    lines = [json.loads(line) for line in told.splitlines() if line.startswith("{")]
    (worker,) = [line["pid"] for line in lines if line["event"] == "worker_begun"]
    assert not is_there(worker)


def test_a_worker_goes_with_the_server_whatever_ends_it(tmp_path: Path) -> None:
    words = ["serve", "--data", str(tmp_path), "--port", "0", "--workers", "1"]
    with started(*COMMAND, *words, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL) as process:
        assert process.stderr is not None
        worker = int(json.loads(process.stderr.readline())["pid"])
        assert is_there(worker)
        process.kill()
        until(lambda: not is_there(worker))


@pytest.mark.parametrize("words", [("--host", "0.0.0.0"), ("--host", "::")])
def test_it_does_not_let_others_in_without_a_token(tmp_path: Path, words: tuple[str, ...]) -> None:
    done = at_once("serve", "--data", tmp_path, "--no-workers", *words, folder=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert "clutchsynth token create" in done.stderr


def test_a_proxy_in_front_is_as_good_as_a_network(tmp_path: Path) -> None:
    (tmp_path / "clutchsynth.toml").write_text('hosts = ["clutch.example"]\n')
    done = at_once("serve", "--data", tmp_path, "--no-workers", folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("clutchsynth: hosts: got 'clutch.example'")


def test_a_revoked_token_opens_nothing(tmp_path: Path) -> None:
    settings = ServiceSettings(data=tmp_path, host="0.0.0.0", workers=0)
    with Store(settings.database_url) as store:
        accounts = Accounts(store)
        accounts.revoke(accounts.make_token("a", 1, ["read"], None).id)
    with pytest.raises(InputError, match="token create"):
        serve(settings, print)


def test_a_port_that_is_taken_is_told(tmp_path: Path) -> None:
    with closing(listening("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = at_once("serve", "--data", tmp_path, "--port", port, "--no-workers", folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"clutchsynth: --port: got {port}; expected a port that is free at 127.0.0.1 (")


def test_an_address_of_elsewhere_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--host: got '192\.0\.2\.1'; expected an address of this machine"):
        listening("192.0.2.1", 0)


def test_a_file_has_one_server_and_others_may_use_it(tmp_path: Path) -> None:
    words = ["serve", "--data", str(tmp_path / "data"), "--port", "0", "--no-workers"]
    (tmp_path / "other").symlink_to(tmp_path / "data")
    with started(*COMMAND, *words, cwd=tmp_path, **SILENT) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]
        for place in ("data", "other"):
            second = at_once("serve", "--data", tmp_path / place, "--port", "0", "--no-workers", folder=tmp_path)
            assert second.returncode == 2
            assert second.stderr.count("\n") == 1
            assert re.fullmatch(r"clutchsynth: --data: got '.*'; expected a file that no other .*\n", second.stderr)
        assert at_once("token", "create", "a", "--data", tmp_path / "data").returncode == 0
        assert at_once("database", "check", "--data", tmp_path / "data").returncode == 0
        assert httpx.get(f"{address}api/v1/session").status_code == 401
        process.kill()
        process.wait()
    with only_server(ServiceSettings(data=tmp_path / "data").database_url):  # a lock goes with its process
        assert is_locked(tmp_path / "data" / "jobs.sqlite.server")
    assert not (tmp_path / "data" / "jobs.sqlite.server").exists()


def test_databases_on_a_server_have_room_for_several(tmp_path: Path) -> None:
    url = "postgresql://nobody@127.0.0.1:1/none"
    assert file_of(url) is None
    with only_server(url), only_server(url):
        pass
    assert file_of("nothing") is None


def test_addresses_are_those_that_browsers_take() -> None:
    with closing(listening("::1", 0)) as six, closing(listening("127.0.0.1", 0)) as four:
        assert address_of(six).startswith("http://[::1]:")
        assert address_of(four).startswith("http://127.0.0.1:")


# ---- the worker -----------------------------------------------------------------------------------------------------

LIVES = "import sys; sys.stdin.read()"  # until its lifeline is cut
STAYS = "import sys, time; sys.stdin.read(); time.sleep(60)"


def kept(script: str, begun: Callable[[], None], **numbers: Any) -> Supervisor:
    settings = ServiceSettings(worker_restart=0.05, worker_restart_most=0.2, **numbers)
    return Supervisor([sys.executable, "-c", script], {"CLUTCHSYNTH_DATABASE": "x"}, settings, begun)


def test_a_worker_that_dies_is_begun_again(tmp_path: Path) -> None:
    starts: list[float] = []
    supervisor = kept(LIVES, lambda: starts.append(time.monotonic()))
    supervisor.start()
    first = until(lambda: supervisor.pid)
    os.kill(first, signal.SIGKILL)
    second = until(lambda: supervisor.pid if supervisor.pid != first else None)
    supervisor.stop()
    assert len(starts) == 2
    assert not is_there(second)
    assert supervisor.pid is None


def test_a_worker_that_cannot_live_is_not_begun_all_the_time() -> None:
    starts: list[float] = []
    supervisor = kept("raise SystemExit(3)", lambda: starts.append(time.monotonic()))
    supervisor.start()
    time.sleep(1.5)
    supervisor.stop()
    assert 3 <= len(starts) <= 10
    after = len(starts)
    time.sleep(0.3)
    assert len(starts) == after


def test_a_worker_that_does_not_end_is_ended() -> None:
    supervisor = kept(STAYS, lambda: None, worker_patience=0.3)
    supervisor.start()
    pid = until(lambda: supervisor.pid)
    supervisor.stop()
    assert not is_there(pid)
