"""Observers driven along one run: a network that can only repeat a recorded trace, and the random cases for it.

The trace ends at an instant at which no window can end, some time after its last row, so that an observer has seen all
that the trace decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random

from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE, Source
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Status
from tachk.engine.zone import explore
from tachk.formats.loading.load import load_model
from tachk.frontend.context import Context
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.made_network import scope_of
from tachk.frontend.queries.observer_processes import elaborate_temporal
from tachk.logic.durations import scaled
from tachk.model.expressions import LocationTest
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.types import IntType
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tachk.syntax.formula import Formula
from tachk.syntax.rewrite import rewrite, substitute
from tachk.transform.observed import observed
from tests.support.exact_trace import ExactTrace
from tests.support.formulas import FLAGS, FormulaShape, random_formula, random_interval, random_trace

SCALE = 4
"""Time units of the replaying network for each one of the case: rows come at even times, the end is odd."""

_EVER = syntax.all_time(NOWHERE)

SHAPE = FormulaShape(depth=2, bound=4, grid=1, numeric=False, rows=10, gap=3)
_TIMES = replace(SHAPE, grid=2)


@dataclass(frozen=True, slots=True)
class ObserverCase:
    """A formula over boolean columns, and a trace; times and bounds are numbers of time units."""

    formula: Formula
    trace: ExactTrace


def random_observer_case(random: Random) -> ObserverCase:
    """Mostly of the shapes that requirements have, now and then any formula."""
    formula = random_formula(random, SHAPE, random.choice((1, 2, 2, 3))) if random.random() < 0.25 else _shaped(random)
    trace = random_trace(random, _TIMES)
    end = trace.times[-1] * SCALE + random.choice((1, 3, 5, 9, 13))
    return ObserverCase(
        scaled(formula, Fraction(SCALE)), ExactTrace(tuple(t * SCALE for t in trace.times), trace.columns, end)
    )


def bounded_observer_case(random: Random) -> ObserverCase:
    """A requirement with windows, often about rises and falls, and a trace in which one flag after the other changes
    exactly a bound of its windows, or the difference of two, after the one before."""
    return _case_on_bounds(random, _on_bounds(random))


def _case_on_bounds(random: Random, formula: Formula) -> ObserverCase:
    bounds = {duration.value for duration in _durations(formula) if isinstance(duration.value, Fraction)}
    gaps = sorted({gap for low in (Fraction(0), *bounds) for high in bounds if (gap := high - low) > 0}) or [
        Fraction(1)
    ]
    flags = {name: random.random() < share for name, share in zip(FLAGS, (0.0, 0.3, 0.7), strict=True)}
    rows, times = [dict(flags)], [Fraction(0)]
    for _ in range(random.randint(1, 6)):
        for name in random.sample(FLAGS, random.choice((1, 1, 2))):
            flags[name] = not flags[name]
        rows.append(dict(flags))
        times.append(times[-1] + random.choice(gaps))
    columns = {name: tuple(row[name] for row in rows) for name in FLAGS}
    end = times[-1] * SCALE + random.choice((1, 5, 13))
    return ObserverCase(scaled(formula, Fraction(SCALE)), ExactTrace(tuple(t * SCALE for t in times), columns, end))


def nested_observer_case(random: Random) -> ObserverCase:
    """A requirement in which something temporal stands in a window, an until or the past, and a trace as for
    `bounded_observer_case`."""
    return _case_on_bounds(random, _nested(random))


def edges_observer_case(random: Random) -> ObserverCase:
    """A requirement in which several edges may have to coincide in a window, and a trace as for
    `bounded_observer_case`."""
    return _case_on_bounds(random, _edges(random))


def past_observer_case(random: Random) -> ObserverCase:
    """A formula with a window on the past that may end before now, or look for an edge."""
    return _case_on_bounds(random, _looking_back(random))


def endless_observer_case(random: Random) -> ObserverCase:
    """A requirement without a deadline, and a trace as for `bounded_observer_case`."""
    return _case_on_bounds(random, _endless(random))


def replaying(trace: ExactTrace, stops: bool = True) -> LoadedModel:
    """A model whose only run takes the rows of a trace at their times and stops at its end, or else goes on for ever
    with the values of the last row."""
    names = list(trace.columns)
    lines = [
        f"bool {', '.join(f'{n} = {_text(trace.columns[n][0])}' for n in names)};",
        "process Replay() {",
        "clock t;",
    ]
    for row in range(len(trace.times)):
        due = trace.end if row + 1 == len(trace.times) else trace.times[row + 1]
        bound = f"invariant t <= {due};" if stops or row + 1 < len(trace.times) else ""
        lines.append(f"{'init ' if row == 0 else ''}location R{row} {{ {bound}")
        if row + 1 < len(trace.times):
            values = ", ".join(f"{name} = {_text(trace.columns[name][row + 1])}" for name in names)
            lines.append(f"to R{row + 1} {{ guard t >= {due}; assign {values}; }}")
        lines.append("}")
    return load_model(Source("replay", "\n".join((*lines, "}", "system Replay;"))))


def query_of(formula: Formula, model: LoadedModel) -> Query | None:
    """The query that asks for a violation; None where there is no observer for the formula."""
    node = ast.TemporalFormula(NOWHERE, formula)
    return elaborate_temporal(node, "property", model.scope, Context(DiagnosticCollector()), "", None)


def violated(model: LoadedModel, query: Query, options: Options = Options()) -> bool:
    """Whether the observer can reach its bad location."""
    network = observed(model.network, query.observer).network
    assert query.observer is not None
    bad = LocationTest(len(network.processes) - 1, query.observer.bad, span=NOWHERE)
    program, goals = lower(network, [bad])
    outcome = explore(program, goals, options, Limits(states=100_000))
    assert outcome.goals[0].status is not Status.UNDECIDED, outcome.reason
    return outcome.goals[0].status is Status.REACHED


def random_watched(random: Random, network: Network) -> Query | None:
    """A query with an observer over locations and integers of a network; None where the formula drawn has none."""
    formula = random_formula(random, SHAPE, 2) if random.random() < 0.2 else _shaped(random)
    atoms = {name: random_atom(random, network) for name in FLAGS}
    watched = rewrite(formula, lambda node: substitute(node, atoms) if isinstance(node, ast.NameExpression) else node)
    node = ast.TemporalFormula(NOWHERE, watched)
    return elaborate_temporal(node, "property", scope_of(network), Context(DiagnosticCollector()), "", None)


def random_atom(random: Random, network: Network) -> ast.Expression:
    integers = [v.name for v in network.variables if isinstance(v.type, IntType) and not network.resets(v)]
    if integers and random.random() < 0.3:
        value = ast.IntegerLiteral(NOWHERE, random.randint(0, 2))
        return ast.BinaryExpression(
            NOWHERE, BinaryOperator.EQUAL, ast.NameExpression(NOWHERE, random.choice(integers)), value
        )
    process = random.choice(network.processes)
    location = ast.Identifier(NOWHERE, random.choice(process.locations).name)
    return ast.MemberExpression(NOWHERE, ast.NameExpression(NOWHERE, process.name), location)


def _text(value: object) -> str:
    return "true" if value else "false"


# ---- shapes of requirements -----------------------------------------------------------------------------------------


def _shaped(random: Random) -> Formula:
    kind = random.random()
    if kind < 0.08:
        return _response(random)
    if kind < 0.14:
        return syntax.And(NOWHERE, (_response(random), _globally(_response(random))))
    if kind < 0.2:
        return syntax.WeakUntil(NOWHERE, _condition(random), _condition(random))
    if kind < 0.3:
        return _globally(_response(random))
    if kind < 0.36:
        end = _condition(random)
        until = syntax.Until(NOWHERE, _EVER, syntax.Not(NOWHERE, _condition(random)), end)
        return _globally(
            _implies(
                syntax.And(NOWHERE, (_trigger(random), syntax.Eventually(NOWHERE, _EVER, end))),
                until,
            )
        )
    return _globally(_implies(_trigger(random), _response(random)))


def _trigger(random: Random) -> Formula:
    flag = _condition(random)
    makers: list[Callable[[], Formula]] = [
        lambda: flag,
        lambda: syntax.Rise(NOWHERE, flag),
        lambda: syntax.Fall(NOWHERE, flag),
        lambda: syntax.Change(NOWHERE, _name(random)),
        lambda: syntax.And(NOWHERE, (syntax.Rise(NOWHERE, flag), _condition(random))),
        lambda: syntax.And(NOWHERE, (flag, _past(random))),
        lambda: _past(random),
    ]
    return random.choices(makers, (5, 5, 1, 1, 1, 1, 1))[0]()


def _response(random: Random) -> Formula:
    makers: list[Callable[[], Formula]] = [
        lambda: _condition(random),
        lambda: syntax.Eventually(NOWHERE, _bounded(random), _condition(random)),
        lambda: syntax.Always(NOWHERE, _bounded(random), _condition(random)),
        lambda: syntax.Until(NOWHERE, _bounded(random), _condition(random), _condition(random)),
        lambda: syntax.WeakUntil(NOWHERE, _condition(random), _condition(random)),
        lambda: _past(random),
        lambda: syntax.Eventually(
            NOWHERE, _bounded(random), syntax.Always(NOWHERE, _bounded(random), _condition(random))
        ),
        lambda: syntax.Always(
            NOWHERE, _bounded(random), syntax.Eventually(NOWHERE, _bounded(random), _condition(random))
        ),
        lambda: syntax.Eventually(NOWHERE, _bounded(random), syntax.Rise(NOWHERE, _condition(random))),
        lambda: syntax.Always(NOWHERE, _bounded(random), syntax.Not(NOWHERE, syntax.Rise(NOWHERE, _condition(random)))),
        lambda: syntax.Always(NOWHERE, _bounded(random), _implies(_trigger(random), _condition(random))),
        lambda: syntax.And(NOWHERE, (_response(random), _response(random))),
        lambda: syntax.Or(NOWHERE, (_response(random), _response(random))),
        lambda: syntax.Always(NOWHERE, _EVER, _condition(random)),
    ]
    return random.choices(makers, (2, 5, 5, 3, 2, 2, 3, 1, 1, 1, 1, 1, 1, 1))[0]()


def _on_bounds(random: Random) -> Formula:
    """A formula whose verdict may hang on the moment at which a window begins or ends."""
    trigger, goal, kept = (syntax.Atom(NOWHERE, ast.NameExpression(NOWHERE, name)) for name in FLAGS)

    def goals() -> Formula:
        found = random.choice((goal, syntax.Rise(NOWHERE, goal), syntax.Fall(NOWHERE, goal)))
        return syntax.Not(NOWHERE, found) if random.random() < 0.5 else found

    state = syntax.Not(NOWHERE, goal) if random.random() < 0.5 else goal
    makers: list[Callable[[], Formula]] = [
        lambda: syntax.Eventually(NOWHERE, _window(random), goals()),
        lambda: syntax.Always(NOWHERE, _window(random), goals()),
        lambda: syntax.Until(NOWHERE, _window(random), kept, goals()),
        lambda: syntax.Eventually(NOWHERE, _window(random), syntax.Always(NOWHERE, _window(random), state)),
        lambda: syntax.Always(NOWHERE, _window(random), syntax.Always(NOWHERE, _window(random), goals())),
        lambda: syntax.Once(NOWHERE, _from_zero(random), state),
        lambda: syntax.Historically(NOWHERE, _from_zero(random), state),
        lambda: syntax.Since(NOWHERE, _from_zero(random), kept, state),
        lambda: syntax.Not(NOWHERE, syntax.Fall(NOWHERE, goal)),
    ]
    answer = random.choices(makers, (3, 4, 4, 2, 3, 2, 2, 2, 1))[0]()
    return _globally(_implies(syntax.Rise(NOWHERE, trigger), answer))


def _nested(random: Random) -> Formula:
    """A chain of answers, a scope between edges, something that settles, or a window in the past."""
    names = random.sample(FLAGS, 3)
    first, second, third = (_state_or_edge(random, name) for name in names)
    flag = syntax.Atom(NOWHERE, ast.NameExpression(NOWHERE, names[0]))
    chained = syntax.And(NOWHERE, (second, syntax.Eventually(NOWHERE, _inner(random), third)))
    begun = syntax.And(NOWHERE, (first, syntax.Not(NOWHERE, second), syntax.Eventually(NOWHERE, _EVER, second)))
    makers: list[Callable[[], Formula]] = [
        lambda: _globally(_implies(first, syntax.Eventually(NOWHERE, _window(random), chained))),
        lambda: syntax.Eventually(NOWHERE, _window(random), chained),
        lambda: syntax.Eventually(NOWHERE, _window(random), syntax.And(NOWHERE, (first, second))),
        lambda: _globally(_implies(begun, syntax.Until(NOWHERE, _EVER, syntax.Not(NOWHERE, third), second))),
        lambda: _globally(_implies(begun, syntax.Until(NOWHERE, _EVER, _implies(third, _answer(random)), second))),
        lambda: _globally(_implies(first, syntax.Until(NOWHERE, _window(random), _negated(second), second))),
        lambda: _globally(_implies(first, syntax.WeakUntil(NOWHERE, syntax.Not(NOWHERE, third), second))),
        lambda: _globally(
            _implies(first, syntax.Eventually(NOWHERE, _from_zero(random), syntax.Always(NOWHERE, _EVER, second)))
        ),
        lambda: _globally(_implies(first, _maybe_negated(random, syntax.Once(NOWHERE, _window(random), second)))),
        lambda: _globally(_implies(first, _maybe_negated(random, syntax.Historically(NOWHERE, _window(random), flag)))),
    ]
    return random.choices(makers, (4, 2, 3, 2, 2, 2, 1, 1, 3, 2))[0]()


def _edges(random: Random) -> Formula:
    several = _combined(random, 2)
    makers: list[Callable[[], Formula]] = [
        lambda: syntax.Eventually(NOWHERE, _window(random), several),
        lambda: syntax.Always(NOWHERE, _window(random), several),
        lambda: syntax.Eventually(
            NOWHERE,
            _window(random),
            syntax.Or(NOWHERE, (several, syntax.Always(NOWHERE, _window(random), _combined(random, 0)))),
        ),
    ]
    found = random.choices(makers, (3, 1, 1))[0]()
    return found if random.random() < 0.5 else _globally(_implies(_combined(random, random.choice((0, 1))), found))


def _combined(random: Random, depth: int) -> Formula:
    """Edges and conditions, joined by and and or."""
    if depth > 0 and random.random() < 0.8:
        join = random.choice((syntax.And, syntax.Or))
        return join(NOWHERE, (_combined(random, depth - 1), _combined(random, depth - 1)))
    one, other = _condition(random), _condition(random)
    condition = one if random.random() < 0.7 else syntax.Or(NOWHERE, (one, other))
    makers: list[Callable[[], Formula]] = [
        lambda: syntax.Rise(NOWHERE, condition),
        lambda: syntax.Fall(NOWHERE, condition),
        lambda: condition,
    ]
    return _maybe_negated(random, random.choices(makers, (4, 3, 3))[0]())


def _looking_back(random: Random) -> Formula:
    first, second, third = (_state_or_edge(random, name) for name in random.sample(FLAGS, 3))
    window = random.choice((_window(random), _window(random), _after(random)))
    past: Formula = syntax.Once(NOWHERE, window, second)
    if random.random() < 0.3:
        past = syntax.Historically(NOWHERE, window, second)
    past = _maybe_negated(random, past)
    makers: list[Callable[[], Formula]] = [
        lambda: _globally(_implies(first, past)),
        lambda: _globally(_implies(first, syntax.Or(NOWHERE, (third, past)))),
        lambda: _globally(_implies(first, syntax.And(NOWHERE, (past, third)))),
        lambda: _globally(_implies(syntax.And(NOWHERE, (first, past)), third)),
        lambda: syntax.Not(NOWHERE, syntax.Eventually(NOWHERE, _EVER, syntax.And(NOWHERE, (first, past)))),
        lambda: _globally(past),
    ]
    return random.choices(makers, (4, 2, 1, 2, 1, 1))[0]()


def _endless(random: Random) -> Formula:
    """Something is promised without a deadline, or assumed."""
    first, second, third = (_state_or_edge(random, name) for name in random.sample(FLAGS, 3))
    state = _condition(random)
    window = syntax.Eventually(NOWHERE, _window(random), second)
    makers: list[Callable[[], Formula]] = [
        lambda: syntax.Eventually(NOWHERE, _EVER, first),
        lambda: _globally(_implies(first, syntax.Eventually(NOWHERE, _EVER, second))),
        lambda: _globally(syntax.Eventually(NOWHERE, _EVER, state)),
        lambda: syntax.Until(NOWHERE, _EVER, state, second),
        lambda: _implies(_globally(state), _globally(_implies(first, second))),
        lambda: _implies(_globally(_implies(state, window)), _globally(third)),
        lambda: _implies(syntax.Eventually(NOWHERE, _EVER, state), syntax.Eventually(NOWHERE, _EVER, second)),
        lambda: _globally(_implies(state, syntax.Until(NOWHERE, _EVER, _negated(_condition(random)), second))),
        lambda: _globally(_implies(syntax.Rise(NOWHERE, state), syntax.Eventually(NOWHERE, _after(random), state))),
        lambda: syntax.And(NOWHERE, (window, syntax.Eventually(NOWHERE, _EVER, third))),
        lambda: syntax.Or(NOWHERE, (window, syntax.Eventually(NOWHERE, _after(random), third))),
    ]
    return random.choice(makers)()


def _after(random: Random) -> syntax.Interval:
    """All time from later on."""
    return replace(syntax.all_time(NOWHERE), lower=syntax.Duration(NOWHERE, Fraction(random.randint(0, 2))))


def _answer(random: Random) -> Formula:
    return syntax.Eventually(NOWHERE, _from_zero(random), _state_or_edge(random, random.choice(FLAGS)))


def _state_or_edge(random: Random, name: str) -> Formula:
    flag = syntax.Atom(NOWHERE, ast.NameExpression(NOWHERE, name))
    makers: list[Callable[[], Formula]] = [
        lambda: flag,
        lambda: syntax.Not(NOWHERE, flag),
        lambda: syntax.Rise(NOWHERE, flag),
        lambda: syntax.Fall(NOWHERE, flag),
    ]
    return random.choices(makers, (3, 1, 3, 1))[0]()


def _negated(formula: Formula) -> Formula:
    return syntax.Not(NOWHERE, formula)


def _maybe_negated(random: Random, formula: Formula) -> Formula:
    return _negated(formula) if random.random() < 0.5 else formula


def _inner(random: Random) -> syntax.Interval:
    length = syntax.Duration(NOWHERE, Fraction(random.randint(1, 2)))
    closed = random.random() < 0.7, random.random() < 0.7
    return syntax.Interval(NOWHERE, syntax.Duration(NOWHERE, Fraction(0)), length, *closed)


def _window(random: Random) -> syntax.Interval:
    lower = random.choice((0, 0, 1, 2))
    begin, end = (syntax.Duration(NOWHERE, Fraction(bound)) for bound in (lower, lower + random.randint(1, 2)))
    return syntax.Interval(NOWHERE, begin, end, random.random() < 0.5, random.random() < 0.5)


def _durations(formula: Formula) -> list[syntax.Duration]:
    found: list[syntax.Duration] = []

    def note(node: object) -> object:
        if isinstance(node, syntax.Duration):
            found.append(node)
        return node

    rewrite(formula, note)
    return found


def _past(random: Random) -> Formula:
    interval = random.choice((_from_zero(random), _EVER))
    makers: list[Callable[[], Formula]] = [
        lambda: syntax.Once(NOWHERE, interval, _condition(random)),
        lambda: syntax.Historically(NOWHERE, interval, _condition(random)),
        lambda: syntax.Since(NOWHERE, interval, _condition(random), _condition(random)),
    ]
    return random.choice(makers)()


def _condition(random: Random) -> Formula:
    flag = syntax.Atom(NOWHERE, _name(random))
    if random.random() < 0.3:
        return syntax.Not(NOWHERE, flag)
    if random.random() < 0.15:
        return syntax.And(NOWHERE, (flag, syntax.Not(NOWHERE, syntax.Atom(NOWHERE, _name(random)))))
    return flag


def _name(random: Random) -> ast.Expression:
    return ast.NameExpression(NOWHERE, random.choice(FLAGS))


def _globally(formula: Formula) -> Formula:
    return syntax.Always(NOWHERE, _EVER, formula)


def _implies(left: Formula, right: Formula) -> Formula:
    return syntax.Implies(NOWHERE, left, right)


def _bounded(random: Random) -> syntax.Interval:
    return _from_zero(random) if random.random() < 0.6 else random_interval(random, replace(SHAPE, unbounded=False))


def _from_zero(random: Random) -> syntax.Interval:
    length = syntax.Duration(NOWHERE, Fraction(random.randint(0, SHAPE.bound)))
    return syntax.Interval(NOWHERE, syntax.Duration(NOWHERE, Fraction(0)), length, True, random.random() < 0.7)
