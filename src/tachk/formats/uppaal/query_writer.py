"""The queries of a UPPAAL document: in the order of the file they came from, headings and saved results included."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tachk.base.span import Source
from tachk.formats.plain.plain_model import PlainModel, PlainQuery
from tachk.formats.uppaal.limits import is_rejected, rejects_deadlock
from tachk.formats.uppaal.query_asides import aside_in, set_aside
from tachk.formats.uppaal.query_reader import (
    MEASURES,
    comment_of,
    conditional_in,
    outcome,
    says,
)
from tachk.formats.uppaal.xml_tree import parse_xml
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_query
from tachk.syntax.picture_layout import QueryLayout
from tachk.syntax.printing.query_printer import print_expected, print_query
from tachk.syntax.query_files import expectation_in

_WORDS = {"holds": "EXPECT:T", "fails": "EXPECT:F"}


@dataclass(frozen=True, slots=True)
class QueryView:
    formula: str
    comment: str
    options: tuple[tuple[str, str], ...] = ()
    results: tuple[str, ...] = ()


def query_views(model: LoadedModel, plain: PlainModel, layouts: Sequence[QueryLayout]) -> tuple[QueryView, ...]:
    """All entries of the list of queries. What the layout does not know comes last, what UPPAAL would refuse to check
    is a comment."""
    rejects = rejects_deadlock(plain)
    properties = {item.name.name: item for item in model.items if isinstance(item, ast.PropertyDeclaration)}
    known = {query.name: query for query in plain.queries}
    views = []
    for layout in layouts:
        if not layout.name:
            views.append(QueryView(layout.formula or "", layout.comment or "", layout.options, layout.results))
        elif layout.name in known:
            views.append(_view(known.pop(layout.name), properties[layout.name], layout, rejects))
    rest = list(_asides(model, views))
    place = 0
    for query in known.values():
        node = properties[query.name]
        if node.span.source is model.document.span.source:
            place = node.span.start
        rest.append((place, _view(query, node, QueryLayout(query.name), rejects)))
    return (*views, *(view for _, view in sorted(rest, key=lambda entry: entry[0])))


def _asides(model: LoadedModel, listed: Sequence[QueryView]) -> Iterator[tuple[int, QueryView]]:
    """The entries in comments of the text, with their places; without those that are listed already."""
    formulas = {" ".join(view.formula.split()) for view in listed}
    headings = {" ".join(view.comment.split()) for view in listed if not view.formula.strip()}
    for comment in model.document.comments:
        entry = aside_in(comment.text)
        if entry is None:
            continue
        formula, said = entry.formula or "", entry.comment or ""
        known = formula in formulas if formula else " ".join(said.split()) in headings
        if not known:
            yield comment.span.start, QueryView(formula, said)


def _view(query: PlainQuery, node: ast.PropertyDeclaration, layout: QueryLayout, rejects: bool) -> QueryView:
    formula = print_query(query.formula)
    if is_rejected(query.formula, rejects):
        formula = set_aside(formula)
    results = layout.results
    if layout.formula is not None:
        entry, diagnostics = parse_query(Source("", layout.formula))
        if entry is not None and not diagnostics and entry.formula == query.formula:
            formula = layout.formula
        else:
            results = ()
    comment = comment_of(node)
    if layout.comment is not None and says(layout.comment, node):
        comment = layout.comment
    if query.conditional is not None:
        if conditional_in(comment) != query.conditional:
            line = f"expect {print_expected(query.conditional)}"
            comment = "\n".join(part for part in (comment_of(node), line) if part)
        return QueryView(formula, comment, layout.options)
    assert not isinstance(query.expectation, ast.ConditionalExpectation), "the values of constants are known"
    stated = expectation_in(formula) or expectation_in(comment) or _outcome(query, results)
    if query.expectation != stated:
        results = ()
        stated = expectation_in(formula) or expectation_in(comment)
        if query.expectation is not None and query.expectation != stated:
            comment = "\n".join(part for part in (comment, _WORDS[query.expectation]) if part)
    return QueryView(formula, comment, layout.options, results)


def _outcome(query: PlainQuery, results: Sequence[str]) -> str | None:
    """The expectation that will be read from saved results; a formula that measures has none."""
    if isinstance(query.formula, ast.QueryFormula) and query.formula.kind in MEASURES:
        return None
    return outcome([parse_xml(Source("", text)).root for text in results])
