"""Families of this distribution: what somebody else has installed beside it changes no test."""

from synth.plugins import FAMILIES as GROUP
from synth.plugins import SHIPPED_FAMILIES, installed

FAMILIES = [point.name for point in installed(GROUP) if point.value.startswith(f"{SHIPPED_FAMILIES}.")]
