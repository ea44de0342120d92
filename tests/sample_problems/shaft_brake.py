"""A small problem whose limits over a range are known in closed form, for tests of ratings and robust fronts."""

import numpy as np
import pandas as pd

import synth

PAIRS = pd.DataFrame(
    {
        "designation": ["firm", "soft"],
        "mu_dynamic [-]": [0.30, 0.40],
        "mu_static [-]": [0.33, 0.44],
        "mu_min [-]": [0.24, 0.20],
        "mu_max [-]": [0.36, 0.60],
        "pressure_allow [N/mm2]": [1.0, 1.2],
        "source": ["made up", "made up"],
    }
)
NEEDED = {"torque": "100 N*m", "speed": "1200 1/min"}
CATALOGS = {"pairs": PAIRS}
FACE = 0.004  # m2


class ShaftBrake(synth.DesignProblem):
    """A brake on a shaft: force against radius."""

    name, title = "shaft_brake", "Shaft brake"
    sources = ("statics",)

    def declare(self, d):
        switch = d.option("stop", ("none", "step"), "none")
        torque = d.requirement("torque", "N*m", lower=1, upper=1000, symbol="T")
        speed = d.requirement("speed", "1/min", lower=1, upper=10000, symbol="n")
        harshest = d.requirement("torque_limit", "N*m", lower=1, upper=2000, optional=True)
        room = d.requirement("ambient_temperature", "degC", 20, lower=-40, upper=100)
        wear = d.requirement("lining_wear", "mm", 2, lower=0, upper=10)
        radius = d.variable("radius", "mm", 20, 200, symbol="r")
        force = d.variable("force", "N", 100, 20000, symbol="F")
        pair = d.part("pair", "pairs")
        held = d.derive("braking_torque", "N*m", pair.mu_dynamic * force * (radius - wear))
        d.derive("size", "mm", 2 * radius)
        d.derive("worth", "-", pair.mu_static / pair.mu_dynamic)
        d.at_least("grip", held, torque, "N*m")
        d.at_most("pressure", force / FACE, pair.pressure_allow, "N/mm2")
        # Not monotone: resonance within 10 per cent of a speed that the radius sets.
        ratio = speed * radius / (0.1 * 40 * np.pi)
        d.at_most("hum", 1 / (0.002 + (ratio - 1) ** 2), 1 / (0.002 + 0.1**2), "-")
        d.at_most("warmth", room + force / 100, 273.15 + 250, "K")
        if switch == "step":
            d.at_most("step", np.where(speed > 130, 2.0 + force / 1e6, 1.0), 1.5, "-")
        if harshest is not None:
            d.at_most("harshness", pair.mu_static * force * radius, harshest, "N*m")
        d.objective("force")
        d.objective("size", default=True)
