"""Friction ring of plates and discs."""
