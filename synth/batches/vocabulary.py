"""The names that the columns of a table may have, over all families and their options."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass
from functools import cache
from typing import Any

from synth.declaration import Declaration
from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.model.registry import every_family, load, skipping_faulty_families
from synth.question.catalogs import as_catalogs
from synth.units import Unit, parse_unit

FAMILY, OPTIONS, LIMITS, FIX, PARTS = "family", "options", "limits", "fix", "parts"
STRUCTURE = (FAMILY, OPTIONS, LIMITS, FIX, PARTS)
SHORT = 5  # letters; words this short are alike by chance


@dataclass(frozen=True)
class Word:
    """What one name of a family is: option, requirement, variable, count, choice, slot, derived or setting."""

    name: str
    kind: str
    unit: Unit | None


def word_of(declaration: Declaration, name: str, settings: Mapping[str, object]) -> Word:
    """Declared object for a name."""
    d = declaration
    kinds: dict[str, Mapping[str, Any]] = {
        "option": d.options,
        "requirement": d.requirements,
        "variable": d.variables,
        "count": d.counts,
        "choice": d.choices,
        "slot": d.slots,
        "derived": d.derived,
        "setting": settings,
    }
    kind = next(kind for kind, members in kinds.items() if name in members)
    # a slot takes any attribute for a column of its table
    unit = vars(kinds[kind][name]).get("unit")
    return Word(name, kind, parse_unit(unit) if unit else None)


def words_of(declaration: Declaration, settings: Mapping[str, object]) -> dict[str, Word]:
    """Return every spelling (name or symbol) of what was declared, and what it stands for."""
    declared = {spelling: word_of(declaration, name, settings) for spelling, name in declaration.names().items()}
    return {name: word_of(declaration, name, settings) for name in settings if name not in declared} | declared


def all_words(
    problem: type[DesignProblem] | DesignProblem, every_option: bool
) -> tuple[dict[str, Word], dict[str, str]]:
    """Return the names of a family and what they stand for, and every spelling with its name.

    Parameters
    ----------
    problem : DesignProblem subclass or instance
    every_option : bool
        Whether those count that only another choice of an option brings.
    """
    base, catalogs = load(problem), as_catalogs(None)
    first = base.declaration(frozenset(), catalogs)
    words = words_of(first, base.simulation_settings)
    spellings = {spelling: word.name for spelling, word in words.items()}
    by_name = {word.name: word for word in words.values()}
    for option in first.options.values() if every_option else ():
        for label in option.choices:
            if label != option.chosen:
                try:
                    other = type(base)(**{**base.options, option.name: label}).declaration(frozenset(), catalogs)
                except InputError:
                    continue  # a label that is refused brings no names
                for spelling, name in other.names().items():
                    spellings.setdefault(spelling, name)
                    if name not in by_name:
                        by_name[name] = word_of(other, name, {})
    return by_name, spellings


@cache
def _words_of_registered(family: str, every_option: bool) -> tuple[dict[str, Word], dict[str, str]]:
    with skipping_faulty_families():
        return all_words(load(family), every_option)
    return {}, {}


class Universe:
    """The names of all registered families, and of one problem of the user's own.

    Parameters
    ----------
    used : set of str
        Families that rows name: of these every option counts, of the others the names that they have by default.
    user_family : DesignProblem subclass or instance, optional
    """

    def __init__(self, used: Set[str], user_family: type[DesignProblem] | None = None) -> None:
        problems: list[Any] = [*every_family()]
        if user_family is not None:
            problems.append(user_family)
        self.words: dict[str, list[Word]] = {}
        self.symbols: set[str] = set()  # and names, of the families that rows name
        self.options: dict[str, dict[str, str]] = {}  # of these families: spelling -> name
        for problem in problems:
            is_used = problem in used or not isinstance(problem, str)
            words, spellings = (_words_of_registered if isinstance(problem, str) else all_words)(problem, is_used)
            for name, word in words.items():
                self.words.setdefault(name, []).append(word)
            if is_used:
                self.symbols |= set(spellings)
                self.options[problem if isinstance(problem, str) else problem.name] = {
                    spelling: name for spelling, name in spellings.items() if words[name].kind == "option"
                }

    def knows(self, name: str) -> bool:
        """True if a heading means something: a name of any family, or a symbol of one that rows name."""
        return name in STRUCTURE or name in self.words or name in self.symbols

    def suggestion(self, name: str, unit: str | None, present: Set[str] = frozenset()) -> str | None:
        """Return the name that a column which is none was probably meant to have; None where it is not near any.

        Only what a row can state is meant, and a heading with a unit only means a quantity that is measured so. Two
        letters may differ, one where the word has only five: ``code`` is no misspelt ``coil``. Beside a column
        ``speed_max`` another one, ``speed_min``, is no misspelling of it.

        Parameters
        ----------
        name, unit : str
            Of the heading.
        present : set of str
            The other headings of the table.
        """
        near = [
            (distance, known)
            for known in [*self.words, *STRUCTURE]
            if known not in present
            and (distance := edit_distance(name.lower(), known.lower(), 2)) <= (1 if len(name) <= SHORT else 2)
            and self._may_have(known, unit)
        ]
        return min(near)[1] if near else None

    def _may_have(self, name: str, unit: str | None) -> bool:
        if name in STRUCTURE:
            return unit is None
        for word in self.words[name]:
            if word.kind in ("derived", "setting"):
                continue
            if unit is None:
                return True
            if word.unit is not None:
                try:
                    parse_unit(unit, word.unit.kind)
                except InputError:
                    continue
                return True
        return False


def edit_distance(a: str, b: str, most: int) -> int:
    """Number of letters typed, left out or changed to make one word of the other, up to a limit.

    Parameters
    ----------
    a, b : str
    most : int
        Anything beyond it counts as one more.

    Examples
    --------
    >>> edit_distance("load_torqe", "load_torque", 2), edit_distance("mass", "torque", 2)
    (1, 3)
    """
    if abs(len(a) - len(b)) > most:
        return most + 1
    row = list(range(len(b) + 1))
    for i, letter in enumerate(a, start=1):
        above, row = row, [i, *([0] * len(b))]
        for j, other in enumerate(b, start=1):
            row[j] = min(above[j] + 1, row[j - 1] + 1, above[j - 1] + (letter != other))
        if min(row) > most:
            return most + 1
    return min(row[-1], most + 1)
