"""The formats a model can be written in, and which file name means which."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from tachk.diagnostics.diagnostic import UsageError
from tachk.formats.dot import to_dot
from tachk.formats.layout_json import read_layout_beside
from tachk.formats.network_json.network import network_to_json
from tachk.formats.plain.expansion import expand
from tachk.formats.plain.model import PlainModel, PlainQuery, Step
from tachk.formats.plain.observer_templates import with_observers
from tachk.formats.tchecker.writer import to_tchecker
from tachk.formats.uppaal.limits import refuses_deadlock
from tachk.formats.uppaal.query_file import print_queries
from tachk.formats.uppaal.writer import print_uppaal
from tachk.formats.uppaal.xta import print_xta
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.picture_layout import Layout


class ExportFormat(StrEnum):
    XTA = "xta"
    XML = "xml"
    QUERIES = "q"
    TCHECKER = "tchecker"
    DOT = "dot"
    JSON = "json"


_SUFFIXES = {
    ".xta": ExportFormat.XTA,
    ".xml": ExportFormat.XML,
    ".q": ExportFormat.QUERIES,
    ".tck": ExportFormat.TCHECKER,
    ".dot": ExportFormat.DOT,
    ".json": ExportFormat.JSON,
}


@dataclass(frozen=True, slots=True)
class Exported:
    """Attributes:
    text: the content of the file.
    queries: the content of a .q file beside it; empty if there is none.
    steps: what was written differently than in the model.
    """

    text: str
    queries: str = ""
    steps: tuple[Step, ...] = ()


def format_of(path: Path, also: tuple[str, ...] = ()) -> ExportFormat:
    """The format a file name means. Raises UsageError if it means none.

    Args:
        also: other endings that the command takes, for the message.
    """
    found = _SUFFIXES.get(path.suffix.lower())
    if found is None:
        raise UsageError(
            f"{path}: the name does not say in which format to write", f"end it with {', '.join((*also, *_SUFFIXES))}"
        )
    return found


def export_model(
    model: LoadedModel,
    format_: ExportFormat,
    definitions: Iterable[str] = (),
    repair_names: bool = True,
    layout: Layout | None = None,
    observers: bool = False,
) -> Exported:
    """A model in another format.

    Args:
        definitions: the names of the constants that were given another value when the model was loaded.
        repair_names: rename what a version of UPPAAL would not take as a name.
        layout: the picture for XML, where the model has none of its own and no side file.
        observers: give temporal properties observers; otherwise they are comments for UPPAAL.

    Raises:
        UnsupportedError: something in the model cannot be said in the format (E0801, E0802).
    """
    match format_:
        case ExportFormat.DOT:
            return Exported(to_dot(model.network))
        case ExportFormat.JSON:
            return Exported(json.dumps(network_to_json(model.network), indent=1) + "\n")
        case ExportFormat.TCHECKER:
            name = Path(model.document.span.source.name).stem
            return Exported(to_tchecker(model.network, model.queries, name).text)
        case ExportFormat.XTA | ExportFormat.QUERIES | ExportFormat.XML:
            if not observers:
                return _plain(model, format_, expand(model, definitions, repair_names), layout)
            watched, steps = with_observers(model)
            plain = expand(watched, definitions, repair_names)
            queries = tuple(_with_formula(query, watched) for query in plain.queries)
            plain = replace(plain, queries=queries, steps=(*plain.steps, *steps), observed=watched is not model)
            return _plain(watched, format_, plain, layout)


def _with_formula(query: PlainQuery, watched: LoadedModel) -> PlainQuery:
    """The query with its documentation below its title: that of an observer says which formula it is about."""
    item = next(i for i in watched.items if isinstance(i, ast.PropertyDeclaration) and i.name.name == query.name)
    return replace(query, comment="\n".join(part for part in (item.title, item.doc) if part))


def _plain(model: LoadedModel, format_: ExportFormat, plain: PlainModel, layout: Layout | None) -> Exported:
    queries = print_queries(plain.queries, refuses_deadlock(plain))
    if format_ is ExportFormat.QUERIES:
        return Exported(queries, "", plain.steps)
    if format_ is ExportFormat.XTA:
        return Exported(print_xta(plain), queries, plain.steps)
    if model.layout is None:
        layout = layout or read_layout_beside(model.document.span.source.name)
    return Exported(print_uppaal(model, plain, layout), "", plain.steps)  # it holds its queries
