"""Reading any kind of model file as a syntax tree, without asking what it means."""

from __future__ import annotations

from dataclasses import dataclass

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.span import Source
from tachk.syntax import ast
from tachk.syntax.parsing.parser import has_errors, parse_document
from tachk.syntax.picture_layout import Layout
from tachk.syntax.query_files import BrokenQuery
from tachk.syntax.source_files import is_tchecker, is_xml


@dataclass(frozen=True, slots=True)
class ReadModel:
    """Attributes:
    layout: the picture, where the file has one.
    broken: queries that cannot be read.
    warnings: what else is to be said.
    headings: entries of a list of queries without a formula, as comments in their places.
    """

    document: ast.Document
    layout: Layout | None = None
    broken: tuple[BrokenQuery, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    headings: tuple[ast.Comment, ...] = ()


def read_model(source: Source) -> ReadModel:
    """A model in tachk's language, UPPAAL's XML or TChecker's format; imports are not followed.

    Raises:
        InputError: with everything that is wrong.
    """
    if is_xml(source):
        from tachk.formats.uppaal.reader import parse_uppaal_xml

        read = parse_uppaal_xml(source)
        if has_errors(read.diagnostics):
            raise InputError(read.diagnostics)
        return ReadModel(read.document, read.layout, read.broken, read.diagnostics, read.headings)
    if is_tchecker(source):
        from tachk.formats.tchecker.reader import parse_tchecker

        document, diagnostics = parse_tchecker(source)
    else:
        document, diagnostics = parse_document(source)
    if document is None or has_errors(diagnostics):
        raise InputError(diagnostics)
    return ReadModel(document, None, (), diagnostics)
