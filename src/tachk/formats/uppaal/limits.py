"""Queries that tachk checks and UPPAAL refuses: some that ask for deadlocks, and all temporal formulas."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from tachk.base.words import Direction, QueryKind
from tachk.formats.plain.plain_model import PlainModel
from tachk.syntax import ast
from tachk.syntax.rewrite import names_in
from tachk.syntax.walk import nodes_of_kind


def rejects_deadlock(plain: PlainModel) -> bool:
    """True if UPPAAL refuses every query about deadlocks of a model: it has priorities, or a template, used or not,
    receives broadcasts under clock guards. With observers in it, the answer would not be about the model."""
    if plain.observed:
        return True
    if len(plain.system.groups) > 1:
        return True
    if any(isinstance(item, ast.ChannelPriorityDeclaration) for item in plain.declarations):
        return True
    return any(_receives_with_clock(template, plain.declarations) for template in plain.templates)


def is_rejected(formula: ast.PropertyFormula, always: bool) -> bool:
    """True if UPPAAL refuses a query because of the word ``deadlock``, or because it is a temporal formula.

    Args:
        always: whether it refuses that word everywhere in the model.
    """
    if not isinstance(formula, ast.QueryFormula):
        return isinstance(formula, ast.TemporalFormula)
    if formula.deadline is not None:
        return True
    if not any(nodes_of_kind(formula, ast.DeadlockExpression)):
        return False
    return always or formula.kind not in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY)


def _receives_with_clock(template: ast.Template, declarations: Iterable[ast.Declaration]) -> bool:
    declared = [*declarations, *template.declarations]
    clocks = set(_declared(declared, template.parameters, _is_clock))
    broadcasts = set(_declared(declared, template.parameters, lambda type_: "broadcast" in type_.prefixes))
    return any(
        edge.guard is not None
        and edge.synchronisation is not None
        and edge.synchronisation.direction is Direction.RECEIVE
        and not broadcasts.isdisjoint(names_in(edge.synchronisation.channel))
        and not clocks.isdisjoint(names_in(edge.guard))
        for edge in template.edges
    )


def _declared(
    declarations: Iterable[ast.Declaration],
    parameters: Iterable[ast.Parameter],
    wanted: Callable[[ast.TypeExpression], bool],
) -> Iterator[str]:
    """The variables and parameters of wanted types, also where a type definition stands between."""
    types: set[str] = set()

    def fits(type_: ast.TypeExpression) -> bool:
        return wanted(type_) or not types.isdisjoint(names_in(type_))

    for item in declarations:
        if isinstance(item, ast.TypedefDeclaration) and fits(item.type):
            types.update(declarator.name.name for declarator in item.declarators)
        elif isinstance(item, ast.VariableDeclaration) and item.type is not None and fits(item.type):
            yield from (declarator.name.name for declarator in item.declarators)
    yield from (parameter.name.name for parameter in parameters if fits(parameter.type))


def _is_clock(type_: ast.TypeExpression) -> bool:
    return any(node.name == "clock" for node in nodes_of_kind(type_, ast.BuiltinType))
