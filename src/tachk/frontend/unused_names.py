"""Names that a model declares and never uses, and variables that it writes and never reads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.records import dataclass
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind

_WORD = re.compile(r"[A-Za-z_]\w*")


@dataclass(frozen=True, slots=True)
class _Uses:
    """``read``: names that are used in any way but being written; ``written``: those that get a value."""

    read: frozenset[str]
    written: frozenset[str]


def unused_names(items: Sequence[ast.Item], own: Sequence[ast.Item]) -> tuple[Diagnostic, ...]:
    """Declarations, global or in a template of the file itself, that are used nowhere.

    Names are compared, not what they mean: of two things with one name both count as used where one is.

    Args:
        items: of the model, imports replaced by what they declare.
        own: those of the file itself; what an imported file declares may be meant for others.
    """
    everywhere = _uses(items)
    from_outside = _members_and_properties(items)
    found = [*_of_declarations(own, everywhere)]
    for template in own:
        if isinstance(template, ast.Template):
            inside = _uses([template])
            uses = _Uses(inside.read | from_outside, inside.written)
            found += _of_declarations(template.declarations, uses)
    return tuple(found)


def _of_declarations(declarations: Iterable[object], uses: _Uses) -> Iterator[Diagnostic]:
    for name, kind in _declared(declarations):
        if name.name in uses.read:
            continue
        if name.name not in uses.written:
            yield Diagnostic("W0608", f"the {kind} `{name.name}` is never used", name.span, "remove it")
        else:
            what = "set, but never compared" if kind == "clock" else "written, but never read"
            message = f"the {kind} `{name.name}` is {what}"
            yield Diagnostic("W0609", message, name.span, "remove it, or ask for its value")


def _declared(declarations: Iterable[object]) -> Iterator[tuple[ast.Identifier, str]]:
    """Each name with the thing that it names."""
    for declaration in declarations:
        if isinstance(declaration, ast.VariableDeclaration):
            kind = _kind(declaration.type)
            yield from ((declarator.name, kind) for declarator in declaration.declarators)
        elif isinstance(declaration, ast.TypedefDeclaration):
            yield from ((declarator.name, "type") for declarator in declaration.declarators)
        elif isinstance(declaration, ast.FunctionDeclaration):
            yield declaration.name, "function"


def _kind(type_: ast.TypeExpression | None) -> str:
    if type_ is None or "const" in type_.prefixes:
        return "constant"
    if isinstance(type_.base, ast.BuiltinType):
        return {"chan": "channel", "clock": "clock"}.get(type_.base.name, "variable")
    return "variable"


def _uses(tree: Sequence[object]) -> _Uses:
    statements = [
        *(update for edge in nodes_of_kind(tree, ast.EdgeDeclaration) for update in edge.updates),
        *(statement.expression for statement in nodes_of_kind(tree, ast.ExpressionStatement)),
        *(e for loop in nodes_of_kind(tree, ast.ForStatement) for e in (*loop.initial, *loop.step)),
    ]
    targets = {id(root): root.name for root in map(_written_name, statements) if root is not None}
    names = nodes_of_kind(tree, ast.NameExpression, ast.NamedType)
    read = {node.name for node in names if id(node) not in targets}
    return _Uses(frozenset(read | _members_and_properties(tree)), frozenset(targets.values()))


def _written_name(statement: object) -> ast.NameExpression | None:
    """The name whose value a statement changes and does nothing else with."""
    if not isinstance(statement, ast.AssignmentExpression | ast.IncrementExpression):
        return None
    target = statement.target
    while isinstance(target, ast.IndexExpression | ast.MemberExpression):
        target = target.base
    return target if isinstance(target, ast.NameExpression) else None


def _members_and_properties(tree: Sequence[object]) -> frozenset[str]:
    """Names behind a dot, and every word of what is kept as text."""
    members = {node.name.name for node in nodes_of_kind(tree, ast.MemberExpression)}
    texts = [
        node.span.text
        for node in nodes_of_kind(tree, ast.PropertyDeclaration, ast.GanttDeclaration, ast.SignalDeclaration)
    ]
    return frozenset(members | {word for text in texts for word in _WORD.findall(text)})
