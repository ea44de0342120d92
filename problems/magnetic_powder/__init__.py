"""Magnetic powder clutch: its declaration, curves and own formulas."""
