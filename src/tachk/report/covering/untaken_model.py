"""A model that notes the edges that no run takes, as text: its property says that none of them is ever taken.

So an ordinary certificate proves of each that it cannot be taken, and the independent checkers need not know of edges.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from tachk.base.records import replace
from tachk.base.span import Span
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.printing.printer import print_document
from tachk.syntax.rewrite import names_in
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.suite import CoveringSuite

_FLAG, _PROPERTY = "taken", "never"


def untaken_model(loaded: LoadedModel, suite: CoveringSuite) -> str | None:
    """The text of the model with one property: nothing that a suite cannot cover is ever taken or visited.

    None if there is no such thing. Edges through branchpoints, and pairs of edges, are left out.
    """
    if suite.coverage is Coverage.PAIRS:
        return None
    taken = names_in(list(loaded.items))
    flag = _unused(_FLAG, taken)
    flags: dict[tuple[str, int], str] = {}
    conditions: list[str] = []
    for (number, each), _ in suite.impossible:
        process = loaded.network.processes[number]
        if suite.coverage is Coverage.LOCATIONS:
            condition = process.locations[each].name
        elif len(process.edges[each].spans) == 1:
            condition = flags.setdefault(_key(process.edges[each].spans[0]), f"{flag}_{len(flags) + 1}")
        else:
            continue
        conditions.append(f"{process.name}.{condition}")
    if not conditions:
        return None
    others = ast.PropertyDeclaration | ast.ExpectationDeclaration | ast.RecordingDeclaration
    items = tuple(_noting(item, flags) for item in loaded.items if not isinstance(item, others))
    text = print_document(ast.Document(loaded.document.span, items))
    stated = f"{_unused(_PROPERTY, taken)}_covered"
    return f"{text}\nproperty {stated} : A[] !({' || '.join(conditions)}) expect holds;\n"


def _unused(word: str, names: Mapping[str, Span]) -> str:
    """The word, or a longer one that begins no name."""
    while any(name.startswith(f"{word}_") for name in names):
        word += "_"
    return word


def _key(span: Span) -> tuple[str, int]:
    return span.source.name, span.start


def _noting(item: ast.Item, flags: Mapping[tuple[str, int], str]) -> ast.Item:
    """A template whose edges note that they are taken, in variables of its own."""
    if not isinstance(item, ast.Template):
        return item
    own = {
        _key(edge.span): flags[_key(edge.span)]
        for edges in (item.edges, *(place.edges for place in item.locations))
        for edge in edges
        if _key(edge.span) in flags
    }
    if not own:
        return item

    def changed(edges: Sequence[ast.EdgeDeclaration]) -> tuple[ast.EdgeDeclaration, ...]:
        return tuple(_with_note(edge, own.get(_key(edge.span))) for edge in edges)

    places = tuple(replace(place, edges=changed(place.edges)) for place in item.locations)
    declared = tuple(_declared(item.name.span, own.values()))
    return replace(item, declarations=(*item.declarations, *declared), locations=places, edges=changed(item.edges))


def _declared(span: Span, names: Iterable[str]) -> Iterator[ast.VariableDeclaration]:
    type_ = ast.TypeExpression(span, (), ast.BuiltinType(span, "bool"))
    for name in names:
        initial = ast.BooleanLiteral(span, False)
        yield ast.VariableDeclaration(span, type_, (ast.Declarator(span, ast.Identifier(span, name), (), initial),))


def _with_note(edge: ast.EdgeDeclaration, flag: str | None) -> ast.EdgeDeclaration:
    if flag is None:
        return edge
    target = ast.NameExpression(edge.span, flag)
    note = ast.AssignmentExpression(edge.span, None, target, ast.BooleanLiteral(edge.span, True))
    return replace(edge, updates=(*edge.updates, note))
