"""Why nothing is feasible, and the ways out."""
