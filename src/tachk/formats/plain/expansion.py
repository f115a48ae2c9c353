"""From a model in tachk's language to the same model in UPPAAL's: every addition has one fixed expansion.

docs/uppaal.md lists them. The result has the same network: the same locations, edges and variables, in the same order.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError, UsageError
from tachk.base.records import replace
from tachk.base.span import NOWHERE
from tachk.formats.plain.clock_conditions import with_plain_conditions
from tachk.formats.plain.declaration_forms import with_plain_declarations
from tachk.formats.plain.free_names import declared_names, name_repairs
from tachk.formats.plain.plain_model import PlainModel, PlainQuery, PlainRewriting
from tachk.formats.plain.value_passing import ValuePassing
from tachk.frontend.expressions.builtin_names import BUILTIN_CONSTANTS, BUILTIN_TYPES
from tachk.frontend.loaded import LoadedModel
from tachk.model.query import Expectation
from tachk.model.types import IntType
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Change
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.rewrite import fresh_name, names_in, renamed, rewrite, substitute
from tachk.syntax.walk import nodes_of_kind


def without_builtins(items: tuple[ast.Item, ...], steps: list[PlainRewriting]) -> tuple[ast.Item, ...]:
    """The items with ranges and numbers for the built-in names that they do not declare themselves."""
    own = declared_names(items)

    def change(node: Any) -> Any:
        match node:
            case ast.NamedType(span, name) if name in BUILTIN_TYPES and name not in own:
                type_ = BUILTIN_TYPES[name]
                assert isinstance(type_, IntType)
                steps.append(PlainRewriting("built-in name", span, f"`{name}` is `int[{type_.low}, {type_.high}]`"))
                low, high = ast.IntegerLiteral(span, type_.low), ast.IntegerLiteral(span, type_.high)
                return ast.RangeType(span, low, high)
            case ast.NameExpression(span, name) if name in BUILTIN_CONSTANTS and name not in own:
                value = BUILTIN_CONSTANTS[name]
                steps.append(PlainRewriting("built-in name", span, f"`{name}` is {value}"))
                return ast.IntegerLiteral(span, value)
            case _:
                return node

    return rewrite(items, change)


_DECLARATIONS = (
    ast.VariableDeclaration
    | ast.TypedefDeclaration
    | ast.FunctionDeclaration
    | ast.ChannelPriorityDeclaration
    | ast.UpdateHook
    | ast.ForeignImport
    | ast.DynamicTemplate
)


def expand(model: LoadedModel, definitions: Iterable[str] = (), repair_names: bool = True) -> PlainModel:
    """The model without anything that UPPAAL does not know.

    Args:
        definitions: the names of the constants that were given another value when the model was loaded.
        repair_names: rename what a version of UPPAAL would not take as a name.

    Raises:
        UnsupportedError: something has no expansion (E0801).
    """
    _refuse_unknown_operators(model.items)
    steps = _imports(model)
    values = dict(model.heading.constants)
    outcomes = {query.name: query.expectation for query in model.queries}
    outcomes |= {query.name: query.expectation for query in model.unchecked}
    overridden = {name: values[name] for name in definitions if name in values}
    typed = tuple(_typed(_with_value(item, overridden, steps), steps) for item in model.items)
    items = _ordered_prefixes(without_builtins(typed, steps))
    declarations: tuple[ast.Declaration, ...] = tuple(item for item in items if isinstance(item, _DECLARATIONS))
    templates = tuple(_classic(item, steps) for item in items if isinstance(item, ast.Template))
    instantiations = tuple(item for item in items if isinstance(item, ast.Instantiation))
    passing = ValuePassing(model.variables, set(names_in(items)))
    declarations, templates, instantiations = passing.expand(declarations, templates, instantiations)
    steps += passing.steps
    plain = PlainModel(
        model.document.span,
        declarations,
        templates,
        instantiations,
        next(item for item in items if isinstance(item, ast.SystemLine)),
        tuple(item for item in items if isinstance(item, ast.ProgressDeclaration)),
        tuple(item for item in items if isinstance(item, ast.GanttDeclaration)),
        _queries(items, steps, outcomes),
        _time_unit(items, steps),
        model.document.comments,
        tuple(steps),
    )
    plain = with_plain_declarations(with_plain_conditions(plain))
    return with_repaired_names(plain) if repair_names else plain


def expand_document(document: ast.Document | None) -> PlainModel:
    """A document by itself, as far as that goes without elaboration: imports are not followed, and values on channels
    stay as they are. No document is an empty model."""
    items: tuple[ast.Item, ...] = () if document is None else _ordered_prefixes(document.items)
    span = NOWHERE if document is None else document.span
    steps: list[PlainRewriting] = []
    typed = tuple(_typed(item, steps) for item in items)
    systems = [item for item in typed if isinstance(item, ast.SystemLine)]
    return PlainModel(
        span,
        tuple(item for item in typed if isinstance(item, _DECLARATIONS)),
        tuple(_classic(item, steps) for item in typed if isinstance(item, ast.Template)),
        tuple(item for item in typed if isinstance(item, ast.Instantiation)),
        systems[0] if systems else ast.SystemLine(span, ()),
        queries=_queries(typed, steps),
        time_unit=_time_unit(typed, steps),
    )


def with_repaired_names(plain: PlainModel) -> PlainModel:
    """The model with every name that a version of UPPAAL refuses replaced, everywhere it is used."""
    repairs, steps = _repairs(plain.items(), [query.formula for query in plain.queries])
    if not repairs:
        return plain
    return replace(
        plain,
        declarations=renamed(plain.declarations, repairs),
        templates=renamed(plain.templates, repairs),
        instantiations=renamed(plain.instantiations, repairs),
        system=renamed(plain.system, repairs),
        progress=renamed(plain.progress, repairs),
        gantt=renamed(plain.gantt, repairs),
        queries=tuple(_renamed(query, repairs) for query in plain.queries),
        steps=(*plain.steps, *steps),
    )


def _renamed(query: PlainQuery, repairs: Mapping[str, str]) -> PlainQuery:
    conditional = None if query.conditional is None else renamed(query.conditional, repairs)
    return replace(query, formula=renamed(query.formula, repairs), conditional=conditional)


def document_repairs(document: ast.Document) -> tuple[ast.Document, list[PlainRewriting]]:
    """A document, imports not followed, with the same replacements.

    Raises:
        UsageError: a name that must change may be used in a file that the document imports.
    """
    properties = [item for item in document.items if isinstance(item, ast.PropertyDeclaration)]
    repairs, steps = _repairs(document.items, [item.formula for item in properties])
    imports = [item.path for item in document.items if isinstance(item, ast.ImportDeclaration)]
    if repairs and imports:
        raise UsageError(
            f"{', '.join(repairs)} must be renamed, but {', '.join(imports)} may use the name as well",
            "rename by hand, or write the whole model as .xta or .xml",
        )
    return replace(document, items=renamed(document.items, repairs)), steps


def _repairs(items: Sequence[ast.Item], formulas: Sequence[object]) -> tuple[dict[str, str], list[PlainRewriting]]:
    used = names_in((*items, *formulas))
    repairs: dict[str, str] = {}
    steps = []
    for name, reason in name_repairs(items, formulas).items():
        repairs[name] = fresh_name(name, {*used, *repairs.values()})
        steps.append(PlainRewriting("name", used[name], f"`{name}` is `{repairs[name]}`: {reason}"))
    return repairs, steps


def _imports(model: LoadedModel) -> list[PlainRewriting]:
    return [
        PlainRewriting("import", item.span, f"the declarations of `{item.path}` stand in its place")
        for item in model.document.items
        if isinstance(item, ast.ImportDeclaration)
    ]


def _with_value(item: ast.Item, values: Mapping[str, int], steps: list[PlainRewriting]) -> ast.Item:
    """A declaration of constants with the values that were given from outside."""
    if not isinstance(item, ast.VariableDeclaration) or not _constant(item):
        return item
    declarators = []
    for declarator in item.declarators:
        name = declarator.name.name
        if name in values:
            boolean = item.type is not None and _is_bool(item.type)
            span = declarator.span
            value = ast.BooleanLiteral(span, bool(values[name])) if boolean else ast.IntegerLiteral(span, values[name])
            steps.append(
                PlainRewriting("constant", declarator.name.span, f"`{name}` is {print_expression(value)}, as given")
            )
            declarators.append(replace(declarator, initialiser=value))
        else:
            declarators.append(declarator)
    if tuple(declarators) == item.declarators:
        return item
    return replace(item, declarators=tuple(declarators))


def _ordered_prefixes(items: tuple[ast.Item, ...]) -> tuple[ast.Item, ...]:
    """The items with ``urgent broadcast``, never the other way round, and ``const`` without ``meta``."""

    def change(node: Any) -> Any:
        if not isinstance(node, ast.TypeExpression) or len(node.prefixes) < 2:
            return node
        present = dict.fromkeys(p for p in ("const", "urgent", "broadcast", "meta", "hybrid") if p in node.prefixes)
        if "const" in present:
            present = {"const": None}
        return node if tuple(present) == node.prefixes else replace(node, prefixes=tuple(present))

    return rewrite(items, change)


def _constant(item: ast.VariableDeclaration) -> bool:
    return item.type is None or "const" in item.type.prefixes


def _is_bool(type_: ast.TypeExpression) -> bool:
    return isinstance(type_.base, ast.BuiltinType) and type_.base.name == "bool"


def _typed(item: ast.Item, steps: list[PlainRewriting]) -> ast.Item:
    """A declaration with the ``int`` that UPPAAL 3.x left out."""
    match item:
        case ast.VariableDeclaration(type=None, span=span):
            steps.append(PlainRewriting("UPPAAL 3.x", span, "a constant without a type is a `const int`"))
            return replace(item, type=ast.TypeExpression(span, ("const",), ast.BuiltinType(span, "int")))
        case ast.Template(declarations=declarations):
            typed = tuple(_typed(declaration, steps) for declaration in declarations)
            if all(new is old for new, old in zip(typed, declarations, strict=True)):
                return item
            return replace(item, declarations=typed)  # type: ignore[arg-type]
        case _:
            return item


def _classic(template: ast.Template, steps: list[PlainRewriting]) -> ast.Template:
    """A template whose edges stand together behind its locations."""
    if template.classic:
        return template
    owners: Sequence[ast.LocationDeclaration | ast.Branchpoint] = (*template.locations, *template.branchpoints)
    edges = tuple(replace(edge, source=owner.name) for owner in owners for edge in owner.edges)
    places = _count(len(template.locations), "location")
    text = f"`{template.name.name}` is written as `state ... trans ...`: {places}, {_count(len(edges), 'edge')}"
    steps.append(PlainRewriting("location blocks", template.name.span, text))
    return replace(
        template,
        locations=tuple(replace(location, edges=()) for location in template.locations),
        branchpoints=tuple(replace(point, edges=()) for point in template.branchpoints),
        edges=edges,
        classic=True,
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


# ---- signals and properties -----------------------------------------------------------------------------------------


def _queries(
    items: Sequence[ast.Item], steps: list[PlainRewriting], outcomes: Mapping[str, Expectation | None] | None = None
) -> tuple[PlainQuery, ...]:
    """The properties as queries.

    Args:
        outcomes: what is expected of properties with the values that the constants have, if these are known.
    """
    signals: dict[str, ast.Expression] = {}
    for item in items:
        if isinstance(item, ast.SignalDeclaration):
            signals[item.name.name] = substitute(item.expression, signals)
            steps.append(
                PlainRewriting(
                    "signal", item.name.span, f"`{item.name.name}` is written out wherever a property names it"
                )
            )
    queries = []
    for item in items:
        if isinstance(item, ast.PropertyDeclaration) and isinstance(item.formula, ast.ScenarioFormula):
            steps.append(PlainRewriting("scenario", item.name.span, f"`{item.name.name}` is left out: UPPAAL has none"))
        elif isinstance(item, ast.PropertyDeclaration):
            formula = _without_signals(item.formula, signals)
            comment = item.title or item.doc
            name = item.name.name
            steps.append(PlainRewriting("property", item.name.span, f"`{name}` is a query with a comment"))
            conditional = item.expectation if isinstance(item.expectation, ast.ConditionalExpectation) else None
            expectation = item.expectation
            if conditional is not None and outcomes is not None:
                outcome = outcomes.get(name)
                expectation = None if outcome is None else outcome.value
            queries.append(PlainQuery(name, formula, comment, expectation, conditional))
        if isinstance(item, ast.HideDeclaration):
            steps.append(
                PlainRewriting("hide", item.span, "UPPAAL shows every process, also those that the model hides")
            )
        if isinstance(item, ast.RecordingDeclaration):
            steps.append(PlainRewriting("recording", item.span, "UPPAAL holds no recordings against models"))
    return tuple(queries)


def _refuse_unknown_operators(items: Sequence[ast.Item]) -> None:
    """Refuses operators that no version of UPPAAL has."""
    for node in nodes_of_kind(items, ast.BinaryExpression):
        if node.operator.since is None:
            message = f"UPPAAL has no operator `{node.operator}`"
            raise UnsupportedError(Diagnostic("E0801", message, node.span, "write a function that computes it"))


def _without_signals(formula: ast.PropertyFormula, signals: Mapping[str, ast.Expression]) -> ast.PropertyFormula:
    """The formula of a property, signals written out. A sentence, a comment for UPPAAL in any case, stays as it is."""
    if isinstance(formula, ast.UncheckedFormula):
        used = next((name for name in names_in(formula) if name in signals), None)
        if used is not None:
            raise UnsupportedError(
                Diagnostic(
                    "E0801",
                    f"the signal `{used}` stands in a query that tachk does not read",
                    formula.span,
                    "write out what the signal stands for",
                )
            )
        return formula
    if isinstance(formula, ast.TemporalFormula | ast.ScenarioFormula):
        return rewrite(formula, partial(_atom_without_signals, signals=signals))
    predicate = None if formula.predicate is None else substitute(formula.predicate, signals)
    return replace(formula, predicate=predicate, operands=tuple(substitute(o, signals) for o in formula.operands))


def _atom_without_signals(node: Any, signals: Mapping[str, ast.Expression]) -> Any:
    if isinstance(node, Atom | Change):
        return replace(node, expression=substitute(node.expression, signals))
    return node


def _time_unit(items: Sequence[ast.Item], steps: list[PlainRewriting]) -> str:
    for item in items:
        if isinstance(item, ast.TimeUnitDeclaration):
            steps.append(PlainRewriting("time unit", item.span, "the time unit is a comment"))
            return f"{item.amount} {item.unit}"
    return ""
