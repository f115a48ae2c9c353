"""Edges that are never taken, as a constant of the model rules them out, directly or through a variable.

The variables that no edge writes are constants. A guard that is false for them rules its edge out, and what only such
edges write is a constant, too. The edges that remain are the least set that contains what can be taken, as far as one
sees so: M. Wegman, F. K. Zadeck, "Constant propagation with conditional branches", TOPLAS 13 (1991).
"""

from __future__ import annotations

from collections.abc import Collection

from tachk.analysis.fold import Known, fold, known_values, negate
from tachk.base.operators import CONNECTIVES, UnaryOperator
from tachk.base.records import replace
from tachk.model.expressions import BOOL, Binary, Block, Call, Constant, Expression, Function, Return, Unary
from tachk.model.network import Edge, Network, Process
from tachk.model.remembered import by_network
from tachk.model.substitution import changed
from tachk.model.types import BoolType

_FALSE = Constant(0, BOOL)


@by_network
def without_impossible(network: Network) -> Network:
    """The network in which the edges that are never taken have the guard ``false`` and nothing else. Numbers stay."""
    possible: set[tuple[int, int]] = set()
    while True:
        reduced = _only(network, possible)
        known = known_values(reduced, [])
        found = {
            (number, place)
            for number, process in enumerate(network.processes)
            for place, edge in enumerate(process.edges)
            if (number, place) in possible or not _is_never(edge, known)
        }
        if len(found) == sum(len(process.edges) for process in network.processes):
            return network
        if found == possible:
            return reduced
        possible = found


def opened(condition: Expression, known: Known) -> Expression:
    """A condition in which calls of functions that do nothing but return a condition are this condition, folded."""
    return fold(_opened(condition), known)


def _opened(condition: Expression) -> Expression:
    match condition:
        case Binary(operator, left, right) if operator in CONNECTIVES:
            return changed(condition, left=_opened(left), right=_opened(right))
        case Unary(UnaryOperator.NOT, operand):
            return negate(_opened(operand))
        case Call(Function(parameters=(), result=BoolType(), body=Block((Return(value),)))) if value is not None:
            return _opened(value)
        case _:
            return condition


def _only(network: Network, possible: Collection[tuple[int, int]]) -> Network:
    return replace(network, processes=tuple(_left(p, number, possible) for number, p in enumerate(network.processes)))


def _left(process: Process, number: int, possible: Collection[tuple[int, int]]) -> Process:
    if all((number, place) in possible for place in range(len(process.edges))):
        return process
    edges = enumerate(process.edges)
    return replace(process, edges=tuple(edge if (number, place) in possible else _never(edge) for place, edge in edges))


def _never(edge: Edge) -> Edge:
    return replace(edge, selects=(), guard=_FALSE, synchronisation=None, updates=())


def _is_never(edge: Edge, known: Known) -> bool:
    guard = edge.guard and opened(edge.guard, known)
    return isinstance(guard, Constant) and guard.value == 0
