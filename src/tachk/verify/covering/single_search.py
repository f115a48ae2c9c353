"""A search for one edge or location alone, with all that makes a search for one target cheap."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.engine.edge_paths import Place
from tachk.engine.options import Limits, Options
from tachk.model.builder import NetworkBuilder
from tachk.model.expressions import BOOL, Assign, Binary, Constant, Expression, LocationTest, Reference, VariableKind
from tachk.model.network import Network, Process
from tachk.model.query import Query
from tachk.verify.covering.coverage import Coverage
from tachk.verify.verdict import Verdict
from tachk.verify.verify import verify


def search_for(network: Network, coverage: Coverage, place: Place, options: Options, limits: Limits) -> Verdict:
    """The verdict on whether some run covers a place; the path of its run is one of the network."""
    searched, target = (network, LocationTest(*place)) if coverage is Coverage.LOCATIONS else _noting(network, place)
    query = Query("covered", QueryKind.POSSIBLY, target)
    return verify(searched, [query], options, limits)[0]


def _noting(network: Network, edge: Place) -> tuple[Network, Expression]:
    """The network with a variable that says whether an edge has been taken, and the test of it."""
    number, place = edge
    builder = NetworkBuilder("taken.", VariableKind.GLOBAL)
    taken = builder.integer("edge", 0, 1, 0).expression
    assert isinstance(taken, Reference)
    note = Assign(taken, Constant(1), taken.type)

    def noting(process: Process) -> Process:
        edges = list(process.edges)
        edges[place] = replace(edges[place], updates=(*edges[place].updates, note))
        return replace(process, edges=tuple(edges))

    processes = tuple(noting(p) if n == number else p for n, p in enumerate(network.processes))
    changed = replace(network, processes=processes, variables=(*network.variables, *builder.variables))
    return changed, Binary(BinaryOperator.EQUAL, taken, Constant(1), BOOL)
