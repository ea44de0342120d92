"""What families that start a load, join shafts or engage by speed answer to requirements that are not theirs."""

from __future__ import annotations

from .machine import MOVED

STARTING = ("driven_inertia", *MOVED, "slip_time_limit", "startup_torque")
SOFTNESS = ("jerk_limit", "acceleration_limit")
FACTORS = ("engagements_per_hour", "switching_factor", "speed_factor")  # they count engagements, or wear by slip
LIFE = ("service_life",)
STARTS = (*STARTING, *SOFTNESS, *FACTORS)
# Of what starts at full current.
SLIPPED = ("driven_inertia", *MOVED, "slip_time_limit", "engagements_per_hour", *SOFTNESS)
SIZES = ("outer_diameter_limit", "length_limit")
SPEEDS = ("idle_speed", "contact_speed_min", "contact_speed_max", "full_torque_speed")

SHOCK = "takes the load without slip, so that its start is a shock: use a friction clutch, or state peak_torque alone"
NEVER_SLIPS = "joins two shafts and never slips: use a friction clutch, and this beside it"
ENGAGED_FROM_OUTSIDE = "is engaged from outside at any speed: use a centrifugal clutch, or leave the speeds out"
NO_HEAT = (*FACTORS, *LIFE, "ambient_temperature")
NO_HOURS = (*NO_HEAT, "peak_torque")
ENVELOPE = {"mass_limit": "mass", "length_limit": "length"}  # limits of what every clutch has
AT_CONTACT = ENVELOPE | {"contact_speed_min": "contact_speed"}
AT_FULL_CURRENT = ENVELOPE | {"overload_torque": "torque"}
BOTH_WAYS = "drives both ways: use wrap_spring"
RELEASED_AT_REST = "releases below its contact speed alone: use wrap_spring"
DRY = "is dry, and no dry lining stands lasting slip: use magnetic_powder_clutch"
NO_LASTING_SLIP = "is not computed in lasting slip: use magnetic_powder_clutch"
FULL_CURRENT = "is computed in starts at full current alone: use multi_plate_clutch"
NO_TIME = "is engaged by its driver, and slip time and jerk are not computed: use a clutch engaged from outside"
GRIPS_ALL = "grips whatever the torque: use a friction clutch"
RISES_WITH_SPEED = "carries the more the faster it turns: use a clutch engaged from outside"

# By kind of family: requirements that ask for what it cannot do, and why.
GRIPPING = dict.fromkeys((*STARTING, *SOFTNESS), SHOCK) | dict.fromkeys(SPEEDS, ENGAGED_FROM_OUTSIDE)
GRIPPING |= {"slip_speed": NO_LASTING_SLIP, "overload_torque": GRIPS_ALL}
ACTUATED = GRIPPING | {"overrun_speed": BOTH_WAYS}
JOINING = dict.fromkeys((*STARTING, *SPEEDS, "overload_torque", "slip_speed"), NEVER_SLIPS)
JOINING |= {"overrun_speed": BOTH_WAYS}
ENGAGED = dict.fromkeys(SPEEDS, ENGAGED_FROM_OUTSIDE) | {"overrun_speed": BOTH_WAYS}
ENGAGED_DRY = ENGAGED | {"slip_speed": DRY}
ENGAGED_IN_PACKS = ENGAGED | {"slip_speed": NO_LASTING_SLIP}
AT_SPEED = dict.fromkeys((*SOFTNESS, "slip_time_limit", "startup_torque"), NO_TIME)
AT_SPEED |= {"slip_speed": DRY, "overrun_speed": RELEASED_AT_REST, "overload_torque": RISES_WITH_SPEED}
POWDER = ENGAGED | {"startup_torque": FULL_CURRENT}
