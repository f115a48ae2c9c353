"""Walking over typed expressions and statements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from operator import attrgetter
from typing import Any

from tachk.base.job import check_job
from tachk.base.operators import COMPARISONS
from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Declare,
    Evaluate,
    Expression,
    Field,
    Function,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    Reference,
    Return,
    Statement,
    Unary,
    Variable,
    While,
)
from tachk.model.floating import hybrid_offsets
from tachk.model.network import Process
from tachk.model.remembered import by_part
from tachk.model.types import ArrayType, ClockType, RecordType, Type

PARTS: dict[type, tuple[str, ...]] = {
    **dict.fromkeys((Constant, Reference, LocationTest, Deadlock), ()),
    **dict.fromkeys((Aggregate, Comma), ("items",)),
    Index: ("base", "index"),
    Field: ("base",),
    Unary: ("operand",),
    Binary: ("left", "right"),
    Conditional: ("condition", "then", "otherwise"),
    Quantifier: ("body",),
    Assign: ("target", "value"),
    Increment: ("target",),
    Call: ("arguments",),
}
"""The fields of each kind of expression that hold expressions, or a tuple of them, in order of evaluation."""


def _getter(names: tuple[str, ...]) -> Callable[[Any], tuple[Expression, ...]]:
    if not names:
        return lambda _: ()
    get: Callable[[Any], Any] = attrgetter(*names)
    return get if len(names) > 1 or names[0] in ("items", "arguments") else lambda expression: (get(expression),)


_CHILDREN = {kind: _getter(names) for kind, names in PARTS.items()}


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct subexpressions, in order of evaluation."""
    return _CHILDREN[type(expression)](expression)


def walk(expression: Expression) -> Iterator[Expression]:
    """The expression and everything inside it; the bodies of called functions are not entered."""
    check_job()
    pending = [expression]
    while pending:
        current = pending.pop()
        yield current
        inner = children(current)
        if inner:
            pending.extend(reversed(inner))


def statement_expressions(statement: Statement) -> Iterator[Expression]:
    """The outermost expressions in a statement, in textual order."""
    pending = [statement]
    while pending:
        match pending.pop():
            case Evaluate(expression):
                yield expression
            case Declare(_, initial) | Return(initial):
                if initial is not None:
                    yield initial
            case Block(statements):
                pending.extend(reversed(statements))
            case If(condition, then, otherwise):
                yield condition
                pending.extend((then,) if otherwise is None else (otherwise, then))
            case While(condition, body):
                yield condition
                pending.append(body)
            case Iterate(_, body):
                pending.append(body)
            case Assert(condition):
                yield condition


def denoted(place: Expression) -> Iterator[Reference | Index | Field]:
    """The places of which an assignable expression may denote one; none for a value that has no place."""
    match place:
        case Reference() | Index() | Field():
            yield place
        case Conditional(_, then, otherwise):
            yield from denoted(then)
            yield from denoted(otherwise)
        case Assign(target) | Increment(target):
            yield from denoted(target)
        case Comma(items):
            yield from denoted(items[-1])
        case Constant() | Aggregate() | Unary() | Binary() | Quantifier() | Call() | LocationTest() | Deadlock():
            return


def roots(place: Expression) -> Iterator[Variable]:
    """The variables an assignable expression may denote a part of."""
    for one in denoted(place):
        if isinstance(one, Reference):
            yield one.variable
        else:
            yield from roots(one.base)


def called_functions(expressions: Iterable[Expression]) -> dict[Function, None]:
    """The functions called by the expressions, directly or through other functions, in order of discovery."""
    found: dict[Function, None] = {}
    pending = list(expressions)
    while pending:
        for node in walk(pending.pop()):
            if isinstance(node, Call) and node.function not in found:
                found[node.function] = None
                pending.extend(statement_expressions(node.function.body))
    return found


def with_bodies(expressions: Iterable[Expression]) -> list[Expression]:
    """The expressions, and the outermost ones in the functions that they call, directly or through other functions."""
    outer = list(expressions)
    return [*outer, *(e for function in called_functions(outer) for e in statement_expressions(function.body))]


def may_change(node: Expression) -> bool:
    """True if a node itself, its parts aside, may change something."""
    return isinstance(node, Assign | Increment) or (isinstance(node, Call) and node.function.operation is None)


def reads_clock(expression: Expression) -> bool:
    """True if the value of the expression depends on the value of a clock; setting one does not read it."""
    match expression:
        case Call(function, arguments):
            pairs = zip(function.parameters, arguments, strict=True)
            return any(not p.reference and reads_clock(a) for p, a in pairs)
        case Assign(_, value):
            return reads_clock(value)
        case Reference() | Index() | Field() if isinstance(expression.type, ClockType):
            return True
        case _:
            return any(reads_clock(child) for child in children(expression))


def reads_hybrid(expression: Expression) -> bool:
    """True if the expression, or a function that it calls, names a hybrid clock."""
    pending = with_bodies([expression])
    while pending:
        node = pending.pop()
        if holds_hybrid_clock(node):
            return True
        while isinstance(node, Index | Field):
            # The places around this one are named only to say which it is.
            if isinstance(node, Index):
                pending.append(node.index)
            node = node.base
        pending += children(node)
    return False


def holds_hybrid_clock(place: Expression) -> bool:
    """True if a place is a hybrid clock, or has one in it."""
    return any(map(_holds_hybrid_clock, denoted(place)))


def _holds_hybrid_clock(place: Reference | Index | Field) -> bool:
    match place:
        case Reference(variable):
            return variable.has_hybrid_clocks
        case Index(base):
            return isinstance(base.type, ArrayType) and (
                _has_hybrid_clocks(base.type.element) or any(variable.is_hybrid for variable in roots(base))
            )
        case Field(base, name):
            return isinstance(base.type, RecordType) and _has_hybrid_clocks(dict(base.type.fields)[name])


def _has_hybrid_clocks(type_: Type) -> bool:
    return any(True for _ in hybrid_offsets(type_))


def is_clock_comparison(node: Expression) -> bool:
    """True if a node itself compares a clock, or a difference of clocks, on its left side with a number."""
    return isinstance(node, Binary) and node.operator in COMPARISONS and isinstance(node.left.type, ClockType)


def depends_on_clocks(condition: Expression) -> bool:
    """True if the truth of a condition depends on clocks. Indices, arguments, and what is assigned compare none."""
    if isinstance(condition, Binary) and (_is_clock(condition.left) or _is_clock(condition.right)):
        return True
    is_composed = isinstance(condition, Unary | Binary | Conditional | Quantifier | Comma)
    return is_composed and any(map(depends_on_clocks, children(condition)))


class ClockDependence:
    """`depends_on_clocks` of conditions and their parts, found once each: of a chain every link would ask anew."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Expression, bool]] = {}  # with the expression, whose place nothing else takes

    def __call__(self, condition: Expression) -> bool:
        pending = [condition]
        while pending:
            part = pending[-1]
            if id(part) in self._known:
                pending.pop()
                continue
            answer = isinstance(part, Binary) and (_is_clock(part.left) or _is_clock(part.right))
            if not answer and isinstance(part, Unary | Binary | Conditional | Quantifier | Comma):
                unknown = [child for child in children(part) if id(child) not in self._known]
                if unknown:
                    pending += unknown
                    continue
                answer = any(self._known[id(child)][1] for child in children(part))
            self._known[id(part)] = part, answer
        return self._known[id(condition)][1]


def _is_clock(side: Expression) -> bool:
    return isinstance(side.type, ClockType)


def compares_clocks(expression: Expression) -> bool:
    """True if clocks are compared anywhere in an expression, also in the index of what it sets."""
    return any(map(is_clock_comparison, walk(expression)))


def asks_deadlock(expression: Expression) -> bool:
    """True if an expression contains `deadlock`."""
    return any(isinstance(node, Deadlock) for node in walk(expression))


def clock_in(expression: Expression) -> Expression | None:
    """The first clock that an expression or a function that it calls names, whatever for."""
    nodes = (node for outer in with_bodies([expression]) for node in walk(outer))
    return next((node for node in nodes if isinstance(node.type, ClockType)), None)


def written_variables(expressions: Iterable[Expression]) -> set[Variable]:
    """The variables that evaluating the expressions may change, functions included.

    A variable passed for a reference parameter counts only if the function changes that parameter.
    """
    return set().union(*map(_written, expressions))


@by_part
def _written(expression: Expression) -> frozenset[Variable]:
    written: set[Variable] = set()
    calls: list[Call] = []
    for outer in with_bodies([expression]):
        for node in walk(outer):
            if isinstance(node, Assign | Increment):
                written.update(roots(node.target))
            elif isinstance(node, Call):
                calls.append(node)
    changed = True
    while changed:
        before = len(written)
        for call in calls:
            for parameter, argument in zip(call.function.parameters, call.arguments, strict=True):
                if parameter.reference and parameter in written:
                    written.update(roots(argument))
        changed = len(written) > before
    return frozenset(written)


def process_expressions(process: Process) -> Iterator[Expression]:
    """Every outermost expression of a process, function bodies excluded."""
    for location in process.locations:
        if location.invariant is not None:
            yield location.invariant
        for pair in (*location.rates, *location.hybrid_rates):
            yield from pair
    for edge in process.edges:
        if edge.guard is not None:
            yield edge.guard
        if edge.synchronisation is not None:
            yield edge.synchronisation.channel
        yield from edge.updates
