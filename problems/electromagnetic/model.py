"""Electromagnetic clutch: a pot magnet with stationary coil presses the pack of a multi-plate or a disc clutch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import cost, friction, practice, wear
from ..disc import body as disc_body
from ..disc import curves as disc_curves
from ..disc import pack as disc_pack
from ..friction import startup_curves
from ..mechanics import magnetics
from ..mechanics import ring as ring_formulas
from ..multi_plate import body as plate_body
from ..multi_plate import curves as pack_curves
from ..multi_plate import pack as plate_pack
from ..multi_plate.requirements import MadePackOptions, PackBodyRequirements, PackRules
from ..sources import (
    ARCHARD,
    DISC_RUN_OUT,
    DISC_WEAR,
    LIST_S0,
    LIST_S1,
    NEALE,
    PLATES_IN_USE,
    S1,
    S4,
    SHAFT,
    SHIGLEY_DISC,
)
from . import curves as magnet_curves
from . import magnet as magnet_blocks

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing


MAGNET_PARTS = 3  # pot, armature and coil
# Pairs on a flat face, as built today; no bare cast iron.
SUITED = ("'disc facing' in surfaces or 'plate pack' in surfaces", "status in ('current', '')", "lining != 'cast iron'")
WEAR_AT_MAGNET = 0.3  # mm, default of wear_depth_limit of dry linings: a magnet does not reach over more


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
        scope = practice.declare_scope(d)
        if pack == "disc":
            self._declare_disc(d, scope=scope)
        else:
            self._declare_multi_plate(d, scope=scope)
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
        # Least power asks for ever larger magnets; with the rules of practice the supply limits it, and size counts.
        d.objective("coil_power", default=not scope.rules)
        d.objective("mass")
        d.objective("outer_diameter", default=scope.rules)
        extra = "disc_inertia" if pack == "disc" else "drag_torque"
        for name in ("volume", "friction_work", extra):
            d.objective(name, default=False)
        if scope.rules or scope.complete:
            wear.offer_wear_life(d)
            d.objective("length", default=False)
            if pack == "multi_plate":
                d.objective("inner_inertia", default=False)

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
        from . import drawing as magnet_drawing  # costly to import; searches do without

        complete = self.option("mass_scope") == "complete"
        if self.option("pack") == "disc":
            return magnet_drawing.disc_magnet_drawing(spec, design, complete=complete)
        return magnet_drawing.plate_magnet_drawing(spec, design, complete=complete)

    def _declare_multi_plate(self, d: Declaration, *, scope: practice.Scope) -> None:
        lubrication = plate_pack.declare_lubrication(d)
        duty = friction.declare_duty(
            d,
            cooling_default="oil_bath" if lubrication == "oil" else "still_air",
            lubrication=lubrication,
            kind=friction.DutyOfPack if scope.rules else friction.Duty,
        )
        options = d.block(MadePackOptions)
        wants = plate_pack.declare_pack_requirements(
            d, duty=duty, options=options, lubrication=lubrication, rules=scope.rules
        )
        required = friction.sizing_torque(duty, wants.surface_factor if options.guide_model == "cz" else 1.0)
        body_wants = rules = coil_rules = seat = None
        if scope.rules or scope.complete:
            body_wants = d.block(
                PackBodyRequirements,
                shaft_diameter=practice.shaft_for(required),
                wear_depth_limit=0.2 if lubrication == "oil" else WEAR_AT_MAGNET,
            )
            practice.declare_shaft(d, body_wants, diameter=body_wants.shaft_diameter, torque=required)
        if scope.rules:
            oil = lubrication == "oil"
            rules = d.block(PackRules, friction_surfaces_max=12 if oil else 8, release_gap_min=0.05 if oil else 0.3)
            coil_rules = magnet_blocks.declare_magnet_rules(d)
            if body_wants is not None:
                seat = magnet_blocks.Seat(required, body_wants.shaft_diameter, body_wants.hub_diameter)
        ring = friction.declare_ring(d, ratio_min=0.15 if scope.rules else 0.10, ratio_max=0.25)
        magnet = magnet_blocks.declare_magnet(d, seat=seat)
        ramp_time = friction.declare_ramp_time(d)
        pair = friction.declare_friction_pair(d, suited=SUITED, duty=duty, lubrication=lubrication, rules=scope.rules)
        pack = plate_pack.declare_pack(d, duty=duty, options=options, wants=wants, ring=ring)
        torque, torques = plate_pack.declare_pack_torques(
            d,
            duty=duty,
            options=options,
            wants=wants,
            ring=ring,
            pair=pair,
            pack=pack,
            required=required,
            force=magnet.actuation_force,
            needs=(magnet_blocks.HOLDS,),
        )
        start, area = plate_pack.declare_pack_start(
            d, duty=duty, ring=ring, pair=pair, pack=pack, torque=torque, torques=torques, ramp_time=ramp_time
        )
        size = plate_pack.pack_size(duty, wants, ring, pair, pack)
        plate_pack.declare_pack_temperature(d, duty=duty, pair=pair, start=start, size=size, rules=scope.rules)
        drag = plate_pack.declare_drag(d, duty=duty, wants=wants, ring=ring, pack=pack)
        body = habits = None
        if body_wants is not None:
            body = plate_body.body_at_magnet(
                duty=duty, wants=body_wants, pack_wants=wants, ring=ring, pack=pack, pack_size=size
            )
            plate_body.declare_body(
                d,
                duty=duty,
                pack_wants=wants,
                ring=ring,
                pair=pair,
                pack=pack,
                start=start,
                body=body,
                pack_size=size,
            )
            if rules is not None and coil_rules is not None:
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
                    cooled_area=size.cooled_area,
                )
                depth = plate_body.wear_depth(body_wants, pair, pack)
                habits = magnet_blocks.Practice(rules=coil_rules, wear_depth=depth, ramp_time=ramp_time)
        built = magnet_blocks.declare_magnet_coil(
            d,
            duty=duty,
            magnet=magnet,
            surfaces=pack.surfaces,
            gap=pack.gap,
            friction_work=start.friction_work,
            practice=habits,
        )
        whole = size if body is None or not scope.complete else body.size
        self._declare_size(d, scope=scope, duty=duty, magnet=magnet, built=built, pack=whole)
        if body is not None:
            self._declare_cost(
                d, magnet=magnet, built=built, mass=body.size.mass, parts=pack.surfaces + 1, pair=pair, area=area
            )
        plate_pack.declare_pack_remarks(d, options=options, lubrication=lubrication)

    def _declare_disc(self, d: Declaration, *, scope: practice.Scope) -> None:
        duty = friction.declare_duty(
            d,
            cooling_default="still_air",
            lubrication="dry",
            kind=friction.DutyOfDiscs if scope.rules else friction.Duty,
        )
        required = friction.sizing_torque(duty)
        body_wants = wants = rules = coil_rules = seat = None
        if scope.rules or scope.complete:
            body_wants = disc_body.declare_body_requirements(d, required=required, wear_depth_limit=WEAR_AT_MAGNET)
            wants = disc_body.declare_disc_requirements(d, body=body_wants)
        if scope.rules:
            rules = d.block(disc_body.DiscRules)
            coil_rules = magnet_blocks.declare_magnet_rules(d)
            if body_wants is not None:
                seat = magnet_blocks.Seat(required, body_wants.shaft_diameter, body_wants.hub_diameter)
        least, most = (0.17, 0.28) if scope.rules else (0.11, 0.13)
        ring = friction.declare_ring(d, ratio_min=least, ratio_max=most)
        pack = disc_pack.declare_disc_pack(
            d, duty=duty, ring=ring, wants=d.block(disc_pack.DiscRequirements) if wants is None else wants
        )
        magnet = magnet_blocks.declare_magnet(d, seat=seat)
        force = magnet.actuation_force
        ramp_time = friction.declare_ramp_time(d)
        pair = friction.declare_friction_pair(d, suited=SUITED, duty=duty, lubrication="dry", rules=scope.rules)

        def torque(mu: Any) -> Any:
            return ring_formulas.friction_torque(mu, force, ring.friction_radius, pack.surfaces)

        low, high = torque(pair.mu_low), torque(pair.mu_high)
        torques = friction.declare_torque(
            d,
            duty=duty,
            pair=pair,
            required=required,
            torque_low=low,
            torque_high=high,
            source=f"{S1}, sizing",
            needs=(magnet_blocks.HOLDS,),
        )
        disc_pack.declare_worn_torque(d, pair=pair, torques=torques, ring=ring, pack=pack, force=force)
        start = friction.declare_startup(d, duty=duty, torques=torques, ramp_time=ramp_time)
        area = pack.surfaces * ring.area
        friction.declare_surface_loads(
            d,
            duty=duty,
            pair=pair,
            start=start,
            area=area,
            rubbing_area=area,
            pressure=force / ring.area,
            pressure_source=f"{S1}, p",
            rubbing_radius=ring.outer_radius,
        )
        size = disc_pack.disc_size(duty, ring, pair, pack)
        discs = disc_pack.Discs(duty, ring, pair, pack, start, size)
        disc_pack.declare_disc_inertia(d, discs)
        disc_pack.declare_disc_temperature(d, discs)
        body = habits = None
        if body_wants is not None:
            body = disc_body.body_at_magnet(discs, body_wants)
            disc_body.declare_body(d, discs, body)
            if rules is not None and coil_rules is not None:
                disc_body.declare_rules(d, discs, rules)
                habits = magnet_blocks.Practice(
                    rules=coil_rules, wear_depth=disc_body.wear_depth(body_wants, discs), ramp_time=ramp_time
                )
        built = magnet_blocks.declare_magnet_coil(
            d,
            duty=duty,
            magnet=magnet,
            surfaces=pack.surfaces,
            gap=duty.plate_gap,
            friction_work=start.friction_work,
            practice=habits,
        )
        whole = size if body is None or not scope.complete else body.size
        self._declare_size(d, scope=scope, duty=duty, magnet=magnet, built=built, pack=whole)
        if body is not None:
            self._declare_cost(
                d, magnet=magnet, built=built, mass=body.size.mass, parts=2 * pack.discs + 2, pair=pair, area=area
            )

    def _declare_size(
        self,
        d: Declaration,
        *,
        scope: practice.Scope,
        duty: friction.Duty,
        magnet: magnet_blocks.Magnet,
        built: magnet_blocks.MagnetSize,
        pack: friction.Size,
    ) -> None:
        for name, value, symbol, text in (
            ("pack_diameter", pack.diameter, "D_pk", "Outside of the pack"),
            ("pack_room", pack.length, "L_room", "Length without the magnet"),
            ("magnet_length", magnet.shape.length, "L_mag", "Engaged magnet: pot, gap and armature"),
        ):
            d.step(name, "mm", value, symbol=symbol, text=text, source="geometry")
        size = friction.Size(
            mass=pack.mass + built.mass,
            diameter=2 * magnetics.larger(magnet.shape.outer_radius, pack.diameter / 2),
            length=pack.length + magnet.shape.length,
        )
        friction.declare_size(
            d,
            size=size,
            mass_of="The whole clutch" if scope.complete else "Pack and magnet with armature and coil",
            outside="Outside of pack or magnet",
            along="The whole clutch" if scope.complete else "Released pack and engaged magnet",
        )
        friction.declare_envelope(
            d, duty=duty, force=magnet.actuation_force, diameter=size.diameter, length=size.length
        )

    def _declare_cost(
        self,
        d: Declaration,
        *,
        magnet: magnet_blocks.Magnet,
        built: magnet_blocks.MagnetSize,
        mass: Any,
        parts: Any,
        pair: friction.Pair,
        area: Any,
    ) -> None:
        wire = magnet.unknowns.winding_wire
        coil = cost.Special("copper", wire, amount=built.copper, mass=built.copper, pieces=1, factor=cost.COPPER)
        cost.declare_cost(
            d, mass=mass + built.mass, parts=parts + MAGNET_PARTS, lining=(pair.part, area), special=[coil]
        )
