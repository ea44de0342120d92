"""Lining: friction pair, what it stands and how it wears."""
