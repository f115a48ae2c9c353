"""Runs with exact times, made of the paths of explorations, or made and judged by the core."""
