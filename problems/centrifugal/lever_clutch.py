"""What the centrifugal clutches with levers are beside their declarations: sources, curves and state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from synth import Design, DesignProblem

from .. import centrifugal as blocks
from . import curves as centrifugal_curves
from . import lever_curves
from . import state as states

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd


class LeverClutch(DesignProblem):
    """Centrifugal clutch with levers; families say of which kind they are."""

    kind: ClassVar[lever_curves.LeverKind]
    sources = blocks.SOURCES
    understands = (*blocks.COMMON, "lining_wear", "contact_travel")
    operating_point = states.OPERATING_POINT

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, Any]:
        """Return clamp force over lining; of a design what happens over the speed, with new and with worn linings.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``clamp_force_over_lining``, or of a design ``over_speed`` and ``over_speed_worn``.
        """
        if design is None:
            return {"clamp_force_over_lining": centrifugal_curves.clamp_force_over_lining(self, spec)}
        return lever_curves.over_speed(self, spec, design, self.kind)

    def state(self, spec: Mapping[str, Any], design: Design, point: Mapping[str, float]) -> pd.DataFrame:
        """State of the flyweights at a speed, the pressing force and the torque that can be carried.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design
            The design.
        point : mapping
            ``speed`` of the driving side [rad/s].
        """
        return states.of_lever(spec, design, self.kind, point["speed"])
