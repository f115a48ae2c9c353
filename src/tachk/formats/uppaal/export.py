"""A model for UPPAAL, in each of its formats: what tachk adds to the language is written out first."""

from __future__ import annotations

from dataclasses import replace

from tachk.formats.exported import Exported, Writing
from tachk.formats.layout_json import read_layout_beside
from tachk.formats.plain.expansion import expand
from tachk.formats.plain.observer_templates import with_observers
from tachk.formats.plain.plain_model import PlainModel, PlainQuery
from tachk.formats.uppaal.limits import refuses_deadlock
from tachk.formats.uppaal.query_file import print_queries
from tachk.formats.uppaal.writer import print_uppaal
from tachk.formats.uppaal.xta import print_xta
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast


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
    return print_queries(plain.queries, refuses_deadlock(plain))
