"""Caches of results that depend on a network or a part of one, for those used last.

Networks are compared by identity: to compare their contents would cost as much as most of the results.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, wraps
from typing import Any, TypeVar, TypeVarTuple

from tachk.model.network import Network

MOST_RESULTS = 16
"""Results of one function that are remembered."""

MOST_PARTS = 20_000
"""Parts of networks for which a result of one function is remembered."""

Part = TypeVar("Part")
Arguments = TypeVarTuple("Arguments")
Result = TypeVar("Result")


def by_network(function: Callable[[Network, *Arguments], Result]) -> Callable[[Network, *Arguments], Result]:
    """A function of a network and other arguments, with a cache of its last results.

    The results are shared and must not be changed. Exceptions are not cached.
    """
    return by_network_where(lambda result: True)(function)


def by_network_where(
    worth: Callable[[Result], bool],
) -> Callable[[Callable[[Network, *Arguments], Result]], Callable[[Network, *Arguments], Result]]:
    """As `by_network`, with a cache of those results that are worth it: of none that takes much memory."""
    return partial(_with_cache, worth)


def _with_cache(
    worth: Callable[[Result], bool], function: Callable[[Network, *Arguments], Result]
) -> Callable[[Network, *Arguments], Result]:
    known: dict[int, tuple[Network, tuple[Any, ...], Any]] = {}

    @wraps(function)
    def remembered(network: Network, /, *arguments: *Arguments) -> Result:
        key = hash((id(network), *arguments))  # a dictionary with the arguments as keys would hash them again and again
        entry = known.get(key)
        if entry is None or entry[0] is not network or entry[1] != arguments:
            entry = network, arguments, function(network, *arguments)
            if not worth(entry[2]):
                result: Result = entry[2]
                return result
            while len(known) >= MOST_RESULTS:
                known.pop(next(iter(known)), None)
            known[key] = entry
        found: Result = entry[2]
        return found

    return remembered


def by_part(function: Callable[[Part, *Arguments], Result]) -> Callable[[Part, *Arguments], Result]:
    """A function of a part of a network, such as an expression, and of what is known about the network, with the last
    result for each part. Networks that have most of their parts in common share what is worked out for them.

    The results are shared and must not be changed. Errors are not remembered.
    """
    known: dict[int, tuple[Part, tuple[Any, ...], Any]] = {}

    @wraps(function)
    def remembered(part: Part, /, *arguments: *Arguments) -> Result:
        entry = known.get(id(part))
        if entry is None or entry[1] != arguments:
            entry = part, arguments, function(part, *arguments)  # the part is kept, so that no other gets its identity
            if len(known) >= MOST_PARTS:
                known.clear()
            known[id(part)] = entry
        found: Result = entry[2]
        return found

    return remembered
