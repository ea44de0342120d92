"""Multi-plate clutch."""
