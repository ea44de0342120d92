"""Roller coupling: its declaration, curves, own formulas and motion."""
