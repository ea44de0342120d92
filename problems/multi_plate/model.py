"""Multi-plate clutch: torque through many rings in a drum, with friction in the plate guides."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import friction, practice
from ..components.lining import wear
from ..components.lining.model import declare_friction_pair
from ..components.pack import curves as pack_curves
from ..components.pack import model as plate_pack
from ..components.pack import plate_sets
from ..components.pack.body import PistonHousing
from ..components.pack.layers import LAYERS
from ..components.pack.requirements import MadePackOptions, PackOptions
from ..components.ring.model import declare_ring
from ..duty import coverage
from ..friction import startup_curves
from ..sources import ARCHARD, LIST_S0, LIST_S1, NEALE, PLATES_IN_USE, S0, SHAFT, UNIFORM_WEAR

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing


class MultiPlateClutch(DesignProblem):
    """Multi-plate clutch, dry or in oil, both end plates being inner plates.

    The torque fades along the pack by friction in the plate guides (S0); start-up, heat and sizing follow S1.
    """

    name = "multi_plate_clutch"
    title = "Multi-plate clutch"
    sources = (LIST_S0, LIST_S1, UNIFORM_WEAR, NEALE, ARCHARD, *PLATES_IN_USE, *SHAFT)
    simulation_settings = startup_curves.SETTINGS
    understands = (
        *friction.COMMON,
        "ambient_temperature",
        "heat_transfer",
        "steel_specific_heat",
        "plate_gap",
        "drag_torque_limit",
    )
    declines, disregards, as_limits = coverage.ENGAGED_IN_PACKS, ("peak_torque",), coverage.ENVELOPE

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        lubrication = plate_pack.declare_lubrication(d)
        layer_of = LAYERS[practice.declare_scope(d)]
        plate_set = plate_sets.declare_plate_set(d)
        options = d.block(MadePackOptions) if plate_set is None else d.block(PackOptions)
        duty = friction.declare_duty(
            d,
            cooling_default="oil_bath" if lubrication == "oil" else "still_air",
            lubrication=lubrication,
            kind=layer_of.kind,
        )
        wants = plate_pack.declare_pack_requirements(d, duty=duty, lubrication=lubrication, kind=layer_of.pack)
        layer = layer_of(d, PistonHousing, lubrication, duty.required_torque)
        ring = declare_ring(d, ratio_min=layer.ratio_min, ratio_max=0.25, listed=plate_set)
        force = d.variable(
            "actuation_force",
            "N",
            50,
            200000,
            symbol="F0",
            text="Axial force of the actuator on the first plate",
            source=f"{S0}, F0",
        )
        ramp_time = friction.declare_ramp_time(d)
        pair = declare_friction_pair(
            d, suited=["'plate pack' in surfaces"], duty=duty, lubrication=lubrication, linings=layer.linings
        )
        plates = None
        if plate_set is not None:
            plates = plate_sets.standard_plates(plate_set, wants=wants, ring=ring)
        pack = plate_pack.declare_pack(d, duty=duty, options=options, wants=wants, ring=ring, plates=plates)
        stack = plate_pack.Stack(duty, options, wants, ring, pair, pack)
        torque, torques = plate_pack.declare_pack_torques(d, stack, force=force)
        if plate_set is not None:
            plate_sets.declare_set_limits(d, plate_set, pair=pair, pack=pack, pressure=torque.pressure)
        built = plate_pack.declare_pack_start(d, stack, torque=torque, torques=torques, ramp_time=ramp_time)
        plate_pack.declare_pack_temperature(d, built)
        layer.judge_temperature(d, built)
        size = layer.size(built)
        friction.declare_size(d, size=size, mass_of=layer.mass_of, outside="Outside of the drum", along=layer.along)
        plate_pack.declare_drag(d, built)
        layer.declare_body(d, built)
        layer.declare_cost(d, built, plate_set)
        friction.declare_envelope(d, duty=duty, force=force, diameter=size.diameter, length=size.length)
        plate_pack.declare_pack_remarks(d, options=options, lubrication=lubrication)
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
        for name in ("mass", "actuation_force", "length", "outer_diameter", "volume", "friction_work", "drag_torque"):
            d.objective(name, default=name in layer.objectives)
        wear.offer_wear_life(d)
        for name in layer.offered:
            d.objective(name, default=False)

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
        # Costly to import; searches do without.
        from ..drawing_parts import Sizes
        from . import drawing as pack_drawing

        size = Sizes(spec, design)
        if self.option("mass_scope") == "parts":
            return pack_drawing.pack_drawing(size)
        return pack_drawing.clutch_drawing(size, piston=self.option("actuator") != "external")
