"""Few paths that together cover all for which there is a path: a greedy choice.

The path to what is farthest from the initial state comes first, as what lies on the way is covered with it. Each path
goes on to what is nearest to its end and still uncovered, as long as that is at most `_DETOUR` times as far from there
as from the initial state: otherwise a new path costs fewer steps. At the end a path goes that covers nothing alone.
A smallest set is NP-hard to find (Aho, Lee 1987: set cover); tests measure how far from it these are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence

from tachk.engine.edge_paths import Actions, EdgePaths, Place
from tachk.model.network import Network
from tachk.verify.covering.coverage import Coverage

_DETOUR = 2


def covering_paths(network: Network, coverage: Coverage, edges: EdgePaths, exact: bool) -> tuple[Actions, ...]:
    """The paths, in the order of the choice.

    Args:
        edges: has searched.
        exact: whether each path has a run; otherwise only those to single edges are used, each judged for itself.
    """
    start = coverage.at_start(network)
    nearest: dict[Place, Actions] = {}
    for edge, path in edges.paths().items():
        place = coverage.by_edge(network, edge)
        if place not in start and (place not in nearest or len(path) < len(nearest[place])):
            nearest[place] = path

    def covered(path: Actions) -> frozenset[Place]:
        return frozenset(coverage.by_edge(network, edge) for edge in edges.taken_by(path)) & nearest.keys()

    if not exact:
        return tuple(nearest[place] for place in sorted(nearest))
    left = set(nearest)
    chosen: list[Actions] = []
    while left:
        farthest = max(left, key=lambda place: (len(nearest[place]), place))
        path = [*nearest[farthest]]
        left -= covered(path)
        while left and (more := _onward(network, coverage, edges, path, nearest, left)) is not None:
            path += more
            left -= covered(more)
        chosen.append(path)
    return tuple(without_redundant(chosen, covered))


def _onward(
    network: Network,
    coverage: Coverage,
    edges: EdgePaths,
    path: Actions,
    nearest: Mapping[Place, Actions],
    left: set[Place],
) -> Actions | None:
    """The way from the end of a path to what is uncovered; None if it is too long, or none was found."""
    processes = enumerate(network.processes)
    places = ((number, place) for number, process in processes for place in range(len(process.edges)))
    wanted = frozenset(edge for edge in places if coverage.by_edge(network, edge) in left)
    more = edges.onward(path, wanted)
    if more is None:
        return None
    reached = {coverage.by_edge(network, edge) for edge in edges.taken_by(more)} & left
    return more if len(more) <= _DETOUR * max(len(nearest[place]) for place in reached) else None


def without_redundant(paths: Sequence[Actions], covered: Callable[[Actions], frozenset[Place]]) -> Sequence[Actions]:
    """The paths without those that cover nothing that no other one covers; the shortest go first."""
    times = Counter(place for path in paths for place in covered(path))
    needed = dict(enumerate(paths))
    for number, path in sorted(needed.items(), key=lambda item: len(item[1])):
        if all(times[place] > 1 for place in covered(path)):
            del needed[number]
            times.subtract(covered(path))
    return [*needed.values()]
