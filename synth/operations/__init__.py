"""Elementary operations of formulas: one record each, which all readers ask."""
