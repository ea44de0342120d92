"""What may be asked of a multi-plate pack and of the clutch around it."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from synth.declaration import Block, Declaration, Option, Requirement

from ...duty import of_drive
from ...friction.duty import Duty
from ...friction.engagement import SOFT_START_SHARE
from ...mechanics import guide_friction
from ...practice import UNSOURCED
from ...sources import S0, TYPICAL
from ..lining import wear
from ..ring.model import Ring
from ..shaft.model import ShaftRequirements

FLATNESS = "out of flat 0.10 mm (AP Racing) and 0.15 mm (Harley-Davidson) when plates are discarded"


class PackOptions(Block):
    """Options of a multi-plate pack."""

    group = "model"

    guide_series = Option(
        guide_friction.GUIDE_SERIES,
        "geometric",
        symbol="gs",
        text="Torque sum: geometric (5), exponential_form (5'), lipka (5''), exponential_K (10), exact",
        source=f"{S0}, eq. (5), (10) and appendix",
    )
    release_aid = Option(
        table="release_aids",
        default="none",
        symbol="aid",
        text="What separates the plates of the released pack",
        source=f"{S0}, release of the plates",
        group="actuator",
    )
    shaft_position = Option(
        ("horizontal", "vertical"),
        "horizontal",
        symbol="pos",
        text="Position of the shaft",
        source=f"{S0}, vertical shafts",
        group="duty",
    )


class MadePackOptions(PackOptions):
    """Options of a pack whose plates are made to size."""

    spline_choice = Option(
        ("free", "catalogue"),
        "free",
        symbol="spl",
        text="free: the inner spline follows the ring; catalogue: it is a row of table splines",
        source="table splines",
    )


class LugRequirements(Block):
    """Lugs of plates that are made to size, all in SI."""

    group = "model"

    lug_clearance = Requirement(
        "mm",
        3,
        lower=0.1,
        upper=30,
        symbol="e_lug",
        text="From the edge of the friction ring to the mean spline radius",
        source=f"{S0}, example",
    )
    lug_count = Requirement(
        "-", 12, lower=3, upper=200, symbol="n_lug", text=f"Lugs of a plate that carry ({TYPICAL})", source=TYPICAL
    )
    lug_height = Requirement(
        "mm", 3, lower=0.5, upper=30, symbol="h_lug", text=f"Loaded flank height of a lug ({TYPICAL})", source=TYPICAL
    )

    def sizes(self, ring: Ring, wants: PackRequirements) -> tuple[Any, Any]:
        """Return number and height [m] of the lugs of a plate that carry."""
        return self.lug_count, self.lug_height


class PracticeLugRequirements(LugRequirements):
    """Lugs that grow in number with the diameter where they are not given, all in SI."""

    lug_count = Requirement(
        "-",
        lower=3,
        upper=200,
        optional=True,
        symbol="n_lug",
        text="Lugs of a plate that carry; by default the share lug share of teeth of lug module all around",
        source=UNSOURCED,
        group="model",
    )
    lug_height = Requirement(
        "mm",
        lower=0.5,
        upper=30,
        optional=True,
        symbol="h_lug",
        text="Loaded flank height of a lug; by default lug module",
        source=UNSOURCED,
        group="model",
    )
    lug_module = Requirement(
        "mm",
        3,
        lower=0.5,
        upper=20,
        symbol="m_l",
        text=f"Module of involute or straight teeth all around the plates ({UNSOURCED})",
        source=UNSOURCED,
        group="practice",
    )

    def sizes(self, ring: Ring, wants: PackRequirements) -> tuple[Any, Any]:
        """Return number and height [m] of the lugs that carry: teeth all around, more of them on larger rings."""
        count = wants.carrying(2 * ring.inner_radius / self.lug_module) if self.lug_count is None else self.lug_count
        return count, self.lug_module if self.lug_height is None else self.lug_height


class PackRequirements(Block):
    """Requirements of a multi-plate pack, all in SI; None where an optional one is not given."""

    group = "model"
    lugs: ClassVar[type[LugRequirements]] = LugRequirements

    guide_friction = Requirement(
        "-",
        0.1,
        lower=0,
        upper=0.5,
        symbol="mu_guide",
        text="Friction of the plates in their splines",
        source=f"{S0}, mu1",
        group="material",
    )
    hub_bore_diameter = of_drive(
        "mm", 2, 700, "d_hub_min", "Least mean diameter 2a of the inner spline: room for the shaft", group="envelope"
    )
    drag_torque_limit = Requirement(
        "N*m",
        lower=0.001,
        upper=1e4,
        optional=True,
        symbol="T_drag_max",
        text="Largest drag of the released clutch",
        source=f"{S0}, after-running",
        group="duty",
    )
    oil_viscosity = Requirement(
        "Pa*s",
        lower=0,
        upper=2,
        symbol="eta_oil",
        text=f"Dynamic viscosity of the oil, 0 when dry ({TYPICAL})",
        source=TYPICAL,
        group="material",
    )
    lug_pressure_limit = Requirement(
        "N/mm2",
        30,
        lower=1,
        upper=200,
        symbol="p_lug_allow",
        text=f"Pressure of the lugs on the spline flanks; 25 to 40 when hardened ({TYPICAL})",
        source=TYPICAL,
        group="material",
    )
    drum_wall = Requirement(
        "mm",
        6,
        lower=1,
        upper=50,
        symbol="s_drum",
        text=f"Drum outside the mean radius of the outer spline ({TYPICAL})",
        source=TYPICAL,
    )
    plate_effectiveness_min = Requirement(
        "-",
        0.5,
        lower=0.05,
        upper=1,
        symbol="eta_min",
        text="Least torque of the pack over that without guide friction; used with guide model series",
        source=f"{S0}, eq. (16)",
    )

    @staticmethod
    def defaults(duty: Duty, *, oil: bool) -> dict[str, Any]:
        """Defaults by duty and lubrication, beside those of all packs."""
        return {}

    def carrying(self, teeth: Any) -> Any:
        """Number of teeth of a plate that carry."""
        return teeth

    def gap(self, duty: Duty, ring: Ring) -> Any:
        """Return the release gap per surface [m]."""
        return duty.plate_gap

    def released_speed(self, duty: Duty) -> Any:
        """Return the speed between the released plates [rad/s]."""
        return duty.driver_speed


class PracticePackRequirements(PackRequirements):
    """Requirements of a pack whose gap grows with its diameter where it is not given."""

    group = "practice"
    lugs = PracticeLugRequirements

    lug_share = Requirement(
        "-",
        0.5,
        lower=0.05,
        upper=1,
        symbol="k_l",
        text=f"Share of the teeth that carries ({UNSOURCED})",
        source=UNSOURCED,
    )
    gap_base = Requirement(
        "mm",
        lower=0,
        upper=3,
        symbol="g_0",
        text="Release gap of a pack without diameter, where plate gap is not given",
        source=f"{UNSOURCED}; {FLATNESS}",
    )
    gap_per_diameter = Requirement(
        "-",
        0.0005,
        lower=0,
        upper=0.1,
        symbol="g_1",
        text=f"Further release gap over outer diameter of the ring: flatness errors grow with it ({UNSOURCED})",
        source=UNSOURCED,
    )
    drag_speed = Requirement(
        "1/min",
        lower=0.1,
        upper=60000,
        symbol="omega_drag",
        text="Speed between the released plates at which their drag is judged; by default driver speed",
        source="requirement of the drive",
        group="duty",
    )

    @staticmethod
    def defaults(duty: Duty, *, oil: bool) -> dict[str, Any]:
        """Defaults by duty and lubrication, beside those of all packs."""
        return {"gap_base": 0.1 if oil else 0.3, "drag_speed": duty.driver_speed}

    def carrying(self, teeth: Any) -> Any:
        """Number of teeth of a plate that carry: the share lug_share."""
        return self.lug_share * teeth

    def gap(self, duty: Duty, ring: Ring) -> Any:
        """Return the release gap per surface [m], which grows with the diameter."""
        grown = self.gap_base + self.gap_per_diameter * (2 * ring.outer_radius)
        return grown if duty.plate_gap is None else duty.plate_gap

    def released_speed(self, duty: Duty) -> Any:
        """Return the speed between the released plates [rad/s]."""
        return self.drag_speed


class OilRules(Block):
    """Rules for packs in oil, all in SI."""

    group = "practice"

    oil_temperature_limit = Requirement(
        "degC",
        120,
        lower=0,
        upper=250,
        symbol="T_oil_max",
        text=f"Largest temperature of oil, above which it ages: mean of the pack, and a magnet's ({UNSOURCED})",
        source=UNSOURCED,
    )


class PackRules(Block):
    """Rules for packs, all in SI."""

    group = "practice"

    friction_surfaces_max = Requirement(
        "-",
        lower=2,
        upper=60,
        symbol="z_max",
        text="Most friction surfaces (up to 20 discs: flott.de; dry packs of three makers stop at 6 to 8)",
        source="flott.de, disk clutch; makers of dry clutches",
    )
    core_slenderness_max = Requirement(
        "-",
        150,
        lower=20,
        upper=1000,
        symbol="lambda_max",
        text="Largest outer diameter of the ring over thickness of a lined core (111 plates: median 133; flatness, "
        f"{FLATNESS})",
        source=UNSOURCED,
    )
    plate_slenderness_max = Requirement(
        "-",
        110,
        lower=20,
        upper=1000,
        symbol="lambda_pl_max",
        text="Largest outer diameter of the ring over thickness of a bare steel plate, which heat cones (median 71; a "
        "tenth above 106)",
        source=UNSOURCED,
    )
    drag_ratio_max = Requirement(
        "-",
        0.05,
        lower=0.001,
        upper=10,
        symbol="k_drag",
        text=f"Largest drag of the released clutch over the torque of the load ({UNSOURCED})",
        source=UNSOURCED,
    )
    release_gap_min = Requirement(
        "mm",
        lower=0.01,
        upper=5,
        symbol="gap_min",
        text="Least release gap per surface where plate gap is given (a transmission pack has 0.06 to 0.09 mm)",
        source=UNSOURCED,
    )
    wear_life_min = wear.LEAST_LIFE
    soft_start_share = SOFT_START_SHARE

    def limit_stroke(self, d: Declaration, *, stroke: Any, ring: Ring) -> None:
        """Declare the limit of the stroke [m], where an actuator has one."""

    def limit_piston(self, d: Declaration, *, area: Any, width: Any, diameter: Any) -> None:
        """Declare that the piston fits between the splines, where there is a piston."""


class PistonPackRules(PackRules):
    """Rules for packs that a piston presses, all in SI."""

    group = "practice"

    stroke_base = Requirement(
        "mm",
        4,
        lower=0,
        upper=100,
        symbol="s_0",
        text=f"Stroke that any actuator has ({UNSOURCED}; three makers)",
        source=UNSOURCED,
    )
    stroke_per_diameter = Requirement(
        "-",
        0.03,
        lower=0,
        upper=1,
        symbol="s_1",
        text=f"Further stroke over outer diameter of the ring ({UNSOURCED})",
        source=UNSOURCED,
    )
    piston_fill = Requirement(
        "-",
        0.85,
        lower=0.1,
        upper=1,
        symbol="k_p",
        text=f"Share of the room between the splines that a ring piston can use ({UNSOURCED})",
        source=UNSOURCED,
    )

    def limit_stroke(self, d: Declaration, *, stroke: Any, ring: Ring) -> None:
        """Declare the limit of the stroke [m]."""
        d.at_most(
            "stroke",
            stroke,
            self.stroke_base + self.stroke_per_diameter * (2 * ring.outer_radius),
            "mm",
            text="An actuator has the stroke",
            source=UNSOURCED,
        )

    def limit_piston(self, d: Declaration, *, area: Any, width: Any, diameter: Any) -> None:
        """Declare that a piston of an area fits between the splines, by their distance and mean diameter."""
        if area is not None:
            d.at_most(
                "piston_fits",
                area,
                self.piston_fill * np.pi * width * diameter,
                "cm2",
                text="A ring piston of that pressure fits between the splines",
                source=UNSOURCED,
            )


class PackBodyRequirements(ShaftRequirements):
    """What is around a pack whatever presses it, all in SI."""

    group = "practice"

    end_plate_ratio = Requirement(
        "-",
        30,
        lower=5,
        upper=200,
        symbol="k_end",
        text=f"Ring diameter over thickness of end plates, web of the hub, drum bottom and piston ({UNSOURCED})",
        source=UNSOURCED,
    )
    wear_depth_limit = Requirement(
        "mm",
        lower=0.01,
        upper=50,
        symbol="d_w_max",
        text="Wear of one lining before it is replaced, where less than its wearable depth (six packs in oil: 0.2 mm; "
        "eight dry car discs: 1.0 mm)",
        source=UNSOURCED,
    )


class BodyRequirements(PackBodyRequirements):
    """What a complete multi-plate clutch has around its pack, all in SI."""

    group = "actuator"

    actuator = Option(
        ("hydraulic", "pneumatic", "external"),
        symbol="act",
        text="What presses: a ring piston in the drum, by oil or by air, or something outside that is not counted",
        source=UNSOURCED,
    )
    actuator_pressure = Requirement(
        "N/mm2",
        lower=0.05,
        upper=40,
        symbol="p_act",
        text="Pressure on the ring piston; air up to 0.9 (three oil units at 1.1 to 1.7, two makers of air clutches)",
        source=UNSOURCED,
    )
