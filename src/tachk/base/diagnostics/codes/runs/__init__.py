"""Codes about runs: recorded ones, written ones, and those that are drawn."""
