"""Reading a model: text to network, queries and warnings, or all that is wrong with it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from tachk.diagnostics.diagnostic import (
    Diagnostic,
    InputError,
    Severity,
    TachkError,
    UnsupportedError,
    UsageError,
    by_place,
)
from tachk.diagnostics.span import Source
from tachk.diagnostics.suggestion import did_you_mean
from tachk.frontend.context import Budget, Context
from tachk.frontend.elaborate import Elaborated, elaborate
from tachk.frontend.findings import Findings
from tachk.frontend.priority_readings import other_readings
from tachk.frontend.queries.expectations import with_expectations
from tachk.frontend.queries.queries import UncheckedQuery, elaborate_each, elaborate_entries, wrong_query
from tachk.frontend.scope import Scope
from tachk.loading.damage import beyond_damage
from tachk.loading.imports import Importer
from tachk.model.expressions import Variable
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_expression
from tachk.syntax.parsing.strict import additions
from tachk.syntax.picture_layout import Layout
from tachk.syntax.query_files import parse_each_query
from tachk.syntax.source_files import is_xml, read_source

if TYPE_CHECKING:
    from tachk.formats.uppaal.reader import XmlModel
    from tachk.syntax.formula import Formula

__all__ = [
    "LoadedModel",
    "UncheckedQuery",
    "elaborate_queries",
    "elaborate_query_file",
    "load_model",
    "other_readings_of",
    "temporal_formula_of",
]

INSTANCES = 2**16
"""Quantifiers are written out at most that many times in one model."""


@dataclass(frozen=True, slots=True)
class LoadedModel:
    """Attributes:
    queries: the properties the model states, in order.
    unchecked: properties that belong to another kind of analysis; of UPPAAL's XML also queries that are wrong.
    document: the syntax tree of the file itself, imports not followed.
    items: of the document, each import replaced by what the file declares.
    layout: the picture, if the file has one (UPPAAL's XML).
    refusals: the constructs of the model that tachk does not check. Where there are any, what was elaborated is
        incomplete: no analysis may see it, so there is no `network`, while everything that concerns the text is there.
    """

    _elaborated: Network = field(repr=False)
    queries: tuple[Query, ...]
    unchecked: tuple[UncheckedQuery, ...]
    warnings: tuple[Diagnostic, ...]
    document: ast.Document = field(repr=False)
    items: tuple[ast.Item, ...] = field(repr=False)
    _scope: Scope = field(repr=False)
    _constants: Context = field(repr=False)
    layout: Layout | None = field(default=None, repr=False)
    refusals: tuple[Diagnostic, ...] = ()
    _overrides: Mapping[str, ast.Expression] = field(default_factory=dict, repr=False)

    @property
    def network(self) -> Network:
        """The model as analyses see it. Raises UnsupportedError where something in it is refused."""
        if self.refusals:
            raise UnsupportedError(self.refusals[0])
        return self._elaborated

    @property
    def formulas(self) -> tuple[Query | UncheckedQuery, ...]:
        """The queries and the unchecked ones together, in the order in which the model states them."""
        stated = [item.name.name for item in self.items if isinstance(item, ast.PropertyDeclaration)]
        order = {name: number for number, name in enumerate(stated)}

        def place(query: Query | UncheckedQuery) -> int:
            # In XML a query that cannot be read is no item, but all queries stand in one text.
            return order[query.name] if self.layout is None else query.span.start

        return tuple(sorted((*self.queries, *self.unchecked), key=place))

    @property
    def heading(self) -> Network:
        """The constants and the time unit without any process: what reports say about every model."""
        return Network((), (), 0, self._elaborated.constants, (), self._elaborated.time_unit)

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The global variables that are not refused."""
        return self._elaborated.variables

    @property
    def names(self) -> Scope:
        """The names that queries may use."""
        return self._scope


def load_model(
    model: str | os.PathLike[str] | Source,
    constants: Mapping[str, int | bool | str] | None = None,
    strict_xta: bool = False,
) -> LoadedModel:
    """Reads and elaborates a model.

    Args:
        model: the path of a file, or a text, in tachk's language or UPPAAL's XML. Imports are relative to its folder.
        constants: other values for global constants; a string is an expression of the language.
        strict_xta: refuse what tachk adds to XTA.

    A model whose only errors are constructs that tachk does not check is loaded, see `LoadedModel.refusals`.

    Raises:
        InputError: with every diagnostic that was found, warnings included.
        UsageError: the file cannot be read, or there is no such constant.
    """
    source = model if isinstance(model, Source) else read_source(model)
    findings = Findings()
    if is_xml(source):
        from tachk.formats.uppaal.reader import parse_uppaal_xml

        return _load_xml(parse_uppaal_xml(source), constants or {}, strict_xta)
    document, merged = Importer(findings, strict_xta).read(source)
    if document is None:
        raise InputError(findings.sorted())
    unreadable = findings.sorted() if findings.has_errors else ()
    items = with_expectations(merged, findings)
    _refuse_dynamic_templates(items, findings)
    overrides = constant_overrides(constants or {}, items, findings)
    context = Context(findings, budget=Budget(INSTANCES))
    running = _without_charts(tuple(items), _charts_beside(source, items), findings)
    result: Elaborated = elaborate(running, document.span, overrides, context)
    if unreadable:
        further = [diagnostic for diagnostic in findings.sorted() if diagnostic not in unreadable]
        raise InputError(by_place((*unreadable, *beyond_damage(unreadable, further, items))))
    if findings.has_mistakes:
        raise InputError(findings.sorted())
    refusals, warnings = _told_apart(findings)
    return LoadedModel(
        result.network,
        result.queries,
        _explained(result.unchecked, refusals),
        warnings,
        document,
        tuple(items),
        result.scope,
        context,
        refusals=refusals,
        _overrides=overrides,
    )


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


def _without_charts(items: tuple[ast.Item, ...], charts: frozenset[str], findings: Findings) -> tuple[ast.Item, ...]:
    """The items without the instances of message sequence charts, which are refused."""
    names = set(charts)
    kept: list[ast.Item] = []
    for item in items:
        match item:
            case ast.Instantiation(name=name, template=template) if template.name in names:
                names.add(name.name)
                _refuse_chart(template, findings)
            case ast.SystemLine(groups=groups):
                for identifier in (i for group in groups for i in group if i.name in names):
                    _refuse_chart(identifier, findings)
                running = (tuple(i for i in group if i.name not in names) for group in groups)
                kept.append(replace(item, groups=tuple(group for group in running if group)))
            case _:
                kept.append(item)
    return tuple(kept) if names else items


def _refuse_chart(name: ast.Identifier, findings: Findings) -> None:
    findings.add(
        "E0750", name.span, f"`{name.name}` is a message sequence chart, which is not supported", "leave it out here"
    )


def _told_apart(findings: Findings) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """The refusals and the warnings among findings that have no other errors."""
    found = findings.sorted()
    return tuple(d for d in found if d.is_unsupported), tuple(d for d in found if not d.is_unsupported)


def _load_xml(read: XmlModel, constants: Mapping[str, int | bool | str], strict_xta: bool) -> LoadedModel:
    """As `load_model`; a wrong query is an unchecked one, for the file is another program's."""
    findings = Findings()
    findings.extend(read.diagnostics)
    if strict_xta:
        # Properties are how a query of UPPAAL's file is held.
        plain = tuple(item for item in read.document.items if not isinstance(item, ast.PropertyDeclaration))
        findings.extend(additions(replace(read.document, items=plain)))
    if findings.has_errors:
        raise InputError(findings.sorted())
    stated = read.document.items
    items = _without_charts(stated, read.charts, findings)
    _refuse_dynamic_templates(items, findings)
    properties = [item for item in items if isinstance(item, ast.PropertyDeclaration)]
    overrides = constant_overrides(constants, items, findings)
    context = Context(findings, budget=Budget(INSTANCES))
    others = [item for item in items if not isinstance(item, ast.PropertyDeclaration)]
    result = elaborate(others, read.document.span, overrides, context)
    queries, unchecked = elaborate_each(properties, result.scope, context)
    if findings.has_mistakes:
        raise InputError(findings.sorted())
    refusals, warnings = _told_apart(findings)
    broken = []
    for query in read.broken:
        own = Findings()
        own.extend(query.diagnostics)
        broken.append(wrong_query(query.name, query.text, query.comment, query.span, own))
    return LoadedModel(
        result.network,
        queries,
        tuple(sorted((*_explained(unchecked, refusals), *broken), key=lambda query: query.span.start)),
        warnings,
        read.document,
        stated,
        result.scope,
        context,
        read.layout,
        refusals,
        overrides,
    )


def other_readings_of(loaded: LoadedModel) -> Iterator[tuple[str, LoadedModel]]:
    """What else a model may mean, each with the place of `default` that it was read with; see `priority_readings`.

    The queries are those of the model, with the names of the reading.
    """
    if loaded.refusals:
        return
    for reading in other_readings(loaded.items):
        context = Context(Findings(), budget=Budget(INSTANCES))
        properties = [item for item in reading.items if isinstance(item, ast.PropertyDeclaration)]
        others = [item for item in reading.items if not isinstance(item, ast.PropertyDeclaration)]
        result = elaborate(others, loaded.document.span, loaded._overrides, context)
        queries, unchecked = elaborate_each(properties, result.scope, context)
        yield (
            reading.place,
            replace(
                loaded,
                _elaborated=result.network,
                queries=queries,
                unchecked=unchecked,
                _scope=result.scope,
                _constants=context,
            ),
        )


def _explained(unchecked: Iterable[UncheckedQuery], refusals: Sequence[Diagnostic]) -> tuple[UncheckedQuery, ...]:
    """The queries, those that use the name of something refused with the reason."""
    return tuple(
        query if query.family or query.diagnostics else replace(query, diagnostics=tuple(refusals[:1]))
        for query in unchecked
    )


def temporal_formula_of(loaded: LoadedModel, node: ast.TemporalFormula) -> Formula | None:
    """What a temporal property of the model says, bounds in its time units; None where it is wrong."""
    from tachk.frontend.queries.observer_processes import temporal_formula

    return temporal_formula(node, loaded._scope, replace(loaded._constants, findings=Findings(), in_query=True))


def elaborate_queries(loaded: LoadedModel, text: str | Source) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The queries of the command line, named ``q1``, ``q2``, ... in order.

    Raises:
        InputError: with every diagnostic that was found.
    """
    source = text if isinstance(text, Source) else Source("<query>", text)
    queries, unchecked = elaborate_query_file(loaded, source)
    diagnostics = [diagnostic for query in unchecked if query.is_wrong for diagnostic in query.diagnostics]
    if diagnostics:
        raise InputError(diagnostics)
    return queries, unchecked


def elaborate_query_file(
    loaded: LoadedModel, source: Source, first: int = 1
) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The queries of a .q file, named as by `elaborate_queries`; a wrong one is unchecked and harms no other.

    Args:
        first: the number of the first query.
    """
    known = loaded._constants
    context = Context(Findings(), known.constants, known.effects, budget=Budget(INSTANCES), time_unit=known.time_unit)
    queries, unchecked = elaborate_entries(parse_each_query(source), loaded._scope, context, first)
    return queries, _explained(unchecked, loaded.refusals)


def _refuse_dynamic_templates(items: Iterable[ast.Item], findings: Findings) -> None:
    for item in items:
        if isinstance(item, ast.DynamicTemplate):
            findings.add(
                "E0750",
                item.span,
                f"the dynamic template `{item.name.name}` is not supported",
                "name a fixed number of processes in the system line",
            )


_BOOLEAN_WORDS = {"yes": "true", "on": "true", "no": "false", "off": "false", "true": "true", "false": "false"}
"""What people write for a Boolean constant, in any case."""


def constant_overrides(
    constants: Mapping[str, int | bool | str], items: Iterable[ast.Item], findings: Findings
) -> dict[str, ast.Expression]:
    """The new values of global constants. Raises UsageError for a name that is none."""
    known, variables = _declared_names(items)
    overrides: dict[str, ast.Expression] = {}
    for name, value in constants.items():
        if name in variables:
            raise UsageError(f"`{name}` is a variable, only constants can be set", "declare it `const` in the model")
        if name not in known:
            help_ = did_you_mean(name, known)
            listed = f"its constants are {', '.join(known)}" if known else "it has none"
            raise UsageError(f"the model has no constant `{name}`", help_ or listed)
        text = str(value).lower() if isinstance(value, bool) else str(value)
        expression, diagnostics = parse_expression(Source(f"-D {name}", text))
        findings.extend(diagnostics)
        if isinstance(expression, ast.NameExpression) and expression.name not in known:
            meant = _BOOLEAN_WORDS.get(expression.name.lower())
            if meant is not None:
                findings.add(
                    "E0201", expression.span, f"unknown name `{expression.name}`", f"a Boolean value is `{meant}`"
                )
                continue
        if expression is not None and not any(d.severity is Severity.ERROR for d in diagnostics):
            overrides[name] = expression
    return overrides


def _declared_names(items: Iterable[ast.Item]) -> tuple[list[str], set[str]]:
    """The names of the global constants, and of the global variables."""
    constants: list[str] = []
    variables: set[str] = set()
    for item in items:
        if isinstance(item, ast.VariableDeclaration):
            names = [declarator.name.name for declarator in item.declarators]
            if item.type is None or "const" in item.type.prefixes:
                constants.extend(names)
            else:
                variables.update(names)
    return constants, variables
