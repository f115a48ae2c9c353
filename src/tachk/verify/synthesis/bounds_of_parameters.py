"""Constants that are upper or lower bounds only, so that moving them one way can only add behaviour.

*Theorem* (T. Hune, J. Romijn, M. Stoelinga, F. Vaandrager, Linear parametric model checking of timed automata, Journal
of Logic and Algebraic Programming 52-53, 2002). In a parametric timed automaton let a parameter occur only in upper
bounds of clocks or of their differences and there only positively, or in lower bounds and there only negatively: an
*upper* parameter; a *lower* one is the mirror image. If upper parameters grow and lower ones shrink, every run stays a
run.

The proof: each guard and each invariant holds for all the clock values for which it held before, so the same actions at
the same times are possible. Hence a reachable state stays reachable. This needs that nothing happens because something
else is *not* possible, and that a value of the parameter is nowhere else than in those bounds. So a constant is called
monotone only if

- the query is about reachable states (``A[]``, ``E<>``, a formula with an observer) and not for ``deadlock``:
  whether a run can be continued is the absence of actions, which ``A<>``, ``E[]`` and ``-->`` look at as well;
- no channel and no process has a priority;
- it is in no guard of a receiver of a broadcast, which must take part where it can, and in no guard of an edge over an
  urgent channel, which stops time where it is possible;
- each occurrence, with constants that are computed from it, is in a comparison ``x < e``, ``x <= e``, ``x > e`` or
  ``x >= e`` of a clock or a difference of two clocks in a guard, an invariant or the query, where ``e`` is a sum in
  which the factor of the constant has one sign for all values in question, and in which nothing exceeds 32
  bits (where numbers wrap around);
- all occurrences agree about the direction. A comparison in the query counts as it is in the states that are looked
  for.

A constant that occurs only in bounds of the property moves nothing in the network. It is monotone where the formula is
true of more runs with more of it, or of fewer (`tachk.logic.bound_directions`): a *lower* one in the sense above if
there are fewer violations with more of it. This holds for deadlines of ``A<>`` and ``-->``, too.

``x == e`` is both bounds at once. Everything else (data, indices, ranges, sizes, calls of functions, rates) is no
bound. What is not known to be monotone is not an error: its values are tried one by one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import StrEnum

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW, BinaryOperator, UnaryOperator
from tachk.base.records import dataclass
from tachk.base.span import NOWHERE, Span
from tachk.base.words import Direction
from tachk.frontend.open_constants import OpenConstants
from tachk.model.expressions import (
    Binary,
    Call,
    Conditional,
    Constant,
    Deadlock,
    Expression,
    Field,
    Index,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
    Variable,
)
from tachk.model.network import Edge, Network, Process
from tachk.model.query import Query
from tachk.model.traversal import (
    called_functions,
    is_clock_comparison,
    process_expressions,
    roots,
    statement_expressions,
    walk,
)
from tachk.model.types import ChannelType, IntType, bounds, element_type
from tachk.verify.plan import Analysis, analysis_of


class ParameterBound(StrEnum):
    """The bound that a constant gives, and with it the direction that adds behaviour."""

    UPPER = "upper"
    """More of it only adds behaviour."""
    LOWER = "lower"
    """Less of it only adds behaviour."""
    ABSENT = "absent"
    """It does not occur in the part on which the property depends."""


@dataclass(frozen=True, slots=True)
class NoBound:
    """The reason why a constant is not known to be monotone.

    Attributes:
        reason: such as "it is compared with `==`".
        span: its place.
    """

    reason: str
    span: Span = NOWHERE


class _Other(Exception):
    """An occurrence that is not a bound."""

    def __init__(self, reason: str, span: Span) -> None:
        self.finding = NoBound(reason, span)


def bounds_of_parameters(
    network: Network, query: Query, constants: OpenConstants, ranges: Mapping[str, tuple[int, int]]
) -> dict[str, ParameterBound | NoBound]:
    """The bounds that each open constant gives.

    Args:
        network, query: elaborated with the open constants.
        ranges: the least and the largest value of each in question.
    """
    limits = {constants.variables[name]: limit for name, limit in ranges.items()}
    return {name: _bound(network, query, constants, name, limits) for name in ranges}


_Limits = Mapping[Variable, tuple[int, int]]


def _bound(
    network: Network, query: Query, constants: OpenConstants, name: str, limits: _Limits
) -> ParameterBound | NoBound:
    if name in constants.needed:
        return NoBound("the structure of the model depends on it", constants.needed[name])
    if name in constants.in_bounds:
        return _in_bounds_only(network, query, constants, name, limits)
    if query.target is None or analysis_of(query) is not Analysis.REACHABILITY:
        return NoBound(f"{query.kind.value} depends on what is not possible", query.span)
    if query.observer is not None and query.observer.endings:
        return NoBound("the formula is about what happens eventually", query.span)
    deadlock = next((node for node in walk(query.target) if isinstance(node, Deadlock)), None)
    if deadlock is not None:
        return NoBound("`deadlock` depends on what is not possible", deadlock.span)
    if network.has_priorities:
        return NoBound("the model has priorities, so that what is possible keeps other things from happening")
    occurrences = _Occurrences(constants.variables[name], limits)
    try:
        found = list(_in_network(network, query, query.target, occurrences))
    except _Other as other:
        return other.finding
    if not found:
        return ParameterBound.ABSENT
    first, _ = found[0]
    against = next((span for bound, span in found if bound is not first), None)
    if against is not None:
        both = f"elsewhere it is a{'n' if first is ParameterBound.UPPER else ''} {first.value} bound"
        return NoBound(
            f"here it is a{'n' if first is ParameterBound.LOWER else ''} {_opposite(first).value} bound, {both}",
            against,
        )
    return first


def _in_bounds_only(
    network: Network, query: Query, constants: OpenConstants, name: str, limits: _Limits
) -> ParameterBound | NoBound:
    """The direction of a constant that bounds a property and nothing else: whatever the runs of the network are, the
    formula is true of more of them with more of it, or of fewer."""
    directions = constants.in_bounds[name]
    if query.observer is not None and query.observer.endings:
        return NoBound("the formula is about what happens eventually", query.span)
    if None in directions:
        return NoBound("it is not known what more of it does to the formula", directions[None])
    if len(directions) > 1:
        return NoBound("here the formula is true more often with less of it, elsewhere with more", directions[False])
    occurrences = _Occurrences(constants.variables[name], limits)
    wanted = [each for each in (query.predicate, *query.operands) if each is not None]
    if query.observer is not None:
        wanted += process_expressions(query.observer.process)
    try:
        for expression in (e for process in network.processes for e in process_expressions(process)):
            occurrences.refuse(expression, "the model uses it as well as a bound of the property")
        for expression in wanted:
            occurrences.refuse(expression, "the property uses it as well as one of its bounds")
    except _Other as other:
        return other.finding
    return ParameterBound.LOWER if True in directions else ParameterBound.UPPER


def _opposite(bound: ParameterBound) -> ParameterBound:
    match bound:
        case ParameterBound.UPPER:
            return ParameterBound.LOWER
        case ParameterBound.LOWER:
            return ParameterBound.UPPER
        case ParameterBound.ABSENT:
            return bound


_Found = Iterator[tuple[ParameterBound, Span]]
"""The bounds that a constant is, each with its place."""


def _in_network(network: Network, query: Query, target: Expression, constant: _Occurrences) -> _Found:
    for process in network.processes:
        yield from _in_process(process, constant)
    if query.observer is not None:
        for expression in process_expressions(query.observer.process):
            constant.refuse(expression, "the formula looks at its value")
    yield from constant.in_condition(target, True)


def _in_process(process: Process, constant: _Occurrences) -> _Found:
    for location in process.locations:
        for pair in location.rates:
            for expression in pair:
                constant.refuse(expression, "the rate of a clock depends on it")
        if location.invariant is not None:
            yield from constant.in_condition(location.invariant, True)
    for edge in process.edges:
        if edge.synchronisation is not None:
            constant.refuse(edge.synchronisation.channel, "a channel is chosen by it")
        for update in edge.updates:
            constant.refuse(update, "an update uses its value")
        if edge.guard is not None:
            _check_channel(edge, edge.guard, constant)
            yield from constant.in_condition(edge.guard, True)


def _check_channel(edge: Edge, guard: Expression, constant: _Occurrences) -> None:
    if edge.synchronisation is None:
        return
    channels = list(roots(edge.synchronisation.channel))
    kinds = [kind for channel in channels if isinstance(kind := element_type(channel.type), ChannelType)]
    if not channels or len(kinds) < len(channels):
        constant.refuse(guard, "it is not plain which kind of channel this edge has")
    if any(kind.urgent for kind in kinds):
        constant.refuse(guard, "this edge is urgent: time stops where it is possible")
    if any(kind.broadcast for kind in kinds) and edge.synchronisation.direction is Direction.RECEIVE:
        constant.refuse(guard, "who receives a broadcast must take part where it can")


@dataclass(frozen=True, slots=True)
class _Occurrences:
    """The occurrences of a constant.

    Attributes:
        variable: the constant.
        limits: the values of all open constants.
    """

    variable: Variable
    limits: _Limits

    def _place(self, expression: Expression) -> Span | None:
        """A place where the constant occurs, in a called function too; None if there is none."""
        for node in walk(expression):
            if isinstance(node, Reference) and node.variable is self.variable:
                return node.span
            if isinstance(node, Call):
                bodies = (s for f in called_functions([node]) for s in statement_expressions(f.body))
                if any(self._place(body) is not None for body in bodies):
                    return node.span
        return None

    def refuse(self, expression: Expression, reason: str) -> None:
        """Raises _Other if the constant occurs at all."""
        place = self._place(expression)
        if place is not None:
            raise _Other(reason, place)

    def in_condition(self, node: Expression, positive: bool) -> _Found:
        """The bounds in a condition, or in its negation where ``positive`` is false.

        Raises _Other for an occurrence that is not a bound.
        """
        if self._place(node) is None:
            return
        match node:
            case Unary(UnaryOperator.NOT, operand):
                yield from self.in_condition(operand, not positive)
            case Binary(BinaryOperator.AND | BinaryOperator.OR, left, right):
                yield from self.in_condition(left, positive)
                yield from self.in_condition(right, positive)
            case Binary(BinaryOperator.IMPLY, left, right):
                yield from self.in_condition(left, not positive)
                yield from self.in_condition(right, positive)
            case Conditional(condition, then, otherwise):
                self.refuse(condition, "a case distinction asks for its value")
                yield from self.in_condition(then, positive)
                yield from self.in_condition(otherwise, positive)
            case Quantifier(QuantifierKind.FORALL | QuantifierKind.EXISTS, _, body):
                yield from self.in_condition(body, positive)
            case Binary(operator, left, right) if is_clock_comparison(node):
                self.refuse(left, "a clock is chosen by it")
                yield from self._in_comparison(operator, right, positive)
            case _:
                self.refuse(node, "it is used as a number and not as a bound of a clock")

    def _in_comparison(self, operator: BinaryOperator, right: Expression, positive: bool) -> _Found:
        match operator:
            case BinaryOperator.LESS | BinaryOperator.LESS_EQUAL:
                growing = positive
            case BinaryOperator.GREATER | BinaryOperator.GREATER_EQUAL:
                growing = not positive
            case _:
                self.refuse(right, f"a clock is compared with it by `{operator.value}`")
                return
        place = self._place(right)
        if place is not None:
            self._interval(right)
            for sign in self._signs(right):
                yield (ParameterBound.UPPER if growing is (sign > 0) else ParameterBound.LOWER), place

    def _signs(self, term: Expression) -> Iterator[int]:
        """1 if a term grows as the constant grows, -1 if it falls, for each occurrence.

        Raises _Other where that is not known.
        """
        place = self._place(term)
        if place is None:
            return
        match term:
            case Reference():
                yield 1
            case Unary(UnaryOperator.MINUS, operand):
                yield from (-sign for sign in self._signs(operand))
            case Binary(BinaryOperator.ADD, left, right):
                yield from self._signs(left)
                yield from self._signs(right)
            case Binary(BinaryOperator.SUBTRACT, left, right):
                yield from self._signs(left)
                yield from (-sign for sign in self._signs(right))
            case Binary(BinaryOperator.MULTIPLY, left, right):
                yield from (sign * self._sign_of(right, place) for sign in self._signs(left))
                yield from (sign * self._sign_of(left, place) for sign in self._signs(right))
            case _:
                raise _Other("the bound is not a sum of multiples of it", place)

    def _sign_of(self, factor: Expression, place: Span) -> int:
        low, high = self._interval(factor)
        if low >= 0:
            return 1
        if high <= 0:
            return -1
        raise _Other("the sign of its factor is not known", place)

    def _interval(self, term: Expression) -> tuple[int, int]:
        """Bounds of the value of a term. Raises _Other where a part of it may exceed 32 bits."""
        match term:
            case Constant(value):
                return value, value
            case Reference(variable) if variable in self.limits:
                return self.limits[variable]
            case Reference() | Index() | Field() if isinstance(term.type, IntType):
                return bounds(term.type)
            case Unary(UnaryOperator.MINUS, operand):
                low, high = self._interval(operand)
                ends = [-high, -low]
            case Binary(BinaryOperator.ADD, left, right):
                (low, high), (least, most) = self._interval(left), self._interval(right)
                ends = [low + least, high + most]
            case Binary(BinaryOperator.SUBTRACT, left, right):
                (low, high), (least, most) = self._interval(left), self._interval(right)
                ends = [low - most, high - least]
            case Binary(BinaryOperator.MULTIPLY, left, right):
                ends = [a * b for a in self._interval(left) for b in self._interval(right)]
            case _:
                return CONSTANT_LOW, CONSTANT_HIGH
        if min(ends) < CONSTANT_LOW or max(ends) > CONSTANT_HIGH:
            raise _Other("the bound may exceed 32 bits", self._place(term) or term.span)
        return min(ends), max(ends)
