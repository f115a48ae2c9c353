"""Processes that can be exchanged without changing what is possible, and the proof that they can."""
