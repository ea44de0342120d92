"""What one system has and another has not: named in one module alone, and done without where it is missing."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.syntax import walked

ROOT = Path(__file__).parents[1]
PACKAGES = ("synth", "problems", "catalogs", "reports")
OWN = "synth/system/operating_system.py"  # where all of it may be named


# ---- names that one system has and another has not ------------------------------------------------------------------

# Of the standard library and of what tells one system from another.
MODULES = {"fcntl", "resource", "pwd", "grp", "spwd", "crypt", "nis", "syslog", "termios", "tty", "pty", "posix"}
MODULES |= {"readline", "curses", "select", "selectors", "msvcrt", "winreg", "winsound", "_winapi", "nt", "psutil"}
# All systems have these; what else is needed has to be looked up first.
PORTABLE = {
    "os": {
        *("O_CREAT", "O_RDONLY", "O_RDWR", "O_WRONLY", "SEEK_SET", "W_OK", "X_OK", "_exit", "access", "close"),
        *("devnull", "dup2", "environ", "fdopen", "fstat", "fsync", "ftruncate", "getpid", "lseek", "open"),
        *("path", "pathsep", "read", "strerror", "utime", "walk", "write"),
    },
    "signal": {"SIGINT", "SIG_IGN", "Signals", "getsignal", "signal"},
}
WORDS = {
    *("AF_UNIX", "socketpair", "set_start_method", "WinDLL", "windll", "symlink_to", "hardlink_to", "chmod", "lchmod"),
    *("is_mount", "sys.platform", "os.name"),
}
ARGUMENTS = {"start_new_session", "preexec_fn", "pass_fds", "process_group", "creationflags", "startupinfo"}
PLACES = re.compile(r"(?<![\w.}/*])/(proc|dev|tmp|bin|sbin|usr|etc|var|sys|opt|home|root)(/|$)|[A-Z]:\\")
METHODS = {"fork", "forkserver"}  # of starting processes
TEXT_MODE = re.compile(r"[rwxat+]+")


def faults(text: str) -> list[str]:
    """Return what a source names that not every system has, or does in a way that is not the same everywhere."""
    nodes = walked(text)
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = {
        id(node.body[0].value)
        for node in nodes
        if isinstance(node, documented) and node.body and isinstance(node.body[0], ast.Expr)
    }
    found: list[str] = []
    for node in nodes:
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names if alias.name.split(".")[0] in MODULES]
        elif isinstance(node, ast.ImportFrom):
            top = (node.module or "").split(".")[0]
            named = [alias.name for alias in node.names]
            found += [top] if top in MODULES else []
            found += [f"{top}.{name}" for name in named if top in PORTABLE and name not in PORTABLE[top]]
            found += [name for name in named if name in WORDS or f"{top}.{name}" in WORDS]
        elif isinstance(node, ast.Attribute):
            owner = node.value.id if isinstance(node.value, ast.Name) else ""
            name = f"{owner}.{node.attr}"
            if owner in PORTABLE and node.attr not in PORTABLE[owner]:
                found.append(name)
            elif node.attr in WORDS or name in WORDS:
                found.append(name)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            found += [repr(node.value)] if PLACES.search(node.value) or node.value in METHODS else []
        elif isinstance(node, ast.Call):
            found += call_faults(node)
    return found


def call_faults(call: ast.Call) -> list[str]:
    """Return what is wrong with a call."""
    function = call.func
    own = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    told = {keyword.arg: keyword.value for keyword in call.keywords}
    found = [f"{own}({name}=)" for name in told if name in ARGUMENTS]
    if own in ("getattr", "hasattr") and len(call.args) > 1 and isinstance(call.args[0], ast.Name):
        named = getattr(call.args[1], "value", "")
        if call.args[0].id in PORTABLE and named not in PORTABLE[call.args[0].id]:
            found.append(f"{own}({call.args[0].id}, {named})")
    is_method = isinstance(function, ast.Attribute)
    if is_method and own in ("replace", "rename") and len(call.args) == 1 and not told:
        found.append(f".{own}() of a file, which may be open elsewhere: put_in_place does that")
    if own == "str" and call.args and getattr(getattr(call.args[0], "func", None), "attr", "") == "relative_to":
        found.append("str() of a path within another: as_posix is the same everywhere")
    as_text = [told.get(name) for name in ("text", "universal_newlines")]
    if any(getattr(value, "value", None) is True for value in as_text) and "encoding" not in told:
        found.append(f"{own}(text=) without encoding")
    if is_method and own in ("read_text", "write_text") and not written_out(call, own):
        found.append(f"{own} without encoding{' and newline' if own == 'write_text' else ''}")
    if own in ("open", "fdopen") and not is_of_os(function):
        mode = mode_of(call, own, is_method)
        if mode is not None and TEXT_MODE.fullmatch(mode) and "encoding" not in told:
            found.append(f"{own} of text without encoding")
        elif mode is not None and TEXT_MODE.fullmatch(mode) and mode[0] in "wxa" and "newline" not in told:
            found.append(f"{own} of text to write without newline")
    return found


def is_of_os(function: ast.expr) -> bool:
    """Tell whether what is called is ``os.open``, which knows no text."""
    return isinstance(function, ast.Attribute) and ast.unparse(function) == "os.open"


def written_out(call: ast.Call, own: str) -> bool:
    told = {keyword.arg for keyword in call.keywords}
    if own == "write_text":
        return {"encoding", "newline"} <= told
    return "encoding" in told


def mode_of(call: ast.Call, own: str, is_method: bool) -> str | None:
    """Return how a file is opened; None where that is no mode, as the first word of an ``open`` of ours."""
    told = next((k.value for k in call.keywords if k.arg == "mode"), None)
    place = 0 if is_method and own == "open" else 1
    given = told if told is not None else call.args[place] if len(call.args) > place else None
    if given is None:
        return None if is_method and not any(k.arg == "encoding" for k in call.keywords) and own == "open" else "r"
    return given.value if isinstance(given, ast.Constant) and isinstance(given.value, str) else None


def test_what_differs_is_named_in_one_module_alone() -> None:
    found = {}
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            name = path.relative_to(ROOT).as_posix()
            if name != OWN:
                found[name] = faults(path.read_text(encoding="utf-8"))
    assert len(found) > 300
    assert {name: told for name, told in found.items() if told} == {}


@pytest.mark.parametrize(
    "text",
    [
        "import fcntl",
        "def f():\n    import resource",
        "from pwd import getpwuid",
        "import psutil",
        "os.kill(process, 0)",
        "os.killpg(process, 9)",
        "from os import fork",
        "os.sched_getaffinity(0)",
        "os.nice(5)",
        "os.getuid()",
        "os.setsid()",
        "os.pread(handle, 200, 0)",
        "os.rename(a, b)",
        "hasattr(os, 'fork')",
        "getattr(os, 'O_NOFOLLOW', 0)",
        "signal.SIGKILL",
        "signal.alarm(5)",
        "signal.setitimer(signal.ITIMER_REAL, 1)",
        "signal.pthread_sigmask(how, mask)",
        "from signal import SIGHUP",
        "socket.AF_UNIX",
        "Path('/proc/cpuinfo')",
        "Path(f'/proc/{process}/statm')",
        "open('/dev/shm/x', 'wb')",
        "place = '/tmp'",
        r"place = 'C:\\Users'",
        "sys.platform == 'win32'",
        "multiprocessing.get_context('fork')",
        "subprocess.Popen(command, start_new_session=True)",
        "subprocess.Popen(command, preexec_fn=prepare)",
        "subprocess.run(command, text=True)",
        "path.read_text()",
        "path.write_text(text, encoding='utf-8')",
        "open(path)",
        "path.open('w', encoding='utf-8')",
        "path.open('r')",
        "os.fdopen(handle, 'w')",
        "temporary.replace(path)",
        "staging.rename(ready)",
        "str(path.relative_to(folder))",
        "link.symlink_to(path)",
        "path.chmod(0o600)",
    ],
)
def test_what_differs_is_noticed(text: str) -> None:
    assert faults(text)


def test_what_is_the_same_everywhere_is_let_be() -> None:
    assert not faults(
        '"""On Linux: /proc/cpuinfo."""\nimport os, signal\nos.environ, os.getpid(), signal.SIGINT\n'
        "text.replace('a', 'b'), replace(record, a=1), frame.rename(columns=names), moment.replace(tzinfo=None)\n"
        "path.read_text(encoding='utf-8'), path.open('rb'), os.open(path, os.O_RDONLY), new.open('designs.csv')\n"
        "path.open('w', encoding='utf-8', newline=''), shape.open(), '/api/v1/jobs'\n"
    )
