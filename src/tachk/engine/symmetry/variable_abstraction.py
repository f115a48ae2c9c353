"""Abstraction of variables that count through processes, so that these processes become interchangeable.

A bus that notifies the stations 1, 2, 3, ... of a collision breaks their symmetry, though the order hardly matters. The
abstracted network keeps less of the counting variable (`tachk.engine.symmetry.abstract_values`). It over-approximates:
every run of the network, its run-time errors included, is a run of the abstracted one, so that a target that is
unreachable there is unreachable. This is existential abstraction (Clarke, Grumberg, Long, Model checking and
abstraction, TOPLAS 16(5), 1994). It is kept only if it yields more interchangeable processes.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk.analysis.fold import Known, known_values, network_expressions
from tachk.base.operators import BinaryOperator, OperandGroup
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.engine.symmetry.process_numbers import most_alike, numbers_of_processes
from tachk.model.expressions import Assign, Binary, Expression, Increment, Reference, Variable, VariableKind
from tachk.model.network import Network
from tachk.model.traversal import roots, walk
from tachk.model.types import ChannelType, IntType
from tachk.transform.cone_of_influence import every_action_counts, mentioned

_OTHER_VALUES = 2
"""A variable that names processes has at most so many values that name none."""


@dataclass(frozen=True, slots=True)
class AbstractedNetwork:
    """An over-approximation of a network.

    Attributes:
        variables: the abstracted variables.
    """

    network: Network
    variables: tuple[Variable, ...]


def with_abstracted_variables(network: Network, targets: Sequence[Expression]) -> AbstractedNetwork | None:
    """An over-approximation with more interchangeable processes; None if there is none, and where every action counts:
    where a target mentions ``deadlock`` or nothing, and where there are priorities."""
    if every_action_counts(network, targets):
        return None
    candidates = _candidates(network, targets)
    if not candidates:
        return None
    from tachk.engine.symmetry.detection import find_symmetry  # of no use to most networks

    symmetry = find_symmetry(network, targets)
    if not symmetry.asymmetries:
        return None
    before = sum(len(group.members) for group in symmetry.groups)
    for names, variables in candidates:
        coarser = _without_order(network, names, variables)
        if coarser is None:
            continue
        found = find_symmetry(coarser.network, targets)
        if sum(len(group.members) for group in found.groups) > before:
            return coarser
    return None


def _candidates(network: Network, targets: Sequence[Expression]) -> Sequence[tuple[range, Sequence[Variable]]]:
    """Ranges of process numbers, the longest first, each with the variables that may count through them. Cheap tests
    come first, as most networks have no such variables."""
    known, observed = known_values(network, []), mentioned(targets)[1]
    most = most_alike(network) + _OTHER_VALUES
    counting = [v for v in _counting(network) if v not in known.values and 2 <= _values(v) <= most]
    forgettable = {v for v in counting if v not in observed and _is_used_by_one_edge_at_a_time(network, v)}
    if not forgettable:
        return []
    found = []
    for numbers in numbers_of_processes(network, max(2, min(map(_values, forgettable)) - _OTHER_VALUES)):
        names = range(min(numbers), max(numbers) + 1)
        variables = [v for v in counting if _may_name(v, names)]
        if len(names) == len(numbers) and variables and forgettable.issuperset(variables):
            found.append((names, variables))
    return sorted(found, key=lambda each: (-len(each[0]), each[0].start))


def _without_order(network: Network, names: range, variables: Sequence[Variable]) -> AbstractedNetwork | None:
    known = known_values(network, [])
    for variable in variables:
        rest = _abstracted(network, variable, names, known)
        if rest is None:
            return None
        network = rest
    return AbstractedNetwork(network, tuple(variables))


def _values(variable: Variable) -> int:
    """The number of values of a variable that may name processes; 0 if it cannot name any."""
    if not isinstance(variable.type, IntType) or variable.declared_meta or variable.carries is not None:
        return 0
    return variable.type.high - variable.type.low + 1


def _may_name(variable: Variable, names: range) -> bool:
    """True if the values of a variable are the numbers of processes and at most `_OTHER_VALUES` others."""
    assert isinstance(variable.type, IntType)
    low, high = variable.type.low, variable.type.high
    return low <= names[0] and names[-1] <= high and _values(variable) <= len(names) + _OTHER_VALUES


def _counting(network: Network) -> list[Variable]:
    """The variables that occur in arithmetic or in comparisons of order."""
    found: dict[Variable, None] = {}
    for outer in network_expressions(network):
        for node in walk(outer):
            operands: tuple[Expression, ...] = ()
            match node:
                case Binary(BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL):
                    pass
                case Binary(operator, left, right) if operator.group is not OperandGroup.CONNECTIVE:
                    operands = (left, right)
                case Increment(target):
                    operands = (target,)
                case Assign(target, _, _, operator) if operator is not None:
                    operands = (target,)
            found |= {each.variable: None for each in operands if isinstance(each, Reference)}
    return [v for v in found if v.kind in (VariableKind.GLOBAL, VariableKind.LOCAL)]


def _abstracted(network: Network, variable: Variable, names: range, known: Known) -> Network | None:
    """The network with the most precise abstraction of the variable that is possible; None if there is none."""
    from tachk.engine.symmetry.abstract_values import IsName, NotAbstractableError, PassedNames

    if not _is_used_by_one_edge_at_a_time(network, variable):
        return None
    for abstraction_class in (PassedNames, IsName):
        try:
            abstraction = abstraction_class(variable, names, known)
            processes = tuple(
                replace(
                    process,
                    edges=tuple(abstraction.edges(process.edges)),
                    variables=abstraction.among(process.variables),
                )
                for process in network.processes
            )
        except NotAbstractableError:
            continue
        coarser = replace(network, processes=processes, variables=abstraction.among(network.variables), signals=())
        return None if variable in mentioned(list(network_expressions(coarser)))[1] else coarser
    return None


def _is_used_by_one_edge_at_a_time(network: Network, variable: Variable) -> bool:
    """True if no two edges that are taken together depend on the variable, and no urgent or receiving broadcast edge
    does."""
    from tachk.engine.symmetry.abstract_values import uses

    sends: set[Variable] = set()
    receives: set[Variable] = set()
    for process in network.processes:
        for edge in process.edges:
            if edge.synchronisation is None or not uses(edge, variable):
                continue
            channel, direction = edge.synchronisation.channel, edge.synchronisation.direction
            assert isinstance(channel.type, ChannelType)
            if channel.type.urgent or (channel.type.broadcast and direction is Direction.RECEIVE):
                return False
            (sends if direction is Direction.SEND else receives).update(roots(channel))
    return sends.isdisjoint(receives)
