"""Studies: what-if, near-optimal designs, prices, infeasibility, comparison of families."""
