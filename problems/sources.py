"""Names of the sources that declarations and curves cite."""

S0 = "S0 (Szoke 1966)"
S1 = "S1 (lecture on friction clutches)"
S2 = "S2 (Kozma et al.)"
S3 = "S3 (Szoke 1967)"
S4 = "S4 (notes on centrifugal clutches)"
NOT_IN_S2 = f"derived; not in {S2}"
NOT_IN_S4 = f"derived; not in {S4}"
EXTENDS_S3 = "extension of S3"
UNIFORM_WEAR = "Shigley, Mechanical Engineering Design, disc clutch with uniform wear"
PRACTICE = "common practice"
TYPICAL = "engineering-typical value"
DRIVE = "requirement of the drive"

# Works as the list of a family names them.
LIST_S0 = "S0: B. Szoke, Engagement and release of the multi-plate clutch (in Hungarian), 1966; appendix by I. Lipka"
LIST_S1 = "S1: lecture on friction clutches (cone, disc, multi-plate; start-up and heat)"
NEALE = "Neale, Tribology Handbook, Tables 7.4 and 7.5"
SHIGLEY_DISC = "Shigley, Mechanical Engineering Design, disc clutch: uniform pressure and uniform wear"
JOHNSON = "K. L. Johnson, Contact Mechanics (1985)"
ARCHARD = "Archard, wear volume in proportion to friction work"
PLATES_IN_USE = (
    "flott.de, lexicon, disk clutch",
    "AP Racing and Harley-Davidson, out-of-flat limits of plates",
    "de.wikipedia, Schleppmoment",
)
DISC_WEAR = "Porsche 964, wear of drive plates"
DISC_RUN_OUT = "Mazda and Porsche 911 SC, run-out limits of driven discs"
ISO_76 = "ISO 76, static load ratings of rolling bearings"
STANDARD_GRAVITY = "CGPM 1901, standard gravity"
SPRINGS = ("EN 13906-1, cylindrical helical springs", "Zimmerli, fatigue strength of springs")
SHAFT = ("DIN 743-2, strength of shafts", "DIN 748-1, shaft ends; DIN 6885-1, parallel keys")
