"""The goals of tests. Imports nothing heavy: command lines are made of it."""

from __future__ import annotations

from enum import StrEnum


class TestGoal(StrEnum):
    """How inputs are chosen."""

    __test__ = False  # pytest takes it for a test

    RANDOM = "random"
    """At random, among those that the environment may send."""
    EDGES = "edges"
    """Half of them on the way to an edge of the system that was not taken yet."""
