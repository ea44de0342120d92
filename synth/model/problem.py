"""The base class of all design problems."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from typing import Any

from synth.declaration import Declaration, DeclarationError, declaring
from synth.errors import InputError
from synth.model.hookspecs import FamilyHooks
from synth.model.model import Model
from synth.model.slot_comparison import SlotComparison, refusal_of
from synth.special import recorded
from synth.system.interrupts import held_back
from synth.tables.catalogs import Catalogs

MOST_MODELS = 16  # that a problem keeps: one per set of requirements given, tables and slots compared


class DesignProblem(FamilyHooks):
    """A design problem, written once: subclass it, name it, and declare it.

    Parameters
    ----------
    **options : str
        Structural choices of the user; ``describe`` lists them.

    Raises
    ------
    InputError
        When an option is unknown or has an unknown value.

    Examples
    --------
    >>> class Rod(DesignProblem):
    ...     name, title = "rod", "Tension rod"
    ...     def declare(self, d):
    ...         force = d.requirement("force", "N")
    ...         diameter = d.variable("diameter", "mm", 1, 100)
    ...         d.at_most("stress", force / (0.785398 * diameter**2), 100e6, "N/mm2")
    ...         d.objective("diameter", "min")
    >>> import synth
    >>> front = synth.synthesize(Rod(), {"force": "10 kN"})
    >>> round(front.designs[0].values["diameter"] * 1e3, 3)
    11.284
    """

    name: str = ""
    title: str = ""
    sources: tuple[str, ...] = ()
    # Requirements that mean here what they mean in every family: what a sheet for several families may state.
    understands: tuple[str, ...] = ()
    # Requirements of other families that ask for what this one cannot do: why, and what does it.
    declines: Mapping[str, str] = {}
    # Requirements of other families that cannot matter here: they are left out, which is said.
    disregards: tuple[str, ...] = ()
    # Requirements of other families that are limits of a quantity here: its name.
    as_limits: Mapping[str, str] = {}
    # What a spec must repeat beside options and requirements so that it asks for the same problem.
    restated: Mapping[str, Any] = {}

    def __init__(self, /, **options: str) -> None:
        if not self.name:
            raise DeclarationError(f"{type(self).__name__} needs a class attribute 'name'")
        self.options = dict(options)
        self._models: dict[tuple[frozenset[str], int, tuple[SlotComparison, ...]], tuple[Model, Catalogs]] = {}

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, parts, limits and objectives on ``d``."""
        raise DeclarationError(f"{type(self).__name__} does not define declare(self, d)")

    def option(self, name: str) -> str:
        """Option that is in force: the one given, or the default."""
        traced = next(iter(self._models.values()), None)
        declared = self.declaration(frozenset(), Catalogs()) if traced is None else traced[0].declaration
        return declared.options[name].chosen

    @property
    def declared_by(self) -> type[DesignProblem]:
        """The class whose sources decide what is declared."""
        return type(self)

    def declaration(
        self, present: frozenset[str], catalogs: Catalogs, options: Mapping[str, str] | None = None
    ) -> Declaration:
        """Declaration of the problem, not traced into a model: for callers that need names alone.

        ``options``: in place of its own.
        """
        declaration = Declaration(self.name, self.options if options is None else options, present, catalogs)
        with held_back(), declaring(self.name), recorded() as calls:
            self.declare(declaration)
        declaration.settle_columns(calls)
        return declaration

    def _where_declared(self, present: frozenset[str], catalogs: Catalogs, word: str) -> str:
        """Say with which optional requirement or option there is a name that is not declared; nothing if with none."""
        declared = self.declaration(present, catalogs)
        for requirement in declared.requirements.values():
            if requirement.sx is None and self._declares(word, self.options, present | {requirement.name}, catalogs):
                return f"{word} is there where {requirement.name} is given"
        for option in declared.options.values():
            others = {name: label for name, label in self.options.items() if name not in (option.name, option.symbol)}
            for label in option.structures:
                if self._declares(word, {**others, option.name: label}, present, catalogs):
                    return f"{word} is there with {option.name}: {label}"
        return ""

    def _declares(self, word: str, options: Mapping[str, str], present: frozenset[str], catalogs: Catalogs) -> bool:
        """Whether the problem declares a name with some options and optional requirements."""
        with suppress(InputError, DeclarationError):  # other entries of the request may not go with this option
            return word in self.declaration(present, catalogs, options).names()
        return False

    def model(self, present: frozenset[str], catalogs: Catalogs, compared: tuple[SlotComparison, ...] = ()) -> Model:
        """Trace the problem once for the requirements given, the catalogues in force and the slots compared."""
        key = (present, id(catalogs), compared)
        known = self._models.pop(key, None)
        if known is None:
            declaration = Declaration(self.name, self.options, present, catalogs)
            with held_back(), declaring(self.name):
                with recorded() as calls:
                    self.declare(declaration)
                declaration.refusals += [refusal_of(comparison, declaration) for comparison in compared]
                # The catalogues are kept with the model, so that their id stays theirs.
                known = Model(self.name, declaration, calls, partial(self._where_declared, present, catalogs)), catalogs
            while len(self._models) >= MOST_MODELS:
                self._models.pop(next(iter(self._models)), None)
        self._models[key] = known
        return known[0]
