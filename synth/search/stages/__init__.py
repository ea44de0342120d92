"""The stages of a search for a front, each a function of what is known so far."""
