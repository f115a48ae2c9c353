"""Types of arguments: a public function refuses an argument of the wrong type, in words, before it does anything."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, wraps
from inspect import Parameter, Signature, signature
from numbers import Real
from operator import index
from typing import ParamSpec, TypeVar

from tachk.base.diagnostics.diagnostic import UsageError

_P = ParamSpec("_P")
_R = TypeVar("_R")


def checked_arguments(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """The function, which raises UsageError where an argument is of another type than its annotation says.

    Where any number of texts or paths follow each other, lists of them are taken, too. Annotations that have no row in
    the tables below allow everything.
    """
    described = cache(lambda: signature(function))

    @wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            bound = described().bind(*args, **kwargs)
        except TypeError:
            return function(*args, **kwargs)  # Python says which argument is missing or too many
        args_, kwargs_ = _checked(described(), bound.arguments)
        return function(*args_, **kwargs_)  # type: ignore[arg-type]

    return call


def check_argument(name: str, value: object, annotation: str) -> None:
    """Raises UsageError where a value is of another type than an annotation says."""
    kinds = list(_alternatives(annotation))
    if not any(_fits(value, kind) for kind in kinds):
        words = " or ".join(dict.fromkeys(_in_words(kind) for kind in kinds))
        raise UsageError(f"`{name}` is {_shown(value)}, but it must be {words}")


def check_proportion(name: str, value: float) -> None:
    """Raises UsageError where a value is not a number between 0 and 1."""
    check_argument(name, value, "float")
    if not 0 < value < 1:
        raise UsageError(f"`{name}` is {value}, but it must lie between 0 and 1")


def _checked(described: Signature, given: Mapping[str, object]) -> tuple[list[object], dict[str, object]]:
    """Positional and named arguments as the function takes them."""
    positional: list[object] = []
    named: dict[str, object] = {}
    for name, value in given.items():
        parameter = described.parameters[name]
        annotation = parameter.annotation if isinstance(parameter.annotation, str) else "Any"
        if parameter.kind is Parameter.VAR_POSITIONAL:
            assert isinstance(value, tuple)
            several = [inner for each in value for inner in (each if isinstance(each, list | tuple) else (each,))]
            for each in several:
                check_argument(name, each, annotation)
            positional += several
        elif parameter.kind is Parameter.VAR_KEYWORD:
            assert isinstance(value, dict)
            for key, each in value.items():
                check_argument(key, each, annotation)
            named |= value
        else:
            check_argument(name, value, annotation)
            if parameter.kind is Parameter.KEYWORD_ONLY:
                named[name] = value
            elif len(positional) == list(described.parameters).index(name):
                positional.append(value)
            else:
                named[name] = value
    return positional, named


def _alternatives(annotation: str) -> Iterator[str]:
    """The parts between the bars outside of brackets."""
    depth, part = 0, ""
    for letter in annotation:
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if letter == "|" and depth == 0:
            yield part.strip()
            part = ""
        else:
            part += letter
    yield part.strip()


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


_TESTS: Mapping[str, Callable[[object], bool]] = {
    "None": lambda value: value is None,
    "str": lambda value: isinstance(value, str),
    "int": _is_whole,
    "float": lambda value: isinstance(value, Real) and value == value,  # nan is none
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
