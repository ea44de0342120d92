"""Migrations of the job database, run by Alembic when a database is opened."""
