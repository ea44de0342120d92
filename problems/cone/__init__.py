"""Cone clutch: its declaration and its own formulas."""
