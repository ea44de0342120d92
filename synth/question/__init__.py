"""A question of a user: a model with requirements, tables, limits and settings."""
