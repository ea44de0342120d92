"""State of a centrifugal clutch at a speed: where flyweights and plate stand, what presses, what can be carried."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design
from synth.declaration import Setting

from ..mechanics import centrifugal
from . import lever_curves
from .curves import MM, RPM, S4, SPEED_AXIS, Path
from .levers import RECONSTRUCTED

if TYPE_CHECKING:
    import pandas as pd

    from ..mechanics.lever_motion import ReversedLever, RodLever

OPERATING_POINT: Mapping[str, Setting] = {"speed": Setting("speed of the driving side", unit="1/min")}
UP, DOWN = "speeding up", "slowing down"


@dataclass(frozen=True)
class Balance:
    """Where flyweights stand at a speed: the stretch between two knots, the position and the force they exert."""

    stretch: int
    position: float
    force: float


def balance(knots: Sequence[tuple[float, float]], force_at: Callable[[float], float], outward: bool) -> Balance:
    """Positions of the flyweights at which their force equals what holds them.

    Speeding up they leave a position as soon as they exceed what holds them there, so that they stand at the first
    position that balances, seen from rest; slowing down at the first one seen from the end. The two differ where the
    motion jumps.

    Parameters
    ----------
    knots : sequence of (force, position)
        What holds the flyweights [N] where a stretch ends and the next begins; between them it is linear.
    force_at : callable
        What the flyweights exert at a position and this speed [N]; linear in the position.
    outward : bool
        Whether the speed is reached from below.

    Examples
    --------
    A spring of 100 N that takes 300 N after 2 mm, and weights that exert 150 N at rest and 200 N after 2 mm:

    >>> balance([(100, 0), (300, 0.002)], lambda x: 150 + 25e3 * x, True)
    Balance(stretch=1, position=0.0006666666666666666, force=166.66666666666666)
    """
    excess = [force_at(position) - force for force, position in knots]
    last = len(knots) - 1
    order = range(last + 1) if outward else range(last, -1, -1)
    for k in order:
        stops = excess[k] <= 0 if outward else excess[k] >= 0
        if not stops:
            continue
        if (outward and k == 0) or (not outward and k == last):
            return Balance(0 if outward else last + 1, knots[k][1], force_at(knots[k][1]))
        low = k - 1 if outward else k
        share = excess[low] / (excess[low] - excess[low + 1])
        position = knots[low][1] + share * (knots[low + 1][1] - knots[low][1])
        return Balance(low + 1, position, force_at(position))
    end = last if outward else 0
    return Balance(last + 1 if outward else 0, knots[end][1], force_at(knots[end][1]))


def of_path(spec: Mapping[str, Any], path: Path, speed: float) -> pd.DataFrame:
    """Return the state of a clutch with balls or plain levers at a speed, reached from below and from above.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    path : Path
        The regimes of the design.
    speed : float
        [rad/s]
    """
    rows = []
    for course, efficiency in ((UP, path.outward), (DOWN, path.inward)):
        returns = math.isfinite(efficiency) and efficiency > 0

        def push(travel: float, efficiency: float = efficiency) -> float:
            return float(path.force(speed, travel, efficiency))

        found = balance(path.knots, push, course == UP) if returns else Balance(0, math.nan, math.nan)
        force, travel = np.array([found.force]), np.array([found.position])
        pull = centrifugal.centrifugal_force(path.mass, path.radius(found.position), speed)
        columns = {name: float(values[0]) for name, values in path.columns(force, travel).items()}
        regime = path.regimes[found.stretch] if returns else "held out: the flyweights do not come back"
        radius = path.radius(found.position) / MM
        rows.append(
            {
                "course": course,
                "regime": regime,
                SPEED_AXIS: speed / RPM,
                "centrifugal force [N]": float(pull),
                "axial force [N]": found.force,
                **columns,
                "radius [mm]": float(radius),
            }
        )
    return _frame(spec, rows, S4)


def of_lever(spec: Mapping[str, Any], design: Design, kind: lever_curves.LeverKind, speed: float) -> pd.DataFrame:
    """Return the state of a clutch whose levers clamp by springs, with new and with worn linings.

    Where the levers jump, the speed is reached from below and from above.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    design : Design
        Values and parts in SI.
    kind : LeverKind
        Of the family.
    speed : float
        [rad/s]
    """
    rows, lever = [], kind.lever(spec, design)
    for words, one in (("new linings", lever), ("worn linings", lever_curves.worn(lever, spec))):
        borders, contact = one.borders(), one.contact_angle
        knots = list(zip(borders.forces, (0.0, contact, contact, one.stop_angle), strict=True))

        def pull(angle: float, one: RodLever | ReversedLever = one) -> float:
            return float(centrifugal.centrifugal_force(one.mass, one.radius(angle), speed))

        courses = {f"{words}, {UP}": True, f"{words}, {DOWN}": False} if borders.snaps else {words: True}
        for course, outward in courses.items():
            found = balance(knots, pull, outward)
            stretch, angle, force = (np.array([x]) for x in (found.stretch, found.position, found.force))
            motion = one.along((stretch, angle, force))
            columns = {name: float(v[0]) for name, v in lever_curves.columns_of(motion, design, kind.own).items()}
            rows.append({"course": course, "regime": kind.regimes[found.stretch], **columns})
    return _frame(spec, rows, RECONSTRUCTED)


def _frame(spec: Mapping[str, Any], rows: Sequence[dict[str, Any]], source: str) -> pd.DataFrame:
    """Return the rows as a frame, with the torque beside what is asked of the clutch."""
    import pandas as pd

    for row in rows:
        row["torque over required_torque [-]"] = row["torque [N*m]"] / spec["required_torque"]
    frame = pd.DataFrame(list(rows))
    frame.attrs["source"] = source
    return frame
