"""Hooks of families: what the engine calls beside the declaration, with what, and what they return."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

    from synth.declaration import Setting
    from synth.drawing import Drawing
    from synth.results import Design


class FamilyHooks:
    """Hooks that a family may override; by default it has none.

    ``simulation_settings`` are what a simulation is told beside the requirements.
    """

    simulation_settings: Mapping[str, Setting] = {}
    # What an operating point is told by, for families that know the state of a design there: numbers with a unit.
    operating_point: Mapping[str, Setting] = {}

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
