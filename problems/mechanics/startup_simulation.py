"""Start-up of a driven inertia through a slipping clutch, integrated in time.

What the closed forms of :mod:`synth.problems.mechanics.startup` leave out is here: a driver of finite inertia with a
motor curve, any course of the ramp, lock-up that is lost again, a driver that stalls, heat that piles up.

Equations of motion (S1, lecture): M1 - M_k = J1 domega1/dt (1) and M_k - M2 = J2 domega2/dt (2). While the clutch
slips, M_k is what the ramp gives, in the direction of slip; locked, it is what both sides need to keep one speed.
Clutch (slipping, locked), load (at rest, turning) and ramp (its corners) make smooth pieces; the integration ends at
the event that closes a piece and starts afresh behind it, so that no step ever crosses a kink.

Numbers only, SI.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from synth.errors import InputError
from synth.text.numbers import number_text, typed_number

from .startup import LOAD_KINDS

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "LOADS",
    "RAMP_SHAPES",
    "DriverTorque",
    "Event",
    "Ramp",
    "StartupRun",
    "SwitchingRun",
    "simulate_startup",
    "simulate_switching",
]

Ramp: TypeAlias = str | Sequence[tuple[float, float]] | Callable[[float], float]
DriverTorque: TypeAlias = float | Callable[[float], float]

RAMP_SHAPES = ("linear", "smooth")
LOADS = (*LOAD_KINDS, "inertia")
_TO_RPM = 30 / math.pi

# Relative accuracy of the integration. Torques that differ by less than _SAME count as equal where a piece could
# otherwise open and close again without end.
_ACCURACY, _SAME = 1e-10, 1e-12
_ROWS = 400  # rows of the frame per run, events apart
_MOST_PIECES = 2000

_SPEED_1, _SPEED_2, _WORK_1, _WORK_2, _FRICTION = range(
    5
)  # the state: both speeds, works of driver and load, friction work


@dataclass(frozen=True)
class Event:
    """Something that changes the equations: when, and what."""

    time: float
    name: str


@dataclass(frozen=True)
class _Mode:
    """What is so within one smooth piece.

    ``slip`` is the sign of omega1 - omega2, 0 when locked; ``motion`` the sign of omega2 of a reactive load, 0 at rest,
    and for an active load whether the clutch carries it already.
    """

    slip: int
    motion: int
    phase: str


@dataclass(frozen=True)
class _Piece:
    """One smooth piece: where it reaches from and to, and the state inside."""

    mode: _Mode
    start: float
    end: float
    state: Callable[[Any], Any]


@dataclass(frozen=True)
class _Question:
    """What is integrated; all SI."""

    torque: float
    ramp_time: float
    load_torque: float
    driven_inertia: float
    driver_speed: float
    load_kind: str
    corners: tuple[float, ...]
    ramp: Callable[[float], float]
    driver_inertia: float
    driver_torque: Callable[[float], float] | None
    hold: float

    @property
    def stands(self) -> bool:
        """Whether the load can stand still by itself."""
        return self.load_kind == "reactive" and self.load_torque > 0

    def capacity(self, time: float) -> float:
        """Torque that the slipping clutch transmits."""
        if time >= self.ramp_time:
            return self.torque
        return self.torque * self.ramp(time / self.ramp_time)

    def torques(self, mode: _Mode, time: float, state: Any) -> tuple[float, float, float]:
        """Return M1, M_k and M2 within a piece."""
        load = self.load_torque * (mode.motion if self.load_kind == "reactive" else 1)
        if mode.slip == 0:
            driver = load if self.driver_torque is None else self.driver_torque(state[_SPEED_1])
            share = 0.0 if self.driver_torque is None else self.driven_inertia / self._both
            return driver, load + share * (driver - load), load
        clutch = mode.slip * self.capacity(time)
        if self.stands and mode.motion == 0:
            load = clutch
        return clutch if self.driver_torque is None else self.driver_torque(state[_SPEED_1]), clutch, load

    @property
    def _both(self) -> float:
        return self.driver_inertia + self.driven_inertia

    def accelerations(self, mode: _Mode, driver: float, clutch: float, load: float) -> tuple[float, float]:
        """Return the accelerations of driver and load."""
        if mode.slip == 0:
            common = 0.0 if self.driver_torque is None else (driver - load) / self._both
            return common, common
        second = (clutch - load) / self.driven_inertia
        return (0.0 if self.driver_torque is None else (driver - clutch) / self.driver_inertia), second

    def rates(self, mode: _Mode, time: float, state: Any) -> list[float]:
        """Return the derivative of the state."""
        driver, clutch, load = self.torques(mode, time, state)
        first, second = self.accelerations(mode, driver, clutch, load)
        slip = state[_SPEED_1] - state[_SPEED_2] if mode.slip else 0.0
        return [first, second, driver * state[_SPEED_1], load * state[_SPEED_2], clutch * slip]


@dataclass(frozen=True)
class StartupRun:
    """A start-up in time. All SI.

    ``outcome`` is locked, slipping (the time was up) or stalled. ``slip_time`` is the time of the first lock-up
    (not-a-number without one), ``friction_work`` counts to the end of the run, ``hold_reserve`` is the least static
    torque over the torque carried while locked (not-a-number where the run ends with lock-up), ``keeps_load`` tells
    whether the driver can carry the load on after lock-up.
    """

    outcome: str
    slip_time: float
    friction_work: float
    peak_slip_power: float
    lock_speed: float
    greatest_acceleration: float
    lowest_driven_speed: float
    hold_reserve: float
    keeps_load: bool
    driver_work: float
    load_work: float
    kinetic_work: float
    end: float
    events: tuple[Event, ...]
    question: _Question = field(repr=False)
    pieces: tuple[_Piece, ...] = field(repr=False)

    def phases(self) -> list[tuple[float, float, str]]:
        """Return beginning, end and name of every phase."""
        found: list[tuple[float, float, str]] = []
        for piece in self.pieces:
            if found and found[-1][2] == piece.mode.phase:
                found[-1] = (found[-1][0], piece.end, piece.mode.phase)
            else:
                found.append((piece.start, piece.end, piece.mode.phase))
        return found

    def frame(self) -> pd.DataFrame:
        """Return torques, speeds, accelerations, powers and works over time, and how to draw them.

        Where an event changes a torque at once there are two rows of one time.

        Returns
        -------
        pandas.DataFrame
            Columns ``name [unit]``; ``attrs`` has title, panels, marks, spans and the results as ``quantities`` in SI.
        """
        import pandas as pd  # costly to import

        finite = self.question.driver_torque is not None
        rows = [row for number, piece in enumerate(self.pieces) for row in self._rows(piece, number)]
        names = ("driver", "clutch", "load")
        frame = pd.DataFrame(
            rows,
            columns=[
                "time [s]",
                *(f"{name}_torque [N*m]" for name in names),
                "clutch_capacity [N*m]",
                "driver_speed [1/min]",
                "driven_speed [1/min]",
                "slip_speed [1/min]",
                "driver_acceleration [rad/s2]",
                "driven_acceleration [rad/s2]",
                *(f"{name}_power [W]" for name in ("driver", "load", "kinetic", "friction")),
                *(f"{name}_work [J]" for name in ("driver", "load", "kinetic", "friction")),
                "phase [-]",
            ],
        )
        torques = ["clutch_torque [N*m]", "load_torque [N*m]", "clutch_capacity [N*m]"]
        accelerations = ["driven_acceleration [rad/s2]"]
        if finite:
            torques.insert(2, "driver_torque [N*m]")
            accelerations.append("driver_acceleration [rad/s2]")
        shares = ("driver", "friction", "load", "kinetic")
        frame.attrs = {
            "title": f"Start-up: {self.headline()}",
            "x": "time [s]",
            "panels": [
                {"label": "torque [N*m]", "columns": torques},
                {"label": "speed [1/min]", "columns": ["driver_speed [1/min]", "driven_speed [1/min]"]},
                {"label": "acceleration [rad/s2]", "columns": accelerations},
                {"label": "power [W]", "columns": [f"{name}_power [W]" for name in shares]},
                {"label": "work [J]", "columns": [f"{name}_work [J]" for name in shares]},
            ],
            "marks": [{"x": event.time, "label": event.name} for event in self.events],
            "spans": [{"from": start, "to": end, "label": name} for start, end, name in self.phases()],
            "quantities": self.quantities(),
            "source": "integration of the equations of motion, restarted at events",
        }
        return frame

    def quantities(self) -> dict[str, float]:
        """Results that the closed forms give too, by public name; not-a-number where there was no lock-up."""
        locked = not math.isnan(self.slip_time)
        return {
            "slip_time": self.slip_time,
            "friction_work": self.friction_work if locked else math.nan,
            "peak_slip_power": self.peak_slip_power,
            "acceleration": self.greatest_acceleration if locked else math.nan,
        }

    def headline(self) -> str:
        """Return the outcome in words."""
        if math.isnan(self.slip_time):
            return "the driver stalls" if self.outcome == "stalled" else f"no lock-up within {number_text(self.end)} s"
        text = f"lock-up after {number_text(self.slip_time)} s"
        if self.outcome == "locked" and not self.keeps_load:
            return f"{text}, but the driver cannot hold the load"
        ends = {"stalled": ", then the driver stalls", "slipping": ", then slip again"}
        return f"{text}{ends.get(self.outcome, f', friction work {number_text(self.friction_work)} J')}"

    def _rows(self, piece: _Piece, number: int) -> list[list[float]]:
        question, mode = self.question, piece.mode
        steps = max(2, math.ceil(_ROWS * (piece.end - piece.start) / self.end) + 1)
        first = question.driver_speed
        inertia = 0.0 if question.driver_torque is None else question.driver_inertia
        phase = next(k for k, (_, end, _) in enumerate(self.phases(), 1) if piece.end <= end)
        rows = []
        for time in np.linspace(piece.start, piece.end, steps):
            state = piece.state(time)
            driver, clutch, load = question.torques(mode, time, state)
            faster, second = question.accelerations(mode, driver, clutch, load)
            speed_1, speed_2 = state[_SPEED_1], state[_SPEED_2]
            slip = speed_1 - speed_2 if mode.slip else 0.0
            kinetic = inertia * faster * speed_1 + question.driven_inertia * second * speed_2
            stored = (inertia * (speed_1**2 - first**2) + question.driven_inertia * speed_2**2) / 2
            row = [
                time,
                driver,
                clutch,
                load,
                question.capacity(time),
                speed_1 * _TO_RPM,
                speed_2 * _TO_RPM,
                slip * _TO_RPM,
                faster,
                second,
                driver * speed_1,
                load * speed_2,
                kinetic,
                clutch * slip,
                state[_WORK_1],
                state[_WORK_2],
                stored,
                state[_FRICTION],
                float(phase),
            ]
            rows.append([float(value) for value in row])
        return rows


def simulate_startup(
    torque: float,
    load_torque: float,
    driven_inertia: float,
    driver_speed: float,
    ramp_time: float,
    load_kind: str = "reactive",
    *,
    ramp: Ramp = "linear",
    driver_inertia: float = math.inf,
    driver_torque: DriverTorque | None = None,
    static_ratio: float = 1.0,
    hold_time: float | None = None,
    time_limit: float | None = None,
) -> StartupRun:
    """Integrate a start-up from the first touch to lock-up and a little beyond.

    Equation (implicit): J1 domega1/dt = M1 - M_k, J2 domega2/dt = M_k - M2

    Parameters
    ----------
    torque : float
        Clutch torque at the end of the ramp T [N m].
    load_torque : float
        L [N m]; 0 where only inertia is driven.
    driven_inertia : float
        J2 [kg m2].
    driver_speed : float
        omega1 at the first touch [rad/s].
    ramp_time : float
        t_r [s]; 0 for a step.
    load_kind : str
        reactive (resists, can stand still), active (acts from the start) or inertia (no load torque).
    ramp : str, table or callable
        Course of the ramp: linear, smooth ((1 - cos(pi x))/2), corners ((0, 0), ..., (1, 1)) of fractions of time and
        torque, or a function of the fraction of time that ends at 1.
    driver_inertia : float
        J1 [kg m2]; infinite for a driver that keeps its speed.
    driver_torque : float or callable, optional
        M1 [N m], constant or as a function of omega1 [rad/s]; needed where J1 is finite.
    static_ratio : float
        Static over sliding friction [-]. Locked, the clutch carries this times the torque of the ramp, and at least
        that torque: a ratio below 1 would mean stick-slip without end.
    hold_time : float, optional
        How long to go on after lock-up [s], 0 ends with it; by default a fifth of the slip time, or until the driver
        stalls where it cannot hold the load.
    time_limit : float, optional
        Longest time [s]; by default well after any possible lock-up.

    Returns
    -------
    StartupRun
        Results, events and the course in time.

    Raises
    ------
    InputError
        When an argument is not possible.

    References
    ----------
    S1 (lecture), equations (1), (2) of the start-up.

    Examples
    --------
    S1's start-up; the closed forms give 3.21806 s and 39524.1 J:

    >>> run = simulate_startup(1080, 600, 30, 26.6, 2)
    >>> run.outcome, run.slip_time, run.friction_work, run.peak_slip_power
    ('locked', 3.21806, 39524.1, 21703.7)
    >>> [(event.name, event.time) for event in run.events]
    [('load starts', 1.11111), ('ramp ends', 2.0), ('lock-up', 3.21806)]
    """
    question = _question(
        torque,
        load_torque,
        driven_inertia,
        driver_speed,
        ramp_time,
        load_kind,
        ramp,
        driver_inertia,
        driver_torque,
        static_ratio,
    )
    limit = _default_limit(question) if time_limit is None else _positive("time_limit", time_limit, "s")
    hold = None if hold_time is None else _positive("hold_time", hold_time, "s", zero=True)
    return _Integration(question, limit, hold).run()


# -- the question ----------------------------------------------------------------------------------


def _positive(name: str, value: float, unit: str, zero: bool = False) -> float:
    number = float(value)
    if not math.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise InputError(name, value, f"a number {'of 0 or more' if zero else 'above 0'}, in {unit}")
    return number


def _question(
    torque: float,
    load_torque: float,
    driven_inertia: float,
    driver_speed: float,
    ramp_time: float,
    load_kind: str,
    ramp: Ramp,
    driver_inertia: float,
    driver_torque: DriverTorque | None,
    static_ratio: float,
) -> _Question:
    if load_kind not in LOADS:
        raise InputError("load_kind", load_kind, "reactive, active or inertia")
    load = _positive("load_torque", load_torque, "N m", zero=True)
    if load_kind == "inertia" and load > 0:
        raise InputError("load_torque", load_torque, "0 with load_kind inertia")
    if (driver_torque is None) != math.isinf(driver_inertia):
        given, missing = ("driver_inertia", "driver_torque") if driver_torque is None else ("driver_torque", "")
        expected = (
            "driver_torque too: a driver of finite inertia changes its speed by the torque it gives"
            if missing
            else "a finite driver_inertia too: a driver of infinite inertia gives whatever the clutch takes"
        )
        raise InputError(given, driver_inertia if missing else driver_torque, expected)
    curve: Callable[[float], float] | None = None
    if callable(driver_torque):
        curve = driver_torque
    elif driver_torque is not None:
        constant = _positive("driver_torque", driver_torque, "N m", zero=True)

        def curve(speed: float) -> float:
            return constant

    course, corners = _course(ramp)
    return _Question(
        torque=_positive("torque", torque, "N m"),
        ramp_time=_positive("ramp_time", ramp_time, "s", zero=True),
        load_torque=load,
        driven_inertia=_positive("driven_inertia", driven_inertia, "kg m2"),
        driver_speed=_positive("driver_speed", driver_speed, "rad/s"),
        load_kind=load_kind,
        corners=tuple(float(corner * ramp_time) for corner in corners),
        ramp=course,
        driver_inertia=math.inf if curve is None else _positive("driver_inertia", driver_inertia, "kg m2"),
        driver_torque=curve,
        hold=max(_positive("static_ratio", static_ratio, "-"), 1.0),
    )


def _course(ramp: Ramp) -> tuple[Callable[[float], float], tuple[float, ...]]:
    """Return the fraction of torque over the fraction of time, and where it has corners."""
    if callable(ramp):
        if abs(ramp(1.0) - 1) > 1e-9:
            raise InputError("ramp", ramp(1.0), "a function that is 1 at the end of the ramp")
        return ramp, (1.0,)
    if isinstance(ramp, str):
        if ramp not in RAMP_SHAPES:
            raise InputError("ramp", ramp, "linear, smooth, a table of corners or a function")
        if ramp == "linear":
            return (lambda x: x), (1.0,)
        return (lambda x: (1 - math.cos(math.pi * x)) / 2), (1.0,)
    times, torques = np.array(ramp, dtype=float).reshape(-1, 2).T
    right = len(times) > 1 and times[0] == 0 and times[-1] == 1 and torques[-1] == 1
    if not right or np.any(np.diff(times) <= 0) or np.any(torques < 0) or not np.all(np.isfinite(torques)):
        raise InputError("ramp", ramp, "corners from (0, 0 or more) to (1, 1), each later than the one before")
    return (lambda x: float(np.interp(x, times, torques))), tuple(times[1:])


def _default_limit(question: _Question) -> float:
    """Return a time late enough for every lock-up: a slip from the end of the ramp on with twice the speed to gain."""
    inertia, speed, ramp_time = question.driven_inertia, question.driver_speed, question.ramp_time
    excess = question.torque - question.load_torque
    if excess <= _SAME * question.torque:
        return 2 * ramp_time + 2 * inertia * speed / question.torque
    return ramp_time + 2 * (inertia * speed + question.torque * ramp_time) / excess


# -- the integration -------------------------------------------------------------------------------

_TROUBLE = "the course of the start-up changes without end"


class _Integration:
    """Goes from piece to piece."""

    def __init__(self, question: _Question, limit: float, hold: float | None) -> None:
        self.question, self.limit, self.hold = question, limit, hold
        self.end = limit
        self.events: list[Event] = []
        self.pieces: list[_Piece] = []
        self.lock_time = self.lock_speed = math.nan
        self.keeps_load = True
        # The works are of the order of the kinetic energy, or of what the torque does at full speed.
        energy = question.driven_inertia * question.driver_speed**2
        self.tolerance = np.array([question.driver_speed] * 2 + [energy] * 3) * _ACCURACY * 1e-2

    def run(self) -> StartupRun:
        """Integrate until lock-up is past, the driver stalls or the time is up."""
        question = self.question
        state = np.array([question.driver_speed, 0.0, 0.0, 0.0, 0.0])
        time, outcome = 0.0, ""
        slip, motion = 1, 0 if question.capacity(0.0) <= question.load_torque * (1 + _SAME) else 1
        if question.load_torque == 0:
            motion = 1
        elif motion:
            self._note(0.0, "load starts")
        if question.ramp_time == 0:
            self._note(0.0, "ramp ends")
        while time < self.end and not outcome:
            if len(self.pieces) > _MOST_PIECES:
                raise ArithmeticError(_TROUBLE)
            mode = _Mode(slip, motion, self._phase(slip, motion, time))
            time, state, reached = self._integrate(mode, time, state)
            if abs(time - question.ramp_time) <= 1e-12 * question.ramp_time and time > 0:
                self._note(time, "ramp ends")
            if reached == "lock" and question.stands and motion == 0:
                reached = "stall"  # the load has not moved: the driver has come down to it
            if reached == "lock":
                slip, motion, state = self._lock(time, state, slip, motion)
            elif reached == "slip":
                _, needed, _ = question.torques(mode, time, state)
                slip = 1 if needed > 0 else -1
                self._note(time, "slips again")
            elif reached == "start":
                # An active load has turned backwards all the time; its start is where the clutch carries it.
                motion = slip if question.stands else 1
                self._note(time, "load starts")
            elif reached == "rest":
                state[_SPEED_2] = 0.0
                motion = 0
                self._note(time, "load stops")
            elif reached == "stall":
                state[_SPEED_1] = 0.0
                outcome = "stalled"
                self._note(time, "driver stalls")
        return self._result(outcome or ("locked" if slip == 0 else "slipping"), time, state)

    def _note(self, time: float, name: str) -> None:
        if not any(event.name == name and event.time == time for event in self.events):
            self.events.append(Event(float(time), name))

    def _phase(self, slip: int, motion: int, time: float) -> str:
        if slip == 0:
            return "locked"
        if not math.isnan(self.lock_time):
            return "slips again"
        if motion == 0:
            return "load at rest" if self.question.stands else "load runs back"
        return "ramp" if time < self.question.ramp_time * (1 - 1e-12) else "full torque"

    def _integrate(self, mode: _Mode, start: float, state: Any) -> tuple[float, Any, str]:
        """Integrate one piece up to its event, the next corner of the ramp or the end; return which it was."""
        question = self.question
        corner = next((c for c in question.corners if c > start * (1 + 1e-12)), math.inf)
        stop = min(corner, self.end)
        watched = self._watched(mode)
        ramping = start < question.ramp_time
        answer = solve_ivp(
            lambda t, y: question.rates(mode, t, y),
            (start, stop),
            state,
            # A motor that is steep for its small rotor is stiff; nothing else here is.
            method="DOP853" if question.driver_torque is None else "LSODA",
            rtol=_ACCURACY,
            atol=self.tolerance,
            events=[function for _, function in watched],
            dense_output=True,
            max_step=(stop - start) / (16 if ramping else 4),
        )
        if answer.status < 0:
            raise ArithmeticError(f"the start-up could not be integrated: {answer.message}")
        time = float(answer.t[-1])
        if time > start:
            self.pieces.append(_Piece(mode, start, time, answer.sol))
        reached = ""
        if answer.status == 1:
            reached = next(name for (name, _), times in zip(watched, answer.t_events, strict=True) if len(times))
        return time, answer.y[:, -1].copy(), reached

    def _watched(self, mode: _Mode) -> list[tuple[str, Any]]:
        """Return the events that may end a piece, each a function that falls through zero."""
        question = self.question
        load = question.load_torque
        found: list[tuple[str, Any]] = []

        def watch(name: str, function: Callable[[float, Any], float]) -> None:
            function.terminal, function.direction = True, -1  # type: ignore[attr-defined]
            found.append((name, function))

        if mode.slip:
            watch("lock", lambda t, y: mode.slip * (y[_SPEED_1] - y[_SPEED_2]))
        else:

            def reserve(t: float, y: Any) -> float:
                return question.hold * question.capacity(t) * (1 + _SAME) - abs(question.torques(mode, t, y)[1])

            watch("slip", reserve)
        if mode.slip and mode.motion == 0:
            watch("start", lambda t, y: load * (1 + _SAME) - question.capacity(t))
        if mode.slip and mode.motion and question.stands:
            watch("rest", lambda t, y: mode.motion * y[_SPEED_2])
        if question.driver_torque is not None:
            watch("stall", lambda t, y: y[_SPEED_1])
        return found

    def _lock(self, time: float, state: Any, slip: int, motion: int) -> tuple[int, int, Any]:
        """Return the mode and state at lock-up; from the first one on the end is in sight."""
        question = self.question
        state[_SPEED_2] = state[_SPEED_1]
        self._note(time, "lock-up")
        motion = 1 if motion == 0 else motion
        if math.isnan(self.lock_time):
            self.lock_time, self.lock_speed = time, float(state[_SPEED_1])
            self.keeps_load = self._keeps_load(self.lock_speed)
            if self.hold is not None:
                self.end = min(time + self.hold, max(self.limit, time))
            elif not self.keeps_load:
                self.end = self.limit  # to show how it ends
            else:
                self.end = max(1.2 * time, min(1.05 * question.ramp_time, 1.5 * time))
        return 0, motion, state

    def _keeps_load(self, speed: float) -> bool:
        """Whether the driver holds some speed up to that of lock-up under the load, or gains speed."""
        if self.question.driver_torque is None:
            return True
        speeds = np.linspace(0.0, speed, 200)
        return any(self.question.driver_torque(float(x)) >= self.question.load_torque for x in speeds)

    def _result(self, outcome: str, end: float, state: Any) -> StartupRun:
        question = self.question
        kinetic = question.driven_inertia * state[_SPEED_2] ** 2 / 2
        if question.driver_torque is not None:
            kinetic += question.driver_inertia * (state[_SPEED_1] ** 2 - question.driver_speed**2) / 2
        slipping = [piece for piece in self.pieces if piece.mode.slip]
        reserves = [self._reserve(piece) for piece in self.pieces if not piece.mode.slip]
        return StartupRun(
            outcome=outcome,
            slip_time=self.lock_time,
            friction_work=float(state[_FRICTION]),
            peak_slip_power=max(_greatest(piece, self._slip_power(piece)) for piece in slipping),
            lock_speed=self.lock_speed,
            greatest_acceleration=max(_greatest(piece, self._driven_acceleration(piece)) for piece in slipping),
            lowest_driven_speed=min(0.0, -max(_greatest(piece, _backward_speed(piece)) for piece in slipping)),
            hold_reserve=min(reserves, default=math.nan),
            keeps_load=self.keeps_load,
            driver_work=float(state[_WORK_1]),
            load_work=float(state[_WORK_2]),
            kinetic_work=float(kinetic),
            end=float(end),
            events=tuple(self.events),
            question=question,
            pieces=tuple(self.pieces),
        )

    def _slip_power(self, piece: _Piece) -> Callable[[float], float]:
        def power(time: float) -> float:
            state = piece.state(time)
            clutch = self.question.torques(piece.mode, time, state)[1]
            return float(clutch * (state[_SPEED_1] - state[_SPEED_2]))

        return power

    def _driven_acceleration(self, piece: _Piece) -> Callable[[float], float]:
        def acceleration(time: float) -> float:
            torques = self.question.torques(piece.mode, time, piece.state(time))
            return float(self.question.accelerations(piece.mode, *torques)[1])

        return acceleration

    def _reserve(self, piece: _Piece) -> float:
        def used(time: float) -> float:
            carried = abs(self.question.torques(piece.mode, time, piece.state(time))[1])
            return carried / (self.question.hold * self.question.capacity(time))

        most = _greatest(piece, used)
        return 1 / most if most > 0 else math.inf


def _backward_speed(piece: _Piece) -> Callable[[float], float]:
    return lambda time: -float(piece.state(time)[_SPEED_2])


def _greatest(piece: _Piece, function: Callable[[float], float]) -> float:
    """Return the greatest value of a smooth function within a piece."""
    times = np.linspace(piece.start, piece.end, 33)
    values = [function(float(time)) for time in times]
    k = int(np.argmax(values))
    around = (float(times[max(k - 1, 0)]), float(times[min(k + 1, len(times) - 1)]))
    best = minimize_scalar(
        lambda t: -function(float(t)), bounds=around, method="bounded", options={"xatol": 1e-9 * (piece.end + 1e-300)}
    )
    return max(values[k], -float(best.fun))


# -- repeated switching ----------------------------------------------------------------------------


@dataclass(frozen=True)
class SwitchingRun:
    """Temperature of a lumped body over many equal engagements. All SI; rises are over ambient.

    ``peak_rise`` is the greatest rise once the engagements repeat themselves, ``mean_rise`` the mean of such a cycle.
    """

    times: Any
    rises: Any
    cycle_time: float
    engagements: int
    peak_rise: float
    mean_rise: float

    def frame(self, limit: float | None = None) -> pd.DataFrame:
        """Return the temperature rise over time, and how to draw it.

        Parameters
        ----------
        limit : float, optional
            Allowed rise [K], drawn as a line.

        Returns
        -------
        pandas.DataFrame
            ``time [min]`` and ``temperature_rise [K]``.
        """
        import pandas as pd  # costly to import

        frame = pd.DataFrame({"time [min]": self.times / 60, "temperature_rise [K]": self.rises})
        lines = [
            {"panel": 0, "y": self.peak_rise, "label": "peak, repeated steadily"},
            {"panel": 0, "y": self.mean_rise, "label": "mean, repeated steadily"},
        ]
        if limit is not None:
            lines.append({"panel": 0, "y": limit, "label": "allowed rise"})
        frame.attrs = {
            "title": f"Repeated switching: every {number_text(self.cycle_time)} s, "
            f"peak {number_text(self.peak_rise)} K over ambient",
            "x": "time [min]",
            "panels": [{"label": "temperature rise [K]", "columns": ["temperature_rise [K]"]}],
            "lines": lines,
            "quantities": {"peak_temperature_rise": self.peak_rise},
            "source": "lumped heat balance C dT/dt = P - h A T with the friction power of the simulation",
        }
        return frame


def simulate_switching(
    run: StartupRun,
    switching_rate: float,
    heat_capacity: float,
    heat_transfer: float,
    cooled_area: float,
    engagements: int | None = None,
) -> SwitchingRun:
    """Let equal engagements follow each other and integrate the temperature of a lumped body.

    Equation (implicit): C dT/dt = P - h A T

    The balance is linear: one engagement is integrated from ambient, and a cycle that begins warmer adds what is left
    of that warmth.

    Parameters
    ----------
    run : StartupRun
        One engagement, up to lock-up.
    switching_rate : float
        Engagements per second [1/s].
    heat_capacity : float
        C [J/K].
    heat_transfer : float
        Surface coefficient h [W/(m2 K)].
    cooled_area : float
        Surface that gives off heat [m2].
    engagements : int, optional
        How many to show; by default until the last is as good as steady, at most 200.

    Returns
    -------
    SwitchingRun
        Temperature rise over time.

    Raises
    ------
    InputError
        When an argument is not possible, the clutch never locks, or still slips when the next engagement is due.

    References
    ----------
    S1 (lecture), repeated switching; lumped heat balance. With the work as a sudden step it is
    :func:`synth.problems.mechanics.heat.peak_temperature_rise`.

    Examples
    --------
    S1's start-up 50 times per hour in 5 kg of steel; all at once the work would give 27.75 K:

    >>> run = simulate_startup(1080, 600, 30, 26.6, 2)
    >>> simulate_switching(run, 50 / 3600, 2400, 150, 0.2).peak_rise
    27.2241
    """
    if math.isnan(run.slip_time):
        raise InputError("run", run.outcome, "a start-up that ends in lock-up; otherwise there is no next engagement")
    cycle = 1 / _positive("switching_rate", switching_rate, "1/s")
    if run.slip_time >= cycle:
        raise InputError(
            "switching_rate", switching_rate, f"less than {typed_number(1 / run.slip_time)} 1/s, so that slip can end"
        )
    capacity = _positive("heat_capacity", heat_capacity, "J/K")
    loss = _positive("heat_transfer", heat_transfer, "W/(m2 K)") * _positive("cooled_area", cooled_area, "m2")
    constant = capacity / loss
    times, rises, area = _one_engagement(run, capacity, constant)
    cooling = np.linspace(times[-1], cycle, 25)[1:]
    rises = np.append(rises, rises[-1] * np.exp(-(cooling - times[-1]) / constant))
    times = np.append(times, cooling)
    left = math.exp(-cycle / constant)
    steady = rises[-1] / -math.expm1(-cycle / constant)
    if engagements is None:
        engagements = min(max(math.ceil(5 * constant / cycle), 5), 200)
    elif engagements < 1:
        raise InputError("engagements", engagements, "1 or more")
    starts = steady * -np.expm1(-np.arange(engagements) * cycle / constant) if left < 1 else np.zeros(engagements)
    fading = np.exp(-times / constant)
    return SwitchingRun(
        times=np.concatenate([n * cycle + times for n in range(engagements)]),
        rises=np.concatenate([start * fading + rises for start in starts]),
        cycle_time=cycle,
        engagements=engagements,
        peak_rise=float(np.max(steady * fading + rises)),
        mean_rise=float(area / (loss * cycle)),
    )


def _one_engagement(run: StartupRun, capacity: float, constant: float) -> tuple[Any, Any, float]:
    """Return times and rises from ambient until lock-up, and the heat brought in."""
    question = run.question
    times, rises, heat = [0.0], [0.0], 0.0
    for piece in run.pieces:
        if not piece.mode.slip:
            continue

        def balance(time: float, rise: Any, piece: _Piece = piece) -> list[float]:
            state = piece.state(time)
            clutch = question.torques(piece.mode, time, state)[1]
            return [clutch * (state[_SPEED_1] - state[_SPEED_2]) / capacity - rise[0] / constant]

        points = np.linspace(piece.start, piece.end, 100)
        scale = run.friction_work / capacity
        answer = solve_ivp(
            balance, (piece.start, piece.end), [rises[-1]], method="LSODA", t_eval=points, rtol=1e-9, atol=1e-9 * scale
        )
        times.extend(points[1:])
        rises.extend(answer.y[0][1:])
        heat += float(piece.state(piece.end)[_FRICTION] - piece.state(piece.start)[_FRICTION])
    return np.array(times), np.array(rises), heat
