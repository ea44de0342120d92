"""The base class of all design problems."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from synth.declaration import Declaration, DeclarationError, Setting, declaring
from synth.errors import InputError
from synth.model.model import Model
from synth.model.slot_comparison import SlotComparison, refusal_of
from synth.special import recorded
from synth.system.interrupts import held_back
from synth.tables.catalogs import Catalogs

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing
    from synth.results import Design


MOST_MODELS = 16  # that a problem keeps: one per set of requirements given, tables and slots compared


class DesignProblem:
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
    simulation_settings: Mapping[str, Setting] = {}
    # What an operating point is told by, for families that know the state of a design there: numbers with a unit.
    operating_point: Mapping[str, Setting] = {}
    # Requirements that mean here what they mean in every family: what a sheet for several families may state.
    understands: tuple[str, ...] = ()
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

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> Mapping[str, pd.DataFrame] | None:
        """Return curves as DataFrames by file name, or None where a family has none.

        Every column is headed ``name [unit]``, in units that people read. ``DataFrame.attrs`` says how to draw a frame:
        ``title``; ``x``, a column, by default the first; ``panels``, each with ``label`` (``torque [N*m]``),
        ``columns``, ``log``, ``points`` (True marks every row), ``stairs`` (``post`` or ``pre``: a value holds up to
        the next row, or from the row before) and ``height`` (over an ordinary panel); ``marks`` (vertical lines:
        ``x``, ``label``); ``spans`` (``from``, ``to``, ``label``, ``shaded``: by default every second one); ``lines``
        (horizontal lines: ``panel``, ``y``, ``label``); ``notes`` (lines of text below); ``source``. Only the title
        is needed. Lines are drawn in row order, and not-a-number breaks them. pandas is imported inside: it is costly.

        Parameters
        ----------
        spec : mapping
            Every declared requirement by name in SI; None where an optional one is not given. Options: :meth:`option`.
        design : Design, optional
            The design; without one the hook returns what the requirement alone allows.
        """
        return None

    def simulate(self, spec: Mapping[str, Any], design: Design) -> Mapping[str, pd.DataFrame] | None:
        """Return simulations in time as DataFrames by file name, or None where a family has none.

        Frames are those of :meth:`curves`. ``attrs["quantities"]`` maps names of derived quantities to what the
        simulation found for them in SI: the second opinion beside the closed form.

        Parameters
        ----------
        spec : mapping
            As for :meth:`curves`, and what the user set of ``simulation_settings``: SI floats, words, rows of tables.
        design : Design
            The design.
        """
        return None

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing | None:
        """Return the dimensioned drawing of a design, or None where a family has none.

        ``synth.drawing`` says what it consists of. Nothing is drawn that the design does not have; every dimension
        names its quantity, and what the model leaves out is told in ``omitted``.

        Parameters
        ----------
        spec : mapping
            As for :meth:`curves`.
        design : Design
            The design.
        """
        return None

    def state(self, spec: Mapping[str, Any], design: Design, point: Mapping[str, float]) -> pd.DataFrame | None:
        """Return the state of a design at an operating point, or None where a family has none.

        One row per course that leads to it. The first columns are ``course`` and ``regime``, in words; every other one
        is headed ``name [unit]``, in units that people read. ``attrs["source"]`` may name the source.

        Parameters
        ----------
        spec : mapping
            As for :meth:`curves`.
        design : Design
            The design.
        point : mapping
            The names of ``operating_point`` in SI.
        """
        return None

    def option(self, name: str) -> str:
        """Return an option that is in force: the one given, or the default."""
        model = next(iter(self._models.values()))[0] if self._models else self.model(frozenset(), Catalogs())
        chosen: str = model.declaration.options[name].chosen
        return chosen

    @property
    def declared_by(self) -> type[DesignProblem]:
        """The class whose sources decide what is declared."""
        return type(self)

    def declaration(
        self, given: frozenset[str], catalogs: Catalogs, options: Mapping[str, str] | None = None
    ) -> Declaration:
        """Declaration of the problem, not traced into a model: for callers that need names alone.

        ``options``: in place of its own.
        """
        declaration = Declaration(self.name, self.options if options is None else options, given, catalogs)
        with held_back(), declaring(self.name), recorded() as calls:
            self.declare(declaration)
        declaration.settle_columns(calls)
        return declaration

    def _where_declared(self, given: frozenset[str], catalogs: Catalogs, word: str) -> str:
        """Say with which optional requirement or option there is a name that is not declared; nothing if with none."""
        declared = self.declaration(given, catalogs)
        for requirement in declared.requirements.values():
            if requirement.sx is None and self._declares(word, self.options, given | {requirement.name}, catalogs):
                return f"{word} is there where {requirement.name} is given"
        for option in declared.options.values():
            others = {name: label for name, label in self.options.items() if name not in (option.name, option.symbol)}
            for label in option.choices:
                if self._declares(word, {**others, option.name: label}, given, catalogs):
                    return f"{word} is there with {option.name}: {label}"
        return ""

    def _declares(self, word: str, options: Mapping[str, str], given: frozenset[str], catalogs: Catalogs) -> bool:
        """Whether the problem declares a name with some options and optional requirements."""
        with suppress(InputError, DeclarationError):  # what was asked beside it does not go with this option
            return word in self.declaration(given, catalogs, options).names()
        return False

    def model(self, given: frozenset[str], catalogs: Catalogs, compared: tuple[SlotComparison, ...] = ()) -> Model:
        """Trace the problem once for the requirements given, the catalogues in force and the slots compared."""
        key = (given, id(catalogs), compared)
        known = self._models.pop(key, None)
        if known is None:
            declaration = Declaration(self.name, self.options, given, catalogs)
            with held_back(), declaring(self.name):
                with recorded() as calls:
                    self.declare(declaration)
                declaration.refusals += [refusal_of(comparison, declaration) for comparison in compared]
                # The catalogues are kept with the model, so that their id stays theirs.
                known = Model(self.name, declaration, calls, partial(self._where_declared, given, catalogs)), catalogs
            while len(self._models) >= MOST_MODELS:
                self._models.pop(next(iter(self._models)), None)
        self._models[key] = known
        return known[0]
