"""A measured quantity, and how well it is known."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import chain, islice
from statistics import median
from typing import Final, overload

import numpy as np

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


_FEW: Final = 1000
"""So many observations are held as they are."""


class PackedSamples(Sequence[Observation]):
    """Many observations, as columns of numbers."""

    def __init__(self, found: Iterable[Observation]) -> None:
        self._values, self._whole = array("d"), bytearray()
        self._files: dict[str, int] = {}
        self._packets, self._first = array("q"), array("q", [0])
        for each in found:
            self._values.append(each.value)
            self._whole.append(isinstance(each.value, int))
            for place in each.places:
                number = self._files.setdefault(place.file, len(self._files))
                self._packets.append(number << _FILE | place.packet)
            self._first.append(len(self._packets))
        self._names = tuple(self._files)

    def __len__(self) -> int:
        return len(self._values)

    @overload
    def __getitem__(self, number: int) -> Observation: ...
    @overload
    def __getitem__(self, number: slice) -> tuple[Observation, ...]: ...
    def __getitem__(self, number: int | slice) -> Observation | tuple[Observation, ...]:
        if isinstance(number, slice):
            return tuple(self[each] for each in range(len(self))[number])
        place = range(len(self))[number]
        packets = self._packets[self._first[place] : self._first[place + 1]]
        places = tuple(PacketPlace(self._names[each >> _FILE], each & (1 << _FILE) - 1) for each in packets)
        return Observation(self._value(place), places)

    def _value(self, place: int) -> float:
        return int(self._values[place]) if self._whole[place] else self._values[place]

    def values(self) -> Iterator[float]:
        """Those of all of them."""
        return map(self._value, range(len(self)))

    def places(self) -> int:
        """The number of packets that they came from."""
        return len(np.unique(np.frombuffer(self._packets, np.int64)))


_FILE: Final = 40
"""So many bits of a number are the packet, those above the file."""


def gathered(found: Iterable[Observation]) -> Sequence[Observation]:
    """The observations; many of them as columns."""
    rest = iter(found)
    first = tuple(islice(rest, _FEW))
    return first if len(first) < _FEW else PackedSamples(chain(first, rest))


def values_of(samples: Sequence[Observation]) -> Iterator[float]:
    """What was observed."""
    return samples.values() if isinstance(samples, PackedSamples) else (sample.value for sample in samples)


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
    samples: Sequence[Observation]
    value: float | None
    confidence: Confidence
    how: str

    @property
    def minimum(self) -> float | None:
        return min(values_of(self.samples), default=None)

    @property
    def median(self) -> float | None:
        return median(values_of(self.samples)) if self.samples else None

    @property
    def maximum(self) -> float | None:
        return max(values_of(self.samples), default=None)

    @property
    def places(self) -> tuple[PacketPlace, ...]:
        """Every packet that a sample came from, each once."""
        return tuple(dict.fromkeys(place for sample in self.samples for place in sample.places))

    def first_places(self, most: int) -> tuple[tuple[PacketPlace, ...], int]:
        """So many of `places`, and how many there are."""
        if not isinstance(self.samples, PackedSamples):
            return self.places[:most], len(self.places)
        first: dict[PacketPlace, None] = {}
        for sample in self.samples:
            first |= dict.fromkeys(sample.places)
            if len(first) >= most:
                break
        return tuple(first)[:most], self.samples.places()


def seen(
    name: str, title: str, samples: Iterable[Observation], missing: str, unit: QuantityUnit = QuantityUnit.MILLISECONDS
) -> Quantity:
    """A quantity whose value is the median of the observations.

    Args:
        missing: what the captures would have to show, said where there is no sample.
    """
    found = gathered(samples)
    if not found:
        return Quantity(name, title, unit, (), None, Confidence.NOT_ENOUGH, missing)
    confidence = Confidence.ONE_SAMPLE if len(found) == 1 else Confidence.MEASURED
    return Quantity(name, title, unit, found, median(values_of(found)), confidence, "the median")


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
