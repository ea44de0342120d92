"""Bounds of the search: intervals, contraction, clusters, curvature, compiled boxes."""
