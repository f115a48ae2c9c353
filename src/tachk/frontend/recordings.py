"""The ``recording { ... }`` of a model: names resolved, everything checked."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Label
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import replace
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.frontend.context import Context
from tachk.frontend.durations import units_of
from tachk.frontend.expressions.typed_expressions import expression
from tachk.frontend.expressions.typing import is_integral
from tachk.frontend.scope import ProcessSymbol, Scope, ValueSymbol
from tachk.model.expressions import (
    Conditional,
    Constant,
    Expression,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Process
from tachk.model.recording import RecordedModel, RecordingMap, VisibleEvents
from tachk.model.timestamp_uncertainty import Allowances
from tachk.model.traversal import asks_deadlock, roots, walk
from tachk.model.types import ArrayType, ChannelType, IntType, element_type
from tachk.syntax import ast


def elaborate_recording(
    items: Iterable[ast.Item], processes: Sequence[Process], scope: Scope, context: Context
) -> RecordingMap | None:
    """The recording of a model that has one; None where it is wrong."""
    found = [item for item in items if isinstance(item, ast.RecordingDeclaration)]
    for other in found[1:]:
        label = Label(found[0].span, "the first one")
        context.findings.add("E0450", other.span, "a second `recording`", "join the two", (label,))
    return _RecordingClauseReader(processes, scope, context).recording(found[0])


def channels_of(items: Iterable[ast.Item]) -> frozenset[str]:
    """The names of the channels on which a recording takes part."""
    found: set[str] = set()
    for item in items:
        for clause in item.clauses if isinstance(item, ast.RecordingDeclaration) else ():
            match clause:
                case ast.VisibleClause(channel=channel):
                    found.add(_name(channel))
                case ast.HiddenClause(channels=channels):
                    found.update(map(_name, channels))
                case _:
                    pass
    return frozenset(found)


def _name(channel: ast.Expression) -> str:
    while isinstance(channel, ast.IndexExpression):
        channel = channel.base
    return channel.name if isinstance(channel, ast.NameExpression) else ""


def _written(column: ast.RecordedColumn) -> ast.Expression:
    return column.expression or ast.NameExpression(column.name.span, column.name.name)


def _process(column: ast.Expression, names: Scope) -> int | None:
    """The number of the process that a column names; None where it names none."""
    symbol = names.lookup(column.name) if isinstance(column, ast.NameExpression) else None
    return symbol.number if isinstance(symbol, ProcessSymbol) else None


_Column = tuple[str, Expression]


class _RecordingClauseReader:
    def __init__(self, processes: Sequence[Process], scope: Scope, context: Context) -> None:
        self.processes = processes
        self.scope = scope
        self.context = context

    def recording(self, node: ast.RecordingDeclaration) -> RecordingMap | None:
        replaced: set[int] = set()
        visible: list[VisibleEvents | None] = []
        hidden: list[Expression | None] = []
        allowances: dict[str, Fraction] = {}
        for clause in node.clauses:
            match clause:
                case ast.ReplacesClause(names=names):
                    replaced.update(number for name in names for number in self._processes(name))
                case ast.VisibleClause():
                    visible.append(self._visible(clause))
                case ast.HiddenClause(channels=channels):
                    hidden += [self._hidden(channel) for channel in channels]
                case ast.AllowanceClause():
                    self._allow(allowances, clause)
                case ast.RecordedModelClause():
                    pass
        models = [clause for clause in node.clauses if isinstance(clause, ast.RecordedModelClause)]
        if models:
            return self._elsewhere(node, models[0])
        if not node.clauses or not visible:
            self.context.error(
                "E0451", node.span, "this `recording` says nothing that is visible", "visible c[i] as event(i);"
            )
        if None in visible or None in hidden:
            return None
        events = tuple(each for each in visible if each is not None)
        self._check_left(events, replaced)
        outside = tuple(each for each in hidden if each is not None)
        self._check_joined(events, outside, replaced)
        return RecordingMap(frozenset(replaced), events, outside, Allowances(**allowances), span=node.span)

    def _elsewhere(self, node: ast.RecordingDeclaration, clause: ast.RecordedModelClause) -> RecordingMap | None:
        """Another model takes the recordings."""
        if len(node.clauses) > 1:
            self.context.error(
                "E0451", node.span, "a `recording` with `import` says nothing else", "leave out the other clauses"
            )
        constants: list[tuple[str, int]] = []
        for given in clause.constants:
            written = given.expression or ast.NameExpression(given.name.span, given.name.name)
            value = expression(written, self.scope, self.context)
            if isinstance(value, Constant):
                constants.append((given.name.name, value.value))
            elif value is not None:
                self.context.error("E0451", written.span, "this is not a constant", "write a constant of this model")
        model = RecordedModel(clause.path, tuple(constants))
        return RecordingMap(frozenset(), (), (), model=model, span=node.span)

    def _processes(self, name: ast.Identifier) -> list[int]:
        """The numbers of the processes with a name, or made from a template with that name."""
        found = [n for n, p in enumerate(self.processes) if name.name in (p.name, p.name.partition("(")[0])]
        if not found:
            known = [p.name.partition("(")[0] for p in self.processes]
            help_ = did_you_mean(name.name, known) or "name a process of the system line"
            self.context.error("E0452", name.span, f"there is no process `{name.name}` to replace", help_)
        return found

    def _allow(self, allowances: dict[str, Fraction], clause: ast.AllowanceClause) -> None:
        """Takes note of an allowance, in units of the model, by the fields of `Allowances`."""
        amount = units_of(clause.amount, clause.unit, clause.span, self.context) or Fraction(0)
        sides = [clause.side] if clause.side else ["input", "output"]
        names = ["tolerance"] if clause.word == "tolerance" else [f"{side}_late" for side in sides]
        if any(name in allowances for name in names):
            words = f"{clause.word} {clause.side}".rstrip()
            self.context.error("E0450", clause.span, f"a second `{words}`", "keep one of the two")
        allowances.update(dict.fromkeys(names, amount))

    # ---- channels ---------------------------------------------------------------------------------------------------

    def _hidden(self, node: ast.Expression) -> Expression | None:
        channel = expression(node, self.scope, self.context)
        return channel if channel is None or self._is_channel(channel, node) else None

    def _is_channel(self, value: Expression, node: ast.Expression) -> bool:
        if isinstance(element_type(value.type), ChannelType):
            return True
        self.context.error("E0301", node.span, "this is not a channel", "name a channel that processes synchronise on")
        return False

    def _visible(self, clause: ast.VisibleClause) -> VisibleEvents | None:
        node: ast.Expression = clause.channel
        written: list[ast.Expression] = []
        while isinstance(node, ast.IndexExpression):
            written.insert(0, node.index)
            node = node.base
        channel = expression(node, self.scope, self.context)
        if channel is None or not self._is_channel(channel, node):
            return None
        type_, names = channel.type, Scope(self.scope, "the recording")
        indices: list[Constant | Variable] = []
        for index in written:
            if not isinstance(type_, ArrayType):
                self.context.error("E0454", index.span, "this is one index too many", "leave it out")
                return None
            found = self._index(index, type_, names)
            if found is None:
                return None
            indices.append(found)
            type_ = type_.element
        if isinstance(type_, ArrayType):
            message = "this is an array of channels: it needs an index"
            self.context.error("E0454", clause.channel.span, message, "name a column of the event, as in c[i]")
            return None
        columns = [self._column(column, names) for column in clause.columns]
        per = [self._common(name, indices) for name in clause.per]
        if None in columns or None in per:
            return None
        declared = {c[1].variable for c in columns if c and isinstance(c[1], Reference)}
        for index, variable in zip(written, indices, strict=True):
            if isinstance(variable, Variable) and variable not in declared:
                help_ = f"write `{clause.event.name}({variable.name}, ...)`, or a constant for it"
                self.context.error("E0455", index.span, f"no column of the event gives `{variable.name}`", help_)
                return None
        return VisibleEvents(
            channel,
            tuple(indices),
            clause.event.name,
            tuple(c for c in columns if c is not None),
            tuple(v for v in per if v is not None),
            clause.direction,
            clause.span,
            self._words(clause.columns, names),
        )

    def _index(self, node: ast.Expression, type_: ArrayType, names: Scope) -> Constant | Variable | None:
        if isinstance(node, ast.NameExpression) and self.scope.lookup(node.name) is None:
            variable = Variable(node.name, type_.index, VariableKind.BOUND, span=node.span)
            symbol = ValueSymbol(Reference(variable), False, "index", node.span)
            names.declare(ast.Identifier(node.span, node.name), symbol, self.context.findings)
            return variable
        value = expression(node, self.scope, self.context)
        if value is None or isinstance(value, Constant):
            return value
        help_ = "write a constant, or a new name for a column of the event"
        self.context.error("E0454", node.span, "the index of a visible channel must not change", help_)
        return None

    def _common(self, name: ast.Identifier, indices: Sequence[Constant | Variable]) -> Variable | None:
        known: Callable[[], list[Variable]] = lambda: [i for i in indices if isinstance(i, Variable)]  # noqa: E731
        for variable in known():
            if variable.name == name.name:
                return variable
        help_ = did_you_mean(name.name, [v.name for v in known()]) or "name an index of the channel"
        self.context.error("E0454", name.span, f"`{name.name}` is not an index of this channel", help_)
        return None

    def _column(self, node: ast.RecordedColumn, names: Scope) -> _Column | None:
        written = _written(node)
        process = _process(written, names)
        if process is not None:
            return node.name.name, self._location(process, written.span)
        value = expression(written, names, replace(self.context, in_query=True))
        if value is None:
            return None
        if asks_deadlock(value):
            self.context.error("E0501", written.span, "`deadlock` can only be used in queries")
            return None
        if not is_integral(value.type):
            self.context.error("E0301", written.span, "a column holds a number or a truth value", None)
            return None
        return (node.name.name, value) if self.context.require_pure(value, "a column") else None

    def _location(self, process: int, span: Span) -> Expression:
        """The number of the location in which a process is."""
        locations = self.processes[process].locations
        type_ = IntType(0, len(locations) - 1)
        value: Expression = Constant(0, type_, span)
        for number in reversed(range(len(locations))):
            here = LocationTest(process, number, span=span)
            value = Conditional(here, Constant(number, type_, span), value, type_, span)
        return value

    def _words(self, columns: Iterable[ast.RecordedColumn], names: Scope) -> dict[str, dict[str, int]]:
        """The numbers of locations, by name, for each column that shows in which location a process is."""
        found: dict[str, dict[str, int]] = {}
        for node in columns:
            process = _process(_written(node), names)
            if process is not None:
                locations = self.processes[process].locations
                found[node.name.name] = {location.name: n for n, location in enumerate(locations)}
        return found

    def _check_left(self, visible: Iterable[VisibleEvents], replaced: Collection[int]) -> None:
        """Reports columns about processes whose place the recording takes."""
        gone = {variable: number for number in replaced for variable in self.processes[number].variables}
        for _, column in (each for clause in visible for each in clause.columns):
            for node in walk(column):
                number = None
                if isinstance(node, LocationTest):
                    number = node.process if node.process in replaced else None
                elif isinstance(node, Reference):
                    number = gone.get(node.variable)
                if number is not None:
                    name = self.processes[number].name
                    message = f"the recording takes the place of `{name}`, so no event can show its inside"
                    self.context.error("E0456", node.span, message, f"leave out the column, or do not replace `{name}`")
                    break

    def _check_joined(
        self, visible: Iterable[VisibleEvents], hidden: Iterable[Expression], replaced: Collection[int]
    ) -> None:
        """Reports channels by which processes join that are both left: the recording would have to take part, too."""
        used: defaultdict[Variable, set[Direction]] = defaultdict(set)
        for number, process in enumerate(self.processes):
            for edge in process.edges if number not in replaced else ():
                if edge.synchronisation is not None:
                    for variable in roots(edge.synchronisation.channel):
                        used[variable].add(edge.synchronisation.direction)
        both = set(Direction)
        for clause in visible:
            (variable,) = roots(clause.channel)
            type_ = element_type(clause.channel.type)
            broadcast = isinstance(type_, ChannelType) and type_.broadcast
            if used[variable] == both and not broadcast and clause.direction is not Direction.RECEIVE:
                message = f"`{variable.name}` joins two processes that are both left in the model"
                help_ = (
                    "make it a broadcast channel, so that the recording hears it, or replace the process that receives"
                )
                self.context.error("E0457", clause.span, message, help_)
        for channel in hidden:
            (variable,) = roots(channel)
            if used[variable] == both:
                message = f"the hidden channel `{variable.name}` joins processes that are left in the model"
                help_ = "leave it out of `hidden`: nothing outside takes part in it"
                self.context.error("E0457", channel.span, message, help_)
