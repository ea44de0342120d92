"""Pack of plates, and the drum and hub around it."""
