"""Temporal formulas as text: `tokens`, `build` and `parser` read them, `printer` writes them."""
