"""Symbols as they are declared (``mu_guide``, ``F0``, ``dT_pk``), taken apart as people write them."""

from __future__ import annotations

import re
from dataclasses import dataclass

GREEK = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "epsilon": "ε",
    "eps": "ε",
    "zeta": "ζ",
    "eta": "η",
    "theta": "θ",
    "iota": "ι",
    "kappa": "κ",
    "lambda": "λ",
    "mu": "μ",
    "nu": "ν",
    "xi": "ξ",
    "pi": "π",
    "rho": "ρ",
    "sigma": "σ",
    "tau": "τ",
    "upsilon": "υ",
    "phi": "φ",
    "chi": "χ",
    "psi": "ψ",
    "omega": "ω",
    "Gamma": "Γ",
    "Delta": "Δ",
    "Theta": "Θ",
    "Lambda": "Λ",
    "Xi": "Ξ",
    "Pi": "Π",
    "Sigma": "Σ",
    "Phi": "Φ",
    "Psi": "Ψ",
    "Omega": "Ω",
}
IRREGULAR = {"dm": ("d", ("m",))}  # written without the underscore of the grammar


@dataclass(frozen=True)
class SymbolParts:
    """A symbol: ``difference`` before it, its letter or word, and its subscripts."""

    difference: bool
    base: str
    subscripts: tuple[str, ...]

    @property
    def italic(self) -> bool:
        """True if the base is a letter, which is set in italics; words stand upright."""
        return len(self.base) == 1


def symbol_parts(symbol: str) -> SymbolParts:
    """Take a symbol apart.

    The grammar is ``base[digits](_sub)*``: a Greek base is named, digits behind the base are a subscript, ``d`` before
    a capital letter or before r is a difference.

    Examples
    --------
    >>> symbol_parts("mu_guide"), symbol_parts("F0").subscripts, symbol_parts("dT_pk").difference
    (SymbolParts(difference=False, base='μ', subscripts=('guide',)), ('0',), True)
    """
    if symbol in IRREGULAR:
        base, subscripts = IRREGULAR[symbol]
        return SymbolParts(False, base, subscripts)
    base, *pieces = symbol.split("_")
    numbered = re.fullmatch(r"([a-zA-Z]+?)(\d+)", base)
    if numbered:
        base, pieces = numbered[1], [numbered[2], *pieces]
    difference = bool(re.fullmatch(r"d(?:[A-Z][a-z]*|r)", base))
    if difference:
        base = base[1:]
    return SymbolParts(difference, GREEK.get(base, base), tuple(GREEK.get(x, x) for x in pieces if x))
