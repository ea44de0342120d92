"""What the documentation shows is run, and what the program offers is documented.

On each page, in order: a ``console`` block runs its ``$`` lines and compares what stands below them, a ``python``
block is executed (as doctest where it has prompts), ``yaml`` and ``csv`` blocks that are named become files. In what
is compared ``...`` stands for anything and white space counts as one blank. Of what a search shows the structure is
compared, and the figures that mark its block (``console 5.426 33.51``: the best of each objective); results of Python
are compared but for a hundredth. ``sh`` and ``powershell`` blocks are for installing; they are not run. Lines are as
wide as where no terminal is; a ``console`` block marked ``80-columns`` shows a narrower screen.
"""

from __future__ import annotations

import csv
import doctest
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import types
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import pytest

import synth
import synth.results.front
from synth.analysis.describe import describe
from synth.question.request_fields import FIELDS
from synth.terminal import cli
from synth.terminal import session as terminal
from tests.docs import lists, mechanics_page
from tests.docs.screens import FIGURE, alike, figures, same, shows_a_search, told_alike
from tests.shipped import FAMILIES
from tests.terminal.entry import at_once, in_process
from tests.waiting import PATIENCE

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(r"^```([^\n`]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LANGUAGES = {"console", "python", "yaml", "csv", "sh", "powershell", "text", "toml"}
COMPARE = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
NARROW = "80-columns"
SENT = re.compile(r" (2?)> (\S+)")  # an output that goes to a file
LINK = re.compile(r"\[[^\]]*\]\((?!https?:)([^)#]*)(?:#([^)]*))?\)")


@dataclass(frozen=True)
class Block:
    """A fenced block: language, file name if it is one, text, and the line it begins at."""

    language: str
    name: str
    text: str
    line: int


def blocks(page: Path) -> list[Block]:
    content = page.read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(content):
        language, _, name = match.group(1).strip().partition(" ")
        text = match.group(2)
        if language == "yaml" and not name and (first := re.match(r"# (\S+\.yaml)\n", text)):
            name = first.group(1)
        found.append(Block(language, name, text, content[: match.start()].count("\n") + 1))
    return found


def marked_figures(marks: Sequence[str]) -> list[float]:
    """Figures among the marks of a block."""
    return [float(mark) for mark in marks if mark.replace(".", "").isdigit()]


def commands(text: str) -> list[tuple[str, str]]:
    """Return the ``$`` lines of a console block, each with the output shown below it."""
    found: list[tuple[str, str]] = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], ""))
        else:
            assert found, f"output before any command: {line!r}"
            command, shown = found[-1]
            found[-1] = (command, shown + line + "\n")
    return found


class Alike(doctest.OutputChecker):
    """Takes results whose figures are a little otherwise."""

    def check_output(self, want: str, got: str, optionflags: int) -> bool:
        return super().check_output(want, got, optionflags) or told_alike(want, got)


class Reader:
    """Does what a page says, in a folder that holds the examples."""

    def __init__(self, page: Path, folder: Path) -> None:
        self.page, self.folder, self.code = page, folder, 0
        self.module = types.ModuleType("page")
        shutil.copytree(ROOT / "examples", folder / "examples")
        paths = [str(Path(sys.executable).parent), os.environ["PATH"]]
        self.environment = {**os.environ, "PATH": os.pathsep.join(paths), "PYTHONPATH": str(ROOT)}
        self.columns = ""  # of the screen; none asked for

    def follow(self, block: Block) -> None:
        where = f"{self.page.name}, line {block.line}"
        if block.language == "console":
            shown, marks = commands(block.text), block.name.split()
            self.columns = NARROW.removesuffix("-columns") if NARROW in marks else ""
            for k, (command, output) in enumerate(shown):
                asks_code = k + 1 < len(shown) and shown[k + 1][0] == "echo $?"
                self.run(command, output, asks_code, where, marks)
        elif block.language == "python":
            self.execute(block, where)
        elif block.language in ("yaml", "csv") and block.name:
            (self.folder / block.name).write_text(block.text, encoding="utf-8")

    def run(self, command: str, shown: str, may_fail: bool, where: str, marks: Sequence[str] = ()) -> None:
        if command == "echo $?":
            assert shown.strip() == str(self.code), f"{where}: the exit code is {self.code}"
            return
        got = self.screen(command, may_fail, where)
        if shown:
            marked = marked_figures(marks) if shows_a_search(shown) else []
            equal = alike(shown, got, marked) if marked else same(shown, got)
            assert equal, f"{where}: $ {command}\nshown:\n{shown}\ngot:\n{got}"

    def screen(self, command: str, may_fail: bool, where: str) -> str:
        """Screen that a command shows."""
        if command.startswith("make "):
            command = recipe(command.removeprefix("make "))
        done = self.done(command)
        self.code = done.returncode
        assert may_fail or self.code == 0, f"{where}: $ {command}\nended with {self.code}\n{done.stderr}"
        return done.stdout if self.code in (0, 3) else done.stdout + done.stderr

    def done(self, command: str) -> subprocess.CompletedProcess[str]:
        """Do a command: what needs a shell in one, of the program itself all else in this process, which is faster."""
        lexer = shlex.shlex(SENT.sub("", command), posix=True, punctuation_chars=True)
        lexer.whitespace_split, lexer.commenters = True, ""
        program, *words = lexer
        if program == "clutchsynth" and not any(set(word) <= set("();<>|&") for word in words):
            with pytest.MonkeyPatch.context() as patch:
                patch.setenv("COLUMNS", self.columns)
                done = in_process(*words, folder=self.folder)
            for number, name in SENT.findall(command):
                stream = "stderr" if number else "stdout"
                (self.folder / name).write_text(getattr(done, stream), encoding="utf-8")
                setattr(done, stream, "")
            return done
        return subprocess.run(
            command,
            shell=True,
            cwd=self.folder,
            env={**self.environment, "COLUMNS": self.columns},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def execute(self, block: Block, where: str) -> None:
        if ">>>" not in block.text:
            exec(compile(block.text, where, "exec"), self.module.__dict__)
            return
        test = doctest.DocTestParser().get_doctest(block.text, {}, where, where, block.line)
        test.globs = self.module.__dict__  # what one block defines, the next may use
        report = io.StringIO()
        failed, tried = doctest.DocTestRunner(Alike(), optionflags=COMPARE).run(
            test, out=report.write, clear_globs=False
        )
        assert tried
        assert not failed, report.getvalue()


def recipe(target: str) -> str:
    """Return the command behind a make target."""
    lines = (ROOT / "Makefile").read_text(encoding="utf-8").splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith(f"{target}:"))
    assert lines[start + 2] == "", "a target that is shown with its output has one command"
    return lines[start + 1].strip().replace("$(BIN)/", "")


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_shows_happens(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    reader = Reader(page, tmp_path)
    found = blocks(page)
    assert {block.language for block in found} <= LANGUAGES
    for block in found:
        reader.follow(block)


def test_a_page_that_is_wrong_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = tmp_path / "page.md"
    page.write_text(
        "```yaml\n# a.yaml\nx: 1\n```\n```console\n$ cat a.yaml\n# a.yaml\n...1\n$ false\n$ echo $?\n1\n```\n"
        "```python\nx = 2\n```\n```python\n>>> x\n2\n```\n"
        "```console\n$ clutchsynth --version > said.txt 2> complaints.txt\n\n$ cat said.txt\nclutchsynth ...\n"
        "$ clutchsynth run nothing.yaml -o out > said.txt 2> complaints.txt\n$ echo $?\n2\n"
        "$ cat said.txt complaints.txt\nclutchsynth: spec: got 'nothing.yaml'...\n```\n"
    )
    right = blocks(page)
    reader = Reader(page, tmp_path)
    for block in right:
        reader.follow(block)
    wrong = [
        Block("console", "", "$ echo a\nb\n", 1),
        Block("console", "", "$ false\n", 1),
        Block("console", "", "$ true\n$ echo $?\n1\n", 1),
        Block("python", "", ">>> x\n3\n", 1),
        Block("python", "", "assert x == 3\n", 1),
    ]
    for block in wrong:
        with pytest.raises(AssertionError), redirect_stdout(io.StringIO()):
            reader.follow(block)


SEARCHED = """\
$ clutchsynth run winch.yaml
Multi-plate clutch: 2 designs; #1 comes nearest to the best mass and length

        mass   length
rank    [kg]     [mm]   limited by
───────────────────────────────────
  #1   5.899    35.14   specific heat
  #2   5.426    38.63   torque capacity

#1: nearest to the best
    remark: hot
...
proven: over all 10 combinations of parts and counts
"""


def test_of_a_search_structure_and_marked_figures_are_compared() -> None:
    ((_, shown),) = commands(SEARCHED)
    better = shown.replace("  #1   5.899    35.14   specific", "  #1   5.812    35.14   torque").replace("hot", "cold")
    assert alike(shown, better.replace("2 designs", "3 designs"), [5.426, 35.14])
    for wrong in (
        shown.replace("5.426", "5.526"),  # a marked figure
        shown.replace("[kg]", "[N]"),
        shown.replace("length", "width"),
        shown.replace("proven", "supposed"),
        shown.replace("limited by", ""),
    ):
        assert not alike(shown, wrong, [5.426, 35.14])


def test_every_table_of_designs_is_marked_by_two_of_its_figures() -> None:
    for page in PAGES:
        for block in blocks(page):
            searched = (
                [shown for _, shown in commands(block.text) if shows_a_search(shown)]
                if block.language == "console"
                else []
            )
            marked = marked_figures(block.name.split())
            where = f"{page.name}, line {block.line}"
            assert len(marked) >= 2 * bool(searched), where
            assert set(marked) <= set(figures("\n".join(searched))), where


# ---- nothing is left out --------------------------------------------------------------------------------------------


def text_of(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def all_pages() -> str:
    return "\n".join(page.read_text(encoding="utf-8") for page in PAGES)


def offered() -> list[tuple[str, list[str]]]:
    """Return the commands of the command line with their options."""
    import typer

    found = []
    pending = list(typer.main.get_command(cli.app).commands.items())
    while pending:
        name, command = pending.pop(0)
        pending += [(f"{name} {own}", part) for own, part in getattr(command, "commands", {}).items()]
        flags = [flag for p in command.params for flag in (*p.opts, *p.secondary_opts) if flag.startswith("-")]
        found.append((name, flags))
    return found


@pytest.mark.slow
def test_every_command_and_option_is_documented() -> None:
    text = all_pages()
    found = offered()
    assert len(found) > 3
    assert "jobs resume" in dict(found)
    for name, flags in found:
        assert f"clutchsynth {name}" in text
        for flag in flags:
            assert re.search(rf"(?<![\w-]){re.escape(flag)}(?![\w-])", text), f"{name} {flag}"


def test_every_key_of_a_spec_is_documented() -> None:
    page = text_of("docs/specs.md")
    for key in FIELDS:
        assert f"`{key}`" in page, key


def test_the_readme_is_short() -> None:
    readme = text_of("README.md")
    assert len(readme.splitlines()) <= 150


def test_lists_of_families_are_those_of_the_registry() -> None:
    for written in lists.lists():
        assert written.content() == text_of(written.page), f"{written.page}: make lists writes it anew"
    assert {link: link.readlink().as_posix() for link in (ROOT / "examples").iterdir() if link.is_symlink()} == {
        link: target for link, target in lists.links().items()
    }
    shown = text_of("README.md").split("## Which clutch for which duty")[1].split("\n## ")[0]
    assert [f"[{synth.load(name).title}](docs/{name}.md)" in shown for name in FAMILIES] == [True] * len(FAMILIES)


def test_every_extra_is_documented() -> None:
    extras = set(tomllib.loads(text_of("pyproject.toml"))["project"]["optional-dependencies"]) - {"dev", "bench"}
    table = text_of("docs/install.md").split("## Outputs and extras")[1].split("\n## ")[0]
    assert set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == extras
    for extra in extras - {"all"}:
        assert f"`{extra}`" in text_of("README.md"), extra


def test_every_exit_code_is_documented() -> None:
    codes = {terminal.FOUND, terminal.INTERNAL, terminal.BAD_INPUT, terminal.INFEASIBLE, terminal.STOPPED}
    codes |= {terminal.DOES_NOT_HOLD, terminal.NOT_PROVEN}
    table = text_of("docs/results.md").split("## Exit codes")[1].split("\n## ")[0]
    assert {int(code) for code in re.findall(r"^\| (\d) \|", table, re.MULTILINE)} == codes


def test_every_public_name_is_documented() -> None:
    page = text_of("docs/python.md")
    for name in synth.__all__:
        assert name in page, name


def test_every_verb_of_a_declaration_is_documented() -> None:
    from synth.declaration import Declaration

    page = text_of("docs/own_problem.md")
    views = {"names", "quantities", "finish", "key", "words", "settle_columns", "tables"}
    verbs = {name for name in vars(Declaration) if not name.startswith("_")} - views
    assert {"requirement", "variable", "part", "at_most"} <= verbs
    for verb in verbs:
        assert f"`{verb}(" in page, verb


def test_every_column_of_the_results_is_documented() -> None:
    page = text_of("docs/results.md")
    for column in ("rank", "score", "status", "gap", "note", "alternatives", "utilisation"):
        assert f"`{column}" in page
    for status in synth.order.feasibility.Status:
        assert f"`{status.value}`" in page
    for kind in ("global", "exhaustive", "heuristic"):
        assert f"`{kind}`" in page


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_has_a_worked_example(family: str) -> None:
    page = text_of(f"docs/{family}.md")
    assert f"family: {family}" in page
    assert "$ clutchsynth run" in page
    for name in describe(family).query("kind == 'objective'")["name"]:
        assert name in page, name


def test_the_page_of_the_formulas_is_that_of_their_docstrings(monkeypatch: pytest.MonkeyPatch) -> None:
    page = text_of("docs/mechanics.md")
    assert mechanics_page.page() == page, "make mechanics writes the page anew"
    found = mechanics_page.formulas()
    assert len(found) > 150
    assert all(f"| `{f.name}(" in page and f"`{f.equation}`" in page for f in found)
    told = found[0].function.__doc__
    monkeypatch.setattr(found[0].function, "__doc__", told.replace(found[0].equation, found[0].equation + " + 1"))
    assert mechanics_page.page() != page


@pytest.mark.slow
def test_the_picture_of_the_readme_is_what_the_program_draws(tmp_path: Path) -> None:
    shown = text_of("docs/pictures/front.svg")
    assert "(docs/pictures/front.svg)" in text_of("README.md").split("```")[0]
    assert at_once("run", "examples/hoist_multi_plate.yaml", "--plot", "-q", "-o", tmp_path / "out").returncode == 0
    drawn = (tmp_path / "out" / "front.svg").read_text()
    assert FIGURE.sub("0", drawn) == FIGURE.sub("0", shown), "make picture draws it anew"
    numbers = ([float(x) for x in re.findall(r"[0-9]+(?:\.[0-9]+)?", text)] for text in (drawn, shown))
    assert all(a == pytest.approx(b, abs=1.0) for a, b in zip(*numbers, strict=True)), "make picture draws it anew"


def test_every_family_has_a_picture_of_its_drawing() -> None:
    for family in (entry.name for entry in map(lists.entry, FAMILIES) if entry.drawing):
        drawn = text_of(f"docs/pictures/drawing_{family}.svg")
        assert f"<title>{synth.load(family).title}: " in drawn, "make gallery draws it anew"


@pytest.mark.slow
def test_a_drawing_of_the_gallery_is_what_the_program_draws(tmp_path: Path) -> None:
    assert at_once("run", "examples/cone_drive.yaml", "-q", "-o", tmp_path / "out").returncode == 0
    assert at_once("report", tmp_path / "out", "-o", tmp_path / "drawn", "--drawing", "-q").returncode == 0
    drawn = (tmp_path / "drawn" / "design_01_drawing.svg").read_text()
    shown = text_of("docs/pictures/drawing_cone_clutch.svg")
    assert FIGURE.sub("0", drawn) == FIGURE.sub("0", shown), "make gallery draws it anew"


def test_every_table_is_in_the_readme_of_the_catalogues() -> None:
    readme = text_of("catalogs/README.md")
    tables = [path.stem for path in (ROOT / "catalogs").glob("*.csv") if not path.stem.endswith(".schema")]
    assert len(tables) > 10
    for name in tables:
        with (ROOT / "catalogs" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            rows = sum(1 for _ in csv.reader(file)) - 1
        assert f"| {name} | {rows} |" in readme, name


def test_the_index_lists_every_page() -> None:
    listed = {target for target, _ in LINK.findall(text_of("docs/index.md"))}
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"index.md"}
    assert pages <= listed, pages - listed


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target, anchor in LINK.findall(page.read_text(encoding="utf-8")):
        goal = page.parent / target if target else page
        assert goal.exists(), target
        if anchor:
            titles = re.findall(r"^#+ (.*)$", goal.read_text(encoding="utf-8"), re.MULTILINE)
            slugs = {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}
            assert anchor in slugs, f"{target}#{anchor}"


def test_installing_uses_targets_that_exist() -> None:
    targets = set(re.findall(r"^(\w+):", text_of("Makefile"), re.MULTILINE))
    named = set(re.findall(r"^(?:\$ )?make (\w+)", all_pages(), re.MULTILINE))
    assert {"demo", "test"} <= named <= targets


def test_the_own_problem_is_short_and_reaches_the_known_optimum() -> None:
    script = ROOT / "examples" / "own_problem.py"
    assert len(script.read_text(encoding="utf-8").splitlines()) <= 40
    module: dict[str, object] = {"__name__": "own_problem"}
    with redirect_stdout(io.StringIO()):
        exec(compile(script.read_text(encoding="utf-8"), str(script), "exec"), module)
    front = module["front"]
    assert isinstance(front, synth.ParetoFront)
    (best,) = front.designs
    assert best.status == synth.order.feasibility.Status.OPTIMAL
    assert front.certificate.kind == "global"
    # J. Golinski; best known 2994.471066 with 7.3 <= l1, l2 <= 8.3 (many later authors).
    assert best.values["weight"] == pytest.approx(2994.471066, rel=1e-6)
    known = {
        "face_width": 3.5,
        "module": 0.7,
        "bearing_distance_1": 7.3,
        "bearing_distance_2": 7.71532,
        "shaft_diameter_1": 3.350215,
        "shaft_diameter_2": 5.286654,
    }
    for name, value in known.items():
        assert best.values[name] / 0.01 == pytest.approx(value, rel=1e-5), name
    assert best.values["pinion_teeth"] == 17
