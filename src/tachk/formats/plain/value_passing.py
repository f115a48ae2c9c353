"""Synchronisation with values, ``c!e`` and ``c?x``, written out with a variable that carries the value.

For a channel ``c`` there is a ``meta`` variable ``c_value`` beside it, an array if ``c`` is one. The sender's first
update stores the value there, the receiver's first update takes it. A template that knows the channel only as a
parameter gets one more parameter for the variable.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.formats.plain.plain_model import PlainRewriting
from tachk.model.expressions import Variable
from tachk.model.types import IntType, RecordType, ScalarType, Type, element_type
from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expressions, print_synchronisation
from tachk.syntax.rewrite import fresh_name

Typed = tuple[ast.Declaration, ...]


@dataclass(slots=True)
class ValuePassing:
    """Attributes:
    names: of the variable that carries the values of a channel, by the channel's name.
    carried: for each template or instantiation the parameters that are channels with values, in order, each with the
        type of the value, None while it is unknown.
    """

    variables: Sequence[Variable]
    taken: set[str]
    steps: list[PlainRewriting] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)
    payloads: dict[str, dict[str, ast.TypeExpression | None]] = field(default_factory=dict)

    def expand(
        self, declarations: Typed, templates: Sequence[ast.Template], instantiations: Sequence[ast.Instantiation]
    ) -> tuple[Typed, tuple[ast.Template, ...], tuple[ast.Instantiation, ...]]:
        """All three without values on channels. Raises UnsupportedError for a channel that cannot be followed."""
        if not any(True for template in templates for _ in _passing(template)):
            return declarations, tuple(templates), tuple(instantiations)
        for template in templates:
            own = self.payloads.setdefault(template.name.name, {})
            parameters = {p.name.name for p in template.parameters}
            for label in _passing(template):
                root = _root(label.channel)
                if root in parameters:
                    own[root] = None
        self._follow(templates, instantiations)
        return (
            declarations + self._carriers(declarations),
            tuple(self._template(template) for template in templates),
            tuple(self._instantiation(node, templates, instantiations) for node in instantiations),
        )

    # ---- channels that are parameters -------------------------------------------------------------------------------

    def _follow(self, templates: Sequence[ast.Template], instantiations: Sequence[ast.Instantiation]) -> None:
        """Finds the parameters of instantiations that carry values, and the types of all of them."""
        parameters = _parameters_of(templates, instantiations)
        changed = True
        while changed:
            changed = False
            for node in instantiations:
                own = {p.name.name for p in node.parameters}
                for wanted in list(self.payloads.get(node.template.name, {})):
                    argument = _argument(node, parameters[node.template.name], wanted)
                    root = _root(argument)
                    if root in own:
                        mine = self.payloads.setdefault(node.name.name, {})
                        if root not in mine:
                            mine[root] = None
                            changed = True
                        found = mine[root]
                    else:
                        found = self._type_of(root, argument.span)
                    if found is not None and self.payloads[node.template.name][wanted] is None:
                        self.payloads[node.template.name][wanted] = found
                        changed = True

    def _type_of(self, channel: str, span: Span) -> ast.TypeExpression | None:
        hidden = self._hidden(channel)
        return None if hidden is None else _type_node(element_type(hidden.type), span)

    def _hidden(self, channel: str) -> Variable | None:
        return next((v for v in self.variables if v.carries is not None and v.carries.name == channel), None)

    def _instantiation(
        self,
        node: ast.Instantiation,
        templates: Sequence[ast.Template],
        instantiations: Sequence[ast.Instantiation],
    ) -> ast.Instantiation:
        parameters = _parameters_of(templates, instantiations)
        arguments = node.arguments
        for wanted in self.payloads.get(node.template.name, {}):
            channel = _argument(node, parameters[node.template.name], wanted)
            arguments = (*arguments, _with_root(channel, self._name(_root(channel))))
        more = self._parameters(node.name.name, node.parameters)
        return replace(node, parameters=node.parameters + more, arguments=arguments)

    def _parameters(self, owner: str, given: Sequence[ast.Parameter]) -> tuple[ast.Parameter, ...]:
        result = []
        for name, type_ in self.payloads.get(owner, {}).items():
            channel = next(p for p in given if p.name.name == name)
            span = channel.span
            known = type_ or ast.TypeExpression(span, (), ast.BuiltinType(span, "int"))
            identifier = ast.Identifier(span, self._name(name))
            result.append(ast.Parameter(span, known, True, identifier, channel.dimensions))
        return tuple(result)

    # ---- declarations -----------------------------------------------------------------------------------------------

    def _name(self, channel: str) -> str:
        if channel not in self.names:
            name = fresh_name(f"{channel}_value", self.taken)
            self.taken.add(name)
            self.names[channel] = name
        return self.names[channel]

    def _carriers(self, declarations: Typed) -> Typed:
        """The variables that carry values, behind everything their types may need."""
        channels = {
            declarator.name.span: declarator
            for item in declarations
            if isinstance(item, ast.VariableDeclaration)
            for declarator in item.declarators
        }
        result = []
        for hidden in self.variables:
            channel = None if hidden.carries is None else channels.get(hidden.carries.span)
            if channel is None:
                continue
            base = _type_node(element_type(hidden.type), channel.span)
            name = ast.Identifier(channel.span, self._name(channel.name.name))
            declared = ast.Declarator(channel.span, name, channel.dimensions)
            self.steps.append(
                PlainRewriting(
                    "value passing", channel.name.span, f"`{name.name}` carries the values of `{channel.name.name}`"
                )
            )
            result.append(ast.VariableDeclaration(channel.span, replace(base, prefixes=("meta",)), (declared,)))
        return tuple(result)

    # ---- edges ------------------------------------------------------------------------------------------------------

    def _template(self, template: ast.Template) -> ast.Template:
        for declaration in template.declarations:
            if isinstance(declaration, ast.VariableDeclaration):
                self._refuse_local(template, declaration)
        own = self._parameters(template.name.name, template.parameters)
        edges = tuple(self._edge(edge) for edge in template.edges)
        return replace(template, parameters=template.parameters + own, edges=edges)

    def _refuse_local(self, template: ast.Template, declaration: ast.VariableDeclaration) -> None:
        used = {_root(label.channel): label.span for label in _passing(template)}
        for declarator in declaration.declarators:
            if declarator.name.name in used:
                raise UnsupportedError(
                    Diagnostic(
                        "E0801",
                        f"values pass over `{declarator.name.name}`, a channel inside a template",
                        used[declarator.name.name],
                        "declare the channel among the global declarations",
                    )
                )

    def _edge(self, edge: ast.EdgeDeclaration) -> ast.EdgeDeclaration:
        label = edge.synchronisation
        if label is None or label.value is None:
            return edge
        carrier = _with_root(label.channel, self._name(_root(label.channel)))
        target, value = (carrier, label.value) if label.direction is Direction.SEND else (label.value, carrier)
        update = ast.AssignmentExpression(label.span, None, target, value)
        plain = replace(label, value=None)
        self.steps.append(
            PlainRewriting(
                "value passing",
                label.span,
                f"`{print_synchronisation(label)}` is `{print_synchronisation(plain)}` and the first update "
                f"`{print_expressions([update])}`",
            )
        )
        return replace(edge, synchronisation=plain, updates=(update, *edge.updates))


def _parameters_of(
    templates: Sequence[ast.Template], instantiations: Sequence[ast.Instantiation]
) -> dict[str, tuple[ast.Parameter, ...]]:
    return {t.name.name: t.parameters for t in templates} | {i.name.name: i.parameters for i in instantiations}


def _passing(template: ast.Template) -> Iterator[ast.SynchronisationLabel]:
    for edge in template.edges:
        if edge.synchronisation is not None and edge.synchronisation.value is not None:
            yield edge.synchronisation


def _root(channel: ast.Expression) -> str:
    while isinstance(channel, ast.IndexExpression):
        channel = channel.base
    if isinstance(channel, ast.NameExpression):
        return channel.name
    raise UnsupportedError(
        Diagnostic("E0801", "the channel over which a value passes is not named directly", channel.span)
    )


def _with_root(channel: ast.Expression, name: str) -> ast.Expression:
    if isinstance(channel, ast.IndexExpression):
        return replace(channel, base=_with_root(channel.base, name))
    return ast.NameExpression(channel.span, name)


def _argument(node: ast.Instantiation, parameters: Sequence[ast.Parameter], name: str) -> ast.Expression:
    return next(a for p, a in zip(parameters, node.arguments, strict=True) if p.name.name == name)


def _type_node(type_: Type, span: Span) -> ast.TypeExpression:
    """A type that a channel can carry, as text has it."""
    match type_:
        case IntType():
            return ast.TypeExpression(span, (), ast.BuiltinType(span, "int"))
        case ScalarType(name) if name.isidentifier():
            return ast.TypeExpression(span, (), ast.NamedType(span, name))
        case RecordType(name) if name.isidentifier():
            return ast.TypeExpression(span, (), ast.NamedType(span, name))
        case _:
            raise UnsupportedError(
                Diagnostic(
                    "E0801",
                    "the values that pass over this channel have a type without a name",
                    span,
                    "name it: typedef struct { ... } message_t;",
                )
            )
