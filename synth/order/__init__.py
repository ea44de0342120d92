"""When values are equal, limits hold and designs dominate."""
