"""Questions that are alike, searched as one tree."""
