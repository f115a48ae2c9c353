"""Runs as output: folded, as text, as a page, as UPPAAL prints them."""
