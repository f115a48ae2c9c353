"""The names of what a test suite covers, and its size in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

from tachk.engine.edge_paths import Place
from tachk.model.network import Network
from tachk.model.quantity import grouped
from tachk.model.run import Participant
from tachk.simulation.stepping.run_file import alike_edges
from tachk.transform.unfolded_edges import UnfoldedNetwork, unfolded_by_edges
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.suite import CoveringSuite

KINDS = {
    Coverage.EDGES: ("edge", "taken"),
    Coverage.PAIRS: ("pair", "taken"),
    Coverage.LOCATIONS: ("location", "visited"),
}
"""What a suite covers, and what runs do with it."""


def place_text(network: Network, coverage: Coverage, place: Place) -> str:
    """``P: A -> B #2`` as in the file of a run, ``P.A``, or ``P: A -> B, B -> C`` for a pair of edges."""
    number, each = place
    process = network.processes[number]
    if coverage is Coverage.PAIRS:
        pair = _unfolded(network).pairs[number][each]
        last = place_text(network, Coverage.EDGES, (number, pair.edge))
        if pair.before is None:
            return f"{last}, first"
        return f"{place_text(network, Coverage.EDGES, (number, pair.before))}, {last.removeprefix(f'{process.name}: ')}"
    if coverage is Coverage.LOCATIONS:
        return f"{process.name}.{process.locations[each].name}"
    alike = alike_edges(network, Participant(number, each))
    which = f" #{alike.index(each) + 1}" if len(alike) > 1 else ""
    edge = process.edges[each]
    return f"{process.name}: {process.locations[edge.source].name} -> {process.locations[edge.target].name}{which}"


@lru_cache(maxsize=1)
def _unfolded(network: Network) -> UnfoldedNetwork:
    return unfolded_by_edges(network)


def size_text(suite: CoveringSuite) -> str:
    """``12 runs with 97 steps take 41 of 43 edges; 2 cannot be taken``"""
    edges = suite.coverage is not Coverage.LOCATIONS
    one = len(suite.runs) == 1
    verb = ("takes" if one else "take") if edges else ("visits" if one else "visit")
    what, done = KINDS[suite.coverage]
    covered, whole = len(suite.covered), len(suite.places)
    share = f"all {counted(whole, what)}" if covered == whole else f"{grouped(covered)} of {counted(whole, what)}"
    text = f"{counted(len(suite.runs), 'run')} with {counted(suite.steps, 'step')} {verb} {share}"
    if suite.impossible:
        text += f"; {grouped(len(suite.impossible))} cannot be {done}"
    if suite.unknown:
        text += f"; {grouped(len(suite.unknown))} unknown"
    return text


_SHOWN = 20
"""So many places or mutants of a kind are named."""


def listed(heading: str, names: Sequence[str]) -> Iterator[str]:
    """The heading and the first names, if there are any."""
    if not names:
        return
    yield heading
    yield from (f"  {name}" for name in names[:_SHOWN])
    if len(names) > _SHOWN:
        yield f"  and {grouped(len(names) - _SHOWN)} more: --format json names all"


def counted(count: int, what: str) -> str:
    return f"{grouped(count)} {what}{'' if count == 1 else 's'}"
