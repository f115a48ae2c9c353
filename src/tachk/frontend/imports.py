"""A model of several files: each ``import`` is replaced by what the file declares, once."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from tachk.diagnostics.diagnostic import InputError, UsageError
from tachk.diagnostics.span import Source
from tachk.frontend.findings import Findings
from tachk.syntax import ast
from tachk.syntax.parser import parse_document
from tachk.syntax.source_files import read_source


@dataclass(slots=True)
class Importer:
    """Reads documents and what they import.

    Attributes:
        reading: the files whose imports are being followed, outermost first.
        done: the files that have been read.
    """

    findings: Findings
    strict_xta: bool = False
    reading: list[Path] = field(default_factory=list)
    done: set[Path] = field(default_factory=set)

    def read(self, source: Source) -> tuple[ast.Document | None, list[ast.Item]]:
        """The document, and its items with the imported ones in the places of their imports."""
        path = Path(source.name).absolute()
        self.reading.append(path.resolve())
        document, diagnostics = parse_document(source, self.strict_xta)
        self.findings.extend(diagnostics)
        items: list[ast.Item] = []
        for item in () if document is None else document.items:
            if isinstance(item, ast.ImportDeclaration):
                items.extend(self._import(item, path.parent))
            else:
                items.append(item)
        self.done.add(self.reading.pop())
        return document, items

    def _import(self, node: ast.ImportDeclaration, folder: Path) -> list[ast.Item]:
        path = folder / node.path
        resolved = path.resolve()
        if resolved in self.reading:
            names = " -> ".join(p.name for p in (*self.reading[self.reading.index(resolved) :], resolved))
            self.findings.add("E0416", node.span, f"files import each other: {names}", "move what both need to a third")
            return []
        if resolved in self.done:
            return []
        try:
            source = read_source(_shown(path))
        except UsageError as error:
            self.findings.add("E0415", node.span, f"cannot import: {error}", error.help)
            return []
        except InputError as error:
            self.findings.extend(error.diagnostics)
            return []
        _, items = self.read(source)
        kept: list[ast.Item] = []
        for item in items:
            if isinstance(item, ast.SystemLine):
                self.findings.add(
                    "E0411",
                    item.span,
                    "an imported file cannot have a system line",
                    "move the system line to the importing file",
                )
            elif not isinstance(item, ast.ProgressDeclaration | ast.GanttDeclaration):
                kept.append(item)
        return kept


def _shown(path: Path) -> str:
    """A path as messages print it: relative to the current folder where it lies inside."""
    try:
        return str(path.resolve().relative_to(Path.cwd()))
    except ValueError:
        return str(path)
