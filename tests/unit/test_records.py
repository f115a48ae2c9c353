"""The decorator does what the standard one does; only later."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError, field, fields, replace
from typing import Any

import pytest

from tachk.records import dataclass


@dataclass(frozen=True, slots=True)
class Point:
    place: str = field(compare=False, repr=False)
    x: int
    more: list[int] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Named(Point):
    name: str = "none"

    def __str__(self) -> str:
        return f"the point {self.name}"


@dataclass(slots=True)
class Counter:
    n: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Identity:
    n: int

    def __post_init__(self) -> None:
        if self.n < 0:
            raise ValueError("negative")


@dataclass(frozen=True, slots=True)
class OwnText:
    n: int

    def __repr__(self) -> str:
        return f"<{self.n}>"


def test_equality_and_text_leave_out_what_the_fields_say() -> None:
    assert Point("here", 1) == Point("there", 1) != Point("here", 2)
    assert Point("here", 1) != Named("here", 1)
    assert repr(Named("here", 1, [2])) == "Named(x=1, more=[2], name='none')"
    assert str(Named("here", 1)) == "the point none"
    assert repr(OwnText(3)) == "<3>"


def test_hash_is_that_of_equal_fields_or_of_the_object() -> None:
    assert hash(OwnText(3)) == hash(OwnText(3)) != hash(OwnText(4))
    assert Identity(1) != Identity(1)
    assert len({Identity(1), Identity(1)}) == 2
    with pytest.raises(TypeError, match="unhashable"):
        hash(Counter())


def test_a_frozen_object_stays_as_it_is() -> None:
    point = Named("here", 1)
    with pytest.raises(FrozenInstanceError):
        point.x = 2  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError):
        del point.name
    counter = Counter()
    counter.n = 7
    assert counter == Counter(7)


def test_arguments_are_checked_and_the_class_may_check_more() -> None:
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'x'"):
        Point("here")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword"):
        Counter(m=3)  # type: ignore[call-arg]
    with pytest.raises(ValueError, match="negative"):
        Identity(-1)
    assert Point("here", 1).more is not Point("here", 1).more


@pytest.mark.parametrize("value", [Named("here", 1, [2], "a"), Counter(4), OwnText(2)])
def test_objects_are_copied_and_pickled(value: Any) -> None:
    assert pickle.loads(pickle.dumps(value)) == value
    assert copy.deepcopy(value) == value
    assert replace(value) == value


def test_the_signature_is_known_before_and_after_the_first_call() -> None:
    @dataclass(frozen=True, slots=True)
    class Late:
        a: int
        b: str = "b"

    before = str(inspect.signature(Late))
    Late(1)
    assert before == str(inspect.signature(Late)) == "(a: 'int', b: 'str' = 'b') -> None"
    assert [each.name for each in fields(Late)] == ["a", "b"]


def test_a_method_is_compiled_once_and_when_it_is_called(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    make = dataclasses.make_dataclass
    monkeypatch.setattr(dataclasses, "make_dataclass", lambda *a, **n: made.append(a[0]) or make(*a, **n))

    @dataclass(frozen=True, slots=True)
    class Late:
        a: int

    assert made == []
    assert Late(1) == Late(1)
    assert made == ["Late", "Late"]
    assert Late(2) != Late(1)
    assert made == ["Late", "Late"]
