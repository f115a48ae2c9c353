"""Variables that count through processes by number, with less known of them: then the processes are interchangeable.

A bus that tells stations 1, 2, 3, ... of a collision tells them apart, though it hardly matters who is told first. Of
such a variable a coarser network keeps less (`tachk.engine.symmetry.kept`): every run of the network, its run-time
errors included, is one of the coarser network, so that what is unreachable there is unreachable. What is reachable
there need not be. This is existential abstraction (Clarke, Grumberg, Long, Model checking and abstraction, TOPLAS
16(5), 1994); that it is worth it is found out by looking for interchangeable processes again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tachk.analysis.fold import Known, known_values, network_expressions
from tachk.base.operators import BinaryOperator, OperandGroup
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.engine.symmetry.kept import BehindIt, NotKeptError, WhetherItNames, uses
from tachk.engine.symmetry.process_numbers import most_alike, numbers_of_processes
from tachk.model.expressions import Assign, Binary, Expression, Increment, Reference, Variable, VariableKind
from tachk.model.network import Network
from tachk.model.traversal import roots, walk
from tachk.model.types import ChannelType, IntType
from tachk.transform.cone_of_influence import every_action_counts, mentioned

_NOBODY = 2
"""So many values of a variable that names processes may be those of none."""


@dataclass(frozen=True, slots=True)
class Coarser:
    """A network that can do all that another one can, and maybe more.

    Attributes:
        variables: those of which it knows less.
    """

    network: Network
    variables: tuple[Variable, ...]


def with_less_known(network: Network, targets: Sequence[Expression]) -> Coarser | None:
    """A coarser network in which more processes are interchangeable, if there is one; none where every action counts:
    where a target speaks of ``deadlock`` or of nothing, and where there are priorities."""
    if every_action_counts(network, targets):
        return None
    candidates = _candidates(network, targets)
    if not candidates:
        return None
    from tachk.engine.symmetry.detection import find_symmetry  # of no use to most networks

    symmetry = find_symmetry(network, targets)
    if not symmetry.apart:
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
    """Numbers of processes, many of them first, each with the variables that may count through them. What is cheap to
    find out is asked first: in most networks there are none."""
    known, asked = known_values(network, []), mentioned(targets)[1]
    most = most_alike(network) + _NOBODY
    counting = [v for v in _counting(network) if v not in known.values and 2 <= _values(v) <= most]
    forgettable = {v for v in counting if v not in asked and _is_used_by_one_edge_at_a_time(network, v)}
    if not forgettable:
        return []
    found = []
    for numbers in numbers_of_processes(network, max(2, min(map(_values, forgettable)) - _NOBODY)):
        names = range(min(numbers), max(numbers) + 1)
        variables = [v for v in counting if _may_name(v, names)]
        if len(names) == len(numbers) and variables and forgettable.issuperset(variables):
            found.append((names, variables))
    return sorted(found, key=lambda each: (-len(each[0]), each[0].start))


def _without_order(network: Network, names: range, variables: Sequence[Variable]) -> Coarser | None:
    known = known_values(network, [])
    for variable in variables:
        rest = _forgotten(network, variable, names, known)
        if rest is None:
            return None
        network = rest
    return Coarser(network, tuple(variables))


def _values(variable: Variable) -> int:
    """How many values a variable that may name processes has; 0 if it cannot name any."""
    if not isinstance(variable.type, IntType) or variable.declared_meta or variable.carries is not None:
        return 0
    return variable.type.high - variable.type.low + 1


def _may_name(variable: Variable, names: range) -> bool:
    """Whether the values of a variable are the numbers of processes, and few others that are nobody's."""
    assert isinstance(variable.type, IntType)
    low, high = variable.type.low, variable.type.high
    return low <= names[0] and names[-1] <= high and _values(variable) <= len(names) + _NOBODY


def _counting(network: Network) -> list[Variable]:
    """The variables that something counts with, or compares by their order."""
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


def _forgotten(network: Network, variable: Variable, names: range, known: Known) -> Network | None:
    """The network with as much kept of the variable as can be."""
    if not _is_used_by_one_edge_at_a_time(network, variable):
        return None
    for kind in (BehindIt, WhetherItNames):
        try:
            kept = kind(variable, names, known)
            processes = tuple(
                replace(process, edges=tuple(kept.edges(process.edges)), variables=kept.among(process.variables))
                for process in network.processes
            )
        except NotKeptError:
            continue
        coarser = replace(network, processes=processes, variables=kept.among(network.variables), signals=())
        return None if variable in mentioned(list(network_expressions(coarser)))[1] else coarser
    return None


def _is_used_by_one_edge_at_a_time(network: Network, variable: Variable) -> bool:
    """Whether no two edges that are taken together depend on the variable, nor one that others wait for or that takes
    part as soon as it is possible."""
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
