"""Shaft of a clutch and the bosses on it."""
