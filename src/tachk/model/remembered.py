"""What depends on a network is worked out once for each of the networks that came last.

Networks are told apart by their identity: to compare two of them would cost as much as most of what is asked.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any, TypeVar, TypeVarTuple

from tachk.model.network import Network

MOST_RESULTS = 16
"""Results of one function that are remembered."""

Asked = TypeVarTuple("Asked")
Result = TypeVar("Result")


def by_network(function: Callable[[Network, *Asked], Result]) -> Callable[[Network, *Asked], Result]:
    """A function of a network and of what is asked about it, with its last results.

    The results are shared: nobody may change them. Nothing that went wrong is remembered.
    """
    known: dict[Hashable, tuple[Network, Any]] = {}

    @wraps(function)
    def remembered(network: Network, /, *asked: *Asked) -> Result:
        key = (id(network), *asked)
        entry = known.get(key)
        if entry is None:
            entry = network, function(network, *asked)  # the network is kept, so that no other gets its identity
            while len(known) >= MOST_RESULTS:
                known.pop(next(iter(known)), None)
            known[key] = entry
        found: Result = entry[1]
        return found

    return remembered
