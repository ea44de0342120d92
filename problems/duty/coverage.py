"""What families that start a load, join shafts or engage by speed answer to requirements that are not theirs."""

from __future__ import annotations

from .machine import MOVED

STARTING = ("driven_inertia", *MOVED, "slip_time_limit", "startup_torque")
SOFTNESS = ("jerk_limit", "acceleration_limit")
FACTORS = ("engagements_per_hour", "switching_factor", "speed_factor")  # they count engagements, or wear by slip
LIFE = ("service_life",)
SPEEDS = ("idle_speed", "contact_speed_min", "contact_speed_max", "full_torque_speed")

SHOCK = "takes the load without slip, so that its start is a shock: use a friction clutch, or state peak_torque alone"
NEVER_SLIPS = "joins two shafts and never slips: use it beside a clutch"
ENGAGED_FROM_OUTSIDE = "is engaged from outside at any speed: use a centrifugal clutch, or leave the speeds out"

# By kind of family: requirements that ask for what it cannot do, and why.
GRIPPING = dict.fromkeys((*STARTING, *SOFTNESS), SHOCK) | dict.fromkeys(SPEEDS, ENGAGED_FROM_OUTSIDE)
JOINING = dict.fromkeys((*STARTING, *SPEEDS, "overload_torque"), NEVER_SLIPS)
ENGAGED = dict.fromkeys(SPEEDS, ENGAGED_FROM_OUTSIDE)
