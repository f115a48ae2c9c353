"""The formats a model can be written in, and which file name means which. One row each, and nobody else lists them.

A format is loaded when something is written in it: the command line names all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.plugins import separate_plugin
from tachk.formats.exported import Exported, Writing

if TYPE_CHECKING:
    from tachk.frontend.loaded import LoadedModel


class ExportFormat(StrEnum):
    XTA = "xta"
    XML = "xml"
    QUERIES = "q"
    TCHECKER = "tchecker"
    DOT = "dot"
    JSON = "json"
    MUNTA = "munta"


def _xta(model: LoadedModel, writing: Writing) -> Exported:
    from tachk.formats.uppaal.export import to_xta

    return to_xta(model, writing)


def _xml(model: LoadedModel, writing: Writing) -> Exported:
    from tachk.formats.uppaal.export import to_xml

    return to_xml(model, writing)


def _queries(model: LoadedModel, writing: Writing) -> Exported:
    from tachk.formats.uppaal.export import to_queries

    return to_queries(model, writing)


def _tchecker(model: LoadedModel, writing: Writing) -> Exported:
    from tachk.formats.tchecker.writer import to_tchecker

    return Exported(to_tchecker(model.network, model.queries, Path(model.document.span.source.name).stem).text)


def _dot(model: LoadedModel, writing: Writing) -> Exported:
    from tachk.formats.dot import to_dot

    return Exported(to_dot(model.network))


def _json(model: LoadedModel, writing: Writing) -> Exported:
    from tachk.formats.network_json.network import network_to_json_text

    return Exported(network_to_json_text(model.network))


def _munta(model: LoadedModel, writing: Writing) -> Exported:
    return Exported(separate_plugin("munta export")(model.network, model.queries))


class _FormatRow(NamedTuple):
    """The ending of the files of a format, and what writes one."""

    suffix: str
    write: Callable[[LoadedModel, Writing], Exported]


_FORMATS = {
    ExportFormat.XTA: _FormatRow(".xta", _xta),
    ExportFormat.XML: _FormatRow(".xml", _xml),
    ExportFormat.QUERIES: _FormatRow(".q", _queries),
    ExportFormat.TCHECKER: _FormatRow(".tck", _tchecker),
    ExportFormat.DOT: _FormatRow(".dot", _dot),
    ExportFormat.JSON: _FormatRow(".json", _json),
    ExportFormat.MUNTA: _FormatRow(".muntax", _munta),
}

SUFFIXES = tuple(row.suffix for row in _FORMATS.values())


def format_of(path: Path, also: tuple[str, ...] = ()) -> ExportFormat:
    """The format a file name means. Raises UsageError if it means none.

    Args:
        also: other endings that the command takes, for the message.
    """
    for format_, row in _FORMATS.items():
        if row.suffix == path.suffix.lower():
            return format_
    raise UsageError(
        f"{path}: the name does not say in which format to write", f"end it with {', '.join((*also, *SUFFIXES))}"
    )


def export_model(model: LoadedModel, format_: ExportFormat, writing: Writing = Writing()) -> Exported:
    """A model in another format.

    Raises:
        UnsupportedError: something in the model cannot be said in the format (E0801, E0802).
    """
    return _FORMATS[format_].write(model, writing)
