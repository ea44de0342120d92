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
BOTH_WAYS = "drives both ways: use wrap_spring"
RELEASED_AT_REST = "releases below its contact speed alone: use wrap_spring"
DRY = "is dry, and no dry lining stands lasting slip: use magnetic_powder_clutch"
NO_LASTING_SLIP = "is not computed in lasting slip: use magnetic_powder_clutch"

# By kind of family: requirements that ask for what it cannot do, and why.
GRIPPING = dict.fromkeys((*STARTING, *SOFTNESS), SHOCK) | dict.fromkeys(SPEEDS, ENGAGED_FROM_OUTSIDE)
GRIPPING |= {"slip_speed": DRY}
ACTUATED = GRIPPING | {"overrun_speed": BOTH_WAYS}
JOINING = dict.fromkeys((*STARTING, *SPEEDS, "overload_torque", "slip_speed"), NEVER_SLIPS)
JOINING |= {"overrun_speed": BOTH_WAYS}
ENGAGED = dict.fromkeys(SPEEDS, ENGAGED_FROM_OUTSIDE) | {"overrun_speed": BOTH_WAYS}
ENGAGED_DRY = ENGAGED | {"slip_speed": DRY}
ENGAGED_IN_PACKS = ENGAGED | {"slip_speed": NO_LASTING_SLIP}
SPEED_ENGAGED = {"slip_speed": DRY, "overrun_speed": RELEASED_AT_REST}
