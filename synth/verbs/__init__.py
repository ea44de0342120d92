"""Verbs: the records from which command line, jobs, JSON schemas and documentation are made."""
