"""Temporal properties: the formula is elaborated through the automaton that watches for its violations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial

from tachk.base.operators import UnaryOperator
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.frontend.context import Context
from tachk.frontend.declarations.channels import ChannelTable
from tachk.frontend.declarations.declarations import Declared
from tachk.frontend.expressions.typed_expressions import condition, integral
from tachk.frontend.queries.formula_durations import resolve_durations
from tachk.frontend.scope import FamilySymbol, ProcessSymbol, Scope
from tachk.frontend.templates.templates import elaborate_process
from tachk.logic.observer.construction import BAD, NoObserver, TrapLocation, build_observer
from tachk.logic.sentences import meaning
from tachk.logic.sufficient_condition import sufficient_condition
from tachk.logic.triggers import (
    awaited_conditions,
    demanded_conditions,
    demanded_implications,
    needed_now,
    needed_state,
)
from tachk.model.connectives import both, either
from tachk.model.expressions import BOOL, Expression, LocationTest, Unary
from tachk.model.query import Expectation, Observer, Query
from tachk.model.traversal import asks_deadlock, clock_in
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Change, Formula, operands
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.rewrite import fresh_name
from tachk.syntax.sentences.parser import parse_sentence

OBSERVER = "Observer"
"""The name of the observer's process, where no other has it."""


def elaborate_temporal(
    node: ast.TemporalFormula,
    name: str,
    scope: Scope,
    context: Context,
    title: str,
    expectation: Expectation | None,
) -> Query | None:
    """The query whether the observer of a formula stays out of its bad location; None after a report."""
    context = replace(context, in_query=True)
    formula = temporal_formula(node, scope, context)
    if formula is None or not _speaks_of_states(formula, scope, context):
        return None
    own_name = fresh_name(OBSERVER, set(scope.names()))
    try:
        built = build_observer(formula, own_name)
    except NoObserver as error:
        context.error("E0730", error.span, error.reason, error.help)
        return None
    process, _ = elaborate_process(
        built.template, own_name, Scope(scope), Declared(own_name), ChannelTable(set()), context
    )
    if built.endings:
        process = replace(process, locations=tuple(replace(each, observes=True) for each in process.locations))
    places = {location.name: number for number, location in enumerate(process.locations)}
    number = _processes(scope)
    enough = sufficient_condition(formula)
    observer = Observer(
        process,
        places[BAD],
        print_formula(formula),
        tuple(places[e.location] for e in built.endings),
        tuple(places[e.entry] for e in built.endings if e.entry is not None),
        tuple(_triggers(formula, scope, context)),
        tuple(_conditions(demanded_conditions(formula), scope, context)),
        tuple(_conditions(awaited_conditions(formula), scope, context)),
        None if enough is None else condition(enough, scope, context),
    )
    query = Query(name, QueryKind.INVARIANTLY, None, (), node.sentence or node.span.text, title, expectation, node.span)
    query = replace(query, observer=observer)
    if built.endings:
        return _endless(query, number, places, built.endings, partial(_translated, scope=scope, context=context))
    bad = LocationTest(number, places[BAD], span=node.span)
    return replace(query, predicate=Unary(UnaryOperator.NOT, bad, BOOL, node.span))


def _endless(
    query: Query,
    observer: int,
    places: Mapping[str, int],
    endings: Sequence[TrapLocation],
    translated: Callable[[ast.Expression], Expression],
) -> Query:
    """The query whether no run gets into an ending and stays, in all its states, where what the ending asks is true."""

    def at(name: str) -> Expression:
        return LocationTest(observer, places[name], span=query.span)

    bad = at(BAD)
    begun = shown = ends = bad
    again: list[Expression] = [bad] * len(endings[0].again)
    for ending in endings:
        here = there = at(ending.location)
        if ending.entry is not None:
            begun = either(begun, at(ending.entry))
            there = either(here, at(ending.entry))
        shown = either(shown, both(there, translated(ending.condition)))
        met: list[Expression | None] = [None if each is None else both(here, translated(each)) for each in ending.again]
        again = [old if new is None else either(old, new) for old, new in zip(again, met, strict=True)]
        if None not in met:
            for each in met:
                here = both(each, here)
            ends = either(ends, here)
    absent = Unary(UnaryOperator.NOT, shown, BOOL, query.span)
    return replace(
        query,
        kind=QueryKind.LEADS_TO,
        predicate=begun,
        operands=(absent,),
        again=tuple(again),
        ends=ends if again else None,
    )


def _translated(text: ast.Expression, *, scope: Scope, context: Context) -> Expression:
    found = condition(text, scope, context)
    assert found is not None
    return found


def _triggers(formula: Formula, scope: Scope, context: Context) -> Iterator[tuple[str, Expression]]:
    for implication in demanded_implications(formula):
        needed = needed_state(implication.left)
        value = None if needed is None else condition(needed, scope, context)
        if value is not None:
            yield print_formula(implication.left), value


def _conditions(parts: Iterable[Formula], scope: Scope, context: Context) -> Iterator[tuple[str, Expression]]:
    """Parts of a formula that are conditions on one state, with their texts."""
    for part in parts:
        now = needed_now(part)
        value = None if now is None else condition(now, scope, context)
        if value is not None:
            yield print_formula(part), value


def temporal_formula(node: ast.TemporalFormula, scope: Scope, context: Context) -> Formula | None:
    """The formula of the property, with bounds in time units of the model; None after a report."""
    formula = node.formula
    if formula is None:
        sentence, diagnostics = parse_sentence(node.span)
        context.findings.extend(diagnostics)
        if sentence is None:
            return None
        formula = meaning(sentence)
    return resolve_durations(formula, scope, context)


def _speaks_of_states(formula: Formula, scope: Scope, context: Context) -> bool:
    """True if every atom is a condition on states without clocks; reports those that are not."""
    good = True
    for atom in _atoms(formula):
        read = condition if isinstance(atom, Atom) else integral
        value = read(atom.expression, scope, context)
        if value is None or not context.require_pure(value, "a temporal property"):
            good = False
        elif (clock := clock_in(value)) is not None:
            good = False
            context.error(
                "E0731",
                clock.span,
                f"a temporal property cannot look at a clock, here `{clock.span.text or 'a clock'}`",
                "queries such as `A[] P.x <= 5` look at clocks; in a formula a window such as `F[0,5]` measures time",
            )
        elif asks_deadlock(value):
            good = False
            context.error("E0501", atom.span, "`deadlock` has no place in a temporal property", "ask A[] not deadlock")
    return good


def _atoms(formula: Formula) -> Iterator[Atom | Change]:
    if isinstance(formula, Atom | Change):
        yield formula
    for operand in operands(formula):
        yield from _atoms(operand)


def _processes(scope: Scope) -> int:
    """The number of processes that the scope names: the number of the one that comes behind them."""
    numbers = [-1]
    for symbol in scope.symbols.values():
        match symbol:
            case ProcessSymbol(number=number):
                numbers.append(number)
            case FamilySymbol(instances=instances):
                numbers += [instance.number for instance in instances.values()]
            case _:
                pass
    return max(numbers) + 1
