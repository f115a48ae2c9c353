"""Global variables that repeat what happens inside processes.

In UPPAAL the guards of one process cannot name the locations and local variables of another. Where an observer has to
look at them, each edge of the observed template that changes them also changes a global *mirror*: a bool for a
location, a variable of the same values for a variable. Mirrors change in the same transition, so they are never late.

One process of a template has one mirror. The processes `T(0)`, `T(1)`, ... of a template with free parameters share an
array, indexed by the parameters. Where several instantiations name the processes of a template, it gets one more
parameter for each mirror.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from tachk.base.operators import PrefixOperator
from tachk.base.span import Span
from tachk.formats.plain.plain_model import PlainRewriting
from tachk.frontend.scope import FamilySymbol, LocationSymbol, ProcessSymbol, Scope, ValueSymbol
from tachk.model.expressions import Constant, Reference, Variable, VariableKind
from tachk.model.network import Network
from tachk.model.types import BoolType, IntType, bounds
from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.rewrite import fresh_name, names_in, rewrite


class NoMirror(Exception):
    """Something that an observer looks at cannot be repeated in a global variable.

    Attributes:
        span: what it is.
        reason: why not, a sentence without a full stop.
    """

    def __init__(self, span: Span, reason: str) -> None:
        super().__init__(reason)
        self.span = span
        self.reason = reason


@dataclass(frozen=True, slots=True)
class Mirror:
    """Attributes:
    name: of the global variable or, where several instantiations have one each, of the template's parameter.
    owner: the template.
    member: the location or local variable.
    indices: the free parameters of the template that index the mirror.
    targets: for each instantiation of the template the global variable that it passes, if they do.
    """

    name: str
    owner: str
    member: str
    is_location: bool
    indices: tuple[str, ...] = ()
    targets: tuple[tuple[str, str], ...] = ()


@dataclass(slots=True)
class Mirrors:
    """The mirrors of one model as they are found to be needed.

    Attributes:
        items: of the model.
        scope: the names that properties may use.
        taken: all names of the model.
    """

    items: Sequence[ast.Item]
    network: Network
    scope: Scope
    taken: set[str]
    steps: list[PlainRewriting] = field(default_factory=list)
    declarations: list[ast.VariableDeclaration] = field(default_factory=list)
    found: dict[tuple[str, str], Mirror] = field(default_factory=dict)

    # ---- expressions ------------------------------------------------------------------------------------------------

    def reflect(self, expression: ast.Expression) -> ast.Expression:
        """The expression with mirrors in place of locations and local variables. Raises NoMirror."""
        return rewrite(expression, self._reflected)

    def _reflected(self, node: Any) -> Any:
        match node:
            case ast.MemberExpression(base=ast.NameExpression(name=name), name=member):
                symbol = self.scope.lookup(name)
                if isinstance(symbol, ProcessSymbol):
                    return self._member(node, name, symbol, member.name, ())
            case ast.MemberExpression(
                base=ast.CallExpression(function=ast.NameExpression(name=name), arguments=arguments), name=member
            ):
                symbol = self.scope.lookup(name)
                if isinstance(symbol, FamilySymbol) and symbol.instances:
                    first = next(iter(symbol.instances.values()))
                    return self._member(node, name, first, member.name, arguments)
            case _:
                pass
        return node

    def _member(
        self,
        node: ast.MemberExpression,
        process: str,
        symbol: ProcessSymbol,
        member: str,
        arguments: tuple[ast.Expression, ...],
    ) -> ast.Expression:
        found = symbol.members.symbols.get(member)
        span = node.span
        match found:
            case LocationSymbol():
                mirror = self._mirror(node, process, symbol, member, True)
            case ValueSymbol(expression=Constant(value=value)) if not arguments:
                return ast.IntegerLiteral(span, value)
            case ValueSymbol(expression=Reference(variable=variable)) if variable.kind is VariableKind.GLOBAL:
                return ast.NameExpression(span, variable.name)
            case ValueSymbol(expression=Reference(variable=variable)) if isinstance(variable.type, BoolType | IntType):
                mirror = self._mirror(node, process, symbol, member, False)
            case _:
                raise NoMirror(span, f"`{print_expression(node)}` is neither a location nor a variable of one number")
        if mirror.indices:
            result: ast.Expression = ast.NameExpression(span, mirror.name)
            for argument in arguments:
                result = ast.IndexExpression(span, result, argument)
            return result
        targets = dict(mirror.targets)
        if not arguments:
            return ast.NameExpression(span, targets.get(process, mirror.name))
        raise NoMirror(span, f"`{process}` is instantiated in more than one way")

    # ---- finding mirrors --------------------------------------------------------------------------------------------

    def _mirror(
        self, node: ast.MemberExpression, process: str, symbol: ProcessSymbol, member: str, is_location: bool
    ) -> Mirror:
        owner = self.network.processes[symbol.number].template
        known = self.found.get((owner, member))
        if known is not None:
            return known
        template = next(item for item in self.items if isinstance(item, ast.Template) and item.name.name == owner)
        direct = owner in _system_names(self.items)
        instantiations = [i for i in self.items if isinstance(i, ast.Instantiation) and i.template.name == owner]
        processes = [n for n, p in enumerate(self.network.processes) if p.template == owner]
        if direct and (instantiations or any(p.reference for p in template.parameters)):
            raise NoMirror(node.span, f"`{owner}` stands in the system line and is instantiated as well")
        if direct and template.parameters:
            mirror = self._array(node, template, process, member, is_location, processes)
        elif len(processes) == 1:
            name = self._fresh(f"{process}_{member}")
            mirror = Mirror(name, owner, member, is_location)
            self._declare(node, name, processes[0], member, is_location)
        else:
            mirror = self._parameter(node, template, instantiations, member, is_location)
        self.found[owner, member] = mirror
        what = "location" if is_location else "variable"
        self.steps.append(
            PlainRewriting(
                "observer", node.span, f"the {what} `{print_expression(node)}` is repeated in `{mirror.name}`"
            )
        )
        return mirror

    def _array(
        self,
        node: ast.MemberExpression,
        template: ast.Template,
        process: str,
        member: str,
        is_location: bool,
        processes: Sequence[int],
    ) -> Mirror:
        name = self._fresh(f"{process}_{member}")
        dimensions = tuple(
            replace(p.type, prefixes=tuple(x for x in p.type.prefixes if x != "const")) for p in template.parameters
        )
        self._declare(node, name, processes[0], member, is_location, dimensions, processes)
        indices = tuple(parameter.name.name for parameter in template.parameters)
        return Mirror(name, template.name.name, member, is_location, indices)

    def _parameter(
        self,
        node: ast.MemberExpression,
        template: ast.Template,
        instantiations: Sequence[ast.Instantiation],
        member: str,
        is_location: bool,
    ) -> Mirror:
        targets = []
        for instantiation in instantiations:
            instance = instantiation.name.name
            numbers = [n for n, p in enumerate(self.network.processes) if p.name == instance]
            if instantiation.parameters or len(numbers) != 1:
                raise NoMirror(node.span, f"`{instance}` is a partial instantiation of `{template.name.name}`")
            name = self._fresh(f"{instance}_{member}")
            self._declare(node, name, numbers[0], member, is_location)
            targets.append((instance, name))
        name = self._fresh(f"in_{member}" if is_location else f"out_{member}")
        return Mirror(name, template.name.name, member, is_location, (), tuple(targets))

    def _fresh(self, wanted: str) -> str:
        name = fresh_name(wanted, self.taken)
        self.taken.add(name)
        return name

    def _declare(
        self,
        node: ast.MemberExpression,
        name: str,
        process: int,
        member: str,
        is_location: bool,
        dimensions: tuple[ast.TypeExpression, ...] = (),
        processes: Sequence[int] = (),
    ) -> None:
        span = node.span
        values = [self._initial(number, member, is_location) for number in processes or [process]]
        type_: ast.TypeExpression
        if is_location or self._is_bool(process, member):
            type_ = ast.TypeExpression(span, (), ast.BuiltinType(span, "bool"))
            literals: list[ast.Expression] = [ast.BooleanLiteral(span, bool(value)) for value in values]
        else:
            ranges = [bounds(self._variable(n, member).type) for n in processes or [process]]  # type: ignore[arg-type]
            low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
            type_ = ast.TypeExpression(span, (), ast.RangeType(span, _number(span, low), _number(span, high)))
            literals = [_number(span, value) for value in values]
        initialiser: ast.Expression = literals[0]
        if dimensions:
            initialiser = self._nested(span, literals, processes)
        declarator = ast.Declarator(span, ast.Identifier(span, name), dimensions, initialiser)
        self.declarations.append(ast.VariableDeclaration(span, type_, (declarator,)))

    def _nested(self, span: Span, literals: list[ast.Expression], processes: Sequence[int]) -> ast.Expression:
        """The initialisers of an array with one element for each process, which are in the order of their indices."""
        keys = [_arguments(self.network.processes[number].name) for number in processes]
        entries = dict(zip(keys, literals, strict=True))

        def build(prefix: tuple[int, ...]) -> ast.Expression:
            if prefix in entries:
                return entries[prefix]
            steps = sorted({key[len(prefix)] for key in entries if key[: len(prefix)] == prefix})
            return ast.InitialiserList(span, tuple((None, build((*prefix, step))) for step in steps))

        return build(())

    def _initial(self, process: int, member: str, is_location: bool) -> int:
        node = self.network.processes[process]
        if is_location:
            return int(node.locations[node.initial].name == member)
        return self._variable(process, member).initial[0]

    def _variable(self, process: int, member: str) -> Variable:
        node = self.network.processes[process]
        return next(v for v in node.variables if v.name == f"{node.name}.{member}")

    def _is_bool(self, process: int, member: str) -> bool:
        return isinstance(self._variable(process, member).type, BoolType)

    # ---- templates --------------------------------------------------------------------------------------------------

    def template(self, template: ast.Template) -> ast.Template:
        """The template with edges that keep its mirrors up to date."""
        mirrors = [mirror for mirror in self.found.values() if mirror.owner == template.name.name]
        if not mirrors:
            return template
        parameters = tuple(self._formal(mirror, template.span) for mirror in mirrors if mirror.targets)
        return replace(
            template,
            parameters=template.parameters + parameters,
            locations=tuple(
                replace(node, edges=self._edges(node.edges, node.name.name, mirrors)) for node in template.locations
            ),
            branchpoints=tuple(
                replace(node, edges=self._edges(node.edges, node.name.name, mirrors)) for node in template.branchpoints
            ),
            edges=self._edges(template.edges, None, mirrors),
        )

    def instantiation(self, node: ast.Instantiation) -> ast.Instantiation:
        """The instantiation with the mirrors among its arguments."""
        more = [
            ast.NameExpression(node.span, dict(mirror.targets)[node.name.name])
            for mirror in self.found.values()
            if mirror.owner == node.template.name and mirror.targets
        ]
        return replace(node, arguments=(*node.arguments, *more)) if more else node

    def _formal(self, mirror: Mirror, span: Span) -> ast.Parameter:
        declaration = next(d for d in self.declarations if d.declarators[0].name.name == mirror.targets[0][1])
        assert declaration.type is not None
        return ast.Parameter(span, declaration.type, True, ast.Identifier(span, mirror.name))

    def _edges(
        self, edges: Iterable[ast.EdgeDeclaration], source: str | None, mirrors: Sequence[Mirror]
    ) -> tuple[ast.EdgeDeclaration, ...]:
        return tuple(replace(edge, updates=(*edge.updates, *self._updates(edge, source, mirrors))) for edge in edges)

    def _updates(
        self, edge: ast.EdgeDeclaration, source: str | None, mirrors: Sequence[Mirror]
    ) -> Iterator[ast.Expression]:
        left = source if edge.source is None else edge.source.name
        for mirror in mirrors:
            span = edge.span
            if mirror.is_location:
                if (left == mirror.member) == (edge.target.name == mirror.member):
                    continue
                value: ast.Expression = ast.BooleanLiteral(span, edge.target.name == mirror.member)
            else:
                receives = edge.synchronisation is not None and edge.synchronisation.value is not None
                if not edge.updates and not receives:
                    continue
                value = ast.NameExpression(span, mirror.member)
            hidden = {mirror.member, mirror.name, *mirror.indices} & {s.name.name for s in edge.selects}
            if hidden:
                raise NoMirror(edge.span, f"a select label of the edge hides `{sorted(hidden)[0]}`")
            place: ast.Expression = ast.NameExpression(span, mirror.name)
            for index in mirror.indices:
                place = ast.IndexExpression(span, place, ast.NameExpression(span, index))
            yield ast.AssignmentExpression(span, None, place, value)


def _system_names(items: Iterable[ast.Item]) -> set[str]:
    return {name.name for item in items if isinstance(item, ast.SystemLine) for group in item.groups for name in group}


def _number(span: Span, value: int) -> ast.Expression:
    if value >= 0:
        return ast.IntegerLiteral(span, value)
    return ast.UnaryExpression(span, PrefixOperator.MINUS, ast.IntegerLiteral(span, -value))


def _arguments(process: str) -> tuple[int, ...]:
    """The values of the free parameters in the name of a process, ``T(1,2)``."""
    return tuple(int(value) for value in process[process.index("(") + 1 : -1].split(","))


def all_names(items: Iterable[ast.Item]) -> set[str]:
    return set(names_in(tuple(items)))
