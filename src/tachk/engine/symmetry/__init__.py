"""Processes that can be permuted without changing the behaviour, and the proof that they can."""
