"""A model that notes the edges that no run takes, as text: its property says that none of them is ever taken.

So an ordinary certificate proves of each that it cannot be taken, and the independent checkers need not know of edges.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from tachk.base.records import replace
from tachk.base.span import Span
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.printing.printer import print_document
from tachk.syntax.rewrite import names_in, rewrite
from tachk.syntax.walk import edges_with_sources
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
    keys = [_key(edge.span) for _, edge in edges_with_sources(item)]
    own = [flags[key] for key in keys if key in flags]
    noting = rewrite(item, lambda node: _with_note(node, flags) if isinstance(node, ast.EdgeDeclaration) else node)
    return replace(noting, declarations=(*item.declarations, *_declared(item.name.span, own)))


def _declared(span: Span, names: Iterable[str]) -> Iterator[ast.VariableDeclaration]:
    type_ = ast.TypeExpression(span, (), ast.BuiltinType(span, "bool"))
    for name in names:
        initial = ast.BooleanLiteral(span, False)
        yield ast.VariableDeclaration(span, type_, (ast.Declarator(span, ast.Identifier(span, name), (), initial),))


def _with_note(edge: ast.EdgeDeclaration, flags: Mapping[tuple[str, int], str]) -> ast.EdgeDeclaration:
    flag = flags.get(_key(edge.span))
    if flag is None:
        return edge
    target = ast.NameExpression(edge.span, flag)
    note = ast.AssignmentExpression(edge.span, None, target, ast.BooleanLiteral(edge.span, True))
    return replace(edge, updates=(*edge.updates, note))
