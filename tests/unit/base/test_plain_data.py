"""Plain data is derived from dataclasses, and what has none is refused."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from fractions import Fraction

import numpy as np
import pytest

from tachk.base.plain_data import Fields, PlainData


class Colour(StrEnum):
    RED = "red"


class Level(IntEnum):
    HIGH = 2


@dataclass(frozen=True, slots=True)
class Inner:
    time: Fraction
    colour: Colour


@dataclass(frozen=True, slots=True)
class Outer:
    name: str
    inner: Inner | None
    counts: dict[Colour, int]
    values: object = ()


INNER = Inner(Fraction(5, 2), Colour.RED)


def test_a_dataclass_is_reported_with_its_fields() -> None:
    told = PlainData().of(Outer("a", INNER, {Colour.RED: 1}, (1.5, Level.HIGH, None, True)))
    assert told == {
        "name": "a",
        "inner": {"time": "5/2", "colour": "red"},
        "counts": {"red": 1},
        "values": [1.5, 2, None, True],
    }
    assert [type(value) for value in (told["inner"]["colour"], told["values"][1], *told["counts"])] == [str, int, str]


def test_arrays_are_lists_of_numbers() -> None:
    told = PlainData()((np.array([1, 2]), np.float64(0.5), np.bool_(True)))
    assert told == [[1, 2], 0.5, True]
    assert [type(value) for value in (told[0][0], told[1], told[2])] == [int, float, bool]


def test_fields_are_renamed_ordered_computed_and_left_out() -> None:
    form = Fields("at=inner.time title=name size", size=lambda outer: len(outer.counts), more=lambda outer: (1,))
    plain = PlainData({Outer: form})
    assert list(plain.of(Outer("a", INNER, {})).items()) == [("at", "5/2"), ("title", "a"), ("size", 0), ("more", [1])]
    assert plain.of(Outer("a", None, {}))["at"] is None


def test_a_function_stands_for_fields_whatever_the_type() -> None:
    plain = PlainData({Fraction: float, float: lambda number: round(number), Colour: lambda colour: colour.name})
    assert plain.of(INNER) == {"time": 2.5, "colour": "RED"}
    assert plain([0.6, 1]) == [1, 1]


def test_what_has_no_plain_data_is_rejected() -> None:
    for value in (object(), {1, 2}, b"bytes"):
        with pytest.raises(TypeError, match="has no plain data"):
            PlainData()(value)
    with pytest.raises(AttributeError):
        PlainData({Outer: Fields("nmae")}).of(Outer("a", None, {}))
