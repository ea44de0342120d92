"""Nonlinear programs: rows, batched interior point, IPOPT as referee."""
