"""Runs with exact times, made and judged by the core."""
