"""The text of a model on a page, with the lines of its properties marked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tachk.report.page.content import Section, SourceLine
from tachk.syntax import ast
from tachk.syntax.source_files import read_source


def source_lines(path: str, items: Iterable[ast.Item], sections: Iterable[Section]) -> Sequence[SourceLine]:
    """The lines of a file; those in which the properties begin that sections are about lead to these.

    Args:
        items: the declarations in the file, and those that it imports.

    Raises UsageError if the file cannot be read.
    """
    by_name = {section.result["name"]: section for section in sections}
    marked: dict[int, Section] = {}
    for item in items:
        if isinstance(item, ast.PropertyDeclaration) and item.name.name in by_name:
            place = item.name.span.in_file
            if place.source.name == path:
                line, _ = place.source.line_column(place.start)
                marked[line] = by_name[item.name.name]
    lines = read_source(path).text.splitlines()
    return [SourceLine(number, text, marked.get(number)) for number, text in enumerate(lines, 1)]
