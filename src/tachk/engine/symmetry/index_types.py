"""Index types of the numbers of a network, found by unification of everything that is compared or stored.

Two numbers are of one type where one is compared with the other for equality, assigned to it, or used as an index where
the other is. Numbers that are ordered, added or multiplied are *plain*: they cannot be names. ``e + 1`` is of the kind
of ``e``, shifted by one; ``(e + 1) % N`` is of the kind of ``e`` if that lies in [0, N - 1], and its numbers can only
be moved round together. Ip & Dill, "Better verification through symmetry", FMSD 9 (1996), call such names scalar sets;
here nothing has to be declared.
"""

from __future__ import annotations

from tachk.base.records import dataclass, field
from tachk.base.span import NOWHERE, Span
from tachk.model.types import (
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    VoidType,
    bounds,
)


@dataclass(frozen=True, slots=True)
class AsymmetryReason:
    """The reason why processes are not interchangeable, in words that follow the name of their template."""

    reason: str
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class ArrayTree:
    """The index types of an array: of its index and of its elements."""

    index: int
    element: Tree


@dataclass(frozen=True, slots=True)
class RecordTree:
    fields: tuple[tuple[str, Tree], ...]


Tree = int | ArrayTree | RecordTree
"""The index types of the parts of a value; a single number has one index type, named by the number of a node."""


@dataclass(frozen=True, slots=True)
class Range:
    """Numbers of a index type that are limited: the slots of a variable, the indices of an array, what a bound variable
    goes through."""

    node: int
    low: int
    high: int
    span: Span


@dataclass(slots=True)
class IndexTypes:
    """The index types found so far.

    Attributes:
        ranges: the limits of numbers.
        defaults: numbers that appear without being written: node, value.
        cycles: all numbers at a node, where one is added modulo their number.
    """

    ranges: list[Range] = field(default_factory=list)
    defaults: list[Range] = field(default_factory=list)
    cycles: list[Range] = field(default_factory=list)
    _parent: list[int] = field(default_factory=list)
    _shift: list[int] = field(default_factory=list)
    _plain: dict[int, AsymmetryReason] = field(default_factory=dict)

    def copy(self) -> IndexTypes:
        """A copy that may be unified further."""
        return IndexTypes(
            [*self.ranges], [*self.defaults], [*self.cycles], [*self._parent], [*self._shift], {**self._plain}
        )

    def roots(self) -> list[int]:
        """The representatives of the index types: the roots of the union-find forest."""
        return [node for node, parent in enumerate(self._parent) if node == parent]

    def keeps_names_of(self, before: IndexTypes) -> bool:
        """True if all that were names before it was copied and unified further still are."""
        return all(root in before._plain or root >= len(before._parent) for root in self._plain)

    def fresh(self) -> int:
        """A fresh index type."""
        self._parent.append(len(self._parent))
        self._shift.append(0)
        return len(self._parent) - 1

    def find(self, node: int) -> tuple[int, int]:
        """The node that stands for the index type, and by how much numbers at this node are larger than there."""
        above = self._parent[node]
        if self._parent[above] == above:  # nearly always
            return above, self._shift[node]
        shift = 0
        path = []
        while self._parent[node] != node:
            path.append(node)
            shift += self._shift[node]
            node = self._parent[node]
        total = shift
        for each in path:
            own = self._shift[each]
            self._parent[each], self._shift[each] = node, total
            total -= own
        return node, shift

    def unify(self, left: int, right: int, shift: int = 0, span: Span = NOWHERE) -> None:
        """Numbers at the left node are those at the right one plus a shift. The older node stands for both types, so
        that what is known by it stays so."""
        (one, above), (other, over) = self.find(left), self.find(right)
        if one == other:
            if above != over + shift:
                self.make_plain(left, "counts with it", span)
            return
        lower = over + shift - above
        if one < other:
            one, other, lower = other, one, -lower
        self._parent[one], self._shift[one] = other, lower
        if one in self._plain:
            self._plain.setdefault(other, self._plain.pop(one))

    def unify_trees(self, left: Tree, right: Tree, span: Span = NOWHERE) -> None:
        match left, right:
            case int(), int():
                self.unify(left, right, 0, span)
            case ArrayTree(index, element), ArrayTree(other, of_other):
                self.unify(index, other, 0, span)
                self.unify_trees(element, of_other, span)
            case RecordTree(fields), RecordTree(others):
                for (_, one), (_, another) in zip(fields, others, strict=True):
                    self.unify_trees(one, another, span)
            case _:
                for node in (*nodes_of(left), *nodes_of(right)):
                    self.make_plain(node, "is used in an unusual way", span)

    def make_plain(self, tree: Tree, reason: str, span: Span = NOWHERE) -> None:
        """Numbers of this index type are more than names."""
        for node in nodes_of(tree):
            self._plain.setdefault(self.find(node)[0], AsymmetryReason(reason, span))

    def plain(self, root: int) -> AsymmetryReason | None:
        """The reason why numbers of an index type are more than names; None if they are names only."""
        return self._plain.get(root)

    def tree(self, type_: Type, span: Span = NOWHERE, limited: bool = True) -> Tree:
        """Fresh index types for the parts of a type."""
        match type_:
            case ArrayType(element):
                index = self.fresh()
                self.ranges.append(Range(index, type_.low, type_.low + type_.size - 1, span))
                return ArrayTree(index, self.tree(element, span, limited))
            case RecordType(_, fields):
                return RecordTree(tuple((name, self.tree(part, span, limited)) for name, part in fields))
            case IntType() | BoolType() | ScalarType():
                node = self.fresh()
                if limited:
                    self.ranges.append(Range(node, *bounds(type_), span))
                return node
            case ClockType() | ChannelType() | VoidType():
                return self.fresh()


def nodes_of(tree: Tree) -> list[int]:
    """The index types of all parts of a value."""
    match tree:
        case int():
            return [tree]
        case ArrayTree(index, element):
            return [index, *nodes_of(element)]
        case RecordTree(fields):
            return [node for _, part in fields for node in nodes_of(part)]
