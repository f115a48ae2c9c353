"""Formulas of which a condition on one state is enough are first looked at in a search that other queries need anyway.

``G (p -> q)`` and ``G (p -> F[0,5] q)`` hold where ``p imply q`` is true in all states. To see that, no observer has to
be beside the network, so that one search answers several such formulas, and plain invariants with them. A formula of
which the condition is false somewhere is checked by its observer, as every other one.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk.analysis.fold import cannot_fail
from tachk.analysis.impossible_edges import without_impossible
from tachk.base.records import replace
from tachk.engine.compiler.goal import mentions_time
from tachk.engine.options import Engine, Options, Pace
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.transform.blocking_processes import without_blocking
from tachk.transform.cone_of_influence import cone_of_influence
from tachk.verify.plan import Analysis, Search, Task

NAME = "sufficient"
"""As `Options.without` names it."""

MEANING = (
    "answer a formula such as `G (p -> q)` or `G (p -> F[0,5] q)` by a search that other queries need anyway: the "
    "formula holds if `p imply q` is true in all states"
)


def shared_searches(network: Network, searches: Sequence[Search], options: Options) -> tuple[Search, ...]:
    """Those of the searches, and new ones, in which conditions that are enough for formulas are looked at as well.

    A condition joins a search only if it brings nothing into it: neither into its cone of influence nor into what is
    left without blocking processes. Of a new search, of conditions only, there are two or more.
    """
    if NAME in options.without or options.engine is not Engine.ZONE or options.pace is not Pace.EARLY:
        return ()
    hosts = [search for search in searches if _may_be_joined(search)]
    joined: dict[int, list[Task]] = {}
    for guest in (guest for search in searches for guest in _guests(search)):
        for number, host in enumerate(hosts):
            others = [*host.targets, *(task.target for task in joined.get(number, ()))]
            if _searched(network, others, options) == _searched(network, [*others, guest.target], options):
                joined.setdefault(number, []).append(guest)
                break
        else:
            hosts.append(Search(Analysis.REACHABILITY, (guest,)))
    return tuple(replace(hosts[n], tasks=(*hosts[n].tasks, *guests)) for n, guests in joined.items())


def _may_be_joined(search: Search) -> bool:
    plain = search.analysis is Analysis.REACHABILITY and search.observer is None
    return plain and not search.explores_everything and not any(map(mentions_time, search.targets))


def _guests(search: Search) -> list[Task]:
    observer = search.observer
    if observer is None or search.analysis is not Analysis.REACHABILITY:
        return []
    enough = observer.sufficient
    return [replace(task, condition=enough) for task in search.tasks if enough is not None and cannot_fail(enough)]


def _searched(network: Network, targets: Sequence[Expression], options: Options) -> tuple[Network, Network]:
    """The networks that are searched for targets: what can influence them, and what is left without blocking others."""
    possible = without_impossible(network)
    whole = cone_of_influence(network, targets).network if options.cone else network
    return whole, without_blocking(possible, targets).network
