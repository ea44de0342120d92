"""Multi-plate clutch: torque through many rings in a drum, with friction in the plate guides."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design, DesignProblem
from synth.declaration import Declaration, Part

from .. import cost, friction, practice, wear
from ..friction import startup_curves
from ..sources import ARCHARD, LIST_S0, LIST_S1, NEALE, PLATES_IN_USE, S0, SHAFT
from . import body as plate_body
from . import curves as pack_curves
from . import pack as plate_pack
from . import plate_sets
from .requirements import MadePackOptions, PackOptions

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing


class MultiPlateClutch(DesignProblem):
    """Multi-plate clutch, dry or in oil, both end plates being inner plates.

    The torque fades along the pack by friction in the plate guides (S0); start-up, heat and sizing follow S1.
    """

    name = "multi_plate_clutch"
    title = "Multi-plate clutch"
    sources = (
        LIST_S0,
        LIST_S1,
        NEALE,
        ARCHARD,
        *PLATES_IN_USE,
        *SHAFT,
    )
    simulation_settings = startup_curves.SETTINGS
    understands = (
        *friction.COMMON,
        "ambient_temperature",
        "heat_transfer",
        "steel_specific_heat",
        "plate_gap",
        "drag_torque_limit",
    )

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        lubrication = plate_pack.declare_lubrication(d)
        scope = practice.declare_scope(d)
        duty = friction.declare_duty(
            d,
            cooling_default="oil_bath" if lubrication == "oil" else "still_air",
            lubrication=lubrication,
            kind=friction.DutyOfPack if scope.rules else friction.Duty,
        )
        plate_set = plate_sets.declare_plate_set(d)
        options = d.block(MadePackOptions) if plate_set is None else d.block(PackOptions)
        wants = plate_pack.declare_pack_requirements(
            d, duty=duty, options=options, lubrication=lubrication, rules=scope.rules
        )
        required = friction.sizing_torque(duty, wants.surface_factor if options.guide_model == "cz" else 1.0)
        body_wants = rules = None
        if scope.rules or scope.complete:
            body_wants = plate_body.declare_body_requirements(d, lubrication=lubrication, required=required)
        if scope.rules:
            rules = plate_body.declare_pack_rules(d, lubrication=lubrication)
        ring = friction.declare_ring(
            d,
            ratio_min=0.15 if scope.rules else 0.10,
            ratio_max=0.25,
            diameters=None if plate_set is None else plate_sets.ring_diameters(plate_set),
        )
        force = self._declare_force(d)
        ramp_time = friction.declare_ramp_time(d)
        pair = friction.declare_friction_pair(
            d, suited=["'plate pack' in surfaces"], duty=duty, lubrication=lubrication, rules=scope.rules
        )
        plates = None
        if plate_set is not None:
            plates = plate_sets.standard_plates(plate_set, wants=wants, ring=ring)
        pack = plate_pack.declare_pack(d, duty=duty, options=options, wants=wants, ring=ring, plates=plates)
        torque, torques = plate_pack.declare_pack_torques(
            d,
            duty=duty,
            options=options,
            wants=wants,
            ring=ring,
            pair=pair,
            pack=pack,
            required=required,
            force=force,
        )
        if plate_set is not None:
            plate_sets.declare_set_limits(d, plate_set, pair=pair, pack=pack, pressure=torque.pressure)
        start, area = plate_pack.declare_pack_start(
            d, duty=duty, ring=ring, pair=pair, pack=pack, torque=torque, torques=torques, ramp_time=ramp_time
        )
        pack_size = plate_pack.pack_size(duty, wants, ring, pair, pack)
        plate_pack.declare_pack_temperature(d, duty=duty, pair=pair, start=start, size=pack_size, rules=scope.rules)
        body = None
        if body_wants is not None:
            body = plate_body.complete_body(
                duty=duty,
                wants=body_wants,
                pack_wants=wants,
                ring=ring,
                pair=pair,
                pack=pack,
                force=force,
                pack_size=pack_size,
            )
        size = body.size if body is not None and scope.complete else pack_size
        friction.declare_size(
            d,
            size=size,
            mass_of="The whole clutch" if scope.complete else "Plates with linings",
            outside="Outside of the drum",
            along="Drum with pack, bottom and actuator"
            if scope.complete
            else "Length of the released pack, without actuator and end stops",
        )
        drag = plate_pack.declare_drag(d, duty=duty, wants=wants, ring=ring, pack=pack)
        if body is not None:
            plate_body.declare_body(
                d,
                duty=duty,
                pack_wants=wants,
                ring=ring,
                pair=pair,
                pack=pack,
                start=start,
                body=body,
                pack_size=pack_size,
            )
            if rules is not None:
                plate_body.declare_rules(
                    d,
                    rules=rules,
                    duty=duty,
                    pack_wants=wants,
                    ring=ring,
                    pair=pair,
                    pack=pack,
                    start=start,
                    drag=drag,
                    body=body,
                    cooled_area=pack_size.cooled_area,
                )
            self._declare_cost(
                d, pair=pair, pack=pack, pack_size=pack_size, plate_set=plate_set, mass=body.size.mass, area=area
            )
        friction.declare_envelope(d, duty=duty, force=force, diameter=size.diameter, length=size.length)
        plate_pack.declare_pack_remarks(d, options=options, lubrication=lubrication)
        self._declare_objectives(d, scope=scope)

    def simulate(self, spec: Mapping[str, Any], design: Design) -> dict[str, pd.DataFrame]:
        """Return the start-up in time, and the temperature of the steel plates over repeated engagements."""
        return startup_curves.startup_frames(self, spec, design)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Return torque over plates and start-up over torque; with a design also force and pressure along the pack."""
        frames = {
            "torque_over_plates": pack_curves.torque_over_plates(self, spec, design),
            "startup_over_torque": startup_curves.startup_over_torque(self, spec, design),
        }
        if design is not None:
            frames["force_along_pack"] = pack_curves.force_along_pack(self, spec, design)
        return frames

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through the released clutch; the pack alone where only that is counted."""
        from . import drawing as pack_drawing  # costly to import; searches do without

        complete = self.option("mass_scope") == "complete"
        piston = complete and self.option("actuator") != "external"
        return pack_drawing.multi_plate_drawing(spec, design, complete=complete, piston=piston)

    def _declare_force(self, d: Declaration) -> Any:
        return d.variable(
            "actuation_force",
            "N",
            50,
            200000,
            symbol="F0",
            text="Axial force of the actuator on the first plate",
            source=f"{S0}, F0",
        )

    def _declare_cost(
        self,
        d: Declaration,
        *,
        pair: friction.Pair,
        pack: plate_pack.Pack,
        pack_size: plate_pack.PackSize,
        plate_set: Part | None,
        mass: Any,
        area: Any,
    ) -> None:
        plates = pack.surfaces + 1
        if plate_set is None:
            cost.declare_cost(d, mass=mass, parts=plates, lining=(pair.part, area))
            return
        bought = plate_set.filled(cost.UNIT_COST, cost.NONE) > cost.NONE  # with their lining
        listed = cost.Special("plates", plate_set, amount=plates, mass=pack_size.mass, pieces=plates)
        cost.declare_cost(d, mass=mass, parts=plates, lining=(pair.part, np.where(bought, 0.0, area)), special=[listed])

    def _declare_objectives(self, d: Declaration, *, scope: practice.Scope) -> None:
        # With the rules of practice a pump presses as hard as its piston allows; least force is then no aim.
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "friction_surfaces",
            "actuation_force",
            "surface_pressure",
            "peak_temperature_rise",
            sized_by="torque_capacity",
        )
        d.objective("mass")
        d.objective("actuation_force", default=not scope.rules)
        d.objective("length", default=scope.rules)
        for name in ("outer_diameter", "volume", "friction_work", "drag_torque"):
            d.objective(name, default=False)
        if scope.rules or scope.complete:
            wear.offer_wear_life(d)
            for name in ("stroke", "inner_inertia"):
                d.objective(name, default=False)
