"""The tension spring of Belegundu: three continuous variables, four limits, flat near its optimum."""

from synth import DesignProblem

OPTIMUM = 0.012665233  # of the literature, for the lightest spring


class TensionSpring(DesignProblem):
    """Least mass of a tension spring; lengths in inches as plain numbers, as the source has them.

    A. D. Belegundu: A study of mathematical programming methods for structural optimization, University of Iowa 1982;
    J. S. Arora: Introduction to Optimum Design, McGraw-Hill 1989, example 3.7.
    """

    name, title, sources = "tension_spring", "Tension spring", ("Belegundu 1982", "Arora 1989")

    def declare(self, d):
        wire = d.variable("wire", "-", 0.05, 2.0)
        coil = d.variable("coil", "-", 0.25, 1.3)
        turns = d.variable("turns", "-", 2.0, 15.0)
        d.at_least("deflection", coil**3 * turns, 71785 * wire**4, "-")
        bending = (4 * coil**2 - wire * coil) / (12566 * (coil * wire**3 - wire**4))
        d.at_most("shear", bending + 1 / (5108 * wire**2), 1, "-")
        d.at_least("surge", 140.45 * wire, coil**2 * turns, "-")
        d.at_most("outer_diameter", coil + wire, 1.5, "-")
        d.derive("volume", "-", (turns + 2) * coil * wire**2)
        d.objective("volume")
