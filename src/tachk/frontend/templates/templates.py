"""From a template, with its parameters bound, to a process."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.frontend.context import Context
from tachk.frontend.declarations.channels import ChannelTable
from tachk.frontend.declarations.declarations import Declared, declare
from tachk.frontend.dropped import checked_part_of_update
from tachk.frontend.expressions.clock_constraints import convex, forbid
from tachk.frontend.expressions.places import assignable, converted
from tachk.frontend.expressions.typed_expressions import condition, expression, type_reader
from tachk.frontend.expressions.typing import can_assign, describe
from tachk.frontend.scope import BrokenSymbol, LocationSymbol, Scope, Symbol, ValueSymbol
from tachk.frontend.templates.chances import chance, rate
from tachk.frontend.templates.rates import invariant_parts
from tachk.model.expressions import Assign, Expression, Reference, Variable, VariableKind
from tachk.model.network import Branching, Edge, Location, Process, Synchronisation
from tachk.model.traversal import compares_clocks
from tachk.model.types import ChannelType, element_type
from tachk.syntax import ast


@dataclass(frozen=True, slots=True)
class EdgeBranch:
    """An edge of the text with its source."""

    source: ast.Identifier
    edge: ast.EdgeDeclaration


def branches(template: ast.Template) -> Iterator[EdgeBranch]:
    """All edges of a template, in order, whichever way it is written."""
    for location in template.locations:
        for edge in location.edges:
            yield EdgeBranch(location.name, edge)
    for point in template.branchpoints:
        for edge in point.edges:
            yield EdgeBranch(point.name, edge)
    for edge in template.edges:
        if edge.source is not None:
            yield EdgeBranch(edge.source, edge)


@dataclass(slots=True)
class Body:
    """Elaborates the locations and edges of one process.

    Attributes:
        scope: the local names; its parent has the parameters.
    """

    template: ast.Template
    scope: Scope
    channels: ChannelTable
    context: Context

    def locations(self) -> tuple[Location, ...]:
        result = []
        for node in self.template.locations:
            invariant, rates, hybrid_rates = invariant_parts(node.invariant, self.scope, self.context)
            result.append(
                Location(
                    node.name.name,
                    invariant,
                    rates,
                    node.urgent,
                    node.committed,
                    node.doc,
                    node.name.span,
                    rate(node, self.scope, self.context),
                    hybrid_rates,
                )
            )
        return tuple(result)

    def edges(self, numbers: dict[str, int]) -> tuple[Edge, ...]:
        """The edges; those through a branchpoint are joined, one for each way in and each way out."""
        points = {point.name.name for point in self.template.branchpoints}
        outgoing: dict[str, list[tuple[ast.EdgeDeclaration, int]]] = {p: [] for p in points}
        incoming: list[tuple[EdgeBranch, Edge, Scope]] = []
        for branch in branches(self.template):
            if branch.source.name in points:
                self._leave_branchpoint(branch, numbers, points, outgoing)
                continue
            source = self._location(branch.source, numbers)
            is_point = branch.edge.target.name in points
            target = 0 if is_point else self._location(branch.edge.target, numbers)
            edge, inner = self._edge(branch.edge, source or 0, target or 0)
            if source is not None and target is not None:
                incoming.append((branch, edge, inner))
        result: list[Edge] = []
        for way, (branch, edge, inner) in enumerate(incoming):
            point = branch.edge.target.name
            if point not in points:
                result.append(edge)
                continue
            result += [self._joined(way, edge, inner, node, target) for node, target in outgoing[point]]
        self._warn_of_dead_branchpoints()
        return tuple(result)

    def _joined(self, way: int, edge: Edge, scope: Scope, node: ast.EdgeDeclaration, target: int) -> Edge:
        """The edge made of a way into a branchpoint, with its number, and a way out of it; either may synchronise."""
        selects, inner = self._selects(node, scope)
        synchronisation, updates = edge.synchronisation, (*edge.updates, *self._updates(node, inner))
        if node.synchronisation is not None:
            if synchronisation is not None:
                self.context.error(
                    "E0750",
                    node.synchronisation.span,
                    "a second synchronisation on the way through a branchpoint is not supported",
                    "keep one of the two: the edge to the branchpoint and its branch are one step",
                )
            synchronisation, first = self._synchronisation(node.synchronisation, inner)
            self._urgent_guard(synchronisation, edge.guard)
            updates = updates if first is None else (first, *updates)
        return replace(
            edge,
            target=target,
            selects=edge.selects + selects,
            synchronisation=synchronisation,
            updates=updates,
            spans=(*edge.spans, node.span),
            doc=edge.doc or node.doc,
            branch=Branching(way, len(edge.selects), chance(node.probability, "a weight", inner, self.context)),
        )

    def _warn_of_dead_branchpoints(self) -> None:
        left = {branch.source.name for branch in branches(self.template)}
        for point in self.template.branchpoints:
            if point.name.name not in left:
                self.context.findings.add(
                    "W0412",
                    point.name.span,
                    f"no edge leaves branchpoint `{point.name.name}`: the edges to it are never taken",
                    "add a branch",
                )

    def _leave_branchpoint(
        self,
        branch: EdgeBranch,
        numbers: dict[str, int],
        points: set[str],
        outgoing: dict[str, list[tuple[ast.EdgeDeclaration, int]]],
    ) -> None:
        edge = branch.edge
        if edge.guard is not None:
            self.context.error(
                "E0404",
                edge.guard.span,
                "an edge that leaves a branchpoint cannot have a guard",
                "put it on the edges that lead to the branchpoint",
            )
        if edge.target.name in points:
            self.context.error(
                "E0404", edge.target.span, "an edge cannot lead from a branchpoint to a branchpoint", "join the two"
            )
            return
        target = self._location(edge.target, numbers)
        if target is not None:
            outgoing[branch.source.name].append((edge, target))

    def _location(self, name: ast.Identifier, numbers: dict[str, int]) -> int | None:
        number = numbers.get(name.name)
        if number is None:
            self.context.error(
                "E0209",
                name.span,
                f"template `{self.template.name.name}` has no location `{name.name}`",
                did_you_mean(name.name, numbers) or f"the locations are {', '.join(numbers)}",
            )
        return number

    def _edge(self, node: ast.EdgeDeclaration, source: int, target: int) -> tuple[Edge, Scope]:
        selects, inner = self._selects(node, self.scope)
        guard = None
        if node.guard is not None:
            guard = self._guard(node.guard, inner)
        synchronisation, first = None, None
        if node.synchronisation is not None:
            from tachk.frontend.templates.switched_off import switched_off

            is_off = switched_off(node.guard, guard, inner, self.context)
            synchronisation, first = self._synchronisation(node.synchronisation, inner, is_off)
            self._urgent_guard(synchronisation, guard)
        updates = self._updates(node, inner)
        if first is not None:
            updates = (first, *updates)
        return Edge(source, target, selects, guard, synchronisation, updates, node.doc, (node.span,)), inner

    def _selects(self, node: ast.EdgeDeclaration, scope: Scope) -> tuple[tuple[Variable, ...], Scope]:
        """The select variables of an edge, and the scope in which they are known."""
        inner = Scope(scope)
        selects = []
        for binding in node.selects:
            type_ = type_reader(inner, self.context).bounded(binding.type, "a select")
            symbol: Symbol = BrokenSymbol(binding.name.span)
            if type_ is not None:
                variable = Variable(binding.name.name, type_, VariableKind.BOUND, span=binding.name.span)
                selects.append(variable)
                symbol = ValueSymbol(Reference(variable), False, "select variable", binding.name.span)
            inner.declare(binding.name, symbol, self.context.findings)
        return tuple(selects), inner

    def _guard(self, node: ast.Expression, scope: Scope) -> Expression | None:
        value = condition(node, scope, self.context)
        if value is None or not self.context.require_pure(value, "a guard"):
            return None
        return convex(value, "guard", self.context)

    def _urgent_guard(self, synchronisation: Synchronisation | None, guard: Expression | None) -> None:
        if synchronisation is None or guard is None or not compares_clocks(guard):
            return
        type_ = synchronisation.channel.type
        if isinstance(type_, ChannelType) and type_.urgent:
            self.context.findings.add(
                "W0403",
                guard.span,
                f"a clock guard on the urgent channel `{synchronisation.channel.span.text}`",
                "UPPAAL warns of this, and analyses that need zones refuse it: guard with variables only",
            )

    def _updates(self, node: ast.EdgeDeclaration, scope: Scope) -> tuple[Expression, ...]:
        values = []
        for update in node.updates:
            checked = checked_part_of_update(update, scope)
            if checked is None:
                continue
            value = expression(checked, scope, self.context)
            if value is not None and forbid(value, "an update", self.context):
                values.append(value)
        return tuple(values)

    def _synchronisation(
        self, node: ast.SynchronisationLabel, scope: Scope, is_off: bool = False
    ) -> tuple[Synchronisation | None, Expression | None]:
        channel = self._channel(node.channel, scope)
        if node.direction is None:
            self.context.error(
                "E0750",
                node.span,
                "a synchronisation without a direction (CSP style) is not supported",
                "write `!` to send or `?` to receive",
            )
            return None, None
        if channel is None:
            return None, None
        if not isinstance(channel.type, ChannelType):
            self.context.error(
                "E0401",
                node.channel.span,
                f"only channels can synchronise, this is {_article(describe(channel.type))}",
                f"choose one of them: `{node.channel.span.text}[i]`"
                if isinstance(element_type(channel.type), ChannelType)
                else None,
            )
            return None, None
        if not self.context.require_pure(channel, "a channel index"):
            return None, None
        direction = node.direction
        self.channels.note(channel, direction, node.span, node.value is not None, is_off)
        first = None
        if node.value is not None:
            first = self._pass_value(node, node.value, channel, direction, scope)
        return Synchronisation(channel, direction, node.span), first

    def _channel(self, node: ast.Expression, scope: Scope) -> Expression | None:
        base = node
        while isinstance(base, ast.IndexExpression):
            base = base.base
        if isinstance(base, ast.NameExpression) and scope.lookup(base.name) is None:
            declared = f"declare it above: `chan {base.name}{'[n]' if base is not node else ''};`"
            channels = [name for name in scope.names() if _is_channel(scope.lookup(name))]
            help_ = did_you_mean(base.name, channels) or scope.declared_below(base.name) or declared
            self.context.error("E0201", base.span, f"unknown channel `{base.name}`", help_)
            return None
        return expression(node, scope, self.context)

    def _pass_value(
        self,
        node: ast.SynchronisationLabel,
        written: ast.Expression,
        channel: Expression,
        direction: Direction,
        scope: Scope,
    ) -> Expression | None:
        if direction is Direction.RECEIVE and not assignable(written, scope, self.context):
            return None
        value = expression(written, scope, self.context)
        if value is None:
            return None
        place = self.channels.value_place(channel, value.type, written.span, self.context)
        if place is None:
            return None
        target, source = (place, value) if direction is Direction.SEND else (value, place)
        if not can_assign(target.type, source.type):
            self.context.error(
                "E0402", written.span, f"{describe(source.type)} cannot be stored in {describe(target.type)}"
            )
            return None
        return Assign(target, converted(source, target.type), target.type, None, node.span)


def _article(noun: str) -> str:
    return ("an " if noun[0] in "aeiou" else "a ") + noun


def elaborate_process(
    template: ast.Template,
    name: str,
    parameters: Scope,
    declared: Declared,
    channels: ChannelTable,
    context: Context,
) -> tuple[Process, Scope]:
    """A process of a template whose parameters are bound in a scope; also its local names, for queries.

    Args:
        declared: what the parameters have declared already (array constants); gets the local variables.
    """
    scope = Scope(parameters.parent, f"process `{name}`", dict(parameters.symbols))
    declare(template.declarations, scope, declared, context)
    numbers: dict[str, int] = {}
    for location in template.locations:
        scope.declare(location.name, LocationSymbol(len(numbers), location.name.span), context.findings)
        numbers.setdefault(location.name.name, len(numbers))
    initial = _initial(template, context)
    body = Body(template, scope, channels, context)
    locations = body.locations() or (Location("nowhere", span=template.name.span),)
    edges = body.edges(numbers)
    process = Process(
        name, template.name.name, locations, edges, initial, tuple(declared.variables), span=template.name.span
    )
    return process, scope


def _initial(template: ast.Template, context: Context) -> int:
    initial = [i for i, location in enumerate(template.locations) if location.initial]
    if len(initial) == 1:
        return initial[0]
    if not template.locations:
        context.error(
            "W0410",
            template.name.span,
            f"template `{template.name.name}` has no locations: its processes do nothing",
            "write at least `init location idle;`",
        )
        return 0
    if not initial:
        context.error(
            "E0403",
            template.name.span,
            f"template `{template.name.name}` has no initial location",
            "write `init` in front of one location",
        )
        return 0
    for number in initial[1:]:
        location = template.locations[number]
        if location.name == template.locations[initial[0]].name:
            continue  # declared twice, which is reported already
        context.error(
            "E0403",
            location.name.span,
            f"`{location.name.name}` is a second initial location",
            f"template `{template.name.name}` starts in `{template.locations[initial[0]].name.name}`",
        )
    return initial[0]


def warn_unreachable(template: ast.Template, context: Context) -> None:
    """Warns about locations that no path of edges leads to, unless some edge leads to an unknown place."""
    successors: dict[str, list[str]] = {}
    known = {node.name.name for node in template.locations} | {node.name.name for node in template.branchpoints}
    for branch in branches(template):
        if branch.edge.target.name not in known:
            return
        successors.setdefault(branch.source.name, []).append(branch.edge.target.name)
    pending = [location.name.name for location in template.locations if location.initial]
    if not pending:
        return
    reached = set(pending)
    while pending:
        for target in successors.get(pending.pop(), ()):
            if target not in reached:
                reached.add(target)
                pending.append(target)
    for location in template.locations:
        if location.name.name not in reached:
            context.findings.add(
                "W0404",
                location.name.span,
                f"no path of edges leads to location `{location.name.name}` of `{template.name.name}`",
                "add an edge to it, or remove it",
            )


def _is_channel(symbol: Symbol | None) -> bool:
    """True if a name stands for a channel, or an array of them."""
    return isinstance(symbol, ValueSymbol) and isinstance(element_type(symbol.expression.type), ChannelType)
