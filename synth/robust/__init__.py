"""Designs under uncertainty: robust counterpart, worst case, yield."""
