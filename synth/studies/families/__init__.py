"""Families compared by the same requirement."""
