"""What a diagnostic code stands for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Explanation:
    """Attributes:
    title: what is wrong, in a few words.
    why: the rule behind it, and how to mend it.
    bad: a short text that has the defect; empty where a text cannot show it.
    good: the same, mended.
    """

    title: str
    why: str
    bad: str = ""
    good: str = ""
