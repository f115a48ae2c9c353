"""The clocks that a simulation takes for hybrid ones: floating point variables that change with the rates of locations.

Clocks that are declared so are, and plain ones that are used like them: with rates that are not certainly 0 or 1, with
floating point numbers, in guards over urgent channels, in weights, or in arithmetic other than `x = y + e`. So are
parameters and their arguments, if one of the two is. Only names are looked at; a plain clock that is taken for a
hybrid one needlessly has the same runs, but for the rounding of floating point numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from collections.abc import Set as AbstractSet

from tachk.base.operators import COMPARISONS, BinaryOperator, PrefixOperator
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind, outermost


def passed_arguments(items: tuple[ast.Item, ...]) -> Iterator[tuple[ast.Parameter, ast.Expression]]:
    """Each parameter with each of its arguments, in partial instantiations, too.

    Functions of different templates that have the same name count as one.
    """
    made = {item.name.name: item for item in items if isinstance(item, ast.Template | ast.Instantiation)}
    functions: dict[str, list[ast.FunctionDeclaration]] = {}
    for function in nodes_of_kind(items, ast.FunctionDeclaration):
        functions.setdefault(function.name.name, []).append(function)
    for item in made.values():
        if isinstance(item, ast.Instantiation) and item.template.name in made:
            yield from zip(made[item.template.name].parameters, item.arguments, strict=False)
    for call in nodes_of_kind(items, ast.CallExpression):
        if isinstance(call.function, ast.NameExpression):
            for function in functions.get(call.function.name, ()):
                yield from zip(function.parameters, call.arguments, strict=False)


_ARITHMETIC = (BinaryOperator.MULTIPLY, BinaryOperator.DIVIDE)
_TRUTHS = (*COMPARISONS, BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLY, BinaryOperator.XOR)
_TRUTHS_OF_TRUTHS = (
    BinaryOperator.MULTIPLY,
    BinaryOperator.BIT_AND,
    BinaryOperator.BIT_OR,
    BinaryOperator.BIT_XOR,
    BinaryOperator.MINIMUM,
    BinaryOperator.MAXIMUM,
)
"""They give 0 or 1 if both operands are."""


def hybrid_clocks(items: Iterable[ast.Item], taken: Iterable[str] = ()) -> frozenset[str]:
    """The names of plain clocks that are used like hybrid ones, or together with those that are ``taken`` for such."""
    tree = tuple(items)
    declared = tuple(node for item in tree for node in nodes_of_kind(item, ast.VariableDeclaration))
    clocks = _plain_clocks(tree)
    floating = _floating(tree)
    passed = [pair for pair in passed_arguments(tree) if pair[0].name.name in clocks | floating]
    initial = [d for node in declared if _is(node, "clock") for d in node.declarators if d.initialiser is not None]
    truths = _truths(tree)
    nodes = [
        node
        for item in tree
        for node in nodes_of_kind(item, ast.BinaryExpression, ast.AssignmentExpression, ast.FunctionDeclaration)
    ]
    comparisons = [*_outermost_comparisons(tree)]
    found = {d.name.name for d in initial if not _is_exact(d.initialiser, floating) or _draws(d.initialiser)}
    found |= {parameter.name.name for parameter, argument in passed if not _is_exact(argument, set())} & clocks
    found |= set(taken)
    found |= {name for guard in urgent_guards(tree) for name in _names(guard, clocks)}
    for edge in (inner for item in tree for inner in nodes_of_kind(item, ast.EdgeDeclaration)):
        found.update(_names(edge.probability, clocks))
    while True:
        more = found | {name for node in nodes for name in _used(node, clocks, floating | found, truths)}
        more |= {name for node in comparisons for name in _inexact(node, clocks, floating | found)}
        more |= {name for pair in passed for name in _passed(*pair, clocks, floating | more)}
        if more <= found:
            return frozenset(found)
        found |= more


def _passed(
    parameter: ast.Parameter, argument: ast.Expression, clocks: AbstractSet[str], floating: AbstractSet[str]
) -> frozenset[str]:
    """The plain clocks among a parameter and its argument, if one of the two is a floating point number."""
    names = frozenset((parameter.name.name, *_names(argument, clocks | floating)))
    return names & clocks if names & floating else frozenset()


def urgent_guards(items: Iterable[ast.Item]) -> Iterator[ast.Expression]:
    """The guards that compare clocks on edges over urgent channels. Receivers of a broadcast, which do not wait,
    are not among them."""
    tree = tuple(items)
    clocks: set[str] = set()
    urgent: dict[str, bool] = {}
    for node in _declarations(tree):
        names = _declared_names(node)
        if _is_of(node.type, "clock"):
            clocks.update(names)
        if _is_of(node.type, "chan") and node.type is not None and "urgent" in node.type.prefixes:
            urgent |= dict.fromkeys(names, "broadcast" in node.type.prefixes)
    for edge in (inner for item in tree for inner in nodes_of_kind(item, ast.EdgeDeclaration)):
        sync, guard = edge.synchronisation, edge.guard
        if sync is None or guard is None:
            continue
        channel = next(iter(_names(sync.channel, set(urgent))), None)
        receives = channel is not None and urgent[channel] and sync.direction is Direction.RECEIVE
        if channel is not None and not receives and any(_names(guard, clocks)):
            yield guard


@dataclass(frozen=True, slots=True)
class DeclaredNames:
    """The names that a model declares and that matter to queries which compute with clocks.

    Attributes:
        clocks: plain clocks.
        floating: floating point variables and hybrid clocks.
        truths: variables, fields and functions whose values are 0 or 1 only.
    """

    clocks: frozenset[str]
    floating: frozenset[str]
    truths: frozenset[str]


def declared_names(items: Iterable[ast.Item]) -> DeclaredNames:
    tree = tuple(items)
    return DeclaredNames(frozenset(_plain_clocks(tree)), frozenset(_floating(tree)), frozenset(_truths(tree)))


def named_clocks(node: ast.Expression, declared: DeclaredNames) -> frozenset[str]:
    """The names of the plain clocks in an expression of a query, also of those inside processes."""
    return frozenset(_names(node, declared.clocks))


def _plain_clocks(tree: tuple[ast.Item, ...]) -> set[str]:
    return {name for node in _declarations(tree) if _is(node, "clock") for name in _declared_names(node)}


def _floating(tree: tuple[ast.Item, ...]) -> set[str]:
    return {name for node in _declarations(tree) if _is_floating(node) for name in _declared_names(node)}


def _declarations(tree: tuple[ast.Item, ...]) -> Iterator[ast.VariableDeclaration | ast.Parameter]:
    return (inner for item in tree for inner in nodes_of_kind(item, ast.VariableDeclaration, ast.Parameter))


def _declared_names(node: ast.VariableDeclaration | ast.Parameter) -> list[str]:
    return [node.name.name] if isinstance(node, ast.Parameter) else [d.name.name for d in node.declarators]


def computed_clocks(node: ast.Expression, declared: DeclaredNames, measured: bool) -> frozenset[str]:
    """The names of the plain clocks with which an expression of a query computes, so that they have to be hybrid ones.

    Args:
        measured: the expression is a value and no condition: alone a clock is exact, but everything else computes.
    """
    clocks, floating, truths = declared.clocks, declared.floating, declared.truths
    if measured:
        alone = isinstance(node, ast.NameExpression | ast.MemberExpression | ast.IndexExpression)
        return frozenset() if alone else frozenset(_names(node, clocks))
    found: set[str] = set()
    for inner in nodes_of_kind(node, ast.BinaryExpression, ast.CallExpression):
        if isinstance(inner, ast.CallExpression):
            found.update(name for argument in inner.arguments for name in _names(argument, clocks))
        else:
            found.update(_used(inner, clocks, floating, truths))
    found.update(name for inner in _outermost_comparisons(node) for name in _inexact(inner, clocks, floating))
    return frozenset(found)


def _outermost_comparisons(tree: object) -> Iterator[ast.Node]:
    """The comparisons that stand in no other one. An inexact part makes the outermost one inexact, too."""
    return outermost(tree, _compares)


def _compares(node: ast.Node) -> bool:
    """True if a node is a comparison, but not one that gives a rate."""
    if not isinstance(node, ast.BinaryExpression) or node.operator not in COMPARISONS:
        return False
    return node.operator is not BinaryOperator.EQUAL or not any(
        isinstance(side, ast.RateExpression) for side in (node.left, node.right)
    )


def _inexact(comparison: ast.Node, clocks: AbstractSet[str], floating: AbstractSet[str]) -> Iterator[str]:
    """The clocks in a comparison that has a floating point number."""
    return iter(()) if _is_exact(comparison, floating) else _names(comparison, clocks)


def _used(
    node: ast.Node, clocks: AbstractSet[str], floating: AbstractSet[str], truths: AbstractSet[str]
) -> Iterator[str]:
    match node:
        case ast.BinaryExpression(operator=BinaryOperator.EQUAL, left=ast.RateExpression() as rate, right=value) | (
            ast.BinaryExpression(operator=BinaryOperator.EQUAL, left=value, right=ast.RateExpression() as rate)
        ):
            if not _stops_or_runs(value, truths):
                yield from _names(rate.clock, clocks)
                yield from _names(value, clocks)
        case ast.BinaryExpression(operator=operator, left=left, right=right):
            direct = [side.name for side in (left, right) if isinstance(side, ast.NameExpression)]
            if operator in _ARITHMETIC:
                yield from clocks & {*direct}
        case ast.AssignmentExpression(operator=None, target=target, value=value) if _is_copy(
            target, value, clocks
        ) and (_is_exact(node, floating)):
            return
        case ast.AssignmentExpression(target=target, value=value):
            if not _is_exact(value, floating):
                yield from _names(target, clocks)
            yield from _names(value, clocks)
        case ast.FunctionDeclaration():
            # A function may set a plain clock, but not read it.
            for compared in outermost(node, lambda inner: isinstance(inner, ast.BinaryExpression)):
                yield from _names(compared, clocks)
        case _:
            return


def _is_copy(target: ast.Expression, value: ast.Expression, clocks: AbstractSet[str]) -> bool:
    """True if an assignment looks like `x = y` or `x = y + e` with clocks x and y."""
    if not _is_place(target, clocks):
        return False
    if isinstance(value, ast.BinaryExpression) and value.operator is BinaryOperator.ADD:
        pairs = ((value.left, value.right), (value.right, value.left))
        return any(_is_place(clock, clocks) and not any(_names(more, clocks)) for clock, more in pairs)
    return _is_place(value, clocks)


def _is_place(node: ast.Expression, clocks: AbstractSet[str]) -> bool:
    while isinstance(node, ast.IndexExpression):
        node = node.base
    match node:
        case ast.NameExpression(name=name) | ast.MemberExpression(name=ast.Identifier(name=name)):
            return name in clocks
        case _:
            return False


def _is(node: ast.VariableDeclaration | ast.Parameter, name: str) -> bool:
    return node.type is not None and "hybrid" not in node.type.prefixes and _is_of(node.type, name)


def _is_of(type_: ast.TypeExpression | None, name: str) -> bool:
    return type_ is not None and isinstance(type_.base, ast.BuiltinType) and type_.base.name == name


def _is_floating(node: ast.VariableDeclaration | ast.Parameter) -> bool:
    return _is(node, "double") or (node.type is not None and "hybrid" in node.type.prefixes)


def _is_exact(node: ast.Node | None, floating: AbstractSet[str]) -> bool:
    """True if nothing in an expression is a floating point number."""
    return not any(nodes_of_kind(node, ast.FloatLiteral)) and not any(_names(node, floating))


def _draws(node: ast.Node | None) -> bool:
    """True if a function of UPPAAL's that draws random numbers may be called."""
    return any(call.function.span.text.startswith("random") for call in nodes_of_kind(node, ast.CallExpression))


def _stops_or_runs(value: ast.Expression, truths: AbstractSet[str]) -> bool:
    """True if a rate is certainly 0 or 1."""
    match value:
        case ast.IntegerLiteral(value=number):
            return number in (0, 1)
        case ast.BooleanLiteral() | ast.QuantifierExpression(kind="forall" | "exists"):
            return True
        case ast.NameExpression(name=name) | ast.MemberExpression(name=ast.Identifier(name=name)):
            return name in truths
        case ast.UnaryExpression(operator=operator, operand=operand):
            return operator is PrefixOperator.NOT or (
                operator is PrefixOperator.PLUS and _stops_or_runs(operand, truths)
            )
        case ast.BinaryExpression(operator=operator, left=left, right=right):
            both = operator in _TRUTHS_OF_TRUTHS and _stops_or_runs(left, truths) and _stops_or_runs(right, truths)
            return both or operator in _TRUTHS
        case ast.ConditionalExpression(then=then, otherwise=otherwise):
            return _stops_or_runs(then, truths) and _stops_or_runs(otherwise, truths)
        case ast.IndexExpression(base=place) | ast.CallExpression(function=place):
            return _stops_or_runs(place, truths)
        case _:
            return False


def _truths(tree: tuple[ast.Item, ...]) -> set[str]:
    """The names of variables, fields and functions whose values are 0 or 1 only."""
    kinds = (ast.VariableDeclaration, ast.Parameter, ast.QuantifierExpression, ast.FunctionDeclaration)
    named = {d.name.name: node.type for node in nodes_of_kind(tree, ast.TypedefDeclaration) for d in node.declarators}
    truths: set[str] = set()
    others: set[str] = set()
    for node in nodes_of_kind(tree, *kinds):
        type_ = node.result if isinstance(node, ast.FunctionDeclaration) else node.type
        match node:
            case ast.VariableDeclaration(declarators=declarators):
                names = [declarator.name.name for declarator in declarators]
            case ast.QuantifierExpression(variable=name):
                names = [name.name]
            case _:
                names = [node.name.name]
        (truths if _is_truth(type_, named) else others).update(names)
    return truths - others


def _is_truth(type_: ast.TypeExpression | None, named: dict[str, ast.TypeExpression]) -> bool:
    for _ in range(len(named) + 1):
        match type_:
            case ast.TypeExpression(base=ast.NamedType(name=name)):
                type_ = named.get(name)
            case _:
                break
    match type_:
        case ast.TypeExpression(base=ast.BuiltinType(name="bool")):
            return True
        case ast.TypeExpression(base=ast.RangeType(low=ast.IntegerLiteral(value=0), high=ast.IntegerLiteral(value=1))):
            return True
        case _:
            return False


def _names(node: ast.Node | None, among: AbstractSet[str]) -> Iterator[str]:
    """Names, also those of fields and those inside processes."""
    for inner in nodes_of_kind(node, ast.NameExpression, ast.MemberExpression):
        name = inner.name if isinstance(inner, ast.NameExpression) else inner.name.name
        if name in among:
            yield name
