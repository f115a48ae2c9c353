"""Whole verdicts with and without what saves states."""
