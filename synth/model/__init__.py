"""A declared problem, traced: its program, constraints and goals."""
