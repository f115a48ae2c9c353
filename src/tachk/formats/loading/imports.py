"""A model of several files: each ``import`` is replaced by what the file declares, once."""

from __future__ import annotations

import os
from collections.abc import Iterable

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.records import dataclass, field
from tachk.base.span import Source
from tachk.frontend.findings import DiagnosticCollector
from tachk.syntax import ast
from tachk.syntax.parsing.contextual import CONTEXTUAL_KEYWORDS
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.source_files import is_tchecker, read_source


@dataclass(slots=True)
class Importer:
    """Reads documents and what they import.

    Attributes:
        unfinished: the files whose imports are being followed, outermost first.
        done: the files that have been read.
    """

    findings: DiagnosticCollector
    strict_xta: bool = False
    unfinished: list[str] = field(default_factory=list)
    done: set[str] = field(default_factory=set)

    def read(self, source: Source) -> tuple[ast.Document | None, list[ast.Item]]:
        """The document, and its items with the imported ones in the places of their imports."""
        self.unfinished.append(os.path.realpath(source.name))
        if is_tchecker(source):
            from tachk.formats.tchecker.reader import parse_tchecker

            document, diagnostics = parse_tchecker(source)
        else:
            document, diagnostics = parse_document(source, self.strict_xta)
        imported: dict[str, list[ast.Item]] = {}
        for node in _imports(document):
            imported.setdefault(node.path, []).extend(self._import(node, os.path.dirname(source.name)))
        words = _keywords_as_types(item for items in imported.values() for item in items)
        if words:
            # The meaning of the text depends on these words not being keywords, so it is read again.
            document, diagnostics = parse_document(source, self.strict_xta, words)
        self.findings.extend(diagnostics)
        items: list[ast.Item] = []
        for item in () if document is None else document.items:
            if isinstance(item, ast.ImportDeclaration):
                items.extend(imported.pop(item.path, ()))
            else:
                items.append(item)
        self.done.add(self.unfinished.pop())
        return document, items

    def _import(self, node: ast.ImportDeclaration, folder: str) -> list[ast.Item]:
        path = os.path.join(os.getcwd(), folder, node.path)
        resolved = os.path.realpath(path)
        if resolved in self.unfinished:
            circle = (*self.unfinished[self.unfinished.index(resolved) :], resolved)
            names = " -> ".join(map(os.path.basename, circle))
            self.findings.add("E0416", node.span, f"files import each other: {names}", "move what both need to a third")
            return []
        if resolved in self.done:
            return []
        try:
            source = read_source(_shown(path))
        except UsageError as error:
            self.findings.add("E0415", node.span, f"cannot import: {error.message}", error.help)
            return []
        except InputError as error:
            self.findings.extend(error.diagnostics)
            return []
        _, items = self.read(source)
        resolved_items: list[ast.Item] = []
        for item in items:
            if isinstance(item, ast.SystemLine):
                self.findings.add(
                    "E0411",
                    item.span,
                    "an imported file cannot have a system line",
                    "move the system line to the importing file",
                )
            elif not isinstance(item, ast.ProgressDeclaration | ast.GanttDeclaration):
                resolved_items.append(item)
        return resolved_items


def _imports(document: ast.Document | None) -> list[ast.ImportDeclaration]:
    return [item for item in document.items if isinstance(item, ast.ImportDeclaration)] if document else []


def _keywords_as_types(items: Iterable[ast.Item]) -> frozenset[str]:
    """Contextual keywords that are names of types."""
    return frozenset(
        declarator.name.name
        for item in items
        if isinstance(item, ast.TypedefDeclaration)
        for declarator in item.declarators
        if declarator.name.name in CONTEXTUAL_KEYWORDS
    )


def _shown(path: str) -> str:
    """A path as messages print it: relative to the current folder where it lies inside."""
    from pathlib import Path  # of no use to most models

    try:
        return str(Path(path).resolve().relative_to(Path.cwd()))
    except ValueError:
        return str(Path(path))
