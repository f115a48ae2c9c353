"""Temporal logic on trees: what formulas and sentences mean, and the observers that watch them."""
