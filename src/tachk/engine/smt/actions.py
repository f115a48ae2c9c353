"""Single actions, each with when it is possible: for priorities, and for deadlocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Protocol

import z3

from tachk.base.job import check_job
from tachk.base.words import Direction
from tachk.engine.smt.machine import PossibleFault, unsupported
from tachk.engine.smt.terms import Formula, all_of, any_of, conj, neg
from tachk.model.network import Edge, Network
from tachk.model.run import Participant
from tachk.model.types import ChannelType

_ACTIONS = 2000
_COMPARISONS = 500
"""More different ways in which a step can be made are refused."""


@dataclass(slots=True)
class Instance:
    """An edge with values of its select variables, and its conditions in the template frame."""

    participant: Participant
    edge: Edge
    fires: z3.BoolRef
    at_source: Formula
    open: Formula = False
    """Its guard holds, and it is there to be taken."""
    channels: list[tuple[Formula, int]] = field(default_factory=list)

    @property
    def process(self) -> int:
        return self.participant.process

    @property
    def receives(self) -> bool:
        return self.edge.synchronisation is not None and self.edge.synchronisation.direction is Direction.RECEIVE

    @property
    def sends(self) -> bool:
        return self.edge.synchronisation is not None and self.edge.synchronisation.direction is Direction.SEND


class EdgesOfMoment(Protocol):
    """The conditions of the edges at one moment."""

    @property
    def instances(self) -> Sequence[Instance]: ...

    @property
    def may_go(self) -> Sequence[Formula]:
        """For each process the formula that the committed rule lets it begin a transition."""
        ...

    @property
    def channels(self) -> Sequence[ChannelType]: ...

    def behind(self, instances: Sequence[Instance], condition: Formula) -> tuple[Formula, list[PossibleFault]]:
        """The formula that invariants allow some edges to fire together where a condition holds; and the run-time
        errors that are possible there."""
        ...


@dataclass(frozen=True, slots=True)
class SymbolicAction:
    """Attributes:
    taken: that the edges of the action fire, and no others.
    possible: that they can, the invariants behind them included, or that something goes wrong in the attempt.
    wrong: what that may be.
    rank: its priority, that of the channel first.
    """

    taken: Formula
    possible: Formula
    wrong: tuple[PossibleFault, ...]
    rank: tuple[int, int]


@dataclass(frozen=True, slots=True)
class _JointEdges:
    """Edges that may fire together: the sender or internal edge first, then the receivers in the order of processes."""

    instances: tuple[Instance, ...]
    condition: Formula
    channel_priority: int


def actions(network: Network, moment: EdgesOfMoment, priorities: Sequence[int]) -> list[SymbolicAction]:
    """All actions of a network.

    Args:
        moment: what the edges say at the moment at which they are taken.
        priorities: of the channels.

    Raises UnsupportedError if there are too many.
    """
    found: list[SymbolicAction] = []
    for choice in _choices(network, moment, priorities):
        check_job()
        if choice.condition is False:
            continue
        if len(found) == _ACTIONS:
            what = f"priorities or deadlocks where a step can be made in more than {_ACTIONS} ways"
            raise unsupported(what, choice.instances[0].edge.spans[0])
        taking = {id(instance) for instance in choice.instances}
        others = [i.fires for i in moment.instances if id(i) not in taking]
        taken = all_of([*(i.fires for i in choice.instances), neg(any_of(others))])
        goes_well, wrong = moment.behind(choice.instances, choice.condition)
        possible = conj(choice.condition, any_of([goes_well, *(fault.condition for fault in wrong)]))
        rank = choice.channel_priority, max(network.processes[i.process].priority for i in choice.instances)
        found.append(SymbolicAction(taken, possible, tuple(wrong), rank))
    return found


def _choices(network: Network, moment: EdgesOfMoment, priorities: Sequence[int]) -> Iterator[_JointEdges]:
    receivers: list[list[Instance]] = [[] for _ in network.processes]
    for instance in moment.instances:
        if instance.receives:
            receivers[instance.process].append(instance)

    def admitted(*instances: Instance) -> Formula:
        return any_of(moment.may_go[i.process] for i in instances)

    for first in moment.instances:
        if first.receives or first.open is False:
            continue
        if not first.sends:
            yield _JointEdges((first,), conj(first.open, admitted(first)), network.default_priority)
            continue
        for condition, channel in first.channels:
            sent = conj(first.open, condition)
            others = [own for process, own in enumerate(receivers) if process != first.process]
            possible = [
                [(i, _receives(i, channel)) for i in own if _receives(i, channel) is not False] for own in others
            ]
            if not moment.channels[channel].broadcast:
                for receiver, receiving in (pair for own in possible for pair in own):
                    whole = all_of([sent, receiving, admitted(first, receiver)])
                    yield _JointEdges((first, receiver), whole, priorities[channel])
                continue
            options = [[(None, neg(any_of(h for _, h in own))), *own] for own in possible if own]
            for chosen in product(*options):
                chosen_receivers = tuple(instance for instance, _ in chosen if instance is not None)
                whole = all_of([sent, *(receiving for _, receiving in chosen), admitted(first, *chosen_receivers)])
                yield _JointEdges((first, *chosen_receivers), whole, priorities[channel])


def _receives(receiver: Instance, channel: int) -> Formula:
    return conj(receiver.open, any_of(condition for condition, named in receiver.channels if named == channel))


def unblocked(found: Sequence[SymbolicAction]) -> Formula:
    """The formula that the action that is taken has the highest priority of those that are possible."""
    parts: list[Formula] = []
    for rank in {action.rank for action in found}:
        higher = any_of(action.possible for action in found if action.rank > rank)
        taken = any_of(action.taken for action in found if action.rank == rank)
        parts.append(neg(conj(taken, higher)))
    return all_of(parts)


# ---- some moment from now on ----------------------------------------------------------------------------------------


class TooManyComparisonsError(Exception):
    """A formula that takes too long to be freed of a moment."""


def sometimes(formula: Formula, moment: z3.ArithRef, first: z3.ArithRef) -> Formula:
    """The formula that a formula about clocks holds at some moment from a first one on, with the moment eliminated.

    Its truth changes only where the moment makes the two sides of a comparison equal, so that these moments, and those
    just behind them, stand for all others (Loos and Weispfenning 1993, virtual substitution).

    Raises TooManyComparisonsError.
    """
    if isinstance(formula, bool):
        return formula
    whole = _without_choices(z3.And(formula, moment >= first), moment)
    comparisons = [_MovingComparison.of(each, moment) for each in _comparisons(whole, moment)]
    roots: dict[str, z3.ArithRef] = {}
    for each in comparisons:
        if each.root is not None:
            roots.setdefault(each.root.sexpr(), each.root)
    found: list[Formula] = []
    for root in roots.values():
        check_job()
        found.append(z3.substitute(whole, (moment, root)))
        found.append(z3.substitute(whole, *((each.whole, each.behind(moment, root)) for each in comparisons)))
    return any_of(found)


@dataclass(frozen=True, slots=True)
class _MovingComparison:
    """A comparison ``factor * moment + rest ~ 0``, with the moment at which its sides are equal."""

    whole: z3.BoolRef
    factor: int
    rest: z3.ArithRef
    root: z3.ArithRef | None

    @staticmethod
    def of(whole: z3.BoolRef, moment: z3.ArithRef) -> _MovingComparison:
        difference = whole.arg(0) - whole.arg(1)
        rest = z3.simplify(z3.substitute(difference, (moment, z3.RealVal(0))))
        at_one = z3.substitute(difference, (moment, z3.RealVal(1)))
        factor = z3.simplify(at_one - rest, som=True)
        if not z3.is_rational_value(factor) or factor.as_fraction().denominator != 1:
            raise ValueError(f"{whole} is not linear in {moment}")
        number = factor.as_fraction().numerator
        return _MovingComparison(whole, number, rest, z3.simplify(-rest / number) if number else None)

    def behind(self, moment: z3.ArithRef, root: z3.ArithRef) -> z3.BoolRef:
        """The comparison just behind a root."""
        value = self.rest + self.factor * root
        kind = self.whole.decl().kind()
        if self.factor == 0:
            return z3.substitute(self.whole, (moment, root))
        if kind in (z3.Z3_OP_EQ, z3.Z3_OP_DISTINCT):
            return z3.BoolVal(kind == z3.Z3_OP_DISTINCT)
        upwards = self.factor > 0
        if kind in (z3.Z3_OP_LT, z3.Z3_OP_LE):
            return value < 0 if upwards else value <= 0
        return value >= 0 if upwards else value > 0


_COMPARED = (z3.Z3_OP_LT, z3.Z3_OP_LE, z3.Z3_OP_GT, z3.Z3_OP_GE, z3.Z3_OP_EQ, z3.Z3_OP_DISTINCT)


def _comparisons(whole: z3.ExprRef, moment: z3.ArithRef) -> list[z3.BoolRef]:
    """The comparisons of real numbers that mention the moment."""
    mentioning = _mentioning(whole, moment)
    found: list[z3.BoolRef] = []
    for current in _parts(whole):
        if z3.is_app(current) and current.decl().kind() in _COMPARED and z3.is_real(current.arg(0)):
            if current.get_id() in mentioning:
                found.append(current)
    return found


def _parts(whole: z3.ExprRef) -> Iterator[z3.ExprRef]:
    """The formula and all its parts, each once, also if it is shared."""
    seen: set[int] = set()
    pending = [whole]
    while pending:
        current = pending.pop()
        if current.get_id() not in seen:
            seen.add(current.get_id())
            yield current
            pending.extend(current.children())


def _mentioning(whole: z3.ExprRef, moment: z3.ArithRef) -> set[int]:
    """The ids of the parts of a formula in which the moment occurs."""
    above: dict[int, list[int]] = {}
    for part in _parts(whole):
        for child in part.children():
            above.setdefault(child.get_id(), []).append(part.get_id())
    found = {moment.get_id()}
    pending = [moment.get_id()]
    while pending:
        for parent in above.get(pending.pop(), ()):
            if parent not in found:
                found.add(parent)
                pending.append(parent)
    return found


def _without_choices(whole: z3.BoolRef, moment: z3.ArithRef) -> z3.BoolRef:
    """The formula with ``If`` between real numbers taken out of comparisons that mention the moment."""
    while True:
        replaced = []
        comparisons = _comparisons(whole, moment)
        if len(comparisons) > _COMPARISONS:
            raise TooManyComparisonsError
        for comparison in comparisons:
            choice = _choice(comparison)
            if choice is not None:
                test, then, otherwise = choice.children()
                one = z3.substitute(comparison, (choice, then))
                other = z3.substitute(comparison, (choice, otherwise))
                replaced.append((comparison, z3.If(test, one, other)))
        if not replaced:
            return whole
        check_job()
        whole = z3.substitute(whole, *replaced)


def _choice(comparison: z3.BoolRef) -> z3.ExprRef | None:
    """An ``If`` between real numbers inside a comparison, the outermost one."""
    choices = (p for p in _parts(comparison) if z3.is_app(p) and p.decl().kind() == z3.Z3_OP_ITE and z3.is_real(p))
    return next(choices, None)
