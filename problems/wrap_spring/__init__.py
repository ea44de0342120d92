"""Wrap-spring clutches: self-wrapping with interference, and actuated with clearance."""
