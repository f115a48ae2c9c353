"""Abstract values of a variable that counts through the numbers of processes, and the edges that use them.

An edge that depends on the variable gets a copy for each concrete value; the copy is enabled where the abstract value
allows this concrete value. So every transition remains possible, and others may be added.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import reduce
from itertools import product
from math import prod

from tachk.analysis.fold import Known, apply_binary, cannot_fail, fold, fold_place
from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.model.connectives import both, conjuncts, negation
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Block,
    Call,
    Constant,
    Evaluate,
    Expression,
    Function,
    Increment,
    Index,
    Iterate,
    Quantifier,
    QuantifierKind,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge
from tachk.model.substitution import substituted
from tachk.model.traversal import written_variables
from tachk.model.types import ArrayType, BoolType, IntType, ScalarType, VoidType, bounds
from tachk.model.variable_layout import default_values
from tachk.transform.cone_of_influence import mentioned

_MOST_COPIES = 10_000
"""The largest number of copies of an edge."""


class NotAbstractableError(Exception):
    """Raised for an edge that the abstraction of a variable cannot express."""


class _AbstractValue:
    """An abstraction of the values of a variable.

    Attributes:
        instead: the variable that holds the abstract value.
    """

    instead: Variable

    def __init__(self, variable: Variable, names: range, known: Known) -> None:
        assert isinstance(variable.type, IntType)
        self._variable, self._names, self._known = variable, names, known
        self._range = range(variable.type.low, variable.type.high + 1)
        (self._begin,) = variable.initial or default_values(variable.type)

    def among(self, variables: tuple[Variable, ...]) -> tuple[Variable, ...]:
        return tuple(self.instead if each is self._variable else each for each in variables)

    def edges(self, edges: Iterable[Edge]) -> Iterator[Edge]:
        """The edges of a process in the abstracted network. Raises NotAbstractableError."""
        for edge in edges:
            if uses(edge, self._variable):
                yield from dict.fromkeys(self._copies(edge))
            else:
                yield edge

    def _copies(self, edge: Edge) -> Iterator[Edge]:
        raise NotImplementedError

    def _with(self, value: int | None, known: Known | None = None) -> Known:
        known = self._known if known is None else known
        return known if value is None else replace(known, values={**known.values, self._variable: (value,)})

    def _mentioned(self, expression: Expression) -> bool:
        return self._variable in mentioned([expression])[1]

    def _after(self, update: Expression, before: int | None, known: Known) -> int | None:
        """The value of the variable after an update, whose value before may be unknown; None if the update sets
        something else."""
        match update:
            case Assign(Reference(variable), new, _, operator) if variable is self._variable:
                given = fold(new, self._with(before, known))
                if not isinstance(given, Constant):
                    raise NotAbstractableError
                after: int | None = given.value
                if operator is not None:
                    after = None if before is None else apply_binary(operator, before, given.value)
            case Increment(Reference(variable), delta) if variable is self._variable:
                after = None if before is None else before + delta
            case _:
                if self._variable in written_variables([update]):
                    raise NotAbstractableError
                return None
        if after is None or after not in self._range:
            raise NotAbstractableError
        return after

    def _one_copy(
        self,
        edge: Edge,
        value: int | None,
        known: Known,
        allowed: Expression | None,
        change: Callable[[int | None, int], Expression],
    ) -> Edge | None:
        """The edge where the variable has a value, or any if none is given; None where it is not possible then."""
        here = self._with(value, known)
        guard = None if edge.guard is None else fold(edge.guard, here)
        if isinstance(guard, Constant):
            if guard.value == 0:
                return None
            guard = None
        if allowed is not None:
            guard = allowed if guard is None else both(allowed, guard)
        synchronisation = edge.synchronisation
        if synchronisation is not None:
            synchronisation = replace(synchronisation, channel=fold_place(synchronisation.channel, here))
        updates = []
        for update in edge.updates:
            after = self._after(update, value, known)
            if after is None:
                updates.append(fold(update, self._with(value, known)))
            else:
                updates.append(change(value, after))
                value = after
        selects = tuple(select for select in edge.selects if select not in known.bound)
        return replace(
            edge,
            selects=selects,
            guard=guard,
            synchronisation=synchronisation,
            updates=tuple(updates),
            branch=None,
        )


class IsName(_AbstractValue):
    """The abstraction that forgets which name the value is; values that name no process are kept."""

    def __init__(self, variable: Variable, names: range, known: Known) -> None:
        super().__init__(variable, names, known)
        others = [value for value in self._range if value not in names]
        self._codes = dict.fromkeys(names, 0) | {value: 1 + number for number, value in enumerate(others)}
        self.instead = replace(variable, type=IntType(0, len(others)), initial=(self._codes[self._begin],))

    def _copies(self, edge: Edge) -> Iterator[Edge]:
        values: list[int | None] = [*self._range] if _reads(edge, self._variable) else [None]
        chosen = [range(low, high + 1) for low, high in map(_bounds, edge.selects)]
        if len(values) * prod(map(len, chosen)) > _MOST_COPIES:
            raise NotAbstractableError
        only = _only_value(edge, self._variable)
        for value in values if only is None else [only] if only in self._range else []:
            for selected in product(*chosen):
                bound = dict(zip(edge.selects, selected, strict=True))
                known = replace(self._known, bound={**self._known.bound, **bound})
                allowed = None if value is None else self._is(self._codes[value])
                copy = self._one_copy(edge, value, known, allowed, self._change)
                if copy is not None:
                    yield copy

    def _is(self, code: int) -> Expression:
        return Binary(BinaryOperator.EQUAL, Reference(self.instead), Constant(code), BOOL)

    def _change(self, _: int | None, after: int) -> Expression:
        return Assign(Reference(self.instead), Constant(self._codes[after]), self.instead.type)


class PassedNames(_AbstractValue):
    """The abstraction that keeps the set of names already passed: the value may be any other name, or the number behind
    all names once all are passed.

    Only for a variable that goes from each name to the next, and back to the first.
    """

    def __init__(self, variable: Variable, names: range, known: Known) -> None:
        super().__init__(variable, names, known)
        if self._range[0] != names[0] or self._range[-1] > names[-1] + 1:
            raise NotAbstractableError
        type_ = ArrayType(BoolType(), IntType(names[0], names[-1]))
        behind = tuple(int(name < self._begin) for name in names)
        self.instead = replace(variable, name=f"behind {variable.name}", type=type_, initial=behind)
        each = self._any_name("each")
        clear = Evaluate(Assign(self._is_behind(Reference(each)), Constant(0, BOOL), BOOL))
        nothing = Function(f"nothing {self.instead.name}", (), VoidType(), Block((Iterate(each, clear),)))
        self._clear = Call(nothing, (), VoidType())

    def _any_name(self, name: str) -> Variable:
        return Variable(name, IntType(self._names[0], self._names[-1]), VariableKind.BOUND)

    def _is_behind(self, name: Expression) -> Expression:
        return Index(Reference(self.instead), name, BOOL)

    def _copies(self, edge: Edge) -> Iterator[Edge]:
        last = self._names[-1] + 1
        if not _reads(edge, self._variable):
            copies = [self._one_copy(edge, None, self._known, None, self._change)]
        else:
            each = self._any_name("each")
            all_behind = Quantifier(QuantifierKind.FORALL, each, self._is_behind(Reference(each)), BOOL)
            copies = [self._copy_for_a_name(edge)]
            if last in self._range:
                copies.append(self._one_copy(edge, last, self._known, all_behind, self._change))
        yield from (copy for copy in copies if copy is not None)

    def _change(self, _: int | None, after: int) -> Expression:
        if after != self._names[0]:
            raise NotAbstractableError
        return self._clear

    def _copy_for_a_name(self, edge: Edge) -> Edge | None:
        """The edge where the variable is a name, which is chosen. Every process knows it by the same name."""
        chosen = self._any_name(self._variable.name)
        it = {self._variable: Reference(chosen)}
        left: list[Expression] = []
        for part in conjuncts(edge.guard):
            values = [fold(part, self._with(name)) for name in self._names]
            truths = {bool(value.value) if isinstance(value, Constant) else None for value in values}
            if None in truths:
                left.append(fold(substituted(part, it), self._known))
            elif truths == {False} and all(map(cannot_fail, left)):
                return None
            elif truths != {True}:
                raise NotAbstractableError
        guard = reduce(both, left, negation(self._is_behind(Reference(chosen))))
        synchronisation = edge.synchronisation
        if synchronisation is not None:
            synchronisation = replace(synchronisation, channel=substituted(synchronisation.channel, it))
        return replace(
            edge,
            selects=(*edge.selects, chosen),
            guard=guard,
            synchronisation=synchronisation,
            updates=tuple(self._updates(edge.updates, chosen)),
            branch=None,
        )

    def _updates(self, updates: Sequence[Expression], chosen: Variable) -> Iterator[Expression]:
        changed = False
        for update in updates:
            afters = [self._after(update, name, self._known) for name in self._names]
            if (changed and self._mentioned(update)) or len({after is None for after in afters}) > 1:
                raise NotAbstractableError
            if afters[0] is None:
                yield substituted(update, {self._variable: Reference(chosen)})
                continue
            changed = True
            if afters == [name + 1 for name in self._names]:
                yield Assign(self._is_behind(Reference(chosen)), Constant(1, BOOL), BOOL)
            elif set(afters) == {self._names[0]}:
                yield self._clear
            else:
                raise NotAbstractableError


def uses(edge: Edge, variable: Variable) -> bool:
    return variable in mentioned(list(_expressions(edge)))[1]


def _reads(edge: Edge, variable: Variable) -> bool:
    """True if the edge does more with the variable than to set it."""
    parts = []
    for part in _expressions(edge):
        sets = isinstance(part, Assign) and part.operator is None and part.target == Reference(variable)
        parts.append(part.value if isinstance(part, Assign) and sets else part)
    return variable in mentioned(parts)[1]


def _only_value(edge: Edge, variable: Variable) -> int | None:
    """The value of a variable with which the guard of an edge may be true, where it begins with this test."""
    match next(conjuncts(edge.guard), None):
        case Binary(BinaryOperator.EQUAL, Reference(tested), Constant(value)) | Binary(
            BinaryOperator.EQUAL, Constant(value), Reference(tested)
        ) if tested is variable:
            return value
        case _:
            return None


def _expressions(edge: Edge) -> Iterator[Expression]:
    if edge.guard is not None:
        yield edge.guard
    if edge.synchronisation is not None:
        yield edge.synchronisation.channel
    yield from edge.updates


def _bounds(variable: Variable) -> tuple[int, int]:
    assert isinstance(variable.type, IntType | BoolType | ScalarType)
    return bounds(variable.type)
