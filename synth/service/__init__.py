"""The service: jobs of a job database over HTTP. What it serves is computed by engine processes, never by its own."""
