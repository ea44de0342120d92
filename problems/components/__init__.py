"""Components of clutches: each declares its sizes, formulas, mass and limits, and draws itself."""
