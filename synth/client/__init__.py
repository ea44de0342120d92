"""A service of clutchsynth elsewhere, used from Python like ``synth`` itself."""
