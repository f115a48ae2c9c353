"""Types of arguments: a public function refuses an argument of the wrong type, in words, before it does anything."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, wraps
from itertools import islice
from operator import index
from typing import ParamSpec, TypeVar

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass

_P = ParamSpec("_P")
_R = TypeVar("_R")


def checked_arguments(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """The function, which raises UsageError where an argument is of another type than its annotation says.

    Where any number of texts or paths follow each other, lists of them are taken, too. Annotations that have no row in
    the tables below allow everything.
    """
    described = cache(lambda: _AnnotatedParameters.of(function))

    @wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        args_, kwargs_ = described().checked(args, kwargs)
        return function(*args_, **kwargs_)  # type: ignore[arg-type]

    return call


def check_argument(name: str, value: object, annotation: str) -> None:
    """Raises UsageError where a value is of another type than an annotation says."""
    kinds = _alternatives(annotation)
    if not any(_fits(value, kind) for kind in kinds):
        words = " or ".join(dict.fromkeys(_in_words(kind) for kind in kinds))
        raise UsageError(f"`{name}` is {_shown(value)}, but it must be {words}")


def check_proportion(name: str, value: float) -> None:
    """Raises UsageError where a value is not a number between 0 and 1."""
    check_argument(name, value, "float")
    if not 0 < value < 1:
        raise UsageError(f"`{name}` is {value}, but it must lie between 0 and 1")


@dataclass(frozen=True, slots=True)
class _AnnotatedParameters:
    """The parameters of a function with their annotations. The module `inspect` would take longer than most calls.

    Attributes:
        positional: in order, each with its annotation.
        several: the name and the annotation of what takes any number of positional arguments; None: there is none.
        named: the annotations of those that can be given by name.
        other: the annotation of those whose names are free; None: there are none.
    """

    positional: Sequence[tuple[str, str]]
    several: tuple[str, str] | None
    named: Mapping[str, str]
    other: str | None

    @classmethod
    def of(cls, function: Callable[..., object]) -> _AnnotatedParameters:
        code, annotations = function.__code__, function.__annotations__
        names = iter([(name, _text(annotations.get(name))) for name in code.co_varnames])
        positional = list(islice(names, code.co_argcount))
        named = dict([*positional[code.co_posonlyargcount :], *islice(names, code.co_kwonlyargcount)])
        several = next(names) if code.co_flags & _VARARGS else None
        other = next(names)[1] if code.co_flags & _VARKEYWORDS else None
        return cls(positional, several, named, other)

    def checked(
        self, given: Sequence[object], named: Mapping[str, object]
    ) -> tuple[Sequence[object], Mapping[str, object]]:
        """The arguments as the function takes them. Python says which are missing or too many."""
        more = given[len(self.positional) :]
        for (name, annotation), value in zip(self.positional, given, strict=False):
            check_argument(name, value, annotation)
        if self.several is not None:
            more = [inner for each in more for inner in (each if isinstance(each, list | tuple) else (each,))]
            for value in more:
                check_argument(self.several[0], value, self.several[1])
            given = [*given[: len(self.positional)], *more]
        for name, value in named.items():
            kind = self.named.get(name) or self.other
            if kind is not None:
                check_argument(name, value, kind)
        return given, named


_VARARGS, _VARKEYWORDS = 0x04, 0x08
"""Among the flags of code, see `inspect`."""


def _text(annotation: object) -> str:
    return annotation if isinstance(annotation, str) else "Any"


@cache
def _alternatives(annotation: str) -> Sequence[str]:
    """The parts between the bars outside of brackets."""
    depth, part, parts = 0, "", list[str]()
    for letter in annotation:
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if letter == "|" and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += letter
    return (*parts, part.strip())


def _fits(value: object, kind: str) -> bool:
    name = kind.partition("[")[0]
    if name in _TESTS:
        return _TESTS[name](value)
    if name in _SEVERAL:
        inner = kind.removeprefix(name)[1:-1]
        if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
            return False
        # An iterator, which can be read only once, is not examined.
        once = isinstance(value, Iterator) or not inner
        return once or all(any(_fits(each, part) for part in _alternatives(inner)) for each in value)
    if name in _CLASSES:
        return any(each.__name__ == name for each in type(value).__mro__)
    return True


def _is_whole(value: object) -> bool:
    try:
        index(value)  # type: ignore[arg-type]
    except TypeError:
        return False
    return True


def _is_real(value: object) -> bool:
    if isinstance(value, int | float):
        return True
    from numbers import Real

    return isinstance(value, Real)


_TESTS: Mapping[str, Callable[[object], bool]] = {
    "None": lambda value: value is None,
    "str": lambda value: isinstance(value, str),
    "int": _is_whole,
    "float": lambda value: _is_real(value) and value == value,  # nan is none
    "os.PathLike": lambda value: isinstance(value, os.PathLike),
    "Path": lambda value: isinstance(value, os.PathLike),
    "Mapping": lambda value: isinstance(value, Mapping),
    "tuple": lambda value: isinstance(value, tuple),
    "HasNetwork": lambda value: hasattr(value, "network"),
    "HasRun": lambda value: hasattr(value, "network") and hasattr(value, "trace"),
}
_SEVERAL = frozenset({"Iterable", "Sequence", "Collection"})
_CLASSES = {
    "Model": "a model of `tachk.load` or `tachk.loads`",
    "Limits": "`tachk.Limits(...)`",
    "Options": "`tachk.Options(...)`",
    "Grid": "a grid",
    "Fraction": "a fraction",
    "PossibleStep": "one of the `choices`",
}
_WORDS = _CLASSES | {
    "None": "None",
    "str": "a text",
    "int": "a whole number",
    "float": "a number",
    "os.PathLike": "a path",
    "Path": "a path",
    "Mapping": "a dictionary",
    "tuple": "a tuple",
    "HasNetwork": "a model of `tachk.load` or `tachk.loads`",
    "HasRun": "a run of a report, such as `report.run(NAME)`",
}


def _in_words(kind: str) -> str:
    name = kind.partition("[")[0]
    if name in _SEVERAL:
        inner = kind.removeprefix(name)[1:-1]
        plural = {"str": "texts", "int": "whole numbers"}.get(inner)
        return "a list" if plural is None else f"a list of {plural}"
    return _WORDS.get(name, name)


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
