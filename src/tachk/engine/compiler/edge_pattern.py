"""Edges for many values of a select variable, compiled once and copied with other constants.

A select variable of a wide range gives one edge for each value. Where a linear term of the value is only an operand
beside something that depends on the state, as in ``2 * i == n + 1``, is compared with a constant, as in ``i != 7``, or
is assigned, as in ``n = i``, the edges have the same form and differ in constants, up to the values at which the range
of a variable or a constant decides something. Of each such
range of values three edges are compiled; where they differ in linear terms only, the others are copies. Whatever is of
another kind is not a pattern, and each value is compiled on its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from tachk.analysis.conditions import conjuncts
from tachk.analysis.failures import can_fail
from tachk.analysis.fold import Known, fold, is_integer
from tachk.base.job import check_job
from tachk.base.operators import COMPARISONS, CONNECTIVES, BinaryOperator, UnaryOperator
from tachk.base.records import dataclass
from tachk.engine.compiler.assembler import Assembler
from tachk.engine.compiler.program import NO_CODE, Condition, ProgramEdge, Test, Update
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.expressions import (
    Assign,
    Binary,
    Constant,
    Expression,
    Field,
    Increment,
    Index,
    LocationTest,
    Reference,
    Unary,
    Variable,
)
from tachk.model.network import Edge
from tachk.model.traversal import reads_clock, walk
from tachk.model.types import is_aggregate
from tachk.model.variable_layout import slot_range


@dataclass(frozen=True, slots=True)
class CompiledEdge:
    """An edge with code of its own: positions in the edge and in jumps count from the beginning of that code."""

    edge: ProgramEdge
    piece: Assembler


@dataclass(frozen=True, slots=True)
class LinearTerm:
    """``slope * value + offset``"""

    slope: int
    offset: int

    def of(self, value: int) -> int:
        return self.slope * value + self.offset


@dataclass(frozen=True, slots=True)
class EdgePattern:
    """The common part of the edges for some values of the last select variable.

    Attributes:
        sample: the edge for one value.
        tests, stores, words: what the numbers are that depend on the value: by the places of the tests of the guard, of
            the stores of the update, and of the words of the code.
    """

    sample: CompiledEdge
    tests: Mapping[int, LinearTerm]
    stores: Mapping[int, LinearTerm]
    words: Mapping[int, LinearTerm]

    def copy(self, selects: tuple[int, ...], assembler: Assembler) -> ProgramEdge:
        """The edge for other values, whose code is appended."""
        check_job()
        edge, value, piece = self.sample.edge, selects[-1], self.sample.piece
        start = len(assembler.code)
        if piece.code:
            assembler.append(piece, {place: term.of(value) for place, term in self.words.items()})
        guard, update = edge.guard, edge.update
        tests = tuple(
            Test(test.slot, test.comparison, self.tests[number].of(value)) if number in self.tests else test
            for number, test in enumerate(guard.tests)
        )
        stores = tuple(
            (slot, self.stores[number].of(value) if number in self.stores else stored)
            for number, (slot, stored) in enumerate(update.stores)
        )
        return ProgramEdge(
            edge.process,
            edge.edge,
            selects,
            edge.source,
            edge.target,
            Condition(tests, _moved(guard.code, start), guard.constraints),
            edge.channel,
            edge.channels,
            sends=edge.sends,
            update=Update(stores, update.resets, _moved(update.code, start)),
        )


def pattern_of(one: CompiledEdge, other: CompiledEdge, last: CompiledEdge) -> EdgePattern | None:
    """The pattern of edges that differ in the last of their selected values, of which the second is one more than the
    first; None if they differ otherwise."""
    edge = one.edge
    if edge.channel_code != NO_CODE or edge.guard.flow:
        return None
    for each in edge.guard.constraints:
        if any(code != NO_CODE for code in (each.bound_code, each.condition, each.left_code, each.right_code)):
            return None
    value = edge.selects[-1]
    assert other.edge.selects[-1] == value + 1
    pattern = EdgePattern(
        one,
        _terms([test.constant for test in edge.guard.tests], [test.constant for test in other.edge.guard.tests], value),
        _terms([stored for _, stored in edge.update.stores], [stored for _, stored in other.edge.update.stores], value),
        _terms(one.piece.code, other.piece.code, value),
    )
    same = all(_is_copy(pattern, each) for each in (other, last))
    return pattern if same else None


def _terms(one: Sequence[int], other: Sequence[int], value: int) -> dict[int, LinearTerm]:
    """The terms for the numbers that differ, by their places."""
    return {
        place: LinearTerm(second - first, first - (second - first) * value)
        for place, (first, second) in enumerate(zip(one, other, strict=False))
        if first != second
    }


def _is_copy(pattern: EdgePattern, compiled: CompiledEdge) -> bool:
    if len(pattern.sample.piece.code) != len(compiled.piece.code):
        return False
    again = Assembler()
    same = pattern.copy(compiled.edge.selects, again) == compiled.edge
    return same and again.code == compiled.piece.code and again.sites == compiled.piece.sites


def _moved(position: int, by: int) -> int:
    return position if position == NO_CODE else position + by


# ---- where the value makes no other difference ----------------------------------------------------------------------


def uniform_ranges(edge: Edge, variable: Variable, known: Known, layout: SlotLayout) -> list[range]:
    """All values of a select variable, in order, in ranges in each of which the compiled edges have the same form.

    The values of other select variables are known. Conservative: empty where nothing is known of the form.
    """
    low, high = slot_range(variable.type)
    guard = [] if edge.guard is None else list(conjuncts(fold(edge.guard, known)))
    updates = [fold(update, known) for update in edge.updates]
    if edge.synchronisation is not None and _mentions(edge.synchronisation.channel, variable):
        return []
    if not all(map(_is_plain, guard)) or not all(map(_is_plain_update, updates)):
        return []
    if any(_mentions(part, variable) and (reads_clock(part) or can_fail(part, known)) for part in guard):
        return []
    cuts = {low, high + 1}
    for part in (*guard, *updates):
        if not _mentions(part, variable):
            continue
        found = _cuts(part, variable, layout)
        if found is None:
            return []
        cuts |= {cut for cut in found if low < cut <= high}
    return [range(first, after) for first, after in pairwise(sorted(cuts))]


def _mentions(expression: Expression, variable: Variable) -> bool:
    return any(isinstance(node, Reference) and node.variable is variable for node in walk(expression))


def _is_plain(expression: Expression) -> bool:
    """True if the code of a condition or value neither calls anything nor needs slots of its own."""
    return all(
        isinstance(node, Constant | Field | Index | Unary | LocationTest)
        or (isinstance(node, Reference) and not node.variable.reference)
        or (isinstance(node, Binary) and not is_aggregate(node.left.type))
        for node in walk(expression)
    )


def _is_plain_update(update: Expression) -> bool:
    if isinstance(update, Assign):
        return not is_aggregate(update.target.type) and _is_plain(update.target) and _is_plain(update.value)
    return isinstance(update, Increment) and _is_plain(update.target)


def _cuts(part: Expression, variable: Variable, layout: SlotLayout) -> list[int] | None:
    """The values of a variable from which on the range of what its terms are compared with or assigned to may decide
    otherwise than before; None if it stands where its value may decide the form of the code."""
    if isinstance(part, Assign) and (not is_integer(part.target.type) or layout.known_slot(part.target) is None):
        return None
    found: list[int] = []
    seen = 0
    for node, term_of, term, other in _operands(part, variable):
        if _mentions(other, variable):
            return None
        seen += _count(term_of, variable)
        if isinstance(other, Constant):
            if not isinstance(node, Binary) or node.operator not in COMPARISONS:
                return None
            found += _crossings(term, (other.value, other.value + 1))
        elif isinstance(part, Assign) and other is part.target:
            slot = layout.known_slot(other)
            assert slot is not None
            bounds = layout.slots[slot]
            found += _crossings(term, (bounds.low, bounds.high + 1))
        else:
            slot = layout.known_slot(other)
            if slot is not None:
                bounds = layout.slots[slot]
                found += _crossings(term, (bounds.low, bounds.low + 1, bounds.high, bounds.high + 1))
    return found if seen == _count(part, variable) else None


def _operands(part: Expression, variable: Variable) -> Iterator[tuple[Expression, Expression, LinearTerm, Expression]]:
    """The largest linear terms of the variable in a condition or an update: for each the expression of which it is an
    operand, the operand, the term, and the other operand."""
    for node in walk(part):
        match node:
            case Binary(operator, left, right) if operator not in CONNECTIVES and linear_term(node, variable) is None:
                for one, other in ((left, right), (right, left)):
                    term = linear_term(one, variable)
                    if term is not None and term.slope != 0:
                        yield node, one, term, other
            case Assign(target, value):
                term = linear_term(value, variable)
                if term is not None and term.slope != 0:
                    yield node, value, term, target
            case _:
                pass


def _count(expression: Expression, variable: Variable) -> int:
    return sum(isinstance(node, Reference) and node.variable is variable for node in walk(expression))


def _crossings(term: LinearTerm, limits: Sequence[int]) -> Iterator[int]:
    """The values from which on the term is on the other side of each limit, which counts as above."""
    for limit in limits:
        distance = limit - term.offset
        yield -(-distance // term.slope) if term.slope > 0 else distance // term.slope + 1


def linear_term(expression: Expression, variable: Variable) -> LinearTerm | None:
    """An expression of the variable and constants as a linear term of it. None for any other, and where some value on
    the way may need more than 32 bits."""
    low, high = slot_range(variable.type)
    match expression:
        case Constant(value=offset):
            found = LinearTerm(0, offset)
        case Reference() if expression.variable is variable:
            found = LinearTerm(1, 0)
        case Unary(UnaryOperator.MINUS, operand):
            inner = linear_term(operand, variable)
            if inner is None:
                return None
            found = LinearTerm(-inner.slope, -inner.offset)
        case Binary(operator, left, right) if operator in _LINEAR:
            one, other = linear_term(left, variable), linear_term(right, variable)
            if one is None or other is None or (operator is BinaryOperator.MULTIPLY and one.slope and other.slope):
                return None
            found = _combined(operator, one, other)
        case _:
            return None
    return found if all(-(2**31) <= found.of(end) < 2**31 for end in (low, high)) else None


_LINEAR = frozenset({BinaryOperator.ADD, BinaryOperator.SUBTRACT, BinaryOperator.MULTIPLY})


def _combined(operator: BinaryOperator, one: LinearTerm, other: LinearTerm) -> LinearTerm:
    if operator is BinaryOperator.MULTIPLY:
        slope = one.slope * other.offset + other.slope * one.offset
        return LinearTerm(slope, one.offset * other.offset)
    sign = 1 if operator is BinaryOperator.ADD else -1
    return LinearTerm(one.slope + sign * other.slope, one.offset + sign * other.offset)
