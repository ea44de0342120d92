"""Disc clutch: torque through one or two large dry discs between pressure plates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import friction, practice
from ..components.discs import curves as disc_curves
from ..components.discs import facing_sets
from ..components.discs import model as disc_pack
from ..components.discs.body import SpringHousing
from ..components.discs.layers import LAYERS
from ..components.lining import wear
from ..components.lining.model import declare_friction_pair
from ..components.ring.model import declare_ring
from ..duty import coverage
from ..friction import startup_curves
from ..sources import ARCHARD, DISC_RUN_OUT, DISC_WEAR, LIST_S0, LIST_S1, NEALE, S1, SHAFT, SHIGLEY_DISC

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing


class DiscClutch(DesignProblem):
    """Dry disc clutch with one or two discs, two friction surfaces each.

    Sizing and start-up follow S1; the worn-in capacity (uniform wear) is Shigley's.
    """

    name = "disc_clutch"
    title = "Disc clutch"
    sources = (LIST_S1, SHIGLEY_DISC, NEALE, LIST_S0, ARCHARD, DISC_WEAR, DISC_RUN_OUT, *SHAFT)
    simulation_settings = startup_curves.SETTINGS
    understands = (*friction.COMMON, "ambient_temperature", "heat_transfer", "plate_gap", "temperature_rise_limit")
    declines, disregards, as_limits = coverage.ENGAGED_DRY, ("peak_torque",), coverage.ENVELOPE

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        duty = friction.declare_duty(d, cooling_default="still_air", lubrication="dry", kind=layer_of.kind)
        layer = layer_of(d, SpringHousing, duty)
        least, most = layer.ring_ratios
        facings = facing_sets.declare_facing_set(d)
        ring = declare_ring(d, ratio_min=least, ratio_max=most, listed=facings)
        facing = None if facings is None else facing_sets.facing_of(facings)
        pack = disc_pack.declare_disc_pack(d, duty=duty, ring=ring, wants=layer.requirements(d), facing=facing)
        force = d.variable(
            "actuation_force",
            "N",
            50,
            200000,
            symbol="F0",
            text="Axial force of the springs on the pressure plate",
            source=f"{S1}, F",
        )
        ramp_time = friction.declare_ramp_time(d)
        pair = declare_friction_pair(
            d, suited=["'disc facing' in surfaces"], duty=duty, lubrication="dry", linings=layer.linings, take_up="soft"
        )
        lined = disc_pack.LinedDiscs(duty, ring, pair, pack)
        start = disc_pack.declare_disc_start(d, lined, force=force, ramp_time=ramp_time)
        if facings is not None:
            facing_sets.declare_set_limits(d, facings, pair=pair, pressure=force / ring.area)
        discs = disc_pack.Discs(**vars(lined), start=start, size=disc_pack.disc_size(lined))
        size = layer.size(discs)
        friction.declare_size(d, size=size, mass_of=layer.mass_of, outside="Outside of the cover", along=layer.along)
        layer.declare_body(d, discs)
        layer.declare_cost(d, discs)
        disc_pack.declare_disc_inertia(d, discs)
        disc_pack.declare_disc_temperature(d, discs)
        layer.declare_rules(d, discs)
        friction.declare_envelope(d, duty=duty, force=force, diameter=size.diameter, length=size.length)
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "discs",
            "actuation_force",
            "surface_pressure",
            "temperature_rise",
            sized_by="worn_torque_capacity",
        )
        d.objective("mass")
        d.objective("actuation_force")
        for name in ("outer_diameter", "length", "volume", "friction_work", "disc_inertia"):
            d.objective(name, default=False)
        wear.offer_wear_life(d)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through the released discs, with their hubs where the whole clutch is counted."""
        from . import drawing as disc_drawing  # costly to import; searches do without

        return disc_drawing.disc_drawing(spec, design)

    def simulate(self, spec: Mapping[str, Any], design: Design) -> dict[str, pd.DataFrame]:
        """Return the start-up in time, and the temperature of the pressure plates over repeated engagements."""
        return startup_curves.startup_frames(self, spec, design)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Return the size a torque needs and what starts cost; of a design pressure over radius, torque over force.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``diameter_over_lining``, ``startup_over_torque``, and of a design ``pressure_over_radius`` and
            ``torque_over_force``.
        """
        curves = {
            "diameter_over_lining": disc_curves.diameter_over_lining(self, spec),
            "startup_over_torque": startup_curves.startup_over_torque(self, spec, design),
        }
        if design is not None:
            curves["pressure_over_radius"] = disc_curves.pressure_over_radius(self, design)
            curves["torque_over_force"] = disc_curves.torque_over_force(self, spec, design)
        return curves
