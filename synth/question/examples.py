"""The examples that families bring: spec files beside the module that declares them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import as_file, files
from typing import Any

from synth.folders.files import read_text
from synth.model.problem import DesignProblem
from synth.model.registry import every_family
from synth.question.spec import read_content

ENDING = ".yaml"


@dataclass(frozen=True, kw_only=True)
class Example:
    """A spec file that shows what a family can do.

    Parameters
    ----------
    name : str
        Of the file, without its ending.
    family : str
    description : str
        The comment that the file begins with, up to its first empty line.
    text : str
        The whole file.
    spec : dict
        What it says.
    """

    name: str
    family: str
    description: str
    text: str
    spec: dict[str, Any]

    @property
    def is_design(self) -> bool:
        """True if it states a design, which is evaluated, and no question."""
        return "values" in self.spec


def examples() -> list[Example]:
    """Return the examples of all registered families, by family and name."""
    return [example for problem in every_family().values() for example in examples_of(problem)]


def examples_of(problem: DesignProblem) -> list[Example]:
    """Return the examples of a family by name: the spec files of its package that name it."""
    return sorted((one for one in _beside(problem) if one.family == problem.name), key=lambda one: one.name)


def _beside(problem: DesignProblem) -> Iterator[Example]:
    package = problem.declared_by.__module__.rpartition(".")[0]
    if not package:
        return  # a module of its own: what lies beside it need not be its
    for entry in files(package).iterdir():
        if entry.name.endswith(ENDING):
            with as_file(entry) as path:
                content, text = read_content(path, "example"), read_text(path, "example")
            if isinstance(content, dict):
                yield Example(
                    name=entry.name.removesuffix(ENDING),
                    family=str(content.get("family")),
                    description=_first_comment(text),
                    text=text,
                    spec=content,
                )


def _first_comment(text: str) -> str:
    words = list[str]()
    for line in text.splitlines():
        comment = line.removeprefix("#").strip()
        if not line.startswith("#") or not comment:
            break
        words.append(comment)
    return " ".join(words)
