"""A network that was made in Python as a syntax tree: what it would be in a file, with a template for each process."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.span import NOWHERE, Source, Span
from tachk.formats.network_text import expression_node, type_node
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.made_network import made_model
from tachk.model.expressions import Call, Expression, LocationTest, Variable
from tachk.model.network import DEFAULT_PRIORITY, Edge, Location, Network, Process
from tachk.model.traversal import walk
from tachk.model.types import ArrayType, BoolType, ChannelType, ClockType, IntType, Type, element_type
from tachk.syntax import ast

AT = NOWHERE


class NotWritable(Exception):
    """The network has something that the language cannot say; the text says what."""


def network_document(network: Network, name: str) -> ast.Document:
    """The document that elaborates to this network.

    Args:
        name: what messages call it.

    Raises:
        NotWritable: there is none.
    """
    if network.default_priority != DEFAULT_PRIORITY:
        raise NotWritable("priorities of channels")
    if any(process.name != process.template for process in network.processes):
        raise NotWritable("several processes of one template")
    for expression in _expressions(network):
        for part in walk(expression):
            if isinstance(part, LocationTest):
                raise NotWritable("a test of a location in the behaviour")
            if isinstance(part, Call) and part.function.operation is None:
                raise NotWritable(f"the function {part.function.name}, which was made in Python, too")
    declarations = tuple(_declaration(variable, variable.name, network, "") for variable in network.variables)
    templates = tuple(_template(process, network) for process in network.processes)
    priorities = sorted({process.priority for process in network.processes})
    groups = tuple(
        tuple(_identifier(process.name) for process in network.processes if process.priority == priority)
        for priority in priorities
    )
    order = [process for priority in priorities for process in network.processes if process.priority == priority]
    if order != list(network.processes):
        raise NotWritable("priorities of processes in another order than the processes")
    items: tuple[ast.Item, ...] = (*declarations, *templates, ast.SystemLine(AT, groups))
    return ast.Document(Span(Source(name, ""), 0, 0), items)


def network_model(network: Network, name: str) -> LoadedModel:
    """A network with the names that queries may use and, where the language can say it, the text that it would have."""
    try:
        document = network_document(network, name)
    except NotWritable:
        document = ast.Document(Span(Source(name, ""), 0, 0), ())
    return made_model(network, document)


def why_not_writable(network: Network) -> str:
    """The reason why a network cannot be written as a document."""
    try:
        network_document(network, "")
    except NotWritable as reason:
        return f"it has {reason}"
    return "it has no process"


def _expressions(network: Network) -> Iterator[Expression]:
    for process in network.processes:
        for location in process.locations:
            yield from () if location.invariant is None else (location.invariant,)
            yield from (rate for _, rate in location.rates)
        for edge in process.edges:
            yield from () if edge.guard is None else (edge.guard,)
            yield from () if edge.synchronisation is None else (edge.synchronisation.channel,)
            yield from edge.updates


def _template(process: Process, network: Network) -> ast.Template:
    prefix = f"{process.name}."
    for variable in process.variables:
        if not variable.name.startswith(prefix):
            raise NotWritable(f"the variable {variable.name} of process {process.name}, which has no name of its own")
    return ast.Template(
        AT,
        _identifier(process.name),
        (),
        tuple(_declaration(v, v.name.removeprefix(prefix), network, process.name) for v in process.variables),
        tuple(
            _location(location, number == process.initial, process, network)
            for number, location in enumerate(process.locations)
        ),
        edges=tuple(_edge(edge, process, network) for edge in process.edges),
    )


def _location(location: Location, initial: bool, process: Process, network: Network) -> ast.LocationDeclaration:
    parts = [] if location.invariant is None else [expression_node(location.invariant, network, process.name)]
    for clock, rate in location.rates:
        derivative = ast.RateExpression(AT, expression_node(clock, network, process.name))
        parts.append(
            ast.BinaryExpression(AT, BinaryOperator.EQUAL, derivative, expression_node(rate, network, process.name))
        )
    invariant = None
    for part in parts:
        invariant = part if invariant is None else ast.BinaryExpression(AT, BinaryOperator.AND, invariant, part)
    return ast.LocationDeclaration(
        AT,
        _identifier(location.name),
        invariant,
        initial=initial,
        urgent=location.urgent,
        committed=location.committed,
        doc=location.doc,
    )


def _edge(edge: Edge, process: Process, network: Network) -> ast.EdgeDeclaration:
    synchronisation = None
    if edge.synchronisation is not None:
        channel = expression_node(edge.synchronisation.channel, network, process.name)
        synchronisation = ast.SynchronisationLabel(AT, channel, edge.synchronisation.direction)
    return ast.EdgeDeclaration(
        AT,
        _identifier(process.locations[edge.source].name),
        _identifier(process.locations[edge.target].name),
        tuple(ast.SelectBinding(AT, _identifier(each.name), type_node(each.type)) for each in edge.selects),
        None if edge.guard is None else expression_node(edge.guard, network, process.name),
        synchronisation,
        tuple(expression_node(update, network, process.name) for update in edge.updates),
        doc=edge.doc,
    )


def _declaration(variable: Variable, name: str, network: Network, owner: str) -> ast.VariableDeclaration:
    base, dimensions = variable.type, []
    while isinstance(base, ArrayType):
        if not isinstance(base.index, IntType):
            raise NotWritable(f"the scalar index of {variable.name}")
        dimensions.append(_size(base.index))
        base = base.element
    if len(set(variable.priorities)) > 0:
        raise NotWritable("priorities of channels")
    prefixes = ("meta",) if network.resets(variable) else ()
    written: ast.TypeExpression
    match base:
        case ClockType():
            written = ast.TypeExpression(AT, prefixes, ast.BuiltinType(AT, "clock"))
        case ChannelType(broadcast, urgent):
            named = (*(("urgent",) if urgent else ()), *(("broadcast",) if broadcast else ()))
            written = ast.TypeExpression(AT, named, ast.BuiltinType(AT, "chan"))
        case IntType() | BoolType():
            written = ast.TypeExpression(AT, prefixes, type_node(base).base)
        case _:
            raise NotWritable(f"the type of {variable.name}")
    initialiser = None
    if isinstance(base, IntType | BoolType):
        initialiser = _initialiser(variable.type, list(variable.initial))
    declarator = ast.Declarator(AT, _identifier(name), tuple(dimensions), initialiser)
    return ast.VariableDeclaration(AT, written, (declarator,))


def _size(index: IntType) -> ast.Expression | ast.TypeExpression:
    return ast.IntegerLiteral(AT, index.high + 1) if index.low == 0 else type_node(index)


def _initialiser(type_: Type, slots: list[int]) -> ast.Expression:
    """The first slots as a value of the type; they are taken away."""
    if isinstance(type_, ArrayType):
        return ast.InitialiserList(AT, tuple((None, _initialiser(type_.element, slots)) for _ in range(type_.size)))
    value = slots.pop(0)
    if isinstance(element_type(type_), BoolType):
        return ast.BooleanLiteral(AT, bool(value))
    positive = ast.IntegerLiteral(AT, abs(value))
    return positive if value >= 0 else ast.UnaryExpression(AT, PrefixOperator.MINUS, positive)


def _identifier(name: str) -> ast.Identifier:
    return ast.Identifier(AT, name)
