"""The check of a saved front."""
