"""The speed reducer of Golinski (1970) as a problem of one's own: ``python examples/own_problem.py``."""

import numpy as np

import synth
from synth import DesignProblem

CM = 0.01  # symbols are SI, the literature is in cm: lengths are divided by CM, limits and weight are plain numbers


class SpeedReducer(DesignProblem):
    name, title, sources = "speed_reducer", "Speed reducer", ("Golinski, J. of Mechanisms 5 (1970) 287-309",)

    def declare(self, d):
        b = d.variable("face_width", "cm", 2.6, 3.6, symbol="b") / CM
        m = d.variable("module", "cm", 0.7, 0.8, symbol="m") / CM
        z = d.count("pinion_teeth", 17, 28, symbol="z")
        l1, l2 = (d.variable(f"bearing_distance_{k}", "cm", 7.3, 8.3, symbol=f"l{k}") / CM for k in (1, 2))
        d1 = d.variable("shaft_diameter_1", "cm", 2.9, 3.9, symbol="d1") / CM
        d2 = d.variable("shaft_diameter_2", "cm", 5.0, 5.5, symbol="d2") / CM
        d.at_least("tooth_bending", b * m**2 * z, 27, "-")
        d.at_least("tooth_contact", b * m**2 * z**2, 397.5, "-")
        for k, span, shaft, torsion, allowed in ((1, l1, d1, 16.9e6, 1100), (2, l2, d2, 157.5e6, 850)):
            stress = np.sqrt((745 * span / (m * z)) ** 2 + torsion) / (0.1 * shaft**3)
            d.at_most(f"deflection_{k}", 1.93 * span**3 / (m * z * shaft**4), 1, "-")
            d.at_most(f"stress_{k}", stress, allowed, "-")
        d.at_most("pinion_diameter", m * z, 40, "-")
        d.at_least("face_ratio_min", b / m, 5, "-")
        d.at_most("face_ratio_max", b / m, 12, "-")
        d.at_least("room_1", l1, 1.5 * d1 + 1.9, "-")
        d.at_least("room_2", l2, 1.1 * d2 + 1.9, "-")
        gears = 0.7854 * b * m**2 * (3.3333 * z**2 + 14.9334 * z - 43.0934) - 1.508 * b * (d1**2 + d2**2)
        d.derive("weight", "-", gears + 7.4777 * (d1**3 + d2**3) + 0.7854 * (l1 * d1**2 + l2 * d2**2))
        d.objective("weight")


front = synth.synthesize(SpeedReducer, {}, gap=1e-5)
print(front.to_frame().filter(like=" [").T.to_string(header=False, float_format="{:.5f}".format))
print("binding:", ", ".join(name for name, used in front.designs[0].utilisation.items() if used > 1 - 1e-5))
print("elasticity:", {name: round(x, 3) for name, x in front.designs[0].elasticity["weight"].items()})
