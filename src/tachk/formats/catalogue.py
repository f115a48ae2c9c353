"""The formats a model can be written in, and which file name means which. One row each, listed here only.

The module of a format is imported when something is written in it: the command line names all of them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.plugins import load_object
from tachk.formats.exported import Exported, Writing

if TYPE_CHECKING:
    from tachk.frontend.loaded import LoadedModel


class ExportFormat(NamedTuple):
    """A format of files.

    Attributes:
        suffix: how its files end.
        writer: the function from a `LoadedModel` and `Writing` to `Exported`.
    """

    suffix: str
    writer: str


EXPORT_FORMATS = {
    "xta": ExportFormat(".xta", "tachk.formats.uppaal.export:to_xta"),
    "xml": ExportFormat(".xml", "tachk.formats.uppaal.export:to_xml"),
    "q": ExportFormat(".q", "tachk.formats.uppaal.export:to_queries"),
    "tchecker": ExportFormat(".tck", "tachk.formats.tchecker.writer:export_tchecker"),
    "dot": ExportFormat(".dot", "tachk.formats.dot:export_dot"),
    "json": ExportFormat(".json", "tachk.formats.network_json.network:export_json"),
    "munta": ExportFormat(".muntax", "tachk.formats.munta:export_munta"),
}

SUFFIXES = tuple(row.suffix for row in EXPORT_FORMATS.values())


def format_of(path: Path, also: tuple[str, ...] = ()) -> str:
    """The format a file name means. Raises UsageError if it means none.

    Args:
        also: other endings that the command takes, for the message.
    """
    for format_, row in EXPORT_FORMATS.items():
        if row.suffix == path.suffix.lower():
            return format_
    raise UsageError(
        f"{path}: the name does not say in which format to write", f"end it with {', '.join((*also, *SUFFIXES))}"
    )


def export_model(model: LoadedModel, format_: str, writing: Writing = Writing()) -> Exported:
    """A model in another format, one of `EXPORT_FORMATS`.

    Raises:
        UnsupportedError: something in the model cannot be said in the format (E0801, E0802).
    """
    exported: Exported = load_object(EXPORT_FORMATS[format_].writer)(model, writing)
    return exported
