"""Disc clutch: torque through one or two large dry discs between pressure plates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from problems import blocks, startup_hook
from problems.mechanics import disc
from problems.mechanics import ring as ring_formulas
from synth import DesignProblem
from synth.declaration import Declaration

if TYPE_CHECKING:
    import pandas as pd

LININGS_SHOWN = (0.02, 0.4)  # friction times allowed pressure [N/mm2], about from wet to ceramic linings


class DiscClutch(DesignProblem):
    """Dry disc clutch with one or two discs, two friction surfaces each.

    Sizing and start-up follow S1; the worn-in capacity (uniform wear) is Shigley's.
    """

    name = "disc_clutch"
    title = "Disc clutch"
    sources = (
        "S1: lecture on friction clutches (cone, disc, multi-plate; start-up and heat)",
        "Shigley, Mechanical Engineering Design, disc clutch: uniform pressure and uniform wear",
        "Neale, Tribology Handbook, Tables 7.4 and 7.5",
    )
    simulation_settings = startup_hook.SETTINGS

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        duty = blocks.declare_duty(d, "still_air", "dry")
        ring = blocks.declare_ring(d, 0.11, 0.13)
        pack = blocks.declare_disc_pack(d, duty, ring)
        force = d.variable(
            "actuation_force", "N", 50, 200000, symbol="F0",
            text="Axial force of the springs on the pressure plate", source="S1 (lecture on friction clutches), F",
        )  # fmt: skip
        ramp_time = blocks.declare_ramp_time(d)
        pair = blocks.declare_friction_pair(d, self.name, duty, "dry")

        def torque(mu: Any) -> Any:
            return ring_formulas.friction_torque(mu, force, ring.friction_radius, pack.surfaces)

        required = blocks.sizing_torque(duty)
        torques = blocks.declare_torque(d, duty, pair, required, torque(pair.mu_low), torque(pair.mu_high))
        blocks.declare_worn_torque(d, pair, torques, ring, pack, force)
        start = blocks.declare_startup(d, duty, torques, ramp_time)
        area = pack.surfaces * ring.area
        blocks.declare_surface_loads(d, duty, pair, start, area, area, force / ring.area, ring.outer_radius)
        size = blocks.disc_size(duty, ring, pair, pack)
        blocks.declare_size(
            d, size, "Pressure plates, linings and cores, without flywheel, springs and cover",
            "Outside of the cover",
            "2 (r2 + s_cover)",
            "Length of the released discs and pressure plates, without flywheel, springs and cover",
        )  # fmt: skip
        blocks.declare_disc_inertia(d, duty, ring, pair, pack)
        blocks.declare_disc_temperature(d, duty, pair, start, ring, pack, size)
        blocks.declare_envelope(d, duty, force, size.diameter, size.length)
        d.objective("mass")
        d.objective("actuation_force")
        for name in ("outer_diameter", "volume", "friction_work", "disc_inertia"):
            d.objective(name, default=False)

    def simulate(self, spec: Mapping[str, Any], design: Any) -> dict[str, pd.DataFrame]:
        """Return the start-up in time, and the temperature of the pressure plates over repeated engagements."""
        # The hottest plate takes its share of the work at the rise of one engagement.
        hottest = disc.HOTTEST_PLATE_SHARE * design.values["friction_work"] / design.values["temperature_rise"]
        return startup_hook.startup_frames(self, spec, design, hottest * design.values["discs"])

    def curves(self, spec: Mapping[str, Any], design: Any = None) -> dict[str, pd.DataFrame]:
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
            "diameter_over_lining": self._diameter_over_lining(spec),
            "startup_over_torque": startup_hook.startup_over_torque(self, spec, design),
        }
        if design is not None:
            curves["pressure_over_radius"] = self._pressure_over_radius(design)
            curves["torque_over_force"] = self._torque_over_force(spec, design)
        return curves

    def _diameter_over_lining(self, spec: Mapping[str, Any]) -> pd.DataFrame:
        import pandas as pd

        grip = np.geomspace(*LININGS_SHOWN, 121) * 1e6
        required = blocks.sizing_torque_of(spec)
        columns = {"friction times allowed pressure [N/mm2]": grip / 1e6}
        lines: list[dict[str, Any]] = []
        for discs, words in ((1, "one disc"), (2, "two discs")):
            for name, short in (("ring_ratio_min", "narrow"), ("ring_ratio_max", "wide")):
                ratio = spec[name]
                mean = ring_formulas.sizing_mean_diameter(required, disc.surface_count(discs), 1.0, grip, ratio)
                columns[f"{words}, {short} ring [mm]"] = ring_formulas.outer_diameter(mean, ratio) * 1e3
        names = [name for name in columns if name.endswith("[mm]")]
        if spec["outer_diameter_limit"] is not None:
            room = (spec["outer_diameter_limit"] - 2 * spec["cover_gap"]) * 1e3
            lines.append({"panel": 0, "y": room, "label": "outer_diameter_limit less cover_gap"})
        frame = pd.DataFrame(columns)
        frame.attrs = {
            "title": f"Disc clutch: outer diameter of the friction ring for {required:.4g} N*m",
            "panels": [{"label": "ring outer diameter [mm]", "columns": names}],
            "lines": lines,
            "source": "S1 (lecture on friction clutches), sizing for pressure",
        }
        return frame

    def _pressure_over_radius(self, design: Any) -> pd.DataFrame:
        import pandas as pd

        value = design.values
        mean, ratio = value["mean_diameter"], value["ring_ratio"]
        radius = np.linspace(value["ring_inner_diameter"], value["ring_outer_diameter"], 101) / 2
        worn = disc.worn_pressure(value["actuation_force"], mean, ratio, radius)
        frame = pd.DataFrame({
            "radius [mm]": radius * 1e3,
            "new lining [N/mm2]": np.full_like(radius, value["surface_pressure"]) / 1e6,
            "worn-in lining [N/mm2]": worn / 1e6,
        })  # fmt: skip
        frame.attrs = {
            "title": "Disc clutch: pressure on the lining",
            "panels": [{"label": "pressure [N/mm2]", "columns": list(frame.columns[1:])}],
            "marks": [
                {"x": value["friction_radius"] * 1e3, "label": "friction radius, new"},
                {"x": mean / 2 * 1e3, "label": "friction radius, worn in"},
            ],
            "lines": [{"panel": 0, "y": design.parts["friction_pair"]["p_allow"] / 1e6, "label": "p_allow"}],
            "source": "uniform pressure; Shigley, Mechanical Engineering Design, uniform wear",
        }
        return frame

    def _torque_over_force(self, spec: Mapping[str, Any], design: Any) -> pd.DataFrame:
        import pandas as pd

        value = design.values
        share = np.linspace(0.0, 1.4, 141)
        frame = pd.DataFrame({
            "axial force [N]": share * value["actuation_force"],
            "new lining [N*m]": share * value["torque"],
            "worn-in lining [N*m]": share * value["worn_torque"],
            "pressure, new lining [N/mm2]": share * value["surface_pressure"] / 1e6,
        })  # fmt: skip
        lines: list[dict[str, Any]] = [
            {"panel": 0, "y": value["required_torque"], "label": "sizing torque"},
            {"panel": 0, "y": spec["load_torque"], "label": "load torque"},
            {"panel": 1, "y": design.parts["friction_pair"]["p_allow"] / 1e6, "label": "p_allow"},
        ]
        given = [name for name in ("startup_torque", "overload_torque") if spec[name] is not None]
        lines += [{"panel": 0, "y": spec[name], "label": name} for name in given]
        frame.attrs = {
            "title": "Disc clutch: torque over the force on the pressure plate",
            "panels": [
                {"label": "torque [N*m]", "columns": ["new lining [N*m]", "worn-in lining [N*m]"]},
                {"label": "pressure [N/mm2]", "columns": ["pressure, new lining [N/mm2]"]},
            ],
            "marks": [{"x": value["actuation_force"], "label": "F0"}],
            "lines": lines,
            "source": "S1 (lecture on friction clutches); Shigley, Mechanical Engineering Design, uniform wear",
        }
        return frame
