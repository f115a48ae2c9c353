"""The sections of code in a UPPAAL document: as they were written where they still say the same, else formatted, with
their comments."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Source, Span
from tachk.formats.plain.plain_model import PlainModel
from tachk.formats.uppaal.query_asides import aside_in
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.parsing.parser import (
    comments_within,
    parse_declarations,
    parse_document,
    parse_parameters,
    parse_system,
)
from tachk.syntax.picture_layout import Layout
from tachk.syntax.printing.comment_placement import Placement, line_nodes, place_comments
from tachk.syntax.printing.expression_printer import print_parameters
from tachk.syntax.printing.printer import write_item
from tachk.syntax.printing.writer import Writer

_BESIDE = (
    ast.PropertyDeclaration
    | ast.ExpectationDeclaration
    | ast.HideDeclaration
    | ast.RecordingDeclaration
    | ast.SignalDeclaration
    | ast.TimeUnitDeclaration
    | ast.ImportDeclaration
)
_DECLARED = (
    ast.VariableDeclaration
    | ast.TypedefDeclaration
    | ast.FunctionDeclaration
    | ast.ChannelPriorityDeclaration
    | ast.UpdateHook
    | ast.ForeignImport
)

Parse = Callable[[Source], tuple[Any, tuple[Diagnostic, ...]]]


@dataclass(frozen=True, slots=True)
class Sections:
    """Writes the sections of one model."""

    plain: PlainModel
    before: tuple[ast.Item, ...]
    after: tuple[ast.Item, ...]
    placement: Placement
    own: bool = True
    comments_before: tuple[str, ...] = ()
    comments_after: tuple[str, ...] = ()

    def declaration(self, written: str | None) -> str:
        """The global declarations, and the comments that stand before the first template."""
        unit = [f"// one time unit is {self.plain.time_unit}"] if self.plain.time_unit else []
        text = self._text(self.before, unit, self.comments_before)
        return (text if unit else self._as_written(written, parse_declarations, self.before, text)) or ""

    def system(self, written: str | None) -> str:
        """The instantiations and the system line with its comments, and the comments of the properties."""
        text = self._text(self.after, [], self.comments_after)
        return self._as_written(written, parse_system, self.after, text) or ""

    def parameter(self, template: ast.Template, written: str | None) -> str | None:
        """The parameters; None where there is no such section."""
        if same(written, parse_parameters, template.parameters):
            return written
        return print_parameters(template.parameters)

    def template_declaration(self, template: ast.Template, written: str | None) -> str | None:
        """The local declarations, after the documentation of the template; None where there is no such section. What
        stands between them and the first location belongs to them.
        """
        doc = [f"/// {line}".rstrip() for line in template.doc.split("\n")] if template.doc else []
        placed = self.placement
        first = bool(self.plain.templates) and template is self.plain.templates[0]
        tables = (placed.opening,) if first else (placed.before, placed.opening)
        head = [c.text for table in tables for c in table.get(id(template), [])]
        between = [c.text for node in template.locations[:1] for c in placed.before.get(id(node), [])]
        last = [c.text for table in (placed.closing, placed.behind) for c in table.get(id(template), [])]
        text = self._text(template.declarations, [*doc, *([""] if doc else []), *head], [*between, *last])
        if doc and "\n".join(doc) not in (written or ""):
            return text
        return self._as_written(written, parse_declarations, template.declarations, text) or None

    def _as_written(self, written: str | None, parse: Parse, meant: object, text: str) -> str | None:
        """A section as it was written where that says the same, comments included, else as it is formatted.

        The comments of a section of the file that the model was read from are those of the model; a side file may be
        older than the text beside it.
        """
        if same(written, parse, meant) and (self.own or _comment_lines(written or "") == _comment_lines(text)):
            return written
        return text

    def comments_beside(self, node: ast.LocationDeclaration | ast.Branchpoint | ast.EdgeDeclaration) -> list[str]:
        """The comments that stand before, in or behind a location or edge, with their delimiters. Those before the
        first location belong to the declarations.
        """
        first = any(node is template.locations[0] for template in self.plain.templates if template.locations)
        found: list[ast.Comment] = []
        for part in (node, *line_nodes(node)):
            if isinstance(part, ast.EdgeDeclaration) and part is not node:
                continue
            tables = [self.placement.opening, self.placement.behind, self.placement.closing]
            if part is not node or not first:
                tables.append(self.placement.before)
            found += [comment for table in tables for comment in table.get(id(part), [])]
        found.sort(key=lambda comment: comment.span.start)
        return [comment.text for comment in found]

    def _text(self, items: Sequence[Any], head: Sequence[str], tail: Sequence[str] = ()) -> str:
        writer = Writer(ast.Document(self.plain.span, tuple(items)), self.placement)
        for line in head:
            writer.raw(line)
        previous: Any = None
        for item in items:
            writer.separate(previous, item, isinstance(item, ast.FunctionDeclaration))
            write_item(writer, item)
            previous = item
        for line in tail:
            writer.raw(line)
        return writer.text()


def _comment_lines(text: str) -> list[str]:
    """The lines of all comments of a section, however they are indented and with however many slashes they begin."""
    found = comments_within(Span(Source("", text), 0, len(text)))
    return [line.strip().lstrip("/").strip() for comment in found for line in comment.text.split("\n")]


def sections(model: LoadedModel, plain: PlainModel, layout: Layout) -> Sections:
    """The sections of a model; what its text declares behind the last template goes to the system section, before the
    system line, and so do the comments of what has no section of its own."""
    declarations, instantiations = iter(plain.declarations), iter(plain.instantiations)
    last = max((at for at, item in enumerate(model.items) if isinstance(item, ast.Template)), default=-1)
    before: list[ast.Item] = []
    after: list[ast.Item] = []
    for at, item in enumerate(model.items):
        if isinstance(item, _DECLARED):
            (before if at < last else after).append(next(declarations))
        elif isinstance(item, ast.Instantiation):
            after.append(next(instantiations))
    after += (plain.system, *plain.progress, *plain.gantt)
    before += declarations  # what the expansion declares
    placement = _placement(model, plain)
    return Sections(
        plain,
        tuple(before),
        tuple(after),
        placement,
        model.layout is not None,
        tuple(_comments_beside(model, plain, placement, layout, before=True)),
        tuple(_comments_beside(model, plain, placement, layout, before=False)),
    )


def _comments_beside(
    model: LoadedModel, plain: PlainModel, placement: Placement, layout: Layout, before: bool
) -> Iterator[str]:
    """The comments of the items that are in no section, those before the last template or those behind it; without
    those that the layout has in a formula."""
    templates = [at for at, item in enumerate(model.items) if isinstance(item, ast.Template)]
    last = max(templates, default=-1)
    found: list[ast.Comment] = []
    for at, item in enumerate(model.items):
        if isinstance(item, _BESIDE) and (at < last) is before:
            tables = (placement.before, placement.opening, placement.behind, placement.closing)
            found += (comment for table in tables for comment in table.get(id(item), []))
    if before:
        found += placement.before.get(id(plain.templates[0]), []) if plain.templates else []
    else:
        found += placement.closing.get(id(model.document), [])
    formulas = [query.formula for query in layout.queries if query.formula is not None]
    for comment in sorted(found, key=lambda comment: comment.span.start):
        elsewhere = aside_in(comment.text) is not None or any(comment.text in formula for formula in formulas)
        if not elsewhere:
            yield comment.text


def same(written: str | None, parse: Parse, meant: object) -> bool:
    """True if a text says exactly what is meant, in today's syntax."""
    if written is None:
        return not meant
    value, diagnostics = parse(Source("", written))
    return not diagnostics and value == meant


def _placement(model: LoadedModel, plain: PlainModel) -> Placement:
    """The places of the comments of all files of a model."""
    placement = Placement()
    items = plain.items()
    roots = {id(item.span.source): item.span.source for item in (*items, model.document)}
    for source in roots.values():
        whole = Span(source, 0, len(source.text))
        beside = tuple(i for i in (*model.document.items, *model.items) if isinstance(i, _BESIDE))
        document = ast.Document(whole, (*items, *beside), tuple(_comments(source, model)))
        found = place_comments(document)
        if source is model.document.span.source and id(document) in found.closing:
            placement.closing[id(model.document)] = found.closing.pop(id(document))
        for name in ("before", "behind", "opening", "closing"):
            getattr(placement, name).update(getattr(found, name))
    return placement


def _comments(source: Source, model: LoadedModel) -> Iterable[ast.Comment]:
    if source is model.document.span.source:
        return model.document.comments
    document, _ = parse_document(source) if source.text else (None, ())
    return () if document is None else document.comments
