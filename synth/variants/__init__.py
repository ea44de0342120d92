"""Size ranges: the fewest standard variants that serve many requirement rows."""
