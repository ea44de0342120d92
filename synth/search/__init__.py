"""The search: branch and bound, heuristics, fronts."""
