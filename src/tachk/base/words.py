"""Words that the text and the network made of it both know, beside the operators."""

from __future__ import annotations

from enum import StrEnum


class Direction(StrEnum):
    """What an edge does with a channel."""

    SEND = "!"
    RECEIVE = "?"


class QueryKind(StrEnum):
    """What a query asks."""

    POSSIBLY = "E<>"
    INVARIANTLY = "A[]"
    EVENTUALLY = "A<>"
    POTENTIALLY_ALWAYS = "E[]"
    LEADS_TO = "-->"
    SUPREMUM = "sup"
    INFIMUM = "inf"
    BOUNDS = "bounds"
