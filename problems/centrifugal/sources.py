"""Names of the sources that the blocks cite, and the sources of the families."""

S4 = "S4 (notes on centrifugal clutches)"
DERIVED = f"derived; not in {S4}"
TYPICAL = "engineering-typical value"
DRIVE = "requirement of the drive"
SHIGLEY = "Shigley, Mechanical Engineering Design, disc clutch with uniform wear"
SOURCES = (
    "S4: notes on centrifugal and magnetic-powder clutches (in Hungarian), analyses 1 and 2, practices 1 to 3",
    SHIGLEY,
)
