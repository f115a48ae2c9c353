"""A measured quantity, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import pairwise
from typing import Any, Final, overload

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.xrce.joined_submessages import places_in
from tachk.xrce.packets import Numbers


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
"""So many observations, or packets that they came from, are held as they are."""

_MANY: Final = 10_000

_FILE: Final = 40
"""So many bits of a number are the packet, those above the file."""


class PackedSamples(Sequence[Observation]):
    """Many observations, as columns of numbers.

    Attributes:
        values: what was observed; whole numbers or not.
    """

    def __init__(self, values: NDArray[Any], places: Numbers, first: Numbers, files: tuple[str, ...]) -> None:
        """Args:
        places: the packets of all of them, one behind the other, with the number of the file above.
        first: where those of each begin, and the end.
        """
        self.values, self._places, self._first, self._files = values, places, first, files

    def __len__(self) -> int:
        return len(self.values)

    @overload
    def __getitem__(self, number: int) -> Observation: ...
    @overload
    def __getitem__(self, number: slice) -> tuple[Observation, ...]: ...
    def __getitem__(self, number: int | slice) -> Observation | tuple[Observation, ...]:
        if isinstance(number, slice):
            return tuple(self[each] for each in range(len(self))[number])
        at = range(len(self))[number]
        places = self._places[self._first[at] : self._first[at + 1]].tolist()
        return Observation(
            self.values[at].item(),
            tuple([PacketPlace(self._files[each >> _FILE], each & (1 << _FILE) - 1) for each in places]),
        )

    def __iter__(self) -> Iterator[Observation]:
        return (
            Observation(value, tuple([PacketPlace(file, packet) for file, packet in places]))
            for value, places in self.rows()
        )

    def rows(self) -> Iterator[tuple[float, list[tuple[str, int]]]]:
        """Each value, and the file and the packet of each place."""
        for begin in range(0, len(self), _MANY):
            ends = self._first[begin : begin + _MANY + 1]
            coded = self._places[ends[0] : ends[-1]]
            files = [self._files[number] for number in (coded >> _FILE).tolist()]
            places = list(zip(files, (coded & (1 << _FILE) - 1).tolist(), strict=True))
            values, limits = self.values[begin : begin + _MANY].tolist(), (ends - ends[0]).tolist()
            yield from ((value, places[a:b]) for value, (a, b) in zip(values, pairwise(limits), strict=True))

    def chosen(self, which: NDArray[np.bool_]) -> PackedSamples:
        """Those where this is true."""
        sizes = np.diff(self._first)[which]
        places = self._places[places_in(self._first[:-1][which], sizes)]
        return PackedSamples(self.values[which], places, np.append(0, np.cumsum(sizes)), self._files)

    def places(self) -> int:
        """The number of packets that they came from."""
        places = np.sort(self._places)
        return int(np.count_nonzero(places[1:] != places[:-1])) + (len(places) > 0)

    @staticmethod
    def together(found: Sequence[PackedSamples]) -> PackedSamples:
        """Those of all, one behind the other."""
        if len(found) == 1:
            return found[0]
        files: dict[str, int] = {}
        places, first, before = [np.zeros(0, np.int64)], [np.zeros(1, np.int64)], 0
        for each in found:
            numbers = np.array([files.setdefault(file, len(files)) for file in each._files], np.int64)
            places.append(numbers[each._places >> _FILE] << _FILE | each._places & (1 << _FILE) - 1)
            first.append(each._first[1:] + before)
            before += len(each._places)
        values = np.concatenate([each.values for each in found]) if found else np.zeros(0)
        return PackedSamples(values, np.concatenate(places), np.concatenate(first), tuple(files))

    def as_they_are(self) -> Sequence[Observation]:
        """The observations themselves if they are few."""
        return tuple(self) if max(len(self), len(self._places)) < _FEW else self


def packed(file: str, values: NDArray[Any], *packets: Numbers) -> PackedSamples:
    """Observations in one file, each of which came from as many packets."""
    places = np.stack(packets, axis=1).ravel() if packets else np.zeros(0, np.int64)
    return PackedSamples(values, places, np.arange(len(values) + 1) * len(packets), (file,))


def packed_groups(file: str, values: NDArray[Any], packets: Numbers, counts: Numbers) -> PackedSamples:
    """Observations in one file, each of which came from so many of these packets."""
    return PackedSamples(values, packets, np.append(0, np.cumsum(counts)), (file,))


def gathered(found: Iterable[PackedSamples]) -> Sequence[Observation]:
    """The observations together; few of them as they are."""
    return PackedSamples.together(list(found)).as_they_are()


def values_of(samples: Sequence[Observation]) -> NDArray[Any]:
    """What was observed."""
    if isinstance(samples, PackedSamples):
        return samples.values
    return np.array([sample.value for sample in samples])


def median_of(samples: Sequence[Observation]) -> float:
    """The middle of what was observed; of two in the middle half their sum. There is something."""
    values, half = values_of(samples), len(samples) // 2
    if len(values) % 2:
        found: float = np.partition(values, half)[half].item()
        return found
    low, high = np.partition(values, [half - 1, half])[half - 1 : half + 1].tolist()
    return float((low + high) / 2)


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
        return values_of(self.samples).min().item() if self.samples else None

    @property
    def median(self) -> float | None:
        return median_of(self.samples) if self.samples else None

    @property
    def maximum(self) -> float | None:
        return values_of(self.samples).max().item() if self.samples else None

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
    name: str, title: str, samples: Sequence[Observation], missing: str, unit: QuantityUnit = QuantityUnit.MILLISECONDS
) -> Quantity:
    """A quantity whose value is the median of the observations.

    Args:
        missing: what the captures would have to show, said where there is no sample.
    """
    if not samples:
        return Quantity(name, title, unit, (), None, Confidence.NOT_ENOUGH, missing)
    confidence = Confidence.ONE_SAMPLE if len(samples) == 1 else Confidence.MEASURED
    return Quantity(name, title, unit, samples, median_of(samples), confidence, "the median")


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
