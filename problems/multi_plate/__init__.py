"""Multi-plate clutch, and the pack of plates that it shares with the electromagnetic clutch."""
