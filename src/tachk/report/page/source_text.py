"""The text of a model on a page, with the lines of its properties marked."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence

from tachk.base.span import Source
from tachk.report.page.content import Section, SourceFile, SourceLine
from tachk.syntax import ast
from tachk.syntax.source_files import read_source


def source_files(path: str, items: Sequence[ast.Item], sections: Iterable[Section]) -> Iterator[SourceFile]:
    """A file and those that it imports; lines in which the properties begin that sections are about lead to these.

    Args:
        items: the declarations in all of them.

    Raises UsageError if the file cannot be read.
    """
    by_name = {section.result["name"]: section for section in sections}
    main = read_source(path)
    texts: dict[str, Source] = {main.name: main}
    marked: dict[tuple[str, int], Section] = {}
    for item in items:
        place = item.span.in_file
        texts.setdefault(place.source.name, place.source)
        if isinstance(item, ast.PropertyDeclaration) and item.name.name in by_name:
            start = item.name.span.in_file
            line, _ = start.source.line_column(start.start)
            marked[start.source.name, line] = by_name[item.name.name]
    for name, source in texts.items():
        lines = enumerate(source.text.splitlines(), 1)
        yield SourceFile(
            os.path.normpath(name), [SourceLine(number, text, marked.get((name, number))) for number, text in lines]
        )
