"""The marks of answers in pictures: filled, hatched, dotted, so that they differ in shape, not only in colour."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from matplotlib.patches import Patch

from tachk.verify.verdict import Answer

_FACE = {Answer.HOLDS: "#5a9367", Answer.FAILS: "#ffffff", Answer.UNKNOWN: "#e4e4e4"}
_INK = {Answer.HOLDS: "#3d6b48", Answer.FAILS: "#a4161a", Answer.UNKNOWN: "#777777"}
_HATCH = {Answer.HOLDS: "", Answer.FAILS: "////", Answer.UNKNOWN: "..."}
_DISTANCES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 10**3, 10**4, 10**5, 10**6)


def mark_of(answer: Answer) -> dict[str, Any]:
    """The colours and the hatch of a patch."""
    return {"facecolor": _FACE[answer], "edgecolor": _INK[answer], "hatch": _HATCH[answer]}


def legend_of(answers: Iterable[Answer]) -> list[Any]:
    """A patch for each answer, with its name."""
    return [Patch(**mark_of(answer), linewidth=0.5, label=answer.value) for answer in answers]


def evenly_labelled(size: int) -> list[int]:
    """The numbers of the values along an axis that get a label: the first, and at most ten in equal distances from
    it."""
    return list(range(0, size, next(distance for distance in _DISTANCES if size <= 11 * distance)))
