"""Curvature of expressions: what is affine, convex or concave on a box."""

from __future__ import annotations

from dataclasses import dataclass

AFFINE, CONVEX, CONCAVE, UNKNOWN = "log-affine", "log-convex", "log-concave", "unknown"

Ends = tuple[float, float]


@dataclass(frozen=True)
class Curvature:
    """Whether a logarithm is convex, and whether it is concave, in the logarithms of the inputs."""

    convex: bool
    concave: bool

    @property
    def word(self) -> str:
        """Return it in a word."""
        return {(True, True): AFFINE, (True, False): CONVEX, (False, True): CONCAVE, (False, False): UNKNOWN}[
            self.convex, self.concave
        ]

    def opposite(self) -> Curvature:
        """Return the curvature of the negative."""
        return Curvature(self.concave, self.convex)

    def __and__(self, other: Curvature) -> Curvature:
        return Curvature(self.convex and other.convex, self.concave and other.concave)

    def __or__(self, other: Curvature) -> Curvature:
        return Curvature(self.convex or other.convex, self.concave or other.concave)


BOTH, NEITHER = Curvature(True, True), Curvature(False, False)


INF = float("inf")
