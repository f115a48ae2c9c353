"""Caches of results that depend on the discrete state alone, for the states used last.

A run that goes round the same discrete states thousands of times is then timed and judged as fast as its few states.
Faults are not cached: they happen again, in their place.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any, Protocol, TypeVar, TypeVarTuple

MOST_STATES = 512
"""Discrete states of which something is remembered."""


_NOTHING: Any = object()
"""Stands for a result that is not known."""


class Memory:
    """Results for discrete states, by function and arguments."""

    def __init__(self) -> None:
        self._known: dict[Hashable, dict[Hashable, Any]] = {}
        self._last: tuple[Hashable, dict[Hashable, Any]] = (None, {})

    def of(self, discrete: Hashable) -> dict[Hashable, Any]:
        """The cache of a discrete state; the oldest one makes room for a new one."""
        last, known_of_last = self._last
        if discrete is last:  # its hash need not be computed again
            return known_of_last
        found = self._known.get(discrete)
        if found is None:
            if len(self._known) == MOST_STATES:
                del self._known[next(iter(self._known))]
            found = self._known[discrete] = {}
        self._last = discrete, found
        return found


class _Remembering(Protocol):
    @property
    def memory(self) -> Memory: ...


Model = TypeVar("Model", bound=_Remembering)
State = TypeVar("State", bound=Hashable)
Arguments = TypeVarTuple("Arguments")
Result = TypeVar("Result")


def by_state(function: Callable[[Model, State, *Arguments], Result]) -> Callable[[Model, State, *Arguments], Result]:
    """A function of a model, a discrete state and other arguments, whose results the model caches.

    The results are shared: nobody may change them.
    """

    @wraps(function)
    def remembered(model: Model, discrete: State, /, *arguments: *Arguments) -> Result:
        known = model.memory.of(discrete)
        key = (function, arguments)
        found: Result = known.get(key, _NOTHING)
        if found is _NOTHING:
            found = known[key] = function(model, discrete, *arguments)
        return found

    return remembered
