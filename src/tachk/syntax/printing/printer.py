"""The canonical text of a document, as ``tachk fmt`` writes it.

Every template is written with location blocks, comments stay next to what they stood next to, and blank lines between
declarations are kept (one at most). Formatting the result again changes nothing, and reading it gives the same model:
``parse(print(d)) == canonical(d)``.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar, assert_never

from tachk.base.records import replace
from tachk.syntax import ast
from tachk.syntax.edge_clauses import ClauseKind, edge_clauses
from tachk.syntax.printing.comment_placement import place_comments
from tachk.syntax.printing.expression_printer import (
    print_clause,
    print_declarator,
    print_dimensions,
    print_expression,
    print_expressions,
    print_parameters,
    print_rate,
    print_type,
    print_variables,
)
from tachk.syntax.printing.query_printer import print_expected, print_query, print_scenario_clause
from tachk.syntax.printing.writer import Writer

_Node = TypeVar("_Node", bound=ast.Item | ast.Declaration)


def canonical(document: ast.Document) -> ast.Document:
    """The same model with every template in the location-centric form and every constant with a type."""
    return replace(document, items=tuple(_item(item) for item in document.items), legacy=False)


def _item(item: ast.Item) -> ast.Item:
    match item:
        case ast.Template():
            return _template(item)
        case ast.VariableDeclaration():
            return _typed(item)
        case _:
            return item


def _typed(declaration: ast.VariableDeclaration) -> ast.VariableDeclaration:
    if declaration.type is not None:
        return declaration
    span = declaration.span
    return replace(declaration, type=ast.TypeExpression(span, ("const",), ast.BuiltinType(span, "int")))


def _template(template: ast.Template) -> ast.Template:
    declarations = tuple(
        _typed(declaration) if isinstance(declaration, ast.VariableDeclaration) else declaration
        for declaration in template.declarations
    )
    if not template.classic or not (template.locations or template.branchpoints):
        return replace(template, declarations=declarations)
    leaving: dict[str, list[ast.EdgeDeclaration]] = defaultdict(list)
    for edge in template.edges:
        assert edge.source is not None, "an edge of the classic form has a source"
        leaving[edge.source.name].append(replace(edge, source=None))
    # An edge whose source does not exist is kept, so that the formatter loses nothing; elaboration reports it.
    known = {node.name.name for node in template.locations} | {node.name.name for node in template.branchpoints}
    lost = [edge for name, edges in leaving.items() if name not in known for edge in edges]
    if lost:
        return replace(template, declarations=declarations)
    taken: set[str] = set()

    def edges_of(name: str) -> tuple[ast.EdgeDeclaration, ...]:
        if name in taken:
            return ()
        taken.add(name)
        return tuple(leaving[name])

    return replace(
        template,
        declarations=declarations,
        locations=tuple(replace(node, edges=edges_of(node.name.name)) for node in template.locations),
        branchpoints=tuple(replace(node, edges=edges_of(node.name.name)) for node in template.branchpoints),
        edges=(),
        classic=False,
    )


def write_block(writer: Writer, header: str, block: ast.BlockStatement, owner: Any) -> None:
    """``header { ... }``; the comments behind ``owner`` go behind the closing brace."""
    writer.begin(block)
    writer.open(f"{header} {{".lstrip(), block)
    previous: Any = None
    for node in (*block.declarations, *block.statements):
        writer.separate(previous, node, isinstance(previous, _DECLARATION) and not isinstance(node, _DECLARATION))
        _write(writer, node)
        previous = node
    writer.close("}", block)
    if owner is not None:
        writer.behind(owner)


_DECLARATION = ast.VariableDeclaration | ast.TypedefDeclaration


def _write(writer: Writer, node: Any) -> None:
    match node:
        case ast.VariableDeclaration():
            writer.begin_all(node)
            writer.ending(print_variables(node), node)
        case ast.TypedefDeclaration(type=type_, declarators=declarators):
            writer.begin_all(node)
            variables = ast.VariableDeclaration(node.span, type_, declarators)
            writer.ending(f"typedef {print_variables(variables)}", node)
        case _:
            _write_statement(writer, node)


def _write_statement(writer: Writer, node: ast.Statement) -> None:
    match node:
        case ast.BlockStatement():
            write_block(writer, "", node, None)
        case ast.ExpressionStatement() | ast.EmptyStatement() | ast.ReturnStatement() | ast.AssertStatement():
            writer.line(_simple(node) or "", node)
        case ast.IfStatement():
            writer.begin(node)
            _write_if(writer, node, "")
            writer.behind(node)
        case ast.WhileStatement(condition=condition, body=body):
            writer.begin(node)
            _write_body(writer, f"while ({print_expression(condition)})", body)
            writer.behind(node)
        case ast.ForStatement(initial=initial, condition=conditions, step=step, body=body):
            parts = "; ".join(print_expressions(part) for part in (initial, conditions, step))
            writer.begin(node)
            _write_body(writer, f"for ({parts})", body)
            writer.behind(node)
        case ast.IterationStatement(variable=variable, type=type_, body=body):
            writer.begin(node)
            _write_body(writer, f"for ({variable.name} : {print_type(type_)})", body)
            writer.behind(node)
        case ast.DoStatement(condition=condition, body=body):
            writer.begin(node)
            _write_body(writer, "do", body)
            writer.ending(writer.joined(f"while ({print_expression(condition)});"), node)
        case _:
            assert_never(node)


def _write_body(writer: Writer, header: str, body: ast.Statement) -> None:
    if isinstance(body, ast.BlockStatement):
        write_block(writer, header, body, None)
        return
    simple = _simple(body)
    if simple is not None and id(body) not in writer.comments.before and writer.fits(f"{header} {simple}"):
        writer.ending(f"{header} {simple}", body)
        return
    writer.raw(header)
    writer.deeper(1)
    _write_statement(writer, body)
    writer.deeper(-1)


def _simple(node: ast.Statement) -> str | None:
    """The text of a statement that has no other inside."""
    match node:
        case ast.ExpressionStatement(expression=expression):
            return f"{print_expression(expression)};"
        case ast.EmptyStatement():
            return ";"
        case ast.ReturnStatement(value=value):
            return f"return {print_expression(value)};" if value is not None else "return;"
        case ast.AssertStatement(condition=condition):
            return f"assert {print_expression(condition)};"
        case _:
            return None


def _write_if(writer: Writer, node: ast.IfStatement, word: str) -> None:
    then = node.then
    if node.otherwise is not None and _takes_else(then):
        # Without braces the inner if would take the else.
        then = ast.BlockStatement(then.span, (), (then,))
    _write_body(writer, f"{word}if ({print_expression(node.condition)})", then)
    if node.otherwise is None:
        return
    if isinstance(node.otherwise, ast.IfStatement) and not writer.comments.touches(node.otherwise):
        _write_if(writer, node.otherwise, writer.joined("else "))
    else:
        first = node.otherwise
        commented = id(first) in writer.comments.before
        _write_body(writer, "else" if commented else writer.joined("else"), first)


def _takes_else(node: ast.Statement) -> bool:
    """True if a following ``else`` would belong to an ``if`` at the end of the statement."""
    match node:
        case ast.IfStatement(otherwise=otherwise):
            return otherwise is None or _takes_else(otherwise)
        case ast.WhileStatement(body=body) | ast.ForStatement(body=body) | ast.IterationStatement(body=body):
            return _takes_else(body)
        case _:
            return False


def print_document(document: ast.Document) -> str:
    """The canonical text of a document, with a line break at its end."""
    settled = canonical(document)
    writer = Writer(settled, place_comments(settled))
    write_separated(writer, settled.items, write_item)
    writer.finish(settled)
    return writer.text()


def write_separated(writer: Writer, nodes: Iterable[_Node], write: Callable[[Writer, _Node], None]) -> None:
    """Writes items or declarations, with a blank line around templates and functions, and elsewhere where the source
    has one."""
    previous: _Node | None = None
    for node in nodes:
        writer.separate(previous, node, _is_separated(previous) or _is_separated(node))
        write(writer, node)
        previous = node


def _is_separated(item: Any) -> bool:
    return isinstance(item, ast.Template | ast.FunctionDeclaration)


def write_item(writer: Writer, item: ast.Item) -> None:
    """One item with its comments."""
    match item:
        case ast.Template():
            _write_template(writer, item)
        case ast.Instantiation(name=name, parameters=parameters, template=template, arguments=arguments):
            taken = f"({print_parameters(parameters)})" if parameters else ""
            writer.line(f"{name.name}{taken} = {template.name}({print_expressions(arguments)});", item)
        case ast.SystemLine(groups=groups):
            text = " < ".join(", ".join(identifier.name for identifier in group) for group in groups)
            writer.begin(item)
            writer.filled("system", f"{text};".split(" "))
            writer.behind(item)
        case ast.ProgressDeclaration(measures=measures):
            writer.line("progress { " + "".join(f"{_measure(measure)}; " for measure in measures) + "}", item)
        case ast.GanttDeclaration(text=text):
            writer.line(f"gantt {text}", item)
        case ast.ImportDeclaration(path=path):
            writer.line(f'import "{path}";', item)
        case ast.TimeUnitDeclaration(amount=amount, unit=unit):
            writer.line(f"time_unit = {amount} {unit};", item)
        case ast.PropertyDeclaration(formula=ast.ScenarioFormula() as scenario):
            _write_scenario(writer, item, scenario)
        case ast.PropertyDeclaration():
            _write_property(writer, item)
        case ast.ExpectationDeclaration(names=names, expectation=expectation):
            writer.begin(item)
            writer.filled("expect", f"{_listed(names)} {print_expected(expectation)};".split(" "))
            writer.behind(item)
        case ast.HideDeclaration(names=names):
            writer.begin(item)
            writer.filled("hide", f"{_listed(names)};".split(" "))
            writer.behind(item)
        case ast.RecordingDeclaration(clauses=clauses):
            writer.begin(item)
            writer.open("recording {", item)
            for clause in clauses:
                writer.begin(clause)
                writer.filled("", f"{_clause(clause)};".split(" "))
                writer.behind(clause)
            writer.close("}", item)
        case _:
            write_declaration(writer, item)


def _clause(clause: ast.RecordingClause) -> str:
    match clause:
        case ast.ReplacesClause(names=names):
            return f"replaces {_listed(names)}"
        case ast.VisibleClause(channel=channel, direction=direction, event=event, columns=columns, per=per):
            cells = ", ".join(map(_column, columns))
            return f"visible {print_expression(channel)}{direction or ''} as {event.name}({cells})" + (
                f" per {_listed(per)}" if per else ""
            )
        case ast.HiddenClause(channels=channels):
            return f"hidden {print_expressions(channels)}"
        case ast.RecordedModelClause(path=path, constants=constants):
            values = ", ".join(map(_column, constants))
            return f'import "{path}"' + (f" ({values})" if values else "")
        case ast.AllowanceClause(word=word, side=side, amount=amount, unit=unit):
            return " ".join(filter(None, (word, side, str(amount), unit)))


def _column(column: ast.RecordedColumn) -> str:
    said = "" if column.expression is None else f" = {print_expression(column.expression)}"
    return column.name.name + said


def _listed(names: Sequence[ast.Identifier]) -> str:
    return ", ".join(identifier.name for identifier in names)


def _measure(measure: ast.ProgressMeasure) -> str:
    guard = "" if measure.guard is None else f"{print_expression(measure.guard)} : "
    return guard + print_expression(measure.expression)


def write_declaration(writer: Writer, item: ast.Declaration) -> None:
    """A declaration with the comments that belong to it."""
    match item:
        case ast.VariableDeclaration(type=type_, declarators=declarators):
            assert type_ is not None, "the canonical form types every constant"
            _write_typed(writer, "", type_, declarators, item)
        case ast.TypedefDeclaration(type=type_, declarators=declarators):
            _write_typed(writer, "typedef ", type_, declarators, item)
        case ast.FunctionDeclaration(result=result, name=name, parameters=parameters, body=body):
            header = f"{print_type(result)} {name.name}({print_parameters(parameters)})"
            writer.begin(item)
            write_block(writer, header, body, item)
        case ast.ChannelPriorityDeclaration(groups=groups):
            writer.line(f"chan priority {' < '.join(print_expressions(group) for group in groups)};", item)
        case ast.UpdateHook(kind=kind, updates=updates):
            writer.line(f"{kind} {{ {print_expressions(updates)} }}" if updates else f"{kind} {{ }}", item)
        case ast.SignalDeclaration(name=name, expression=expression, doc=doc):
            writer.begin(item, doc)
            writer.condition(f"signal {name.name} = ", expression, ";", item)
        case ast.DynamicTemplate(name=name, parameters=parameters):
            writer.line(f"dynamic {name.name}({print_parameters(parameters)});", item)
        case ast.ForeignImport(library=library, span=span):
            text = span.text if span.text.startswith("import") else f'import "{library}" {{ }}'
            writer.line(f"{text};", item)


def _write_typed(
    writer: Writer, word: str, type_: ast.TypeExpression, declarators: Sequence[ast.Declarator], item: Any
) -> None:
    """A declaration; a structure that is long or commented gets a line for each field."""
    names = ", ".join(print_declarator(declarator) for declarator in declarators)
    line = f"{word}{print_type(type_)} {names};"
    base = type_.base
    if not isinstance(base, ast.StructType) or (writer.fits(line) and not writer.comments.inside(item)):
        _write_list(writer, line, f"{word}{print_type(type_)} ", declarators, item)
        return
    writer.begin(item)
    writer.open(" ".join((*([word.strip()] if word else []), *type_.prefixes, "struct")) + " {", item)
    for field in base.fields:
        write_declaration(writer, field)
    writer.close(f"}} {names};", item)


def _write_list(writer: Writer, line: str, head: str, declarators: Sequence[ast.Declarator], item: Any) -> None:
    """A declaration on one line, or with a long initialiser list broken between its items."""
    last = declarators[-1]
    if writer.fits(line) or len(declarators) > 1 or not isinstance(last.initialiser, ast.InitialiserList):
        writer.line(line, item)
        return
    parts = [print_expression(ast.InitialiserList(last.span, (entry,)))[2:-2] for entry in last.initialiser.items]
    writer.begin(item)
    writer.open(f"{head}{last.name.name}{print_dimensions(last.dimensions)} = {{", item)
    writer.filled("", [*(f"{part}," for part in parts[:-1]), parts[-1]])
    writer.close("};", item)


def _write_property(writer: Writer, item: ast.PropertyDeclaration) -> None:
    title = f' "{item.title}"' if item.title else ""
    expectation = f" expect {print_expected(item.expectation)}" if item.expectation else ""
    head, formula = f"property {item.name.name}{title} :", print_query(item.formula)
    writer.begin(item, item.doc)
    if writer.fits(f"{head} {formula}{expectation};"):
        writer.ending(f"{head} {formula}{expectation};", item)
        return
    writer.raw(head)
    writer.deeper(1)
    if expectation:
        writer.raw(formula)
        writer.ending(f"{expectation.strip()};", item)
    else:
        writer.ending(f"{formula};", item)
    writer.deeper(-1)


def _write_scenario(writer: Writer, item: ast.PropertyDeclaration, scenario: ast.ScenarioFormula) -> None:
    title = f' "{item.title}"' if item.title else ""
    writer.begin(item, item.doc)
    writer.open(f"scenario {item.name.name}{title} {{", item)
    for clause in scenario.clauses:
        writer.begin(clause)
        writer.filled("", f"{print_scenario_clause(clause)};".split(" "))
        writer.behind(clause)
    writer.close("}", item)


# ---- templates ----------------------------------------------------------------------------------------------------


def _write_template(writer: Writer, template: ast.Template) -> None:
    writer.begin(template, template.doc)
    writer.open(f"process {template.name.name}({print_parameters(template.parameters)}) {{", template)
    write_separated(writer, template.declarations, write_declaration)
    previous: Any = template.declarations[-1] if template.declarations else None
    owners: list[ast.LocationDeclaration | ast.Branchpoint] = [*template.locations, *template.branchpoints]
    for node in owners:
        brief = _brief(writer, node) and (previous is None or _brief(writer, previous))
        writer.separate(previous, node, not brief)
        _write_location(writer, node)
        previous = node
    writer.close("}", template)


def _brief(writer: Writer, node: Any) -> bool:
    """True if a location needs no braces."""
    if not isinstance(node, ast.LocationDeclaration) or node.doc or writer.comments.inside(node):
        return False
    return not (node.invariant or node.exponential_rate or node.edges)


def _write_location(writer: Writer, node: ast.LocationDeclaration | ast.Branchpoint) -> None:
    if isinstance(node, ast.Branchpoint):
        writer.begin(node)
        writer.open(f"branchpoint {node.name.name} {{", node)
    else:
        given = (("init", node.initial), ("urgent", node.urgent), ("committed", node.committed))
        flags = "".join(f"{word} " for word, present in given if present)
        head = f"{flags}location {node.name.name}"
        writer.begin(node, node.doc)
        empty = not (node.invariant or node.exponential_rate or node.edges)
        if empty and not writer.comments.inside(node):
            writer.ending(f"{head};", node)
            return
        writer.open(f"{head} {{", node)
        if node.invariant is not None:
            writer.begin(node.invariant)
            writer.condition("invariant ", node.invariant, ";", node.invariant)
        if node.exponential_rate is not None:
            rate = print_rate(node.exponential_rate, node.rate_divisor)
            writer.line(f"exponential_rate {rate};", node.exponential_rate)
    previous: Any = None
    for edge in node.edges:
        if previous is not None:
            writer.separate(previous, edge, False)
        _write_edge(writer, edge)
        previous = edge
    writer.close("}", node)


def _write_edge(writer: Writer, edge: ast.EdgeDeclaration) -> None:
    clauses = [(clause, print_clause(clause)) for clause in edge_clauses(edge)]
    head = f"to {edge.target.name}" if edge.controllable else f"uncontrollable to {edge.target.name}"
    writer.begin(edge, edge.doc)
    if not clauses and not writer.comments.inside(edge):
        writer.ending(f"{head};", edge)
        return
    line = f"{head} {{ " + " ".join(f"{clause.kind.value} {text};" for clause, text in clauses) + " }"
    if writer.fits(line) and not writer.comments.inside(edge):
        writer.ending(line, edge)
        return
    writer.open(f"{head} {{", edge)
    for clause, text in clauses:
        writer.begin(clause.first)
        if clause.kind in (ClauseKind.GUARD, ClauseKind.PROBABILITY):
            writer.condition(f"{clause.kind.value} ", clause.first, ";", clause.first)
        else:
            writer.ending(f"{clause.kind.value} {text};", clause.first)
    writer.close("}", edge)
