"""Layouts as JSON: the side file ``model.layout.json`` beside ``model.ta``.

There is a line for each location and each edge, so that version control shows what moved. Sections of code are kept
line by line: the text of the model says the same, but not with the blanks of the file.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.span import Source, Span
from tachk.syntax.picture_layout import (
    EdgeKey,
    EdgeLayout,
    LabelLayout,
    Layout,
    NodeLayout,
    Point,
    QueryLayout,
    TemplateLayout,
)
from tachk.syntax.source_files import read_source

Json = Any
T = TypeVar("T")

_VERSION = 1


def layout_path(model: str | os.PathLike[str]) -> Path:
    """The side file of a model."""
    return Path(model).with_suffix(".layout.json")


def read_layout_beside(model: str | os.PathLike[str]) -> Layout | None:
    """The layout in the side file of a model, None if there is no such file.

    Raises:
        InputError: E0125, the file cannot be understood.
        UsageError: it cannot be read.
    """
    path = layout_path(model)
    return layout_from_json(read_source(path)) if path.is_file() else None


# ---- writing --------------------------------------------------------------------------------------------------------


def layout_to_json(layout: Layout) -> str:
    """The text of a side file."""
    lines = ["{", f'"layout": {_VERSION},', f'"dtd": {_line(layout.dtd)},']
    lines += _section("", "declaration", layout.declaration)
    lines.append('"templates": {')
    for number, (name, template) in enumerate(layout.templates.items(), 1):
        lines.append(f"  {_line(name)}: {{")
        lines.append(f'    "name": {_line(template.name)},')
        lines += _section("    ", "parameter", template.parameter)
        lines += _section("    ", "declaration", template.declaration)
        lines.append('    "nodes": {')
        lines += _listed(f"      {_line(key)}: {_line(_node(node))}" for key, node in template.nodes.items())
        lines.append("    },")
        lines.append('    "edges": [')
        lines += _listed(f"      {_line(_edge(key, edge))}" for key, edge in template.edges.items())
        lines.append("    ],")
        lines.append(f'    "extra": {_line(template.extra)}')
        lines.append("  }" + ("," if number < len(layout.templates) else ""))
    lines.append("},")
    lines += _section("", "system", layout.system)
    lines += [f'"options": {_line(layout.options)},', '"queries": [']
    lines += _listed(f"  {_line(_query(query))}" for query in layout.queries)
    lines += ["],", f'"extra": {_line(layout.extra)}', "}"]
    return "\n".join(lines) + "\n"


def _section(indent: str, name: str, text: str | None) -> list[str]:
    """A section of code as a list of its lines, each on a line of its own."""
    if text is None:
        return []
    lines = _listed(f"{indent}  {_line(line)}" for line in text.split("\n"))
    return [f'{indent}"{name}": [', *lines, f"{indent}],"]


def _listed(lines: Iterable[str]) -> list[str]:
    text = list(lines)
    return [line + ("," if place < len(text) else "") for place, line in enumerate(text, 1)]


def _line(value: Json) -> str:
    return json.dumps(value, ensure_ascii=False)


def _node(node: NodeLayout) -> dict[str, Json]:
    return _given(
        at=node.position,
        name=node.name,
        labels=_labels(node.labels),
        colour=node.colour,
        id=node.id,
        written_name=node.written_name,
    )


def _edge(key: EdgeKey, edge: EdgeLayout) -> dict[str, Json]:
    return _given(
        source=key.source,
        target=key.target,
        occurrence=key.occurrence,
        nails=edge.nails,
        labels=_labels(edge.labels),
        colour=edge.colour,
        attributes=dict(edge.attributes),
    )


def _labels(labels: Mapping[str, LabelLayout]) -> dict[str, Json]:
    return {
        kind: label.position if label.text is None else _given(at=label.position, text=label.text)
        for kind, label in labels.items()
    }


def _query(query: QueryLayout) -> dict[str, Json]:
    return _given(
        name=query.name,
        comment=query.comment,
        formula=query.formula,
        options=query.options,
        results=query.results,
    )


def _given(**values: Json) -> dict[str, Json]:
    """The values that say something."""
    return {key: value for key, value in values.items() if value or (value == "" and key == "written_name")}


# ---- reading --------------------------------------------------------------------------------------------------------


def layout_from_json(source: Source) -> Layout:
    """The layout in the text of a side file.

    Raises:
        InputError: E0125, the text is not JSON, or not that of a layout.
    """
    try:
        value = json.loads(source.text)
    except json.JSONDecodeError as error:
        raise _refuse(source, f"this is not JSON: {error.msg}", error.pos) from None
    except RecursionError:
        raise _refuse(source, "this is nested too deeply", 0) from None
    try:
        return _read_layout(value)
    except _UnexpectedError as error:
        raise _refuse(source, str(error), 0) from None


class _UnexpectedError(Exception):
    pass


def _refuse(source: Source, message: str, offset: int) -> InputError:
    span = Span(source, offset, min(offset + 1, len(source.text)))
    help_ = "write it again with tachk convert, or remove it: then tachk lays out a new picture"
    return InputError([Diagnostic("E0125", f"not a layout: {message}", span, help_)])


def _read_layout(value: Json) -> Layout:
    whole = _object(value, "the file")
    version = whole.get("layout")
    if version != _VERSION:
        raise _UnexpectedError(f"version {version!r} is unknown, this tachk reads version {_VERSION}")
    return Layout(
        {name: _read_template(part) for name, part in _object(whole.get("templates", {}), "`templates`").items()},
        _text(whole.get("dtd", ""), "`dtd`"),
        _pairs(whole.get("options", [])),
        tuple(_read_query(part) for part in _list(whole.get("queries", []), "`queries`")),
        _texts(whole.get("extra", []), "`extra`"),
        _read_section(whole.get("declaration"), "`declaration`"),
        _read_section(whole.get("system"), "`system`"),
    )


def _read_template(value: Json) -> TemplateLayout:
    part = _object(value, "a template")
    edges = [_read_edge(edge) for edge in _list(part.get("edges", []), "`edges`")]
    return TemplateLayout(
        _point(part.get("name")),
        {name: _read_node(node) for name, node in _object(part.get("nodes", {}), "`nodes`").items()},
        dict(edges),
        _texts(part.get("extra", []), "`extra`"),
        _read_section(part.get("parameter"), "`parameter`"),
        _read_section(part.get("declaration"), "`declaration`"),
    )


def _read_section(value: Json, what: str) -> str | None:
    return None if value is None else "\n".join(_texts(value, what))


def _read_node(value: Json) -> NodeLayout:
    part = _object(value, "a location")
    return NodeLayout(
        _point(part.get("at")),
        _point(part.get("name")),
        _read_labels(part.get("labels", {})),
        _text(part.get("colour", ""), "`colour`"),
        _text(part.get("id", ""), "`id`"),
        _maybe(part.get("written_name"), "`written_name`"),
    )


def _read_edge(value: Json) -> tuple[EdgeKey, EdgeLayout]:
    part = _object(value, "an edge")
    occurrence = part.get("occurrence", 0)
    if not isinstance(occurrence, int):
        raise _UnexpectedError("`occurrence` is not a number")
    key = EdgeKey(_text(part.get("source"), "`source`"), _text(part.get("target"), "`target`"), occurrence)
    nails = tuple(_required_point(nail) for nail in _list(part.get("nails", []), "`nails`"))
    attributes = {
        name: _text(text, "an attribute") for name, text in _object(part.get("attributes", {}), "`attributes`").items()
    }
    colour = _text(part.get("colour", ""), "`colour`")
    return key, EdgeLayout(nails, _read_labels(part.get("labels", {})), colour, attributes)


def _read_labels(value: Json) -> dict[str, LabelLayout]:
    return {kind: _read_label(label) for kind, label in _object(value, "`labels`").items()}


def _read_label(value: Json) -> LabelLayout:
    if isinstance(value, dict):
        return LabelLayout(_point(value.get("at")), _maybe(value.get("text"), "`text`"))
    return LabelLayout(_point(value))


def _read_query(value: Json) -> QueryLayout:
    part = _object(value, "a query")
    return QueryLayout(
        _text(part.get("name", ""), "`name`"),
        _maybe(part.get("comment"), "`comment`"),
        _maybe(part.get("formula"), "`formula`"),
        _pairs(part.get("options", [])),
        _texts(part.get("results", []), "`results`"),
    )


def _object(value: Json, what: str) -> dict[str, Json]:
    return _of(value, dict, what, "not an object")


def _list(value: Json, what: str) -> list[Json]:
    return _of(value, list, what, "not a list")


def _text(value: Json, what: str) -> str:
    return _of(value, str, what, "not a text")


def _of(value: Json, kind: type[T], what: str, problem: str) -> T:
    if not isinstance(value, kind):
        raise _UnexpectedError(f"{what} is {problem}")
    return value


def _maybe(value: Json, what: str) -> str | None:
    return None if value is None else _text(value, what)


def _texts(value: Json, what: str) -> tuple[str, ...]:
    return tuple(_text(item, what) for item in _list(value, what))


def _pairs(value: Json) -> tuple[tuple[str, str], ...]:
    pairs = [_texts(pair, "an option") for pair in _list(value, "`options`")]
    if any(len(pair) != 2 for pair in pairs):
        raise _UnexpectedError("an option is not a pair of texts")
    return tuple((pair[0], pair[1]) for pair in pairs)


def _point(value: Json) -> Point | None:
    return None if value is None else _required_point(value)


def _required_point(value: Json) -> Point:
    if not (isinstance(value, list) and len(value) == 2 and all(type(number) is int for number in value)):
        raise _UnexpectedError("a point is not a pair of integers")
    return Point(*value)
