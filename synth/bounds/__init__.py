"""Bounds of the search: intervals, contraction, clusters, curvature, the kernel of boxes."""
