"""The arithmetic and the tree of verification, which share nothing with the search."""
