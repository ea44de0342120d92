"""Dry discs between pressure plates, and their hubs and cover."""
