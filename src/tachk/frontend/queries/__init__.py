"""Queries, properties, their expected answers, and the observers of formulas."""
