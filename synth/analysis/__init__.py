"""One design: evaluated, described, drawn as curves."""
