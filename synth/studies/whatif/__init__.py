"""How the best designs move with what is asked."""
