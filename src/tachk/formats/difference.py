"""The difference in behaviour between two models, as text.

Compared are the models as UPPAAL would get them: imports followed, additions expanded, every template in the classic
form. Layout, comments, the time unit and the names of properties and branchpoints do not count, nor does the order of
declarations, templates, locations, edges or properties. The order of processes and of updates counts, because
broadcasts and updates are executed in it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from tachk.formats.plain.expansion import with_repaired_names
from tachk.formats.plain.plain_model import PlainModel
from tachk.syntax import ast
from tachk.syntax.edge_clauses import edge_clauses
from tachk.syntax.printing.comment_placement import Placement
from tachk.syntax.printing.expression_printer import (
    print_clause,
    print_declarator,
    print_expression,
    print_expressions,
    print_parameters,
    print_rate,
    print_type,
)
from tachk.syntax.printing.printer import write_declaration
from tachk.syntax.printing.query_printer import print_expected, print_query
from tachk.syntax.printing.writer import Writer
from tachk.syntax.rewrite import fresh_name, names_in


@dataclass(frozen=True, slots=True)
class ModelDifference:
    """Attributes:
    where: the part of the model: ``"declarations"``, ``"template Train"``, ``"system"``, ``"properties"``.
    what: what changed: ``"location Safe"``, ``"edge A -> B"``.
    before, after: its text; None where it is not there.
    """

    where: str
    what: str
    before: str | None
    after: str | None


def difference(before: PlainModel, after: PlainModel) -> tuple[ModelDifference, ...]:
    """The changes from one model to the other, in the order of the models."""
    changes: list[ModelDifference] = []
    _compare("declarations", _declarations(before.declarations), _declarations(after.declarations), changes)
    old = {template.name.name: template for template in before.templates}
    new = {template.name.name: template for template in after.templates}
    for name in dict.fromkeys((*old, *new)):
        where = f"template {name}"
        if name not in new or name not in old:
            count = len((old.get(name) or new[name]).locations)
            text = f"{count} location{'' if count == 1 else 's'}"
            changes.append(
                ModelDifference(where, "the template", text if name in old else None, text if name in new else None)
            )
        else:
            _compare_templates(where, old[name], new[name], changes)
    _compare("system", _system(before), _system(after), changes)
    _compare_many("properties", _queries(before), _queries(after), changes)
    old_wrong, new_wrong = ([(text, "") for text in model.wrong] for model in (before, after))
    _compare_many("queries that are wrong", old_wrong, new_wrong, changes)
    return tuple(changes)


def least_difference(before: PlainModel, after: PlainModel) -> tuple[ModelDifference, ...]:
    """`difference`, where a name that was replaced for some version of UPPAAL may be the same name."""
    changes = difference(before, after)
    repaired = difference(with_repaired_names(before), with_repaired_names(after))
    return repaired if len(repaired) < len(changes) else changes


def print_difference(changes: Sequence[ModelDifference]) -> str:
    """One heading for each part of the model, one or two lines for each change."""
    lines: list[str] = []
    heading = ""
    for change in changes:
        if change.where != heading:
            heading = change.where
            lines.append(heading)
        if change.before is None:
            lines.append(f"  + {_joined(change.what, change.after)}")
        elif change.after is None:
            lines.append(f"  - {_joined(change.what, change.before)}")
        else:
            lines.append(f"  ~ {change.what}")
            lines += [f"      - {line}" for line in change.before.splitlines() or ["(nothing)"]]
            lines += [f"      + {line}" for line in change.after.splitlines() or ["(nothing)"]]
    return "\n".join(lines) + "\n" if lines else ""


def _joined(what: str, text: str | None) -> str:
    first, *rest = (text or "").splitlines() or [""]
    return "\n".join([f"{what}: {first}" if first else what, *(f"      {line}" for line in rest)])


# ---- parts ----------------------------------------------------------------------------------------------------------


def _compare(where: str, before: Mapping[str, str], after: Mapping[str, str], changes: list[ModelDifference]) -> None:
    for name in dict.fromkeys((*before, *after)):
        old, new = before.get(name), after.get(name)
        if old != new:
            changes.append(ModelDifference(where, name, old, new))


def _compare_many(
    where: str, before: Iterable[tuple[str, str]], after: Iterable[tuple[str, str]], changes: list[ModelDifference]
) -> None:
    """Compares things that may occur several times; one that went and one that came of the same name are a change."""
    old, new = Counter(before), Counter(after)
    gone, come = list((old - new).elements()), list((new - old).elements())
    for what, text in gone:
        partner = next((item for item in come if item[0] == what), None)
        if partner is not None:
            come.remove(partner)
        changes.append(ModelDifference(where, what, text, None if partner is None else partner[1]))
    changes += [ModelDifference(where, what, None, text) for what, text in come]


def _compare_templates(where: str, before: ast.Template, after: ast.Template, changes: list[ModelDifference]) -> None:
    before, after = _with_named_choices(before), _with_named_choices(after)
    _compare(where, _head(before), _head(after), changes)
    _compare(where, _declarations(before.declarations), _declarations(after.declarations), changes)
    _compare(where, _locations(before), _locations(after), changes)
    _compare_many(where, _edges(before), _edges(after), changes)


def _with_named_choices(template: ast.Template) -> ast.Template:
    """The template with its branchpoints named after the locations that lead to them: UPPAAL's XML has no names."""
    names: dict[str, str] = {}
    for point in template.branchpoints:
        sources = sorted({e.source.name for e in template.edges if e.source and e.target.name == point.name.name})
        wanted = f"after_{'_'.join(sources)}"
        names[point.name.name] = fresh_name(wanted, {*names.values(), *names_in(template.locations)})
    return _with_ends(template, names) if names else template


def _with_ends(template: ast.Template, names: Mapping[str, str]) -> ast.Template:
    """The template with other names for some branchpoints."""

    def end(identifier: ast.Identifier) -> ast.Identifier:
        return replace(identifier, name=names.get(identifier.name, identifier.name))

    return replace(
        template,
        branchpoints=tuple(replace(point, name=end(point.name)) for point in template.branchpoints),
        edges=tuple(
            replace(edge, source=None if edge.source is None else end(edge.source), target=end(edge.target))
            for edge in template.edges
        ),
    )


def _head(template: ast.Template) -> dict[str, str]:
    return {"parameters": print_parameters(template.parameters)}


def _declarations(items: Iterable[ast.Declaration]) -> dict[str, str]:
    """The text of every declaration by what it declares."""
    found: dict[str, str] = {}
    for item in items:
        match item:
            case ast.VariableDeclaration(type=type_, declarators=declarators) if type_ is not None:
                for declarator in declarators:
                    found[declarator.name.name] = f"{print_type(type_)} {print_declarator(declarator)}"
            case ast.TypedefDeclaration(type=type_, declarators=declarators):
                for declarator in declarators:
                    found[f"type {declarator.name.name}"] = f"{print_type(type_)} {print_declarator(declarator)}"
            case ast.FunctionDeclaration(name=name):
                found[f"{name.name}()"] = _text(item)
            case ast.ChannelPriorityDeclaration():
                found["chan priority"] = _text(item)
            case _:
                text = _text(item)
                found[text.split("{")[0].strip()] = text
    return found


def _text(item: ast.Declaration) -> str:
    writer = Writer(ast.Document(item.span, (item,)), Placement())
    write_declaration(writer, item)
    return "\n".join(line for line in writer.text().splitlines() if line.strip())


def _locations(template: ast.Template) -> dict[str, str]:
    found = {}
    for location in template.locations:
        urgent = location.urgent and not location.committed  # a committed location is urgent anyway
        flags = (("init", location.initial), ("urgent", urgent), ("committed", location.committed))
        parts = [word for word, present in flags if present]
        if location.invariant is not None:
            parts.append(f"invariant {print_expression(location.invariant)}")
        if location.exponential_rate is not None:
            parts.append(f"exponential_rate {print_rate(location.exponential_rate, location.rate_divisor)}")
        found[f"location {location.name.name}"] = "; ".join(parts)
    for point in template.branchpoints:
        found[f"branchpoint {point.name.name}"] = ""
    return found


def _edges(template: ast.Template) -> Iterator[tuple[str, str]]:
    for edge in template.edges:
        source = "" if edge.source is None else edge.source.name
        parts = [f"{clause.kind.value} {print_clause(clause)};" for clause in edge_clauses(edge)]
        arrow = "->" if edge.controllable else "-u->"
        yield f"edge {source} {arrow} {edge.target.name}", " ".join(parts)


def _system(model: PlainModel) -> dict[str, str]:
    found = {}
    for node in model.instantiations:
        parameters = f"({print_parameters(node.parameters)})" if node.parameters else ""
        found[f"process {node.name.name}"] = f"{parameters}= {node.template.name}({print_expressions(node.arguments)})"
    groups = (", ".join(name.name for name in group) for group in model.system.groups)
    found["system line"] = " < ".join(groups)
    return found


def _queries(model: PlainModel) -> Iterator[tuple[str, str]]:
    for query in model.queries:
        text = " ".join(print_query(query.formula).split())
        yield text, "" if query.expectation is None else f"expect {print_expected(query.expectation)}"
