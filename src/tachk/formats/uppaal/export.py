"""A model for UPPAAL, in each of its formats: what tachk adds to the language is written out first."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from tachk.base.records import replace
from tachk.formats.exported import Exported, Writing
from tachk.formats.layout_json import read_layout_beside
from tachk.formats.plain.expansion import expand
from tachk.formats.plain.observer_templates import with_observers
from tachk.formats.plain.plain_model import PlainModel, PlainQuery
from tachk.formats.uppaal.limits import rejects_deadlock
from tachk.formats.uppaal.query_file import print_queries
from tachk.formats.uppaal.writer import print_uppaal
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.edge_clauses import edge_clauses
from tachk.syntax.printing.comment_placement import place_comments
from tachk.syntax.printing.expression_printer import (
    print_clause,
    print_expression,
    print_parameters,
    print_rate,
)
from tachk.syntax.printing.printer import write_declaration, write_item, write_separated
from tachk.syntax.printing.writer import Writer

_Listed = TypeVar("_Listed", ast.LocationDeclaration, ast.EdgeDeclaration)


def print_xta(plain: PlainModel) -> str:
    """The model without its queries, which XTA has no place for: see `tachk.formats.uppaal.query_file`."""
    document = ast.Document(plain.span, plain.items(), plain.comments)
    writer = Writer(document, place_comments(document))
    if plain.time_unit:
        writer.raw(f"// one time unit is {plain.time_unit}")
        writer.raw("")
    write_separated(writer, document.items, _write_item)
    writer.finish(document)
    return writer.text()


def _write_item(writer: Writer, item: ast.Item) -> None:
    if isinstance(item, ast.Template):
        _write_template(writer, item)
    else:
        write_item(writer, item)


def _write_template(writer: Writer, template: ast.Template) -> None:
    writer.begin(template)
    _documentation(writer, template.doc)
    writer.open(f"process {template.name.name}({print_parameters(template.parameters)}) {{", template)
    write_separated(writer, template.declarations, write_declaration)
    if template.declarations:
        writer.raw("")
    if template.locations:
        writer.raw("state")
    _write_list(writer, template.locations, _state)
    if template.branchpoints:
        writer.raw(f"branchpoint {', '.join(point.name.name for point in template.branchpoints)};")
    for word, chosen in (
        ("commit", [node for node in template.locations if node.committed]),
        ("urgent", [node for node in template.locations if node.urgent and not node.committed]),
        ("init", [node for node in template.locations if node.initial]),
    ):
        if chosen:
            writer.raw(f"{word} {', '.join(node.name.name for node in chosen)};")
    if template.edges:
        writer.raw("trans")
        _write_list(writer, template.edges, _edge)
    writer.close("}", template)


def _write_list(writer: Writer, nodes: Sequence[_Listed], text: Callable[[_Listed], str]) -> None:
    """Locations or edges, one a line, with commas between them."""
    writer.deeper(1)
    for place, node in enumerate(nodes, 1):
        writer.begin(node)
        _inner_comments(writer, node)
        _documentation(writer, node.doc)
        writer.ending(text(node) + (";" if place == len(nodes) else ","), node)
    writer.deeper(-1)


def _documentation(writer: Writer, doc: str) -> None:
    for line in doc.split("\n") if doc else ():
        writer.raw(f"// {line}".rstrip())


def _inner_comments(writer: Writer, node: ast.LocationDeclaration | ast.EdgeDeclaration) -> None:
    """The comments inside a node that is written on one line, before it."""
    parts: list[Any] = [node]
    if isinstance(node, ast.LocationDeclaration):
        parts += [p for p in (node.invariant, node.exponential_rate, node.rate_divisor) if p is not None]
    else:
        parts += [*node.selects, *node.updates]
        parts += [part for part in (node.guard, node.synchronisation, node.probability) if part is not None]
    for part in parts:
        tables = [writer.comments.opening, writer.comments.closing]
        if part is not node:
            tables += [writer.comments.before, writer.comments.behind]
        for table in tables:
            for comment in table.get(id(part), []):
                writer.raw(comment.text)


def _state(location: ast.LocationDeclaration) -> str:
    invariant = "" if location.invariant is None else print_expression(location.invariant)
    rate = location.exponential_rate
    shown = "" if rate is None else f" ; {print_rate(rate, location.rate_divisor)}"
    inside = f"{invariant}{shown}".strip()
    return f"{location.name.name} {{ {inside} }}" if inside else location.name.name


def _edge(edge: ast.EdgeDeclaration) -> str:
    assert edge.source is not None, "an edge of the classic form has a source"
    clauses = [f"{clause.kind.value} {print_clause(clause)};" for clause in edge_clauses(edge)]
    arrow = "->" if edge.controllable else "-u->"
    inside = f" {' '.join(clauses)} " if clauses else " "
    return f"{edge.source.name} {arrow} {edge.target.name} {{{inside}}}"


def to_xta(model: LoadedModel, writing: Writing) -> Exported:
    """The text form, with the queries beside it."""
    _, plain = _expanded(model, writing)
    return Exported(print_xta(plain), _queries(plain), plain.steps)


def to_xml(model: LoadedModel, writing: Writing) -> Exported:
    """The XML form, which holds its queries."""
    watched, plain = _expanded(model, writing)
    layout = read_layout_beside(watched.document.span.source.name) if watched.layout is None else None
    return Exported(print_uppaal(watched, plain, layout), "", plain.steps)


def to_queries(model: LoadedModel, writing: Writing) -> Exported:
    """The queries alone."""
    _, plain = _expanded(model, writing)
    return Exported(_queries(plain), "", plain.steps)


def _expanded(model: LoadedModel, writing: Writing) -> tuple[LoadedModel, PlainModel]:
    """The model, with its observers if they are wanted, as it is and as UPPAAL understands it."""
    if not writing.observers:
        return model, expand(model, writing.definitions, writing.repair_names)
    watched, steps = with_observers(model)
    plain = expand(watched, writing.definitions, writing.repair_names)
    queries = tuple(_with_formula(query, watched) for query in plain.queries)
    return watched, replace(plain, queries=queries, steps=(*plain.steps, *steps), observed=watched is not model)


def _with_formula(query: PlainQuery, watched: LoadedModel) -> PlainQuery:
    """The query with its documentation below its title: that of an observer says which formula it is about."""
    item = next(i for i in watched.items if isinstance(i, ast.PropertyDeclaration) and i.name.name == query.name)
    return replace(query, comment="\n".join(part for part in (item.title, item.doc) if part))


def _queries(plain: PlainModel) -> str:
    return print_queries(plain.queries, rejects_deadlock(plain))
