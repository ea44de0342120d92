"""Texts for people: the one rule by which numbers are shown."""
