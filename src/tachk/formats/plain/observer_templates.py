"""Temporal properties for UPPAAL: an observer beside the model, and the query that its bad location is not reached.

The observers of several properties would multiply each other's states. So one of them is chosen when a run begins, and
the others sleep. As every choice is possible, a query about an observer is about all runs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.span import Span
from tachk.base.words import Direction, QueryKind
from tachk.formats.plain.mirrors import Mirrors, NoMirror, all_names
from tachk.formats.plain.plain_model import PlainRewriting
from tachk.frontend.loaded import LoadedModel, temporal_formula_of
from tachk.logic.observer.construction import BAD, NoObserver, build_observer
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Change, Formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.rewrite import fresh_name, rewrite, substitute


@dataclass(frozen=True, slots=True)
class _WatchedProperty:
    """A property whose observer can be written, with the template of the observer."""

    property: ast.PropertyDeclaration
    formula: Formula
    template: ast.Template


def with_observers(model: LoadedModel) -> tuple[LoadedModel, tuple[PlainRewriting, ...]]:
    """The model with an observer for each temporal property, as far as UPPAAL's language can say what it looks at; and
    what was done. A property without an observer stays as it is."""
    temporal = [
        (item, item.formula)
        for item in model.items
        if isinstance(item, ast.PropertyDeclaration) and isinstance(item.formula, ast.TemporalFormula)
    ]
    if not temporal:
        return model, ()
    if model.refusals:
        reason = "stays a comment: something in the model is not checked"
        return model, tuple(
            PlainRewriting("property", item.name.span, f"`{item.name.name}` {reason}") for item, _ in temporal
        )
    signals: dict[str, ast.Expression] = {}
    for item in model.items:
        if isinstance(item, ast.SignalDeclaration):
            signals[item.name.name] = substitute(item.expression, signals)
    taken = all_names(model.items)
    mirrors = Mirrors(model.items, model.network, model.scope, taken)
    steps: list[PlainRewriting] = []
    watched = []
    for item, formula in temporal:
        found = _watched(model, item, formula, signals, mirrors, steps)
        if found is not None:
            watched.append(found)
    if not watched:
        return model, tuple(steps)
    return replace(model, items=_Weaver(model, mirrors, watched).items()), (*steps, *mirrors.steps)


def _watched(
    model: LoadedModel,
    item: ast.PropertyDeclaration,
    node: ast.TemporalFormula,
    signals: Mapping[str, ast.Expression],
    mirrors: Mirrors,
    steps: list[PlainRewriting],
) -> _WatchedProperty | None:
    name = item.name.name
    formula = temporal_formula_of(model, node)
    if formula is None or name not in {query.name for query in model.queries}:
        steps.append(PlainRewriting("property", item.name.span, f"`{name}` stays a comment: tachk does not check it"))
        return None
    copy = replace(mirrors, steps=[], declarations=[*mirrors.declarations], found=dict(mirrors.found))
    try:
        reflected = rewrite(formula, partial(_reflected, signals=signals, mirrors=copy))
        own = fresh_name(f"Observer_{name}", mirrors.taken)
        built = build_observer(reflected, own, _declared(model.items))
        for original in model.items:
            if isinstance(original, ast.Template):
                copy.template(original)
    except NoMirror as reason:
        steps.append(PlainRewriting("property", reason.span, f"`{name}` stays a comment: {reason.reason}"))
        return None
    except NoObserver as reason:
        steps.append(PlainRewriting("property", reason.span, f"`{name}` stays a comment: {reason.reason}"))
        return None
    if built.endings:
        unseen = f"a run without end may violate it, which no location such as `{BAD}` shows"
        steps.append(PlainRewriting("property", item.name.span, f"`{name}` stays a comment: {unseen}"))
        return None
    mirrors.taken.add(own)
    mirrors.steps += copy.steps
    mirrors.declarations, mirrors.found = copy.declarations, copy.found
    steps.append(
        PlainRewriting(
            "property", item.name.span, f"`{name}` is watched by `{own}`; its query asks that `{BAD}` is never reached"
        )
    )
    doc = "\n".join(part for part in (item.doc, print_formula(formula)) if part)
    return _WatchedProperty(item, formula, replace(built.template, doc=doc))


def _declared(items: Iterable[ast.Item]) -> Iterator[str]:
    """The names of the model that some version of UPPAAL would not take for something in a template as well."""
    for item in items:
        match item:
            case ast.VariableDeclaration(declarators=declarators) | ast.TypedefDeclaration(declarators=declarators):
                yield from (declarator.name.name for declarator in declarators)
            case ast.FunctionDeclaration(name=name) | ast.Template(name=name) | ast.Instantiation(name=name):
                yield name.name
            case _:
                pass


def _reflected(node: Any, signals: Mapping[str, ast.Expression], mirrors: Mirrors) -> Any:
    if isinstance(node, Atom | Change):
        return replace(node, expression=mirrors.reflect(substitute(node.expression, signals)))
    return node


class _Weaver:
    """Puts observers and mirrors into the items of a model."""

    def __init__(self, model: LoadedModel, mirrors: Mirrors, watched: list[_WatchedProperty]) -> None:
        self.model = model
        self.mirrors = mirrors
        self.watched = watched
        self.chosen = self._fresh("observed") if len(watched) > 1 else ""
        self.chooser = self._fresh("ChooseObserver") if len(watched) > 1 else ""

    def _fresh(self, wanted: str) -> str:
        name = fresh_name(wanted, self.mirrors.taken)
        self.mirrors.taken.add(name)
        return name

    def items(self) -> tuple[ast.Item, ...]:
        originals = self.model.items
        templates = [at for at, item in enumerate(originals) if isinstance(item, ast.Template)]
        queries = {entry.property.name.name: entry for entry in self.watched}
        result: list[ast.Item] = []
        for at, item in enumerate(originals):
            if at == templates[0]:
                result += self._declarations(self.watched[0].property.span)
            match item:
                case ast.Template():
                    result.append(self.mirrors.template(item))
                case ast.Instantiation():
                    result.append(self.mirrors.instantiation(item))
                case ast.SystemLine():
                    result.append(self._system(item))
                case ast.PropertyDeclaration() if item.name.name in queries:
                    result.append(self._query(queries[item.name.name]))
                case _:
                    result.append(item)
            if at == templates[-1]:
                result += self._templates()
        return tuple(result)

    def _declarations(self, span: Span) -> list[ast.VariableDeclaration]:
        found = list(self.mirrors.declarations)
        if self.chosen:
            numbers = ast.RangeType(span, ast.IntegerLiteral(span, 0), ast.IntegerLiteral(span, len(self.watched)))
            declared = ast.Declarator(span, ast.Identifier(span, self.chosen))
            found.append(ast.VariableDeclaration(span, ast.TypeExpression(span, (), numbers), (declared,)))
        return found

    def _templates(self) -> list[ast.Template]:
        if not self.chosen:
            return [entry.template for entry in self.watched]
        awakened = [self._asleep(entry.template, number) for number, entry in enumerate(self.watched, start=1)]
        return [self._choice(awakened[0].span), *awakened]

    def _choice(self, span: Span) -> ast.Template:
        low, high = ast.IntegerLiteral(span, 1), ast.IntegerLiteral(span, len(self.watched))
        type_ = ast.TypeExpression(span, (), ast.RangeType(span, low, high))
        name = self._fresh("number")
        update = ast.AssignmentExpression(
            span, None, ast.NameExpression(span, self.chosen), ast.NameExpression(span, name)
        )
        edge = ast.EdgeDeclaration(
            span,
            None,
            ast.Identifier(span, "Chosen"),
            (ast.SelectBinding(span, ast.Identifier(span, name), type_),),
            updates=(update,),
        )
        choice = ast.LocationDeclaration(
            span, ast.Identifier(span, "Choice"), initial=True, committed=True, edges=(edge,)
        )
        chosen = ast.LocationDeclaration(span, ast.Identifier(span, "Chosen"))
        doc = "Chooses the observer of a run."
        return ast.Template(span, ast.Identifier(span, self.chooser), (), (), (choice, chosen), classic=False, doc=doc)

    def _asleep(self, template: ast.Template, number: int) -> ast.Template:
        """The observer, which begins to watch before time passes if it is chosen."""
        span = template.span
        first = next(location for location in template.locations if location.initial)
        channel = next(
            d.declarators[0].name.name
            for d in template.declarations
            if isinstance(d, ast.VariableDeclaration) and d.type is not None and "broadcast" in d.type.prefixes
        )
        guard = ast.BinaryExpression(
            span, BinaryOperator.EQUAL, ast.NameExpression(span, self.chosen), ast.IntegerLiteral(span, number)
        )
        label = ast.SynchronisationLabel(span, ast.NameExpression(span, channel), Direction.SEND)
        edge = ast.EdgeDeclaration(span, None, first.name, (), guard, label)
        asleep = ast.Identifier(span, fresh_name("Asleep", {location.name.name for location in template.locations}))
        rest = tuple(replace(location, initial=False) for location in template.locations)
        return replace(template, locations=(ast.LocationDeclaration(span, asleep, initial=True, edges=(edge,)), *rest))

    def _system(self, line: ast.SystemLine) -> ast.SystemLine:
        names = [entry.template.name for entry in self.watched]
        if self.chooser:
            names.append(ast.Identifier(line.span, self.chooser))
        return replace(line, groups=(*line.groups[:-1], (*line.groups[-1], *names)))

    def _query(self, entry: _WatchedProperty) -> ast.PropertyDeclaration:
        item = entry.property
        span = item.formula.span
        bad = ast.MemberExpression(span, ast.NameExpression(span, entry.template.name.name), ast.Identifier(span, BAD))
        comment = print_formula(entry.formula)
        if isinstance(item.formula, ast.TemporalFormula) and item.formula.sentence:
            comment = f"{item.formula.sentence}\n{comment}"
        return replace(
            item,
            formula=ast.QueryFormula(span, QueryKind.INVARIANTLY, ast.UnaryExpression(span, PrefixOperator.NOT, bad)),
            doc="\n".join(part for part in (item.doc, comment) if part),
        )
