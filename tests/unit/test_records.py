"""The decorator does what the standard one does; only later."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError
from typing import Any

import pytest

import tachk.base.records
from tachk.base import record_methods
from tachk.base.records import dataclass, field, fields, replace


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
    compiled = tachk.base.records._compiled  # type: ignore[attr-defined]
    monkeypatch.setattr(tachk.base.records, "_compiled", lambda *a: made.append(a[0].__name__) or compiled(*a))

    @dataclass(frozen=True, slots=True)
    class Late:
        a: int

    assert made == []
    assert Late(1) == Late(1)
    assert made == ["Late", "Late"]
    assert Late(2) != Late(1)
    assert made == ["Late", "Late"]


def test_classes_are_like_those_of_the_standard_decorator() -> None:
    """What both make of the same words."""
    ours = {"dataclass": dataclass, "field": field}
    theirs = {"dataclass": dataclasses.dataclass, "field": dataclasses.field}
    words = """
from __future__ import annotations

@dataclass(frozen=True, slots=True)
class Base:
    "A base."
    a: int
    b: list[int] = field(default_factory=list, kw_only=True)
    c: str = field(default="c", repr=False, hash=False)

@dataclass(frozen=True, slots=True)
class Derived(Base):
    d: int = 4
    e: tuple[int, ...] = field(default=(), init=False)
    c: str = "d"

@dataclass(eq=False)
class Plain:
    x: object = None
"""
    for names in (ours, theirs):
        exec(words, names)
    for name, arguments in (("Base", (1,)), ("Derived", (1, "x")), ("Plain", ())):
        mine, other = ours[name], theirs[name]
        for what in ("__match_args__", "__slots__", "__doc__"):
            if what != "__doc__" or name == "Base":
                assert getattr(mine, what, None) == getattr(other, what, None)
        assert str(inspect.signature(mine)) == str(inspect.signature(other))
        assert [(f.name, f.type, f.init, f.kw_only) for f in fields(mine)] == [
            (f.name, f.type, f.init, f.kw_only) for f in fields(other)
        ]
        assert dataclasses.asdict(mine(*arguments)) == dataclasses.asdict(other(*arguments))
        if name != "Plain":
            assert repr(mine(*arguments)) == repr(other(*arguments))
            assert hash(mine(1, b=3)) == hash(other(1, b=3))
    foreign = {"dataclass": dataclass, "field": dataclasses.field}
    with pytest.raises(TypeError, match="the function `field` is that of"):
        exec("@dataclass()\nclass Wrong:\n    x: int = field(repr=False)", foreign)
    mutable = {"dataclass": dataclass}
    with pytest.raises(ValueError, match="mutable default"):
        exec("@dataclass()\nclass Wrong:\n    x: list = []", mutable)


@pytest.mark.parametrize("number", [1, 3, 30])
def test_records_of_any_size_are_like_those_of_the_standard_decorator(number: int) -> None:
    """Also of more fields than there are compiled methods for."""
    names = [f"n{each}" for each in range(number)]
    ours, theirs = (
        made(frozen=True)(type("Sized", (), {"__annotations__": dict.fromkeys(names, int)}))
        for made in (dataclass, dataclasses.dataclass)
    )
    mine, other = ours(*range(number)), theirs(*range(number))
    assert repr(mine) == repr(other)
    assert hash(mine) == hash(other)
    assert dataclasses.asdict(mine) == dataclasses.asdict(other)
    assert mine == ours(**dict(zip(names, range(number), strict=True))) != replace(mine, n0=7)
    assert replace(mine, n0=7) == dataclasses.replace(mine, n0=7)
    assert [each.default for each in dataclasses.fields(mine)] == [each.default for each in dataclasses.fields(other)]


@pytest.mark.parametrize("kind", record_methods.METHODS)
def test_the_compiled_methods_are_what_their_text_says(kind: str) -> None:
    for number, method in enumerate(record_methods.METHODS[kind]):
        written = eval(record_methods.text(kind, number)).__code__
        assert (written.co_code, written.co_consts, written.co_names, written.co_varnames) == (
            method.__code__.co_code,
            method.__code__.co_consts,
            method.__code__.co_names,
            method.__code__.co_varnames,
        )


def test_standard_classes_and_records_inherit_from_each_other() -> None:
    @dataclasses.dataclass(frozen=True)
    class Standard(OwnText):
        more: str = "m"

    assert dataclasses.astuple(Standard(1)) == (1, "m")
    assert replace(Standard(1), n=2) == Standard(2)
    assert [each.name for each in fields(Standard)] == ["n", "more"]


def test_an_object_that_holds_itself_has_a_text() -> None:
    point = Point("here", 1)
    point.more.append(point)  # type: ignore[arg-type]
    assert repr(point) == "Point(x=1, more=[...])"
