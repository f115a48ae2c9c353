"""Words that the text and the network made of it both know, beside the operators."""

from __future__ import annotations

from enum import StrEnum


class Direction(StrEnum):
    """The direction of a synchronisation."""

    SEND = "!"
    RECEIVE = "?"

    @property
    def opposite(self) -> Direction:
        """The direction of those with which it synchronises."""
        return Direction.RECEIVE if self is Direction.SEND else Direction.SEND


class QueryKind(StrEnum):
    """The kind of a query."""

    POSSIBLY = "E<>"
    INVARIANTLY = "A[]"
    EVENTUALLY = "A<>"
    POTENTIALLY_ALWAYS = "E[]"
    LEADS_TO = "-->"
    SUPREMUM = "sup"
    INFIMUM = "inf"
    BOUNDS = "bounds"
