"""Query forms of UPPAAL that tachk names but does not check: statistical, game, learning and scenario queries."""

from __future__ import annotations

import re
from collections.abc import Sequence

_PREFIXES = {
    "Pr": "statistical",
    "simulate": "statistical",
    "control": "game",
    "control_t": "game",
    "minE": "learning",
    "maxE": "learning",
    "minPr": "learning",
    "maxPr": "learning",
    "strategy": "learning",
    "saveStrategy": "learning",
    "loadStrategy": "learning",
    "scenario": "scenario",
    "sat": "scenario",
}

_AFTER_PREFIX = {
    "Pr": ("[", "("),
    "simulate": ("[",),
    "control": (":", "[", "_"),
    "control_t": ("*",),
    "minE": ("(", "["),
    "maxE": ("(", "["),
    "minPr": ("(", "["),
    "maxPr": ("(", "["),
    "saveStrategy": ("(",),
    "scenario": (":",),
    "sat": (":",),
}


def words_of(text: str) -> list[str]:
    """A text cut into words and single characters."""
    return re.findall(r"\w+|\S", text)


def unchecked_family(words: Sequence[str]) -> str | None:
    """The family of a query given as its words, or None if it is a symbolic one."""
    first, second = words[0], words[1] if len(words) > 1 else ""
    if first in _PREFIXES:
        if first == "strategy" and len(words) > 2 and words[2] in ("=", ":="):
            return "learning"
        if first == "simulate" and second.isdigit():
            return "statistical"
        if second in _AFTER_PREFIX.get(first, ()):
            return _PREFIXES[first]
    if first == "E" and second == "[" and ";" in words[2:] and ("max" in words or "min" in words):
        return "statistical"
    if first == "E" and second == "[" and len(words) > 2 and words[2] in ("<", "#"):
        return "statistical"
    if first == "{" and "control" in words:
        return "game"
    if len(words) > 2 and words[-2] == "under":
        return "learning"
    if first in ("A", "E") and second == "[" and "U" in words and words[-1] == "]":
        return "game"
    return None
