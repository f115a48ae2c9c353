"""A run, told: folded, as text, as a page, as UPPAAL prints it."""
