"""Blocks that clutches with a coil share: coil, winding, curves over temperature."""
