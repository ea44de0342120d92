"""Design families: one file each, found through the entry point group ``clutchsynth.problems``."""
