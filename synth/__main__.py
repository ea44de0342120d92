"""``python -m synth`` is the command ``clutchsynth``."""

from synth.terminal.cli import main

if __name__ == "__main__":
    main()
