"""Shipped part tables: one CSV and one schema per table."""
