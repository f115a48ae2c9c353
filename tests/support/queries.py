"""Queries about a model, each of them right."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.frontend.loaded import LoadedModel, elaborate_query_file
from tachk.frontend.queries.queries import UncheckedQuery
from tachk.model.query import Query


def elaborate_queries(loaded: LoadedModel, text: str | Source) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The queries of a text, named ``q1``, ``q2``, ... in order.

    Raises:
        InputError: with every diagnostic that was found.
    """
    source = text if isinstance(text, Source) else Source("<query>", text)
    queries, unchecked = elaborate_query_file(loaded, source)
    diagnostics = [diagnostic for query in unchecked if query.is_wrong for diagnostic in query.diagnostics]
    if diagnostics:
        raise InputError(diagnostics)
    return queries, unchecked
