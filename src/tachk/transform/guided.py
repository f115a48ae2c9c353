"""Networks in which some processes follow a path, transition by transition, and all others act as they like.

For each process of the path a table says which of its edges, with which values of its select variables, is taken in
which transition. A variable that nothing else reads counts the transitions that have been taken: the guard of an edge
tests whether it is its turn, and the process that begins a transition counts it. So every run of the guided network
has the edges of runs of the network, under the same numbers. It need not be one: a process that must receive a
broadcast stays out where the path says so. Each run that is used is replayed.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import prod

from tachk.analysis.components import ComponentSet, written_components
from tachk.analysis.fold import Known
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.connectives import both
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Constant,
    Expression,
    Index,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Network, Process
from tachk.model.run import Transition
from tachk.model.types import ArrayType, IntType, bounds
from tachk.transform.transformation import Exactness, Transformation

_FALSE = Constant(0, BOOL)
_NO_EDGE = -1


@dataclass(frozen=True, slots=True)
class GuidedNetwork(Transformation):
    """``tables``: the arrays of the network that are only read, by index."""

    tables: tuple[Variable, ...]


def guided(
    network: Network, path: Sequence[Transition], members: Collection[int], spared: Collection[Variable]
) -> GuidedNetwork:
    """The network in which the members take the transitions of the path, and nothing else.

    Args:
        spared: variables that the others leave to the members: no edge of theirs writes one.
    """
    done = Reference(Variable("[done]", IntType(0, len(path)), VariableKind.GLOBAL, (0,)))
    processes = list(network.processes)
    tables = []
    for number, process in enumerate(network.processes):
        if number not in members:
            processes[number] = _sparing(process, ComponentSet((variable, None) for variable in spared))
            continue
        used = {p.edge for transition in path for p in transition.participants if p.process == number}
        codes = _codes(process, used)
        taken = [_NO_EDGE] * (len(path) + 1)
        for place, transition in enumerate(path):
            for participant in transition.participants:
                if participant.process == number:
                    edge = process.edges[participant.edge]
                    taken[place] = codes[participant.edge] + sum(
                        step * (value - low)
                        for value, (step, low) in zip(participant.selects, _steps(edge), strict=True)
                    )
        type_ = ArrayType(IntType(_NO_EDGE, max(max(taken), 0)), IntType(0, len(path)))
        table = Variable(f"[path of {process.name}]", type_, VariableKind.GLOBAL, tuple(taken))
        tables.append(table)
        turn = Index(Reference(table), done, type_.element)
        processes[number] = replace(
            process,
            edges=tuple(
                _in_turn(edge, codes[place], turn, done) if place in used else replace(edge, guard=_FALSE)
                for place, edge in enumerate(process.edges)
            ),
        )
    variables = (*network.variables, done.variable, *tables)
    along = replace(network, processes=tuple(processes), variables=variables)
    return GuidedNetwork(network, along, Exactness.NOTHING, tuple(tables))


def _codes(process: Process, used: Collection[int]) -> dict[int, int]:
    """The code of each edge that is used, with the first values of its select variables; the others follow."""
    codes = {}
    free = 0
    for place in sorted(used):
        codes[place] = free
        sizes = [high - low + 1 for low, high in (bounds(v.type) for v in process.edges[place].selects)]  # type: ignore[arg-type]
        free += prod(sizes)
    return codes


def _steps(edge: Edge) -> list[tuple[int, int]]:
    """By how much the code grows with each select variable, and the least value of this."""
    steps = []
    step = 1
    for variable in edge.selects:
        low, high = bounds(variable.type)  # type: ignore[arg-type]
        steps.append((step, low))
        step *= high - low + 1
    return steps


def _in_turn(edge: Edge, code: int, turn: Expression, done: Reference) -> Edge:
    number: Expression = Constant(code)
    for variable, (step, low) in zip(edge.selects, _steps(edge), strict=True):
        above = Binary(BinaryOperator.SUBTRACT, Reference(variable), Constant(low), IntType())
        number = _sum(number, Binary(BinaryOperator.MULTIPLY, Constant(step), above, IntType()))
    its_turn = Binary(BinaryOperator.EQUAL, turn, number, BOOL)
    guard = its_turn if edge.guard is None else both(its_turn, edge.guard)
    if edge.synchronisation is not None and edge.synchronisation.direction is Direction.RECEIVE:
        return replace(edge, guard=guard)
    counted = Assign(done, _sum(done, Constant(1)), done.type)
    return replace(edge, guard=guard, updates=(*edge.updates, counted))


def _sum(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.ADD, left, right, IntType())


def _sparing(process: Process, spared: ComponentSet) -> Process:
    return replace(
        process,
        edges=tuple(
            replace(edge, guard=_FALSE) if spared.meets(written_components(edge.updates, Known())) else edge
            for edge in process.edges
        ),
    )
