"""Electromagnetic clutch: a pack of plates or discs with the magnet that presses it."""
