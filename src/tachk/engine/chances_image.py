"""The flat form of the chances of a program, in which they go to the core beside it."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence

from tachk.engine.compiler.program import Chances, Computed, HybridClocks


def chances_image(chances: Chances) -> Iterator[int]:
    """The numbers that `src/core/flow/chances.cpp` reads."""
    for rates in chances.rates:
        yield from _numbers(rates)
    for choice, weight in zip(chances.choices, chances.weights, strict=True):
        yield choice
        yield from _number(weight)
    yield from _hybrid(chances.hybrid)
    yield from (len(chances.starts), *chances.starts)
    yield from _numbers(chances.observed)


def _hybrid(clocks: HybridClocks) -> Iterator[int]:
    yield from (len(clocks.slots), *clocks.slots)
    if not clocks.slots:
        return
    for rates in (rates for process in clocks.rates for rates in process):
        yield len(rates)
        for rate in rates:
            yield from (rate.clock, int(rate.varies), *_number(rate.rate))
    yield from (len(clocks.reads), *clocks.reads)


def _numbers(numbers: Sequence[Computed]) -> Iterator[int]:
    for number in numbers:
        yield from _number(number)


def _number(number: Computed) -> tuple[int, int]:
    if number.slot >= 0:
        return 3, number.slot
    if number.code >= 0:
        return 2 if number.floating else 1, number.code
    bits = struct.unpack("<q", struct.pack("<d", number.constant))[0]
    return 0 if number.floating else 4, bits
