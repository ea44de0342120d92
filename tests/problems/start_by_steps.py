"""The start-up by small steps in time, independent of the closed forms."""

import numpy as np


def start(torque, load, inertia, speed, ramp, kind):
    """Friction work, slip time, peak power and torque at lock by small steps of constant torque slope."""
    count = 200_000
    # the lock lies before this time for both kinds of load
    end = 1.001 * max(ramp, (inertia * speed + torque * ramp / 2 + load * ramp) / (torque - load))
    t = np.linspace(0.0, end, count + 1)
    clutch = torque * np.minimum(t / ramp, 1.0)
    resisting = np.full_like(t, load) if kind == "active" else np.minimum(clutch, load)
    net = (clutch - resisting) / inertia
    driven = np.concatenate([[0.0], np.cumsum((net[1:] + net[:-1]) / 2 * np.diff(t))])
    last = int(np.argmax(driven >= speed))
    assert last > 0
    power = clutch * np.maximum(speed - driven, 0.0)
    work = np.sum((power[1 : last + 1] + power[:last]) / 2 * np.diff(t)[:last])
    return work, t[last], power[: last + 1].max(), clutch[last]
