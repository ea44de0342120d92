"""Electromagnetic clutch: a pot magnet with stationary coil presses the pack of a multi-plate or a disc clutch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import friction, practice
from ..components.discs import curves as disc_curves
from ..components.discs import model as disc_pack
from ..components.discs.body import DiscHousing
from ..components.lining import wear
from ..components.lining.model import declare_friction_pair
from ..components.magnet import curves as magnet_curves
from ..components.magnet import model as magnet_blocks
from ..components.magnet.model import Magnet, MagnetSize, Pressed
from ..components.pack import curves as pack_curves
from ..components.pack import model as plate_pack
from ..components.pack.body import PackHousing
from ..components.pack.requirements import MadePackOptions
from ..components.ring.model import declare_ring
from ..duty import coverage
from ..friction import startup_curves
from ..mechanics import magnetics
from ..sources import ARCHARD, DISC_RUN_OUT, DISC_WEAR, LIST_S0, LIST_S1, NEALE, PLATES_IN_USE, S4, SHAFT, SHIGLEY_DISC
from .layers import LAYERS, Sources

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing


# Pairs on a flat face; no bare cast iron, wood, cork or lining of the lecture.
SUITED = (
    "'disc facing' in surfaces or 'plate pack' in surfaces",
    "status != 'obsolete'",
    "lining not in ('cast iron', 'wood (historical)', 'cork', 'unspecified lining of the seed example')",
)


class ElectromagneticClutch(DesignProblem):
    """Friction clutch that an electromagnet engages, with the pack of a multi-plate or of a disc clutch.

    Instead of a given actuation force the magnet is sized with the pack: circuit, coil, heat, pull on the released
    armature. Only the idea of the magnet is the source's (S4); the model is derived.
    """

    name = "electromagnetic_clutch"
    title = "Electromagnetic clutch"
    sources = (
        "S4: notes on centrifugal clutches, figure 2-27: an electromagnet instead of clamp springs",
        LIST_S0,
        LIST_S1,
        "Ampere's law, Maxwell's force, Froehlich's saturation curve, steady heat balance",
        NEALE,
        SHIGLEY_DISC,
        ARCHARD,
        *PLATES_IN_USE,
        DISC_WEAR,
        DISC_RUN_OUT,
        *SHAFT,
    )
    simulation_settings = startup_curves.SETTINGS
    understands = (*friction.COMMON, "ambient_temperature", "heat_transfer", "plate_gap")
    declines, disregards, as_limits = coverage.ENGAGED_IN_PACKS, ("peak_torque",), coverage.ENVELOPE

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        pack = d.option(
            "pack",
            ("multi_plate", "disc"),
            "multi_plate",
            symbol="pk",
            text="Friction pack that the magnet presses: many plates in a drum, or one or two dry discs",
            source=f"{S4}, section 6.6",
            group="model",
        )
        layer_of = LAYERS[practice.declare_scope(d)]
        if pack == "disc":
            self._declare_disc(d, layer_of)
        else:
            self._declare_multi_plate(d, layer_of)

    def simulate(self, spec: Mapping[str, Any], design: Design) -> dict[str, pd.DataFrame]:
        """Return the start-up in time, and the temperature of the pack over repeated engagements.

        The torque rises in ``ramp_time``; the rise of the current is not simulated.
        """
        return startup_curves.startup_frames(self, spec, design)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Return the curves of pack and start-up; of a design torque over current and temperature, force over gap.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``startup_over_torque`` with ``torque_over_plates`` or ``diameter_over_lining``, and of a design
            ``torque_over_current``, ``torque_over_temperature``, ``force_over_gap`` and ``heat_balance``.
        """
        frames = {"startup_over_torque": startup_curves.startup_over_torque(self, spec, design)}
        if self.option("pack") == "disc":
            frames["diameter_over_lining"] = disc_curves.diameter_over_lining(self, spec)
        else:
            frames["torque_over_plates"] = pack_curves.torque_over_plates(self, spec, design)
        if design is not None:
            coil = magnet_curves.drawings(self, spec, design)
            frames["torque_over_current"] = magnet_curves.torque_over_current(coil, spec)
            frames["torque_over_temperature"] = coil.torque_over_temperature()
            frames["force_over_gap"] = magnet_curves.force_over_gap(self, spec, design)
            frames["heat_balance"] = coil.heat_balance()
        return frames

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through pack, armature and pot, with details of a lining and of the gap."""
        # Costly to import; searches do without.
        from ..drawing_parts import Sizes
        from . import drawing as magnet_drawing

        return magnet_drawing.DRAWINGS[self.option("pack"), self.option("mass_scope")](Sizes(spec, design))

    def _declare_multi_plate(self, d: Declaration, layer_of: type[Sources]) -> None:
        lubrication = plate_pack.declare_lubrication(d)
        options = d.block(MadePackOptions)
        duty = friction.declare_duty(
            d,
            cooling_default="oil_bath" if lubrication == "oil" else "still_air",
            lubrication=lubrication,
            kind=layer_of.plates.kind,
        )
        wants = plate_pack.declare_pack_requirements(d, duty=duty, lubrication=lubrication, kind=layer_of.plates.pack)
        pack_layer = layer_of.plates(d, PackHousing, lubrication, duty.required_torque)
        layer = layer_of(d, duty.required_torque, pack_layer.shaft)
        ring = declare_ring(d, ratio_min=pack_layer.ratio_min, ratio_max=0.25)
        magnet = layer.declare_magnet(d)
        ramp_time = friction.declare_ramp_time(d)
        pair = declare_friction_pair(d, suited=SUITED, duty=duty, lubrication=lubrication, linings=pack_layer.linings)
        pack = plate_pack.declare_pack(d, duty=duty, options=options, wants=wants, ring=ring)
        stack = plate_pack.Stack(duty, options, wants, ring, pair, pack)
        torque, torques = plate_pack.declare_pack_torques(
            d, stack, force=magnet.actuation_force, needs=(magnet_blocks.HOLDS,)
        )
        built = plate_pack.declare_pack_start(d, stack, torque=torque, torques=torques, ramp_time=ramp_time)
        plate_pack.declare_pack_temperature(d, built)
        pack_layer.judge_temperature(d, built)
        plate_pack.declare_drag(d, built)
        pack_layer.declare_body(d, built)
        pressed = Pressed(
            duty=duty,
            pair=pair,
            start=built.start,
            ramp_time=ramp_time,
            surfaces=pack.surfaces,
            gap=pack.gap,
            wear_depth=pack_layer.wear_depth(built),
            size=pack_layer.size(built),
            full_size=pack_layer.full_size(built),
            parts=pack.surfaces + 1,
            area=built.area,
            objective="drag_torque",
            offered=pack_layer.offered,
        )
        self._declare_magnet(d, layer=layer, magnet=magnet, pressed=pressed)
        plate_pack.declare_pack_remarks(d, options=options, lubrication=lubrication)

    def _declare_disc(self, d: Declaration, layer_of: type[Sources]) -> None:
        duty = friction.declare_duty(d, cooling_default="still_air", lubrication="dry", kind=layer_of.discs.kind)
        pack_layer = layer_of.discs(d, DiscHousing, duty)
        layer = layer_of(d, duty.required_torque, pack_layer.shaft)
        least, most = pack_layer.ring_ratios
        ring = declare_ring(d, ratio_min=least, ratio_max=most)
        pack = disc_pack.declare_disc_pack(d, duty=duty, ring=ring, wants=pack_layer.requirements(d))
        magnet = layer.declare_magnet(d)
        ramp_time = friction.declare_ramp_time(d)
        pair = declare_friction_pair(d, suited=SUITED, duty=duty, lubrication="dry", linings=pack_layer.linings)
        lined = disc_pack.LinedDiscs(duty, ring, pair, pack)
        start = disc_pack.declare_disc_start(
            d, lined, force=magnet.actuation_force, ramp_time=ramp_time, needs=(magnet_blocks.HOLDS,)
        )
        discs = disc_pack.Discs(**vars(lined), start=start, size=disc_pack.disc_size(lined))
        disc_pack.declare_disc_inertia(d, discs)
        disc_pack.declare_disc_temperature(d, discs)
        pack_layer.declare_body(d, discs)
        pack_layer.declare_rules(d, discs)
        pressed = Pressed(
            duty=duty,
            pair=pair,
            start=start,
            ramp_time=ramp_time,
            surfaces=pack.surfaces,
            gap=duty.plate_gap,
            wear_depth=pack_layer.wear_depth(discs),
            size=pack_layer.size(discs),
            full_size=pack_layer.full_size(discs),
            parts=2 * pack.discs + 2,
            area=discs.area,
            objective="disc_inertia",
            offered=(),
        )
        self._declare_magnet(d, layer=layer, magnet=magnet, pressed=pressed)

    def _declare_magnet(self, d: Declaration, *, layer: Sources, magnet: Magnet, pressed: Pressed) -> None:
        """Declare coil, size, cost and objectives."""
        pull = magnet_blocks.declare_pull(d, pressed, magnet)
        layer.limit_pull_in(d, magnet, pull)
        winding = magnet_blocks.declare_coil(d, pressed, magnet, pull)
        layer.limit_magnet(d, pressed, magnet, pull, winding)
        built = magnet_blocks.declare_magnet_size(d, pressed, magnet, pull, winding)
        self._declare_size(d, layer=layer, pressed=pressed, magnet=magnet, built=built)
        layer.declare_cost(d, pressed, magnet, built)
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "friction_surfaces",
            "coil_power",
            "surface_pressure",
            "peak_temperature_rise",
            "coil_temperature_rise",
            sized_by="torque_capacity",
        )
        for name in ("coil_power", "mass", "outer_diameter", "volume", "friction_work", pressed.objective):
            d.objective(name, default=name in layer.objectives)
        wear.offer_wear_life(d)
        for name in (*layer.offered, *pressed.offered):
            d.objective(name, default=False)

    def _declare_size(
        self, d: Declaration, *, layer: Sources, pressed: Pressed, magnet: Magnet, built: MagnetSize
    ) -> None:
        pack = pressed.size
        for name, value, symbol, text in (
            ("pack_diameter", pack.diameter, "D_pk", "Outside of the pack"),
            ("pack_room", pack.length, "L_room", "Length without the magnet"),
        ):
            d.step(name, "mm", value, symbol=symbol, text=text, source="geometry")
        magnet_blocks.name_length(d, magnet)
        size = friction.Size(
            mass=pack.mass + built.mass,
            diameter=2 * magnetics.larger(magnet.shape.outer_radius, pack.diameter / 2),
            length=pack.length + magnet.shape.length,
        )
        friction.declare_size(
            d, size=size, mass_of=layer.mass_of, outside="Outside of pack or magnet", along=layer.along
        )
        friction.declare_envelope(
            d, duty=pressed.duty, force=magnet.actuation_force, diameter=size.diameter, length=size.length
        )
