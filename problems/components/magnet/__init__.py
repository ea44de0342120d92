"""Pot magnet that presses a pack: circuit, force, coil and mass."""
