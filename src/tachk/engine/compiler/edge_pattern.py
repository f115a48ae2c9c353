"""Edges for many values of a select variable, compiled once and copied with other constants.

A select variable of a wide range gives one edge for each value. Where the value is only an operand beside something
that depends on the state, as in ``i == n + 1``, or is assigned, as in ``n = i``, all these edges have the same form and
differ in constants. Two of them are compiled; where they differ in nothing but the two values, the others are copies.
Whatever is of another kind is not a pattern, and each value is compiled on its own.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk.analysis.conditions import conjuncts
from tachk.analysis.failures import can_fail
from tachk.analysis.fold import Known, fold, is_integer
from tachk.base.job import check_job
from tachk.base.operators import COMPARISONS, CONNECTIVES
from tachk.base.records import dataclass
from tachk.engine.compiler.assembler import Assembler
from tachk.engine.compiler.program import NO_CODE, Condition, ProgramEdge, Test, Update
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.cell_layout import cell_range
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


@dataclass(frozen=True, slots=True)
class CompiledEdge:
    """An edge with code of its own: positions in the edge and in jumps count from the beginning of that code."""

    edge: ProgramEdge
    piece: Assembler


@dataclass(frozen=True, slots=True)
class EdgePattern:
    """What the edges for all values of the last select variable have in common.

    Attributes:
        sample: the edge for one value.
        tests, stores, words: the numbers of those that hold the value: tests of the guard, stores of the update, words
            of the code.
    """

    sample: CompiledEdge
    tests: frozenset[int]
    stores: frozenset[int]
    words: tuple[int, ...]

    def copy(self, selects: tuple[int, ...], assembler: Assembler) -> ProgramEdge:
        """The edge for other values, whose code is appended."""
        check_job()
        edge, value, piece = self.sample.edge, selects[-1], self.sample.piece
        start = len(assembler.code)
        if piece.code:
            assembler.append(piece, dict.fromkeys(self.words, value))
        guard, update = edge.guard, edge.update
        tests = tuple(
            Test(test.slot, test.comparison, value) if number in self.tests else test
            for number, test in enumerate(guard.tests)
        )
        stores = tuple(
            (slot, value if number in self.stores else stored) for number, (slot, stored) in enumerate(update.stores)
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


def pattern_of(one: CompiledEdge, other: CompiledEdge) -> EdgePattern | None:
    """The pattern of two edges that differ in the last of their selected values; None if they differ otherwise."""
    edge = one.edge
    if edge.channel_code != NO_CODE or edge.guard.flow:
        return None
    for each in edge.guard.constraints:
        if any(code != NO_CODE for code in (each.bound_code, each.condition, each.left_code, each.right_code)):
            return None
    code, others = one.piece.code, other.piece.code
    if len(code) != len(others):
        return None
    tests, other_tests = edge.guard.tests, other.edge.guard.tests
    stores, other_stores = edge.update.stores, other.edge.update.stores
    pattern = EdgePattern(
        one,
        frozenset(n for n, (test, second) in enumerate(zip(tests, other_tests, strict=False)) if test != second),
        frozenset(n for n, (store, second) in enumerate(zip(stores, other_stores, strict=False)) if store != second),
        tuple(n for n, (word, second) in enumerate(zip(code, others, strict=True)) if word != second),
    )
    again = Assembler()
    same = pattern.copy(other.edge.selects, again) == other.edge and again.code == others
    return pattern if same and again.sites == other.piece.sites else None


def _moved(position: int, by: int) -> int:
    return position if position == NO_CODE else position + by


# ---- where the value makes no other difference ----------------------------------------------------------------------


def uniform_values(edge: Edge, variable: Variable, known: Known, layout: SlotLayout) -> range:
    """The values of a select variable for which the compiled edges have the same form; those of other select variables
    are known. Conservative: values may be left out, or all."""
    low, high = cell_range(variable.type)
    guard = [] if edge.guard is None else list(conjuncts(fold(edge.guard, known)))
    updates = [fold(update, known) for update in edge.updates]
    if edge.synchronisation is not None and _mentions(edge.synchronisation.channel, variable):
        return range(0)
    if not all(map(_is_plain, guard)) or not all(map(_is_plain_update, updates)):
        return range(0)
    for part in (*guard, *updates):
        if not _mentions(part, variable):
            continue
        uses = _uses(part, variable, layout)
        if uses is None:
            return range(0)
        low, high = max([low, *(first for first, _ in uses)]), min([high, *(last for _, last in uses)])
    if any(_mentions(part, variable) and (reads_clock(part) or can_fail(part, known)) for part in guard):
        return range(0)
    return range(low, high + 1)


def _mentions(expression: Expression, variable: Variable) -> bool:
    return any(isinstance(node, Reference) and node.variable is variable for node in walk(expression))


def _is_plain(expression: Expression) -> bool:
    """Whether the code of a condition or value neither calls anything nor needs slots of its own."""
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


def _uses(part: Expression, variable: Variable, layout: SlotLayout) -> Sequence[tuple[int, int]] | None:
    """For each place where a variable stands the values for which nothing there can be known beforehand; None if it
    stands where its value may decide the form of the code."""

    def is_it(expression: Expression) -> bool:
        return isinstance(expression, Reference) and expression.variable is variable

    if isinstance(part, Assign) and (not is_integer(part.target.type) or layout.known_slot(part.target) is None):
        return None
    found: list[tuple[int, int]] = []
    for node in walk(part):
        match node:
            case Binary(operator, left, right) if is_it(left) != is_it(right) and operator not in CONNECTIVES:
                other = right if is_it(left) else left
                if isinstance(other, Constant) or _mentions(other, variable):
                    return None
                slot = layout.known_slot(other) if operator in COMPARISONS else None
                cell = None if slot is None else layout.slots[slot]
                found.append((-(2**31), 2**31 - 1) if cell is None else (cell.low + 1, cell.high - 1))
            case Assign(target, value) if is_it(value):
                slot = layout.known_slot(target)
                assert slot is not None
                found.append((layout.slots[slot].low, layout.slots[slot].high))
            case _:
                pass
    return found if len(found) == sum(map(is_it, walk(part))) else None
