"""From parse trees to syntax tree nodes.

Each method is named after a rule (or its alias) of the grammar and gets everything the rule matched, tokens included.
Methods hold no state; a rule of the language that the grammar cannot express is enforced by raising `Misplaced`.
"""

from __future__ import annotations

import re
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.operators import BinaryOperator
from tachk.base.words import Direction, QueryKind
from tachk.syntax import ast
from tachk.syntax.building.build_expressions import Children, ExpressionBuilder, ListOf, nodes, only, span_of
from tachk.syntax.building.build_template import ClassicLine, WrittenClause, clauses_of, template
from tachk.syntax.chains import chain
from tachk.syntax.formulas.build import FormulaBuilder, WholeFormula, as_formula
from tachk.syntax.parsing.misplaced import Misplaced
from tachk.syntax.parsing.tokens import Token
from tachk.syntax.parsing.unchecked import unchecked_family


class Builder(ExpressionBuilder, FormulaBuilder):
    """The callbacks of the grammar's rules."""

    # ---- functions and statements ----

    def function(self, children: Children) -> ast.FunctionDeclaration:
        result, name, _, parameters, _, body = children
        return ast.FunctionDeclaration(span_of(children), result, name, tuple(parameters or ()), body)

    def block(self, children: Children) -> ast.BlockStatement:
        declarations: list[Any] = []
        statements: list[Any] = []
        for child in nodes(children):
            if not isinstance(child, ast.VariableDeclaration | ast.TypedefDeclaration):
                statements.append(child)
            elif statements:
                raise Misplaced(
                    Diagnostic(
                        "E0106",
                        "a block declares its variables before its first statement",
                        child.span,
                        "move the declaration up, or open a new block with { }",
                        (Label(statements[0].span, "first statement"),),
                    )
                )
            else:
                declarations.append(child)
        return ast.BlockStatement(span_of(children), tuple(declarations), tuple(statements))

    def expression_statement(self, children: Children) -> ast.ExpressionStatement:
        return ast.ExpressionStatement(span_of(children), children[0])

    def empty_statement(self, children: Children) -> ast.EmptyStatement:
        return ast.EmptyStatement(children[0].span)

    def if_statement(self, children: Children) -> ast.IfStatement:
        otherwise = None if children[5] is None else _embedded(children, 6)
        return ast.IfStatement(span_of(children), children[2], _embedded(children, 4), otherwise)

    def while_statement(self, children: Children) -> ast.WhileStatement:
        return ast.WhileStatement(span_of(children), children[2], _embedded(children, 4))

    def do_statement(self, children: Children) -> ast.DoStatement:
        return ast.DoStatement(span_of(children), _embedded(children, 1), children[4])

    def for_statement(self, children: Children) -> ast.ForStatement:
        _, _, initial, _, condition, _, step, _, _ = children
        return ast.ForStatement(
            span_of(children), tuple(initial or ()), tuple(condition or ()), tuple(step or ()), _embedded(children, 8)
        )

    def iteration_statement(self, children: Children) -> ast.IterationStatement:
        return ast.IterationStatement(span_of(children), children[2], children[4], _embedded(children, 6))

    def return_statement(self, children: Children) -> ast.ReturnStatement:
        return ast.ReturnStatement(span_of(children), children[1])

    def assert_statement(self, children: Children) -> ast.AssertStatement:
        return ast.AssertStatement(span_of(children), children[1])

    def skipped(self, children: Children) -> None:
        """Text passed over after an error leaves nothing behind."""

    # ---- declarations and the system section ----

    def document(self, children: Children) -> tuple[Any, ...]:
        return nodes(children)

    def declarations_fragment(self, children: Children) -> tuple[Any, ...]:
        return nodes(children)

    def stray_semicolon(self, children: Children) -> None:
        """``;`` alone: legal in XTA, means nothing."""

    def channel_priority(self, children: Children) -> ast.ChannelPriorityDeclaration:
        return ast.ChannelPriorityDeclaration(span_of(children), tuple(tuple(g) for g in only(children, ListOf)))

    def channel_group(self, children: Children) -> ListOf:
        return ListOf(nodes(children))

    def update_hook(self, children: Children) -> ast.UpdateHook:
        return ast.UpdateHook(span_of(children), children[0].text, tuple(children[2] or ()))

    def foreign_import(self, children: Children) -> ast.ForeignImport:
        return ast.ForeignImport(span_of(children), children[1].text[1:-1])

    def signal(self, children: Children) -> ast.SignalDeclaration:
        return ast.SignalDeclaration(span_of(children), children[1], children[3], children[0].doc)

    def instantiation(self, children: Children) -> ast.Instantiation:
        name = children[0]
        if isinstance(children[1], Token) and children[1].type == "EQUALS":
            parameters, template_name, arguments = None, children[2], children[4]
        else:
            parameters, template_name, arguments = children[2], children[5], children[7]
        return ast.Instantiation(
            span_of(children), name, tuple(parameters or ()), template_name, tuple(arguments or ())
        )

    def process_group(self, children: Children) -> ListOf:
        return ListOf(nodes(children))

    def system_line(self, children: Children) -> ast.SystemLine:
        return ast.SystemLine(span_of(children), tuple(tuple(group) for group in only(children, ListOf)))

    def dynamic_template(self, children: Children) -> ast.DynamicTemplate:
        return ast.DynamicTemplate(span_of(children), children[1], tuple(children[3] or ()))

    def progress_measure(self, children: Children) -> ast.ProgressMeasure:
        return ast.ProgressMeasure(span_of(children), children[0], children[2])

    def progress(self, children: Children) -> ast.ProgressDeclaration:
        return ast.ProgressDeclaration(span_of(children), nodes(children))

    def gantt(self, children: Children) -> ast.GanttDeclaration:
        return ast.GanttDeclaration(span_of(children), children[1].text)

    def import_file(self, children: Children) -> ast.ImportDeclaration:
        return ast.ImportDeclaration(span_of(children), children[1].text[1:-1])

    def time_unit(self, children: Children) -> ast.TimeUnitDeclaration:
        return ast.TimeUnitDeclaration(span_of(children), int(children[2].text), children[3].text)

    # ---- queries and properties ----

    def path_formula(self, children: Children) -> ast.QueryFormula:
        quantifier, deadline, predicate = children
        kind = QueryKind(quantifier.text)
        if deadline is not None and kind is not QueryKind.EVENTUALLY:
            help_ = f"ask {kind.value} without it; A<>[<= t] p and p -->[<= t] q have a deadline"
            raise Misplaced(Diagnostic("E0105", f"{kind.value} has no deadline", deadline.span, help_))
        return ast.QueryFormula(span_of(children), kind, predicate, deadline=deadline)

    def leads_to(self, children: Children) -> ast.QueryFormula:
        trigger, _, deadline, answer = children
        return ast.QueryFormula(span_of(children), QueryKind.LEADS_TO, trigger, (answer,), deadline)

    def deadline(self, children: Children) -> ast.Deadline:
        _, comparison, bound, _ = children
        return ast.Deadline(span_of(children), bound, comparison.text == "<")

    def extreme_values(self, children: Children) -> ast.QueryFormula:
        kind, _, predicate, _, _, operands = children
        return ast.QueryFormula(span_of(children), QueryKind(kind.text), predicate, tuple(operands))

    def unchecked(self, children: Children) -> ast.UncheckedFormula:
        token = children[0]
        family = unchecked_family(re.findall(r"\w+|\S", token.text)) or "statistical"
        return ast.UncheckedFormula(token.span, token.text, family)

    def sentence(self, children: Children) -> ast.TemporalFormula:
        return ast.TemporalFormula(children[0].span, None, children[0].text)

    def query(self, children: Children) -> ast.QueryEntry:
        formula, _, expected = children
        if isinstance(formula, WholeFormula):
            formula = ast.TemporalFormula(formula.span, as_formula(formula.expression))
        return ast.QueryEntry(span_of(children), formula, "", None if expected is None else _outcome(expected))

    def expected(self, children: Children) -> Token | ast.ConditionalExpectation:
        outcome, _, condition, _, otherwise = children
        if condition is None:
            word: Token = outcome
            return word
        return ast.ConditionalExpectation(span_of(children), outcome.text, condition, _outcome(otherwise))

    def property(self, children: Children) -> ast.PropertyDeclaration:
        keyword, name, title, _, entry, _ = children
        return ast.PropertyDeclaration(
            span_of(children),
            name,
            title.text[1:-1] if title is not None else "",
            entry.formula,
            entry.expectation,
            keyword.doc,
        )

    def expectation(self, children: Children) -> ast.ExpectationDeclaration:
        return ast.ExpectationDeclaration(span_of(children), _identifiers(children), _outcome(children[-2]))

    def hide(self, children: Children) -> ast.HideDeclaration:
        return ast.HideDeclaration(span_of(children), _identifiers(children))

    # ---- scenarios ----

    def scenario(self, children: Children) -> ast.PropertyDeclaration:
        keyword, name, title, _, *clauses, _ = children
        formula = ast.ScenarioFormula(span_of(children), nodes(clauses))
        text = title.text[1:-1] if title is not None else ""
        return ast.PropertyDeclaration(formula.span, name, text, formula, None, keyword.doc)

    def scenario_event(self, children: Children) -> ast.ScenarioStep:
        bounds, channel, _, _, condition, _ = children
        earliest, latest = (None, None) if bounds is None else (bounds.earliest, bounds.latest)
        return ast.ScenarioStep(span_of(children), channel, earliest, latest, condition)

    def scenario_silence(self, children: Children) -> ast.ScenarioStep:
        _, time, _ = children
        return ast.ScenarioStep(span_of(children), None, time)

    def scenario_bounds(self, children: Children) -> ast.ScenarioStep:
        """The times of an event, which is not known yet."""
        word, *rest = children
        times = only(rest, ast.ScenarioTime)
        earliest = None if word.type == "WITHIN" else times[0]
        latest = None if word.type == "AFTER" else times[-1]
        return ast.ScenarioStep(span_of(children), None, earliest, latest)

    def scenario_time(self, children: Children) -> ast.ScenarioTime:
        amount, unit = children
        value = int(amount.text) if amount.type == "INTEGER" else ast.NameExpression(amount.span, amount.text)
        return ast.ScenarioTime(span_of(children), value, "" if unit is None else unit.text)

    def observes(self, children: Children) -> ast.ObservesClause:
        return ast.ObservesClause(span_of(children), nodes(children))

    # ---- recordings ----

    def recording(self, children: Children) -> ast.RecordingDeclaration:
        return ast.RecordingDeclaration(span_of(children), nodes(children[2:-1]))

    def replaces(self, children: Children) -> ast.ReplacesClause:
        return ast.ReplacesClause(span_of(children), _identifiers(children))

    def visible(self, children: Children) -> ast.VisibleClause:
        _, channel, mark, _, event, _, columns, _, *rest = children
        direction = None if mark is None else Direction(mark.text)
        common = _identifiers(rest)
        return ast.VisibleClause(span_of(children), channel, direction, event, tuple(columns or ()), common)

    def hidden(self, children: Children) -> ast.HiddenClause:
        return ast.HiddenClause(span_of(children), nodes(children))

    def recorded_model(self, children: Children) -> ast.RecordedModelClause:
        _, path, *rest = children
        columns = next((each for each in rest if isinstance(each, ListOf)), ())
        return ast.RecordedModelClause(span_of(children), path.text[1:-1], tuple(columns))

    def tolerance(self, children: Children) -> ast.AllowanceClause:
        word, *rest = children
        return self.lateness([word, None, *rest])

    def lateness(self, children: Children) -> ast.AllowanceClause:
        word, side, amount, unit, _ = children
        names = ["" if each is None else each.text for each in (side, unit)]
        return ast.AllowanceClause(span_of(children), word.text, names[0], int(amount.text), names[1])

    def columns(self, children: Children) -> ListOf:
        return ListOf(nodes(children))

    def column(self, children: Children) -> ast.RecordedColumn:
        name, _, expression = children
        return ast.RecordedColumn(span_of(children), name, expression)

    # ---- templates ----

    def process(self, children: Children) -> ast.Template:
        keyword, name, _, parameters, _, _, *body = children[:-1]
        items = [child for child in body if child is not None]
        return template(span_of(children), keyword.doc, name, tuple(parameters or ()), items)

    def state(self, children: Children) -> ast.LocationDeclaration:
        token, _, invariant, _, rate, _, divisor, _ = children
        identifier = ast.Identifier(token.span, token.text)
        return ast.LocationDeclaration(
            span_of(children), identifier, invariant, rate, doc=token.doc, rate_divisor=divisor
        )

    def state_line(self, children: Children) -> ClassicLine:
        return ClassicLine("state", span_of(children), nodes(children))

    def branchpoint_line(self, children: Children) -> ClassicLine:
        return ClassicLine("branchpoint", span_of(children), nodes(children))

    def commit_line(self, children: Children) -> ClassicLine:
        return ClassicLine("commit", span_of(children), nodes(children))

    def urgent_line(self, children: Children) -> ClassicLine:
        return ClassicLine("urgent", span_of(children), nodes(children))

    def init_line(self, children: Children) -> ClassicLine:
        return ClassicLine("init", span_of(children), nodes(children))

    def trans_line(self, children: Children) -> ClassicLine:
        return ClassicLine("trans", span_of(children), nodes(children))

    def edge(self, children: Children) -> ast.EdgeDeclaration:
        source, arrow, target, _, *clauses, _ = children
        return ast.EdgeDeclaration(
            span_of(children),
            ast.Identifier(source.span, source.text) if source is not None else None,
            target,
            controllable=arrow.text == "->",
            doc=source.doc if source is not None else arrow.doc,
            **clauses_of(only(clauses, WrittenClause)),
        )

    def outgoing(self, children: Children) -> ast.EdgeDeclaration:
        uncontrollable, keyword, target, *rest = children
        return ast.EdgeDeclaration(
            span_of(children),
            None,
            target,
            controllable=uncontrollable is None,
            doc=(uncontrollable or keyword).doc,
            **clauses_of(only(rest, WrittenClause)),
        )

    def flag(self, children: Children) -> Token:
        token: Token = children[0]
        return token

    def location(self, children: Children) -> ast.LocationDeclaration:
        flags = [child for child in children if isinstance(child, Token) and child.type.endswith("_FLAG")]
        words = [flag.text for flag in flags]
        for place, flag in enumerate(flags):
            if flag.text in words[:place]:
                raise Misplaced(Diagnostic("E0107", f"'{flag.text}' is written twice", flag.span, "remove one"))
        name = next(child for child in children if isinstance(child, ast.Identifier))
        given: dict[str, Any] = {}
        for clause in only(children, WrittenClause):
            if clause.kind in given:
                raise Misplaced(
                    Diagnostic(
                        "E0107",
                        f"location '{name.name}' has two '{clause.kind}' clauses",
                        clause.span,
                        "join them with &&" if clause.kind == "invariant" else "remove one",
                    )
                )
            given[clause.kind] = clause.value
        rate, divisor = given.get("exponential_rate", (None, None))
        return ast.LocationDeclaration(
            span_of(children),
            name,
            given.get("invariant"),
            rate,
            "init" in words,
            "urgent" in words,
            "committed" in words,
            only(children, ast.EdgeDeclaration),
            children[0].doc,
            divisor,
        )

    def branchpoint(self, children: Children) -> ast.Branchpoint:
        return ast.Branchpoint(span_of(children), children[1], only(children, ast.EdgeDeclaration))

    def _clause(self, children: Children) -> WrittenClause:
        return WrittenClause(children[0].text, span_of(children), children[1])

    def exponential_rate(self, children: Children) -> WrittenClause:
        keyword, rate, _, divisor, _ = children
        return WrittenClause(keyword.text, span_of(children), (rate, divisor))

    invariant = select = guard = sync = assign = probability = _clause

    def bindings(self, children: Children) -> ListOf:
        return ListOf(nodes(children))

    def binding(self, children: Children) -> ast.SelectBinding:
        return ast.SelectBinding(span_of(children), children[0], children[2])

    def synchronisation(self, children: Children) -> ast.SynchronisationLabel:
        if len(children) == 1:
            return ast.SynchronisationLabel(children[0].span, children[0], None)
        channel, direction, value = children
        return ast.SynchronisationLabel(span_of(children), channel, Direction(direction.text), value)

    def conjunction_list(self, children: Children) -> Any:
        """Conjuncts separated by commas, as in UPPAAL 3.x."""
        return chain(BinaryOperator.AND, nodes(children))

    # ---- fragments ----

    def parameters_fragment(self, children: Children) -> tuple[Any, ...]:
        return tuple(children[0] or ())

    def select_fragment(self, children: Children) -> tuple[Any, ...]:
        return tuple(children[0] or ())

    def assignment_fragment(self, children: Children) -> tuple[Any, ...]:
        return tuple(children[0] or ())

    def constraint_fragment(self, children: Children) -> Any:
        return children[0]

    def rate_fragment(self, children: Children) -> Any:
        rate, _, divisor = children
        return None if rate is None else (rate, divisor)

    def synchronisation_fragment(self, children: Children) -> Any:
        return children[0]


def _identifiers(children: Children) -> tuple[ast.Identifier, ...]:
    return tuple(child for child in children if isinstance(child, ast.Identifier))


def _embedded(children: Children, place: int) -> ast.Statement:
    """The statement that another one consists of; an empty one where it was passed over after an error."""
    given: ast.Statement | None = children[place]
    return given if given is not None else ast.EmptyStatement(span_of(children[:place]))


def _outcome(expected: Token | ast.ConditionalExpectation) -> ast.Expected:
    return expected.text if isinstance(expected, Token) else expected
