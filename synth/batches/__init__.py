"""Batches: a table of requirements as one job that can be interrupted and resumed."""
