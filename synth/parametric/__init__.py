"""Many questions as one search."""
