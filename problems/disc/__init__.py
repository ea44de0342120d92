"""Disc clutch, and the pack of discs that it shares with the electromagnetic clutch."""
