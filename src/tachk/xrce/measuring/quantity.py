"""A measured quantity, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from enum import StrEnum
from statistics import median
from typing import Final

from tachk.base.records import dataclass


class Confidence(StrEnum):
    """The evidence for a quantity."""

    MEASURED = "measured"
    ONE_SAMPLE = "one sample"
    BOUND = "bound only"
    ASSUMED = "assumed"
    NOT_ENOUGH = "not enough evidence"


class QuantityUnit(StrEnum):
    MILLISECONDS = "ms"
    PERCENT = "%"
    COUNT = ""


@dataclass(frozen=True, slots=True)
class PacketPlace:
    """A packet of a file; a number from 1."""

    file: str
    packet: int


@dataclass(frozen=True, slots=True)
class Observation:
    """One observation and the packets that it came from."""

    value: float
    places: tuple[PacketPlace, ...]


@dataclass(frozen=True, slots=True)
class Quantity:
    """Attributes:
    name: an identifier.
    title: what is measured.
    unit: of the values.
    samples: what was seen, in the order in which it was seen.
    value: what it amounts to; None where nothing can be said.
    confidence: how that is known.
    how: what it was inferred from, or what is missing, as a sentence.
    """

    name: str
    title: str
    unit: QuantityUnit
    samples: tuple[Observation, ...]
    value: float | None
    confidence: Confidence
    how: str

    @property
    def minimum(self) -> float | None:
        return min((sample.value for sample in self.samples), default=None)

    @property
    def median(self) -> float | None:
        return median(sample.value for sample in self.samples) if self.samples else None

    @property
    def maximum(self) -> float | None:
        return max((sample.value for sample in self.samples), default=None)

    @property
    def places(self) -> tuple[PacketPlace, ...]:
        """Every packet that a sample came from, each once."""
        return tuple(dict.fromkeys(place for sample in self.samples for place in sample.places))


def seen(
    name: str, title: str, samples: Iterable[Observation], missing: str, unit: QuantityUnit = QuantityUnit.MILLISECONDS
) -> Quantity:
    """A quantity whose value is the median of the observations.

    Args:
        missing: what the captures would have to show, said where there is no sample.
    """
    found = tuple(samples)
    if not found:
        return Quantity(name, title, unit, (), None, Confidence.NOT_ENOUGH, missing)
    confidence = Confidence.ONE_SAMPLE if len(found) == 1 else Confidence.MEASURED
    return Quantity(name, title, unit, found, median(s.value for s in found), confidence, "the median")


_LATENESS: Final = 0.04
"""The part by which a single recorded wait may be too long: what computes and sends comes late, never early."""

_OFF: Final = 0.004
"""The part by which any number of recorded waits may be off."""


def roundest(low: float, high: float, samples: int) -> float:
    """The number with the fewest digits between two others or a little below: a likely setting of a timer.

    Args:
        samples: how many waits were seen; the fewer, the longer even the shortest of them may be.
    """
    low, high = low * (1 - max(_LATENESS / max(samples, 1), _OFF)), high * (1 + _OFF)
    step = 10.0 ** math.floor(math.log10(high))
    while step > 1e-6:
        for part in (1.0, 0.5):
            found = math.floor(high / (step * part)) * step * part
            if found >= low:
                return float(f"{found:.9g}")
        step /= 10
    return low


_LATE: Final = 1.1


def punctual(samples: Sequence[Observation]) -> list[Observation]:
    """The samples that are hardly longer than the shortest: the others waited for something else as well."""
    shortest = min((sample.value for sample in samples), default=0.0)
    return [sample for sample in samples if sample.value <= shortest * _LATE]
