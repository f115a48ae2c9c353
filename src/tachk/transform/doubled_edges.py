"""Networks with a clock more that actions set, and their runs as those of the network alone.

Every action is decided by one edge: an internal one, or the one that sends. Each of these edges is there twice, with
the same priority, so that what is possible, what is urgent, and where nothing is possible stay as they are. The guards
and updates of the two differ in a clock and a variable that nothing else knows.

Strongly non-Zeno automata: S. Tripakis, "Verifying progress in timed systems", ARTS 1999; S. Tripakis, S. Yovine, A.
Bouajjani, "Checking timed Buechi automata emptiness efficiently", FMSD 26 (2005).
"""

from __future__ import annotations

from collections.abc import Callable, Collection

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.model.connectives import both, either, is_set
from tachk.model.expressions import BOOL, Assign, Binary, Constant, Expression, Reference, Variable, VariableKind
from tachk.model.network import Edge, Network, Process
from tachk.model.run import Participant, Transition
from tachk.model.types import ClockType, IntType
from tachk.transform.extension import Extension
from tachk.transform.transformation import Exactness


@dataclass(frozen=True, slots=True)
class DoubledNetwork(Extension):
    """A network with copies of edges behind those of each process, and a clock and a variable behind those of the last.

    Attributes:
        mark: a condition on the variable.
        clock: the value of the clock.
        copied: of each process the edges that the copies are copies of.
    """

    mark: Expression
    clock: Expression
    copied: tuple[tuple[int, ...], ...]

    def lift_transition(self, transition: Transition) -> Transition:
        """The transition with the edges of which it has copies."""
        return Transition(tuple(map(self._original_edge, transition.participants)))

    def _original_edge(self, participant: Participant) -> Participant:
        first = len(self.original.processes[participant.process].edges)
        if participant.edge < first:
            return participant
        return replace(participant, edge=self.copied[participant.process][participant.edge - first])


def strongly_non_zeno(network: Network, length: int = 1) -> DoubledNetwork:
    """The strongly non-Zeno instrumentation: a clock is reset by every action that comes when it has counted so many
    time units.

    A run with infinitely many actions resets it infinitely often exactly if time diverges in it. `mark` holds behind an
    action that does. Actions over urgent channels do not: no time has passed right before them.
    """
    since, late_action = _clock("time since the last reset"), _flag("reset")
    limit = Constant(length)

    def edges_for(_process: int, _number: int, edge: Edge) -> tuple[Edge, Edge | None]:
        plain = replace(edge, updates=(*edge.updates, _set(late_action, 0)))
        if edge.is_urgent:
            return plain, None
        early = both(edge.guard, Binary(BinaryOperator.LESS, Reference(since), limit, BOOL))
        late = both(edge.guard, Binary(BinaryOperator.GREATER_EQUAL, Reference(since), limit, BOOL))
        return replace(plain, guard=early), replace(
            edge, guard=late, updates=(*edge.updates, _set(since, 0), _set(late_action, 1))
        )

    return _doubled(network, edges_for, since, late_action)


def with_guessed_suffix(network: Network, lasting: Collection[tuple[int, int]]) -> DoubledNetwork:
    """The network with a clock that is reset by one action of the run, any one: `mark` holds from then on.

    From then on only these edges (process and number) decide what happens, and nothing does one time unit later. So a
    run in which time does not diverge, and that takes these edges only from some moment on, is one that does not come
    to that time, and each run that does not come there although it goes on for ever is such a run. Where there are
    priorities, a run that comes there need not be one of the original.
    """
    since, started = _clock("time since the start"), _flag("started")
    before = Binary(BinaryOperator.EQUAL, Reference(started), Constant(0), BOOL)
    soon = Binary(BinaryOperator.LESS, Reference(since), Constant(1), BOOL)

    def edges_for(process: int, number: int, edge: Edge) -> tuple[Edge, Edge | None]:
        if (process, number) not in lasting:
            # To leave out what others wait for, or what time waits for, would make more possible.
            hinders = network.has_priorities or edge.is_urgent
            return edge if hinders else replace(edge, guard=both(edge.guard, before)), None
        copy = replace(edge, guard=both(edge.guard, before), updates=(*edge.updates, _set(since, 0), _set(started, 1)))
        # No time passes while an action over an urgent channel is possible, and clocks may not decide whether it is.
        return (edge if edge.is_urgent else replace(edge, guard=both(edge.guard, either(before, soon)))), copy

    exactness = Exactness.NOTHING if network.has_priorities else Exactness.SAME_STATES
    return _doubled(network, edges_for, since, started, exactness)


def with_guessed_resets(network: Network) -> DoubledNetwork:
    """The network with a clock that any action resets, or does not: where it does, `mark` is true until the next
    action, and it is so at the start of the run."""
    since = _clock("time since the guessed reset")
    begun = Variable("guessed reset", IntType(0, 1), VariableKind.LOCAL, (1,))

    def edges_for(_process: int, _number: int, edge: Edge) -> tuple[Edge, Edge | None]:
        plain = replace(edge, updates=(*edge.updates, _set(begun, 0)))
        return plain, replace(edge, updates=(*edge.updates, _set(since, 0), _set(begun, 1)))

    return _doubled(network, edges_for, since, begun)


def _doubled(
    network: Network,
    edges_for: Callable[[int, int, Edge], tuple[Edge, Edge | None]],
    clock: Variable,
    flag: Variable,
    exactness: Exactness = Exactness.SAME_ANSWERS,
) -> DoubledNetwork:
    processes, originals = [], []
    for place, process in enumerate(network.processes):
        edges: list[Edge] = []
        copies: list[Edge] = []
        copied: list[int] = []
        for number, edge in enumerate(process.edges):
            copy: Edge | None = None
            if edge.begins:
                edge, copy = edges_for(place, number, edge)
            edges.append(edge)
            if copy is not None:
                copies.append(copy)
                copied.append(number)
        processes.append(replace(process, edges=(*edges, *copies)))
        originals.append(tuple(copied))
    last: Process = processes[-1]
    processes[-1] = replace(last, variables=(*last.variables, clock, flag))
    mark = is_set(Reference(flag))
    doubled = replace(network, processes=tuple(processes))
    return DoubledNetwork(network, doubled, exactness, mark, Reference(clock), tuple(originals))


def _clock(name: str) -> Variable:
    return Variable(name, ClockType(), VariableKind.LOCAL, (0,))


def _flag(name: str) -> Variable:
    return Variable(name, IntType(0, 1), VariableKind.LOCAL, (0,))


def _set(variable: Variable, value: int) -> Expression:
    return Assign(Reference(variable), Constant(value), variable.type)
