"""What checking a front again has shown, and how that is told."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from synth.text.numbers import gap_text, number_text


class Verdict(StrEnum):
    """How a check ended."""

    HOLDS = "holds"
    REFUTED = "refuted"  # something is not as claimed
    NOT_PROVEN = "not_proven"  # nothing is wrong, but the proof did not close within its effort


@dataclass(frozen=True)
class Verification:
    """What checking a front again has shown.

    ``findings`` say in a sentence each what is not as claimed, ``open`` which claims could be neither proven again nor
    refuted within the effort. ``proven_gap`` is the smallest gap that could be proven (None: none was claimed, or none
    could be), ``nodes`` counts the boxes of that proof, ``amounts`` tells in words what the gap stands for where it is
    no share of the value.
    """

    findings: tuple[str, ...]
    open: tuple[str, ...]
    certificate: str
    designs: int
    claimed_gap: float | None
    proven_gap: float | None
    nodes: int
    seconds: float
    amounts: str = ""

    @property
    def verdict(self) -> Verdict:
        """How the check ended: one finding refutes, whatever else is open."""
        return Verdict.REFUTED if self.findings else Verdict.NOT_PROVEN if self.open else Verdict.HOLDS

    @property
    def holds(self) -> bool:
        """Whether everything is as claimed, and proven again as far as a proof is claimed."""
        return self.verdict is Verdict.HOLDS

    def sentence(self) -> str:
        """Return the outcome in words."""
        effort = f"({self.nodes} boxes, {number_text(self.seconds, 2)} s)"
        listed = "1 design is" if self.designs == 1 else f"{self.designs} designs are"
        if not self.holds:
            shown = self.proven_gap
            proven = "" if shown is None else f"; what could be proven is a gap of {gap_text(shown)}"
            if self.findings:
                count = f"{len(self.findings)} finding{'s' * (len(self.findings) > 1)}"
                return f"does not hold: {count}{proven} {effort}"
            saved = f"{listed} as saved" if self.designs else "no design is listed"
            return f"not proven again: {saved}, nothing refutes the claim, but its proof did not close{proven} {effort}"
        if self.certificate != "global":
            return f"holds: {listed} as saved; the certificate is {self.certificate}, so no proof is claimed or checked"
        if not self.designs:
            return f"holds: proven again that no design is feasible {effort}"
        return (
            f"holds: {listed} as saved, and proven again that no feasible design improves one of them by more than "
            f"{gap_text(self.claimed_gap or 0.0)} in every objective{self.amounts} {effort}"
        )
