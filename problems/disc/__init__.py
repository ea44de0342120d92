"""Disc clutch."""
