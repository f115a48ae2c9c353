"""Scenarios as they are written: ``scenario NAME { press; within 5 ms lit[1] with n == 1; }``."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.records import dataclass, replace
from tachk.base.words import QueryKind
from tachk.frontend.context import Context
from tachk.frontend.durations import units_of
from tachk.frontend.expressions.typed_expressions import condition, constant_integer, expression
from tachk.frontend.queries.scenario_observer import ObservedChannel, ScenarioEvent, scenario_observer
from tachk.frontend.scope import Scope
from tachk.model.expressions import Constant, Expression, Index, LocationTest, Reference, Variable
from tachk.model.query import Expectation, Query
from tachk.model.traversal import asks_deadlock, clock_in, walk
from tachk.model.types import ArrayType, ChannelType, element_type, slot_count
from tachk.syntax import ast
from tachk.syntax.printing.query_printer import print_query
from tachk.syntax.rewrite import fresh_name

SCENARIO = "Scenario"
"""The name of the observer's process, where no other has it."""

_LONGEST = 2**30
_SHOWN = 4
"""A scenario of more steps is not written out in reports."""


def elaborate_scenario(
    node: ast.ScenarioFormula,
    name: str,
    scope: Scope,
    context: Context,
    title: str,
    expectation: Expectation | None,
) -> Query | None:
    """The query whether some run has the events of a scenario; None after a report."""
    reader = _ScenarioReader(scope, replace(context, in_query=True))
    steps = [reader.step(clause) for clause in node.clauses if isinstance(clause, ast.ScenarioStep)]
    also = [
        channel
        for clause in node.clauses
        if isinstance(clause, ast.ObservesClause)
        for written in clause.channels
        for channel in reader.channels(written)
    ]
    if not steps:
        context.error("E0460", node.span, f"the scenario `{name}` has no event", "name a channel, as in `press;`")
    known = [step for step in steps if step is not None]
    if not steps or len(known) < len(steps) or context.findings.has_errors:
        return None
    observer, reached = scenario_observer(fresh_name(SCENARIO, set(scope.names())), known, also)
    shown = len(known) <= _SHOWN
    text = print_query(node) if shown else f"scenario of {len(known)} steps"
    query = Query(name, QueryKind.POSSIBLY, reached, (), text, title, expectation, node.span)
    return replace(query, observer=observer)


@dataclass(frozen=True, slots=True)
class _ScenarioReader:
    scope: Scope
    context: Context

    def step(self, node: ast.ScenarioStep) -> ScenarioEvent | None:
        earliest = 0 if node.earliest is None else self._time(node.earliest)
        latest = None if node.latest is None else self._time(node.latest)
        if earliest is None or (node.latest is not None and latest is None):
            return None
        if latest is not None and latest < earliest:
            self.context.error("E0461", node.span, f"no event is from {earliest} to {latest}", "exchange the two times")
            return None
        if node.channel is None:
            if not earliest:
                help_ = "write how long nothing happens, or leave it out"
                self.context.error("E0461", node.span, "a silence takes no time here", help_)
                return None
            return ScenarioEvent((), earliest, None, None)
        channels = tuple(self.channels(node.channel))
        value = None if node.condition is None else self._condition(node.condition)
        if not channels or (node.condition is not None and value is None):
            return None
        return ScenarioEvent(channels, earliest, latest, value)

    def _time(self, node: ast.ScenarioTime) -> int | None:
        if isinstance(node.amount, int):
            amount: int | None = node.amount
        else:
            amount = constant_integer(node.amount, "a time of a scenario", self.scope, self.context)
        if amount is None or (units := units_of(amount, node.unit, node.span, self.context)) is None:
            return None
        if units.denominator != 1:
            message = f"{units} units of the model are no whole number"
            self.context.error("E0461", node.span, message, "choose a smaller `time_unit`")
            return None
        if not 0 <= units < _LONGEST:
            self.context.error("E0461", node.span, f"a time of {units} is outside [0, 2^30)")
            return None
        return int(units)

    def channels(self, node: ast.Expression) -> Iterator[ObservedChannel]:
        """The channel that a name and indices mean, or all of an array."""
        channel = expression(node, self.scope, self.context)
        if channel is None:
            return
        if not isinstance(element_type(channel.type), ChannelType):
            help_ = "name a channel that processes synchronise on; conditions go behind `with`"
            self.context.error("E0301", node.span, "this is not a channel", help_)
            return
        place = self._place(channel)
        if place is None:
            help_ = "write constants as indices, or leave the last ones out: `send[0]` is any of its channels"
            self.context.error("E0460", node.span, "an event of a scenario is on a channel that is known", help_)
            return
        variable, first = place
        for number in range(slot_count(channel.type)):
            yield ObservedChannel(variable, first + number)

    def _place(self, channel: Expression) -> tuple[Variable, int] | None:
        match channel:
            case Reference(variable):
                return variable, 0
            case Index(base, Constant(value), type_) if isinstance(base.type, ArrayType):
                above = self._place(base)
                return None if above is None else (above[0], above[1] + (value - base.type.low) * slot_count(type_))
            case _:
                return None

    def _condition(self, node: ast.Expression) -> Expression | None:
        value = condition(node, self.scope, self.context)
        if value is None or not self.context.require_pure(value, "a scenario"):
            return None
        clock = clock_in(value)
        if clock is not None:
            help_ = "say when an event happens with `within`, `after` or `from ... to`"
            self.context.error("E0462", clock.span, "a scenario cannot look at a clock", help_)
        elif asks_deadlock(value):
            self.context.error("E0501", node.span, "`deadlock` has no place in a scenario", "ask E<> deadlock")
        elif any(isinstance(part, LocationTest) for part in walk(value)):
            help_ = "compare variables; a variable that edges set can show where a process is"
            self.context.error("E0462", node.span, "a scenario cannot look at locations", help_)
        else:
            return value
        return None
