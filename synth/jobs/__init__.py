"""Batches: many requirement rows as one job that survives whatever stops it."""
