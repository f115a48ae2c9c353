"""The vocabulary of a template: what its edges say, and what it could say and does not.

An edge that a model lacks is most likely made of words that are there: a function that nothing calls, a channel on
which the others act, a guard that completes those of its siblings.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import product

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.logic.observer.conditions import negated
from tachk.syntax import ast
from tachk.syntax.chains import chain, conjuncts
from tachk.syntax.printing.expression_printer import print_expressions, print_synchronisation
from tachk.syntax.rewrite import names_in, substitute
from tachk.syntax.walk import edges_with_sources, nodes_of_kind


@dataclass(frozen=True, slots=True)
class PlacedEdge:
    """An edge with the name of its source."""

    source: str
    edge: ast.EdgeDeclaration


@dataclass(frozen=True, slots=True)
class EdgeLabel:
    """A synchronisation with the bindings of its names; None: the edge is internal."""

    selects: tuple[ast.SelectBinding, ...] = ()
    synchronisation: ast.SynchronisationLabel | None = None
    text: str = ""

    @property
    def bound(self) -> frozenset[str]:
        return frozenset(binding.name.name for binding in self.selects)


INTERNAL = EdgeLabel()


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """Attributes:
    edges: those between two locations; those to and from branchpoints are left out.
    labels: of its edges, each once.
    other_labels: synchronisations on its channel parameters with elements that others use and none of its edges does.
    unanswered: synchronisations on channels on which others send, or receive, and nobody takes the other side.
    unheard: the same on broadcast channels, on which nobody need receive.
    updates: the lists of updates of its edges, and each of them alone, without those that need a name of a select; and
        what gives a variable that they change its initial value again.
    calls: of its functions without parameters and result that nothing in it calls.
    complements: guards that are true only where none of the edges from a location with a label is possible, by the
        location and the text of the label; in a committed location by it and None, whatever the labels are.
    conditions: calls of its functions without parameters that are true or false and that nothing in it calls.
    """

    template: ast.Template
    locations: tuple[str, ...]
    edges: tuple[PlacedEdge, ...]
    labels: tuple[EdgeLabel, ...]
    other_labels: tuple[EdgeLabel, ...]
    unanswered: tuple[EdgeLabel, ...]
    unheard: tuple[EdgeLabel, ...]
    updates: tuple[tuple[ast.Expression, ...], ...]
    calls: tuple[ast.Expression, ...]
    conditions: tuple[ast.Expression, ...]
    complements: Mapping[tuple[str, str | None], tuple[ast.Expression, ...]]

    def complementary(self, source: str, label: EdgeLabel) -> tuple[ast.Expression, ...]:
        """The guards that complete those of the edges with which an edge with that label would compete."""
        return self.complements.get((source, label.text)) or self.complements.get((source, None), ())


def _complements(
    edges: Sequence[PlacedEdge], labels: Iterable[EdgeLabel], committed: Collection[str]
) -> dict[tuple[str, str | None], tuple[ast.Expression, ...]]:
    found: dict[tuple[str, str | None], tuple[ast.Expression, ...]] = {}
    texts = {id(placed): label_of(placed.edge).text for placed in edges}
    for source in {placed.source for placed in edges}:
        here = [placed for placed in edges if placed.source == source]
        for label in labels:
            same = [placed.edge for placed in here if texts[id(placed)] == label.text]
            found[source, label.text] = tuple(_complement(same, label))
        if source in committed:
            found[source, None] = tuple(_complement([placed.edge for placed in here], INTERNAL))
    return found


def _complement(siblings: Sequence[ast.EdgeDeclaration], label: EdgeLabel) -> Iterator[ast.Expression]:
    """The negation of each condition that all the edges have, and of all their guards together."""
    guards = [edge.guard for edge in siblings if edge.guard is not None]
    bound = {binding.name.name for edge in siblings for binding in edge.selects} - label.bound
    if not guards or len(guards) < len(siblings) or bound & names_in(guards).keys():
        return
    parts = [part for guard in guards for part in conjuncts(negated(guard))]
    whole = chain(BinaryOperator.AND, list(dict.fromkeys(parts)), guards[0].span)
    common = [part for part in conjuncts(guards[0]) if all(part in conjuncts(guard) for guard in guards[1:])]
    yield from dict.fromkeys([*map(negated, common), whole])


def label_of(edge: ast.EdgeDeclaration) -> EdgeLabel:
    return _label(edge.selects, edge.synchronisation)


def _label(selects: tuple[ast.SelectBinding, ...], label: ast.SynchronisationLabel | None) -> EdgeLabel:
    return EdgeLabel(selects, label, "" if label is None else print_synchronisation(label))


def placed_edges(template: ast.Template) -> Iterator[PlacedEdge]:
    """The edges of a template between two locations."""
    places = {location.name.name for location in template.locations}
    for source, edge in edges_with_sources(template):
        if {source, edge.target.name} <= places:
            yield PlacedEdge(source, edge)


def vocabulary(template: ast.Template, items: Sequence[ast.Item]) -> Vocabulary:
    """The vocabulary of a template of a model.

    Args:
        items: of the model, imports replaced by what they declare.
    """
    edges = tuple(placed_edges(template))
    labels = {label_of(placed.edge).text: label_of(placed.edge) for placed in edges if placed.edge.synchronisation}
    updates = {
        print_expressions(placed.edge.updates): placed.edge.updates
        for placed in edges
        if placed.edge.updates and not names_in(placed.edge.updates).keys() & label_of(placed.edge).bound
    }
    updates |= {print_expressions((one,)): (one,) for several in list(updates.values()) for one in several}
    others = {label.text: label for label in _other_elements(template, items) if label.text not in labels}
    unanswered = {
        broadcast: {
            label.text: label
            for label in _unanswered(template, items, _global_channels(items, broadcast))
            if label.text not in labels
        }
        for broadcast in (False, True)
    }
    uncalled = list(_uncalled(template))
    updates |= {print_expressions(each): each for each in _resets(template, items, edges)}
    return Vocabulary(
        template,
        tuple(location.name.name for location in template.locations),
        edges,
        tuple(labels.values()),
        tuple(others.values()),
        tuple(unanswered[False].values()),
        tuple(unanswered[True].values()),
        tuple(updates.values()),
        tuple(_call(function) for function in uncalled if _result(function) == "void"),
        tuple(_call(function) for function in uncalled if _result(function) == "bool"),
        _complements(
            edges,
            (INTERNAL, *labels.values()),
            {location.name.name for location in template.locations if location.committed},
        ),
    )


def _resets(
    template: ast.Template, items: Sequence[ast.Item], edges: Iterable[PlacedEdge]
) -> Iterator[tuple[ast.Expression, ...]]:
    """Assignments of their initial values to the variables that the edges change, where these are numbers."""
    declared = {
        declarator.name.name: declarator.initialiser
        for each in (*items, *template.declarations)
        if isinstance(each, ast.VariableDeclaration)
        for declarator in each.declarators
        if not declarator.dimensions
    }
    for update in (update for placed in edges for update in placed.edge.updates):
        if isinstance(update, ast.AssignmentExpression) and isinstance(update.target, ast.NameExpression):
            initial = declared.get(update.target.name)
            if isinstance(initial, ast.IntegerLiteral | ast.BooleanLiteral):
                yield (replace(update, operator=None, value=initial),)


def _uncalled(template: ast.Template) -> Iterator[ast.FunctionDeclaration]:
    functions = [each for each in template.declarations if isinstance(each, ast.FunctionDeclaration)]
    for function in functions:
        others = [each for each in template.declarations if each is not function]
        used = names_in([*others, *template.locations, *template.edges, *template.branchpoints])
        if function.name.name not in used and not function.parameters:
            yield function


def _result(function: ast.FunctionDeclaration) -> str:
    base = function.result.base
    return base.name if isinstance(base, ast.BuiltinType) else ""


def _call(function: ast.FunctionDeclaration) -> ast.Expression:
    span = function.name.span
    return ast.CallExpression(span, ast.NameExpression(span, function.name.name), ())


# ---- channels on which others act -----------------------------------------------------------------------------------


def _unanswered(template: ast.Template, items: Sequence[ast.Item], channels: frozenset[str]) -> Iterator[EdgeLabel]:
    """What the template could say on those global channels on which only one side acts, with its own parameters as
    indices. What the recording replaces is such a side, for the channels that are recorded."""
    acting: dict[str, set[Direction | None]] = {}
    modelled: set[str] = set()
    edges: list[tuple[ast.Template, ast.EdgeDeclaration]] = []
    replaced = {name.name for clause in nodes_of_kind(list(items), ast.ReplacesClause) for name in clause.names}
    for other in (item for item in items if isinstance(item, ast.Template)):
        local = _local_names(other)
        for placed in placed_edges(other):
            label = placed.edge.synchronisation
            base = _indexed(label.channel)[0] if label is not None else None
            if label is not None and base is not None and base.name in channels and base.name not in local:
                acting.setdefault(base.name, set()).add(label.direction)
                modelled |= set() if other.name.name in replaced else {base.name}
                edges.append((other, placed.edge))
    recorded = names_in([clause.channel for clause in nodes_of_kind(list(items), ast.VisibleClause)])
    elsewhere = names_in([item for item in items if isinstance(item, ast.RecordingDeclaration | ast.Instantiation)])
    lonely = {name for name, sides in acting.items() if len(sides) == 1 and name not in elsewhere}
    lonely |= recorded.keys() - modelled
    for other, edge in edges:
        yield from _answering(template, other, edge, frozenset(lonely))


def _other_elements(template: ast.Template, items: Sequence[ast.Item]) -> Iterator[EdgeLabel]:
    """What the template could say on the channels that are its parameters, with any constant index that the model uses
    on one."""
    templates = [item for item in items if isinstance(item, ast.Template)]
    constants = list(dict.fromkeys(_constant_indices(templates)))
    for parameter in template.parameters:
        if len(parameter.dimensions) == 1 and _is_channel(parameter.type):
            for direction in _directions(template, parameter.name.name):
                for name in constants:
                    span = parameter.name.span
                    element = ast.IndexExpression(
                        span, ast.NameExpression(span, parameter.name.name), ast.NameExpression(span, name)
                    )
                    yield _label((), ast.SynchronisationLabel(span, element, direction))
    for label in (placed.edge.synchronisation for placed in placed_edges(template)):
        if label is not None and isinstance(label.channel, ast.IndexExpression):
            yield from _with_other_numbers(label, label.channel, items)


_FEW_ELEMENTS = 8


def _with_other_numbers(
    label: ast.SynchronisationLabel, channel: ast.IndexExpression, items: Sequence[ast.Item]
) -> Iterator[EdgeLabel]:
    """A label with another number as the last index, where that is a number and the array is small."""
    base = channel.base
    if not isinstance(channel.index, ast.IntegerLiteral) or not isinstance(base, ast.NameExpression):
        return
    sizes = [
        declarator.dimensions[0]
        for item in items
        if isinstance(item, ast.VariableDeclaration)
        for declarator in item.declarators
        if declarator.name.name == base.name and declarator.dimensions
    ]
    for size in sizes:
        if isinstance(size, ast.IntegerLiteral) and size.value <= _FEW_ELEMENTS:
            for number in range(size.value):
                element = replace(channel, index=replace(channel.index, value=number))
                yield _label((), replace(label, channel=element))


def _answering(
    template: ast.Template, other: ast.Template, edge: ast.EdgeDeclaration, channels: frozenset[str]
) -> Iterator[EdgeLabel]:
    """The synchronisations of a template with an edge of another one on one of some channels."""
    label = edge.synchronisation
    if label is None or label.direction is None or label.value is not None:
        return
    base, indices = _indexed(label.channel)
    if base is None or base.name not in channels or base.name in _local_names(template):
        return
    types = {parameter.name.name: parameter.type.base for parameter in other.parameters}
    types |= {binding.name.name: binding.type.base for binding in edge.selects}
    choices = [list(_own_indices(template, index, types)) for index in indices]
    for chosen in product(*choices):
        channel: ast.Expression = base
        for index in chosen:
            channel = ast.IndexExpression(label.span, channel, index)
        yield _label((), ast.SynchronisationLabel(label.span, channel, label.direction.opposite))


def _own_indices(
    template: ast.Template, index: ast.Expression, types: Mapping[str, object]
) -> Iterator[ast.Expression]:
    """What a template writes for an index of another one."""
    local = names_in(index).keys() & types.keys()
    if not local:
        yield index
        return
    for name in local:
        for parameter in template.parameters:
            if _same_type(parameter.type.base, types[name]):
                yield substitute(index, {name: ast.NameExpression(index.span, parameter.name.name)})


def _same_type(one: object, other: object) -> bool:
    return isinstance(one, ast.NamedType) and isinstance(other, ast.NamedType) and one.name == other.name


def _indexed(channel: ast.Expression) -> tuple[ast.NameExpression | None, list[ast.Expression]]:
    indices: list[ast.Expression] = []
    while isinstance(channel, ast.IndexExpression):
        indices.insert(0, channel.index)
        channel = channel.base
    return (channel if isinstance(channel, ast.NameExpression) else None), indices


def _constant_indices(templates: Iterable[ast.Template]) -> Iterator[str]:
    """The names by which elements of channels that are parameters are chosen."""
    for template in templates:
        channels = {parameter.name.name for parameter in template.parameters if _is_channel(parameter.type)}
        local = _local_names(template)
        for placed in placed_edges(template):
            label = placed.edge.synchronisation
            base, indices = _indexed(label.channel) if label is not None else (None, [])
            bound = label_of(placed.edge).bound
            if base is not None and base.name in channels:
                for index in indices:
                    if isinstance(index, ast.NameExpression) and index.name not in local | bound:
                        yield index.name


def _directions(template: ast.Template, channel: str) -> tuple[Direction, ...]:
    """The directions in which a template uses a channel; both, if it does not."""
    labels = [placed.edge.synchronisation for placed in placed_edges(template)]
    found = {
        label.direction
        for label in labels
        if label is not None and label.direction is not None and channel in names_in(label.channel)
    }
    return tuple(found) or (Direction.SEND, Direction.RECEIVE)


def _is_channel(type_: ast.TypeExpression) -> bool:
    return isinstance(type_.base, ast.BuiltinType) and type_.base.name == "chan"


def _global_channels(items: Sequence[ast.Item], broadcast: bool) -> frozenset[str]:
    return frozenset(
        declarator.name.name
        for item in items
        if isinstance(item, ast.VariableDeclaration) and item.type is not None and _is_channel(item.type)
        if ("broadcast" in item.type.prefixes) == broadcast
        for declarator in item.declarators
    )


def _local_names(template: ast.Template) -> frozenset[str]:
    names = {parameter.name.name for parameter in template.parameters}
    return frozenset(names | {name.name for each in template.declarations for name in _declared(each)})


def _declared(declaration: ast.Declaration) -> Iterator[ast.Identifier]:
    yield from (declarator.name for declarator in nodes_of_kind(declaration, ast.Declarator))
