"""Reading a model: text to network, queries and warnings, or all that is wrong with it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from tachk.base.diagnostics.diagnostic import (
    Diagnostic,
    InputError,
    TachkError,
    by_place,
)
from tachk.base.records import replace
from tachk.base.span import Source
from tachk.formats.loading.imports import Importer
from tachk.frontend.context import Budget, Context
from tachk.frontend.elaborate import Elaborated, elaborate, elaborate_each_property
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.loaded import INSTANCES, LoadedModel, explained
from tachk.frontend.overrides import constant_overrides
from tachk.frontend.queries.expectations import with_expectations
from tachk.frontend.queries.queries import wrong_query
from tachk.syntax import ast
from tachk.syntax.source_files import is_xml, read_source

if TYPE_CHECKING:
    from tachk.formats.uppaal.reader import XmlModel
from bisect import bisect_right

from tachk.base.diagnostics.diagnostic import Severity
from tachk.base.span import Span

NO_SYSTEM_LINE = "E0410"


def beyond_damage(
    syntax: Sequence[Diagnostic], semantic: Iterable[Diagnostic], items: Sequence[ast.Item]
) -> tuple[Diagnostic, ...]:
    """The errors among ``semantic`` that the errors in ``syntax`` cannot have caused."""
    damaged = [_damaged_range(error.span, items) for error in syntax if error.severity is Severity.ERROR]
    mentioned = {word for span in damaged for word in re.findall(r"\w+", span.text)}
    return tuple(
        diagnostic
        for diagnostic in semantic
        if diagnostic.severity is Severity.ERROR
        and diagnostic.code != NO_SYSTEM_LINE
        and not any(_overlap(span, diagnostic.span) for span in damaged)
        and not mentioned & set(re.findall(r"`(\w+)", diagnostic.message))
    )


def _damaged_range(error: Span, items: Sequence[ast.Item]) -> Span:
    """The item around an error, or the text between its neighbours."""
    spans = sorted((i.span for i in items if i.span.source is error.source), key=lambda span: span.start)
    before = bisect_right(spans, error.start, key=lambda span: span.start)
    if before and error.start <= spans[before - 1].end:
        return spans[before - 1]
    start = spans[before - 1].end if before else 0
    end = spans[before].start if before < len(spans) else len(error.source.text)
    return Span(error.source, start, end)


def _overlap(one: Span, other: Span) -> bool:
    return one.source is other.source and one.start <= other.end and other.start <= one.end


def load_model(
    model: str | os.PathLike[str] | Source,
    constants: Mapping[str, int | bool | str] | None = None,
    strict_xta: bool = False,
    keeps_doubles: bool = False,
) -> LoadedModel:
    """Reads and elaborates a model.

    Args:
        model: the path of a file, or a text, in tachk's language or UPPAAL's XML. Imports are relative to its folder.
        constants: other values for global constants; a string is an expression of the language.
        strict_xta: refuse what tachk adds to XTA.
        keeps_doubles: take floating point variables into the network, as simulations want it.

    A model whose only errors are constructs that tachk does not check is loaded, see `LoadedModel.refusals`.

    Raises:
        InputError: with every diagnostic that was found, warnings included.
        UsageError: the file cannot be read, or there is no such constant.
    """
    source = model if isinstance(model, Source) else read_source(model)
    findings = DiagnosticCollector()
    if is_xml(source):
        from tachk.formats.uppaal.reader import parse_uppaal_xml

        return _load_xml(parse_uppaal_xml(source), constants or {}, strict_xta, keeps_doubles)
    document, merged = Importer(findings, strict_xta).read(source)
    if document is None:
        raise InputError(findings.sorted())
    unreadable = findings.sorted() if findings.has_errors else ()
    items = with_expectations(merged, findings)
    _refuse_dynamic_templates(items, findings)
    overrides = constant_overrides(constants or {}, items, findings)
    context = _context(items, findings, keeps_doubles)
    running = _without_charts(tuple(items), _charts_beside(source, items), findings)
    result: Elaborated = elaborate(running, document.span, overrides, context)
    if unreadable:
        further = [diagnostic for diagnostic in findings.sorted() if diagnostic not in unreadable]
        raise InputError(by_place((*unreadable, *beyond_damage(unreadable, further, items))))
    if findings.has_mistakes:
        raise InputError(findings.sorted())
    unsupported, warnings = _distinguished(findings)
    return LoadedModel(
        result.network,
        result.queries,
        explained(result.unchecked, unsupported),
        warnings,
        document,
        tuple(items),
        result.scope,
        context,
        refusals=unsupported,
        overrides=overrides,
        recording=result.recording,
    )


def _context(items: Sequence[ast.Item], findings: DiagnosticCollector, keeps_doubles: bool) -> Context:
    if not keeps_doubles:
        return Context(findings, budget=Budget(INSTANCES))
    from tachk.frontend.hybrid_clocks import hybrid_clocks, urgent_guards

    for guard in urgent_guards(items):
        findings.add(
            "W0403",
            guard.span,
            "a clock guard on an urgent channel",
            "UPPAAL warns of it, too; a simulation takes the edge as soon as the guard holds, a search refuses it",
        )
    return Context(findings, budget=Budget(INSTANCES), keeps_doubles=True, hybrid_clocks=hybrid_clocks(items))


def _charts_beside(source: Source, items: Sequence[ast.Item]) -> frozenset[str]:
    """The names of message sequence charts, which a model that came from XML has in its side file.

    Looked for only where the model runs something that it does not describe.
    """
    described = {item.name.name for item in items if isinstance(item, ast.Template | ast.Instantiation)}
    lines = (item for item in items if isinstance(item, ast.SystemLine))
    run = {name.name for line in lines for group in line.groups for name in group}
    run |= {item.template.name for item in items if isinstance(item, ast.Instantiation)}
    if run <= described:
        return frozenset()
    from tachk.formats.layout_json import read_layout_beside

    layout = None
    with suppress(TachkError):  # then the unknown name is what has to be mended first
        layout = read_layout_beside(source.name)
    charts = [] if layout is None else [text for text in layout.extra if text.startswith("<lsc")]
    names = (re.search(r"<name[^>]*>\s*(\w+)", chart) for chart in charts)
    return frozenset(name[1] for name in names if name is not None)


def _without_charts(
    items: tuple[ast.Item, ...], charts: frozenset[str], findings: DiagnosticCollector
) -> tuple[ast.Item, ...]:
    """The items without the instances of message sequence charts, which are refused."""
    names = set(charts)
    supported: list[ast.Item] = []
    for item in items:
        match item:
            case ast.Instantiation(name=name, template=template) if template.name in names:
                names.add(name.name)
                _refuse_chart(template, findings)
            case ast.SystemLine(groups=groups):
                for identifier in (i for group in groups for i in group if i.name in names):
                    _refuse_chart(identifier, findings)
                running = (tuple(i for i in group if i.name not in names) for group in groups)
                supported.append(replace(item, groups=tuple(group for group in running if group)))
            case _:
                supported.append(item)
    return tuple(supported) if names else items


def _refuse_chart(name: ast.Identifier, findings: DiagnosticCollector) -> None:
    findings.add(
        "E0750", name.span, f"`{name.name}` is a message sequence chart, which is not supported", "leave it out here"
    )


def _distinguished(findings: DiagnosticCollector) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """The refusals and the warnings among findings that have no other errors."""
    found = findings.sorted()
    return tuple(d for d in found if d.is_unsupported), tuple(d for d in found if not d.is_unsupported)


def _load_xml(
    read: XmlModel, constants: Mapping[str, int | bool | str], strict_xta: bool, keeps_doubles: bool
) -> LoadedModel:
    """As `load_model`; a wrong query is an unchecked one, for the file is another program's."""
    findings = DiagnosticCollector()
    findings.extend(read.diagnostics)
    if strict_xta:
        from tachk.syntax.parsing.strict import additions

        # Properties are how a query of UPPAAL's file is held.
        plain = tuple(item for item in read.document.items if not isinstance(item, ast.PropertyDeclaration))
        findings.extend(additions(replace(read.document, items=plain)))
    if findings.has_errors:
        raise InputError(findings.sorted())
    stated = read.document.items
    items = _without_charts(stated, read.charts, findings)
    _refuse_dynamic_templates(items, findings)
    overrides = constant_overrides(constants, items, findings)
    context = _context(items, findings, keeps_doubles)
    result = elaborate_each_property(items, read.document.span, overrides, context)
    if findings.has_mistakes:
        raise InputError(findings.sorted())
    unsupported, warnings = _distinguished(findings)
    broken = []
    for query in read.broken:
        own = DiagnosticCollector()
        own.extend(query.diagnostics)
        broken.append(wrong_query(query.name, query.text, query.comment, query.span, own))
    return LoadedModel(
        result.network,
        result.queries,
        tuple(sorted((*explained(result.unchecked, unsupported), *broken), key=lambda query: query.span.start)),
        warnings,
        read.document,
        stated,
        result.scope,
        context,
        read.layout,
        unsupported,
        overrides,
    )


def _refuse_dynamic_templates(items: Iterable[ast.Item], findings: DiagnosticCollector) -> None:
    for item in items:
        if isinstance(item, ast.DynamicTemplate):
            findings.add(
                "E0750",
                item.span,
                f"the dynamic template `{item.name.name}` is not supported",
                "name a fixed number of processes in the system line",
            )
