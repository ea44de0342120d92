"""Names of the sources that the blocks cite."""

S0 = "S0 (Szoke 1966)"
S1 = "S1 (lecture on friction clutches)"
S4 = "S4 (notes on centrifugal clutches)"
TYPICAL = "engineering-typical value"
PRACTICE = "common practice"
