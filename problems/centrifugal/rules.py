"""What an engineer demands of a centrifugal clutch, beside what its formulas need: requirements with a default each."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.declaration import Block, Requirement

from ..components.lining import wear
from ..components.springs.model import SpringRules
from ..friction.duty import Duty as FrictionDuty
from ..practice import UNSOURCED

if TYPE_CHECKING:
    from synth.declaration import Declaration

    from .body import Built


class Rules(Block):
    """Rules for all centrifugal clutches, all in SI."""

    group = "practice"

    allow_obsolete = replace(
        FrictionDuty.allow_obsolete,
        text="historical: also friction pairs that are built no more (cork, leather, wood, felt); yes: also those not "
        "allowed in new designs (asbestos), to re-compute old machines",
    )
    springs_per_set_min = Requirement(
        "-",
        3,
        lower=2,
        upper=12,
        symbol="N_min",
        text=f"Least springs in each set: two tilt the plate that they push ({UNSOURCED})",
        source=UNSOURCED,
    )
    setting_tolerance = Requirement(
        "mm",
        0.2,
        lower=0,
        upper=2,
        symbol="tol",
        text="Tolerance of the deflection of springs at rest, a tenth of the least such deflection: the contact speed "
        f"shifts with it ({UNSOURCED})",
        source=UNSOURCED,
    )
    friction_surfaces_max = Requirement(
        "-", 4, lower=2, upper=8, symbol="z_max", text=f"Most friction surfaces ({UNSOURCED})", source=UNSOURCED
    )
    gap_per_surface_min = Requirement(
        "mm",
        0.3,
        lower=0,
        upper=5,
        symbol="g_min",
        text="Least travel of the plate to contact over friction surfaces, so that the released clutch does not drag",
        source="practice, 0.3 to 0.5 mm and the run-out",
    )
    wire_diameter_min = Requirement(
        "mm",
        0.8,
        lower=0,
        upper=20,
        symbol="d_sp_min",
        text=f"Least wire of springs that turn with the clutch and bow outwards ({UNSOURCED})",
        source=UNSOURCED,
    )
    wear_life_min = wear.LEAST_LIFE

    @property
    def springs(self) -> SpringRules:
        """What they ask of springs."""
        return SpringRules(self.springs_per_set_min, self.setting_tolerance, self.wire_diameter_min)

    def limit_circle(self, d: Declaration, built: Built) -> None:
        """Declare limits of the circle on which springs stand, beside those of the formulas."""


class LeverRules(Rules):
    """Rules for centrifugal clutches with levers, whose springs stand on the circle of the weights; all in SI."""

    group = "practice"

    spring_gap = Requirement(
        "mm",
        2,
        lower=0,
        upper=50,
        symbol="c_sp",
        text=f"Gap between springs around their circle ({UNSOURCED})",
        source=UNSOURCED,
    )
    spring_circles = Requirement(
        "-",
        1,
        lower=0.1,
        upper=10,
        symbol="k_circle",
        text="Circles of the radius of the weights at rest over which the springs are spread; springs inside others "
        f"count as a circle more ({UNSOURCED})",
        source=UNSOURCED,
    )

    def limit_circle(self, d: Declaration, built: Built) -> None:
        """Declare that all springs stand beside each other on the circle of the weights."""
        taken: Any = sum(one.share_of_circle(self.spring_gap) for one in built.springs)
        d.at_most(
            "spring_circle",
            taken,
            self.spring_circles * 2 * np.pi * built.rest_radius,
            "mm",
            text="The springs have room on the circle of the weights",
            source=UNSOURCED,
        )
        for one in built.springs:
            d.at_most(
                f"{one.part.slot}_inside",
                built.rest_radius + one.outside / 2,
                d.derived["outer_diameter"].sx / 2,
                "mm",
                text="No spring on the circle of the weights reaches beyond the clutch",
                source="geometry",
            )
