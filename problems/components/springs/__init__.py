"""Sets of compression springs around a shaft."""
