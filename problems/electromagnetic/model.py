"""Electromagnetic clutch: a pot magnet with stationary coil presses the pack of a multi-plate or a disc clutch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from problems import friction
from problems.disc import curves as disc_curves
from problems.disc import pack as disc_pack
from problems.electromagnetic import curves as magnet_curves
from problems.electromagnetic import magnet as magnet_blocks
from problems.friction import startup_curves
from problems.mechanics import magnetics
from problems.mechanics import ring as ring_formulas
from problems.multi_plate import curves as pack_curves
from problems.multi_plate import pack as plate_pack
from problems.multi_plate.requirements import MadePackOptions
from problems.sources import S4
from synth import DesignProblem
from synth.declaration import Declaration

if TYPE_CHECKING:
    import pandas as pd


class ElectromagneticClutch(DesignProblem):
    """Friction clutch that an electromagnet engages, with the pack of a multi-plate or of a disc clutch.

    Instead of a given actuation force the magnet is sized with the pack: circuit, coil, heat, pull on the released
    armature. Only the idea of the magnet is the source's (S4); the model is derived.
    """

    name = "electromagnetic_clutch"
    title = "Electromagnetic clutch"
    sources = (
        "S4: notes on centrifugal clutches, figure 2-27: an electromagnet instead of clamp springs",
        "S0: B. Szoke, Engagement and release of the multi-plate clutch (in Hungarian), 1966; appendix by I. Lipka",
        "S1: lecture on friction clutches (cone, disc, multi-plate; start-up and heat)",
        "Ampere's law, Maxwell's force, Froehlich's saturation curve, steady heat balance",
        "Neale, Tribology Handbook, Tables 7.4 and 7.5",
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
        if pack == "disc":
            self._declare_disc(d)
        else:
            self._declare_multi_plate(d)
        d.objective("coil_power")
        d.objective("mass")
        extra = "disc_inertia" if pack == "disc" else "drag_torque"
        for name in ("outer_diameter", "volume", "friction_work", extra):
            d.objective(name, default=False)

    def simulate(self, spec: Mapping[str, Any], design: Any) -> dict[str, pd.DataFrame]:
        """Return the start-up in time, and the temperature of the pack over repeated engagements.

        The torque rises in ``ramp_time``; the rise of the current is not simulated.
        """
        return startup_curves.startup_frames(self, spec, design)

    def curves(self, spec: Mapping[str, Any], design: Any = None) -> dict[str, pd.DataFrame]:
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

    def _declare_multi_plate(self, d: Declaration) -> None:
        lubrication = plate_pack.declare_lubrication(d)
        duty = friction.declare_duty(
            d, cooling_default="oil_bath" if lubrication == "oil" else "still_air", lubrication=lubrication
        )
        options = d.block(MadePackOptions)
        wants = plate_pack.declare_pack_requirements(d, duty=duty, options=options, lubrication=lubrication)
        ring = friction.declare_ring(d, ratio_min=0.10, ratio_max=0.25)
        magnet = magnet_blocks.declare_magnet(d)
        ramp_time = friction.declare_ramp_time(d)
        pair = friction.declare_friction_pair(d, family=self.name, duty=duty, lubrication=lubrication)
        pack = plate_pack.declare_pack(d, duty=duty, options=options, wants=wants, ring=ring)
        required = friction.sizing_torque(duty, wants.surface_factor if options.guide_model == "cz" else 1.0)
        plate_pack.refuse_impossible_pack(
            d, duty=duty, options=options, wants=wants, ring=ring, pack=pack, required=required
        )
        torque = plate_pack.declare_pack_torque(
            d, options=options, wants=wants, ring=ring, pair=pair, pack=pack, force=magnet.actuation_force
        )
        needs = ("guide_jams", magnet_blocks.HOLDS)
        torques = friction.declare_torque(
            d, duty=duty, pair=pair, required=required, torque_low=torque.low, torque_high=torque.high, needs=needs
        )
        start = friction.declare_startup(d, duty=duty, torques=torques, ramp_time=ramp_time)
        area = pack.surfaces * ring.area
        rubbing = pack.aid.area_factor * area
        friction.declare_surface_loads(
            d,
            duty=duty,
            pair=pair,
            start=start,
            area=area,
            rubbing_area=rubbing,
            pressure=torque.pressure,
            rubbing_radius=ring.outer_radius,
        )
        size = plate_pack.pack_size(duty, wants, ring, pair, pack)
        plate_pack.declare_pack_temperature(d, duty=duty, pair=pair, start=start, size=size)
        plate_pack.declare_drag(d, duty=duty, wants=wants, ring=ring, pack=pack)
        self._declare_magnet_and_size(d, duty=duty, magnet=magnet, surfaces=pack.surfaces, start=start, pack=size)
        plate_pack.declare_pack_remarks(d, options=options, lubrication=lubrication)

    def _declare_disc(self, d: Declaration) -> None:
        duty = friction.declare_duty(d, cooling_default="still_air", lubrication="dry")
        ring = friction.declare_ring(d, ratio_min=0.11, ratio_max=0.13)
        pack = disc_pack.declare_disc_pack(d, duty=duty, ring=ring)
        magnet = magnet_blocks.declare_magnet(d)
        force = magnet.actuation_force
        ramp_time = friction.declare_ramp_time(d)
        pair = friction.declare_friction_pair(d, family=self.name, duty=duty, lubrication="dry")

        def torque(mu: Any) -> Any:
            return ring_formulas.friction_torque(mu, force, ring.friction_radius, pack.surfaces)

        required = friction.sizing_torque(duty)
        low, high = torque(pair.mu_low), torque(pair.mu_high)
        torques = friction.declare_torque(
            d, duty=duty, pair=pair, required=required, torque_low=low, torque_high=high, needs=(magnet_blocks.HOLDS,)
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
            rubbing_radius=ring.outer_radius,
        )
        size = disc_pack.disc_size(duty, ring, pair, pack)
        disc_pack.declare_disc_inertia(d, duty=duty, ring=ring, pair=pair, pack=pack)
        disc_pack.declare_disc_temperature(d, duty=duty, pair=pair, start=start, ring=ring, pack=pack, size=size)
        self._declare_magnet_and_size(d, duty=duty, magnet=magnet, surfaces=pack.surfaces, start=start, pack=size)

    def _declare_magnet_and_size(
        self,
        d: Declaration,
        *,
        duty: friction.Duty,
        magnet: magnet_blocks.Magnet,
        surfaces: Any,
        start: friction.Startup,
        pack: friction.Size,
    ) -> None:
        mass = magnet_blocks.declare_magnet_coil(
            d, duty=duty, magnet=magnet, surfaces=surfaces, friction_work=start.friction_work
        )
        size = friction.Size(
            mass=pack.mass + mass,
            diameter=2 * magnetics.larger(magnet.shape.outer_radius, pack.diameter / 2),
            length=pack.length + magnet.shape.length,
        )
        friction.declare_size(
            d,
            size=size,
            mass_of="Pack and magnet with armature and coil",
            outside="Outside of pack or magnet",
            across="the larger of both",
            along="Released pack and engaged magnet",
        )
        friction.declare_envelope(
            d, duty=duty, force=magnet.actuation_force, diameter=size.diameter, length=size.length
        )
