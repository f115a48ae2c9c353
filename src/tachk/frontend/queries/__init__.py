"""Queries, properties, what they are expected to answer, and the observers of formulas."""
