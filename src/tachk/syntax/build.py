"""From what the grammar recognises to syntax tree nodes.

Each method is named after a rule (or its alias) of the grammar and gets everything the rule matched, tokens included.
Methods hold no state; a rule of the language that the grammar cannot express is enforced by raising `Misplaced`.
"""

from __future__ import annotations

import re
from typing import Any, TypeVar

from tachk.diagnostics.diagnostic import Diagnostic, Label
from tachk.diagnostics.span import Span
from tachk.syntax import ast
from tachk.syntax.build_template import Clause, Line, clauses_of, template
from tachk.syntax.chains import chain
from tachk.syntax.misplaced import Misplaced
from tachk.syntax.tokens import Token
from tachk.syntax.unchecked import unchecked_family

Children = list[Any]
T = TypeVar("T")

_SYMBOLIC = {"and": "&&", "or": "||", "not": "!", ":=": "="}
_TYPE_NAMES = ("double", "string")


def _only(children: Children, kind: type[T]) -> tuple[T, ...]:
    return tuple(child for child in children if isinstance(child, kind))


def _nodes(children: Children) -> tuple[Any, ...]:
    return tuple(child for child in children if isinstance(child, ast.Node))


def _span(children: Children) -> Span:
    """From the first to the last thing a rule matched."""
    first = next(child for child in children if child is not None)
    last = next(child for child in reversed(children) if child is not None)
    start: Span = first.span
    return Span(start.source, start.start, last.span.end)


class _List(tuple[Any, ...]):
    """A non-empty list with the place it spans."""

    __slots__ = ()

    @property
    def span(self) -> Span:
        return _span(list(self))


class Builder:
    """The callbacks of the grammar's rules."""

    # ---- expressions ----

    def name(self, children: Children) -> ast.Identifier:
        token = children[0]
        return ast.Identifier(token.span, token.text)

    def name_expression(self, children: Children) -> ast.NameExpression:
        token = children[0]
        return ast.NameExpression(token.span, token.text)

    def integer(self, children: Children) -> ast.IntegerLiteral:
        return ast.IntegerLiteral(children[0].span, int(children[0].text))

    def float(self, children: Children) -> ast.FloatLiteral:
        return ast.FloatLiteral(children[0].span, children[0].text)

    def string(self, children: Children) -> ast.StringLiteral:
        return ast.StringLiteral(children[0].span, children[0].text[1:-1])

    def boolean(self, children: Children) -> ast.BooleanLiteral:
        return ast.BooleanLiteral(children[0].span, children[0].text == "true")

    def deadlock(self, children: Children) -> ast.DeadlockExpression:
        return ast.DeadlockExpression(children[0].span)

    def parenthesised(self, children: Children) -> Any:
        """The expression itself, its place widened by the parentheses."""
        inner = children[1]
        fields = [getattr(inner, name) for name in inner.__dataclass_fields__ if name != "span"]
        return type(inner)(_span(children), *fields)

    def assignment(self, children: Children) -> ast.AssignmentExpression:
        target, operator, value = children
        return ast.AssignmentExpression(_span(children), _SYMBOLIC.get(operator.text, operator.text), target, value)

    def conditional(self, children: Children) -> ast.ConditionalExpression:
        return ast.ConditionalExpression(_span(children), children[0], children[2], children[4])

    def binary(self, children: Children) -> Any:
        """Operands with operators between them, which bind equally and to the left."""
        operands = [children[0]]
        joined = _SYMBOLIC.get(children[1].text, children[1].text)
        for operator, operand in zip(children[1::2], children[2::2], strict=True):
            symbol = _SYMBOLIC.get(operator.text, operator.text)
            if symbol != joined:
                operands = [chain(joined, operands)]
                joined = symbol
            operands.append(operand)
        return chain(joined, operands)

    def unary(self, children: Children) -> ast.UnaryExpression:
        operator = children[0].text
        return ast.UnaryExpression(_span(children), _SYMBOLIC.get(operator, operator), children[1])

    def increment_before(self, children: Children) -> ast.IncrementExpression:
        return ast.IncrementExpression(_span(children), children[0].text, True, children[1])

    def increment_after(self, children: Children) -> ast.IncrementExpression:
        return ast.IncrementExpression(_span(children), children[1].text, False, children[0])

    def quantifier(self, children: Children) -> ast.QuantifierExpression:
        kind, _, variable, _, type_, _, body = children
        return ast.QuantifierExpression(_span(children), kind.text, variable, type_, body)

    def spawn(self, children: Children) -> ast.SpawnExpression:
        return ast.SpawnExpression(_span(children), children[1], tuple(children[3] or ()))

    def index(self, children: Children) -> ast.IndexExpression:
        return ast.IndexExpression(_span(children), children[0], children[2])

    def call(self, children: Children) -> ast.CallExpression:
        return ast.CallExpression(_span(children), children[0], tuple(children[2] or ()))

    def member(self, children: Children) -> ast.MemberExpression:
        return ast.MemberExpression(_span(children), children[0], children[2])

    def rate(self, children: Children) -> ast.RateExpression:
        return ast.RateExpression(_span(children), children[0])

    def arguments(self, children: Children) -> _List:
        return _List(_nodes(children))

    # ---- types and variables ----

    def prefix(self, children: Children) -> Token:
        token: Token = children[0]
        return token

    def type(self, children: Children) -> ast.TypeExpression:
        *prefixes, base = children
        return ast.TypeExpression(_span(children), tuple(prefix.text for prefix in prefixes), base)

    def builtin_type(self, children: Children) -> ast.BuiltinType:
        return ast.BuiltinType(children[0].span, children[0].text)

    def range_type(self, children: Children) -> ast.RangeType:
        return ast.RangeType(_span(children), children[2], children[4])

    def scalar_type(self, children: Children) -> ast.ScalarSetType:
        return ast.ScalarSetType(_span(children), children[2])

    def struct_type(self, children: Children) -> ast.StructType:
        return ast.StructType(_span(children), _only(children, ast.VariableDeclaration))

    def named_type(self, children: Children) -> ast.NamedType | ast.BuiltinType:
        token = children[0]
        if token.text in _TYPE_NAMES:
            return ast.BuiltinType(token.span, token.text)
        return ast.NamedType(token.span, token.text)

    def index_type(self, children: Children) -> ast.TypeExpression:
        base = self.range_type(children) if children[0].type == "INT" else self.scalar_type(children)
        return ast.TypeExpression(base.span, (), base)

    def dimension(self, children: Children) -> Any:
        return children[1]

    def declarator(self, children: Children) -> ast.Declarator:
        name, *dimensions, _, initialiser = children
        return ast.Declarator(_span(children), name, tuple(dimensions), initialiser)

    def initialiser_list(self, children: Children) -> ast.InitialiserList:
        return ast.InitialiserList(_span(children), tuple(_only(children, _InitialiserItem)))

    def initialiser_item(self, children: Children) -> _InitialiserItem:
        return _InitialiserItem((children[0], children[2]))

    def variables(self, children: Children) -> ast.VariableDeclaration:
        return ast.VariableDeclaration(_span(children), children[0], _only(children, ast.Declarator))

    def typedef(self, children: Children) -> ast.TypedefDeclaration:
        return ast.TypedefDeclaration(_span(children), children[1], _only(children, ast.Declarator))

    def legacy_constants(self, children: Children) -> ast.VariableDeclaration:
        return ast.VariableDeclaration(_span(children), None, _only(children, ast.Declarator))

    def legacy_constant(self, children: Children) -> ast.Declarator:
        return self.declarator(children)

    def parameters(self, children: Children) -> _List:
        collected: list[ast.Parameter] = []
        for child in children:
            if isinstance(child, ast.Parameter):
                collected.append(child)
            elif isinstance(child, _ParameterContinued):
                type_ = collected[-1].type
                collected.append(ast.Parameter(child.name.span, type_, True, child.name, child.dimensions))
        return _List(collected)

    def parameter(self, children: Children) -> ast.Parameter:
        type_, ampersand, name, *dimensions = children
        return ast.Parameter(_span(children), type_, ampersand is not None, name, tuple(dimensions))

    def legacy_const_parameter(self, children: Children) -> ast.Parameter:
        const, name, *dimensions = children
        type_ = ast.TypeExpression(const.span, ("const",), ast.BuiltinType(const.span, "int"))
        return ast.Parameter(_span(children), type_, False, name, tuple(dimensions))

    def legacy_parameter(self, children: Children) -> _ParameterContinued:
        token, *dimensions = children
        return _ParameterContinued(ast.Identifier(token.span, token.text), tuple(dimensions))

    # ---- functions and statements ----

    def function(self, children: Children) -> ast.FunctionDeclaration:
        result, name, _, parameters, _, body = children
        return ast.FunctionDeclaration(_span(children), result, name, tuple(parameters or ()), body)

    def block(self, children: Children) -> ast.BlockStatement:
        declarations: list[Any] = []
        statements: list[Any] = []
        for child in _nodes(children):
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
        return ast.BlockStatement(_span(children), tuple(declarations), tuple(statements))

    def expression_statement(self, children: Children) -> ast.ExpressionStatement:
        return ast.ExpressionStatement(_span(children), children[0])

    def empty_statement(self, children: Children) -> ast.EmptyStatement:
        return ast.EmptyStatement(children[0].span)

    def if_statement(self, children: Children) -> ast.IfStatement:
        return ast.IfStatement(_span(children), children[2], children[4], children[6])

    def while_statement(self, children: Children) -> ast.WhileStatement:
        return ast.WhileStatement(_span(children), children[2], children[4])

    def do_statement(self, children: Children) -> ast.DoStatement:
        return ast.DoStatement(_span(children), children[1], children[4])

    def for_statement(self, children: Children) -> ast.ForStatement:
        _, _, initial, _, condition, _, step, _, body = children
        return ast.ForStatement(_span(children), tuple(initial or ()), tuple(condition or ()), tuple(step or ()), body)

    def iteration_statement(self, children: Children) -> ast.IterationStatement:
        return ast.IterationStatement(_span(children), children[2], children[4], children[6])

    def return_statement(self, children: Children) -> ast.ReturnStatement:
        return ast.ReturnStatement(_span(children), children[1])

    def assert_statement(self, children: Children) -> ast.AssertStatement:
        return ast.AssertStatement(_span(children), children[1])

    def skipped(self, children: Children) -> None:
        """Text passed over after an error leaves nothing behind."""

    # ---- declarations and the system section ----

    def document(self, children: Children) -> tuple[Any, ...]:
        return _nodes(children)

    def declarations_fragment(self, children: Children) -> tuple[Any, ...]:
        return _nodes(children)

    def stray_semicolon(self, children: Children) -> None:
        """``;`` alone: legal in XTA, means nothing."""

    def channel_priority(self, children: Children) -> ast.ChannelPriorityDeclaration:
        return ast.ChannelPriorityDeclaration(_span(children), tuple(tuple(g) for g in _only(children, _List)))

    def channel_group(self, children: Children) -> _List:
        return _List(_nodes(children))

    def update_hook(self, children: Children) -> ast.UpdateHook:
        return ast.UpdateHook(_span(children), children[0].text, tuple(children[2] or ()))

    def foreign_import(self, children: Children) -> ast.ForeignImport:
        return ast.ForeignImport(_span(children), children[1].text[1:-1])

    def signal(self, children: Children) -> ast.SignalDeclaration:
        return ast.SignalDeclaration(_span(children), children[1], children[3], children[0].doc)

    def instantiation(self, children: Children) -> ast.Instantiation:
        name = children[0]
        if isinstance(children[1], Token) and children[1].type == "EQUALS":
            parameters, template_name, arguments = None, children[2], children[4]
        else:
            parameters, template_name, arguments = children[2], children[5], children[7]
        return ast.Instantiation(_span(children), name, tuple(parameters or ()), template_name, tuple(arguments or ()))

    def process_group(self, children: Children) -> _List:
        return _List(_nodes(children))

    def system_line(self, children: Children) -> ast.SystemLine:
        return ast.SystemLine(_span(children), tuple(tuple(group) for group in _only(children, _List)))

    def dynamic_template(self, children: Children) -> ast.DynamicTemplate:
        return ast.DynamicTemplate(_span(children), children[1], tuple(children[3] or ()))

    def progress_measure(self, children: Children) -> ast.ProgressMeasure:
        return ast.ProgressMeasure(_span(children), children[0], children[2])

    def progress(self, children: Children) -> ast.ProgressDeclaration:
        return ast.ProgressDeclaration(_span(children), _nodes(children))

    def gantt(self, children: Children) -> ast.GanttDeclaration:
        return ast.GanttDeclaration(_span(children), children[1].text)

    def import_file(self, children: Children) -> ast.ImportDeclaration:
        return ast.ImportDeclaration(_span(children), children[1].text[1:-1])

    def time_unit(self, children: Children) -> ast.TimeUnitDeclaration:
        return ast.TimeUnitDeclaration(_span(children), int(children[2].text), children[3].text)

    # ---- queries and properties ----

    def path_formula(self, children: Children) -> ast.QueryFormula:
        return ast.QueryFormula(_span(children), children[0].text, children[1])

    def leads_to(self, children: Children) -> ast.QueryFormula:
        return ast.QueryFormula(_span(children), "-->", children[0], (children[2],))

    def extreme_values(self, children: Children) -> ast.QueryFormula:
        kind, _, predicate, _, _, operands = children
        return ast.QueryFormula(_span(children), kind.text, predicate, tuple(operands))

    def unchecked(self, children: Children) -> ast.UncheckedFormula:
        token = children[0]
        family = unchecked_family(re.findall(r"\w+|\S", token.text)) or "statistical"
        return ast.UncheckedFormula(token.span, token.text, family)

    def query(self, children: Children) -> ast.QueryEntry:
        formula, _, outcome = children
        return ast.QueryEntry(_span(children), formula, "", outcome.text if outcome is not None else None)

    def property(self, children: Children) -> ast.PropertyDeclaration:
        keyword, name, title, _, entry, _ = children
        return ast.PropertyDeclaration(
            _span(children),
            name,
            title.text[1:-1] if title is not None else "",
            entry.formula,
            entry.expectation,
            keyword.doc,
        )

    # ---- templates ----

    def process(self, children: Children) -> ast.Template:
        keyword, name, _, parameters, _, _, *body = children[:-1]
        items = [child for child in body if child is not None]
        return template(_span(children), keyword.doc, name, tuple(parameters or ()), items)

    def state(self, children: Children) -> ast.LocationDeclaration:
        token, _, invariant, _, rate, _, divisor, _ = children
        identifier = ast.Identifier(token.span, token.text)
        return ast.LocationDeclaration(
            _span(children), identifier, invariant, rate, doc=token.doc, rate_divisor=divisor
        )

    def state_line(self, children: Children) -> Line:
        return Line("state", _span(children), _nodes(children))

    def branchpoint_line(self, children: Children) -> Line:
        return Line("branchpoint", _span(children), _nodes(children))

    def commit_line(self, children: Children) -> Line:
        return Line("commit", _span(children), _nodes(children))

    def urgent_line(self, children: Children) -> Line:
        return Line("urgent", _span(children), _nodes(children))

    def init_line(self, children: Children) -> Line:
        return Line("init", _span(children), _nodes(children))

    def trans_line(self, children: Children) -> Line:
        return Line("trans", _span(children), _nodes(children))

    def edge(self, children: Children) -> ast.EdgeDeclaration:
        source, arrow, target, _, *clauses, _ = children
        return ast.EdgeDeclaration(
            _span(children),
            ast.Identifier(source.span, source.text) if source is not None else None,
            target,
            controllable=arrow.text == "->",
            doc=source.doc if source is not None else arrow.doc,
            **clauses_of(_only(clauses, Clause)),
        )

    def outgoing(self, children: Children) -> ast.EdgeDeclaration:
        uncontrollable, keyword, target, *rest = children
        return ast.EdgeDeclaration(
            _span(children),
            None,
            target,
            controllable=uncontrollable is None,
            doc=(uncontrollable or keyword).doc,
            **clauses_of(_only(rest, Clause)),
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
        for clause in _only(children, Clause):
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
            _span(children),
            name,
            given.get("invariant"),
            rate,
            "init" in words,
            "urgent" in words,
            "committed" in words,
            _only(children, ast.EdgeDeclaration),
            children[0].doc,
            divisor,
        )

    def branchpoint(self, children: Children) -> ast.Branchpoint:
        return ast.Branchpoint(_span(children), children[1], _only(children, ast.EdgeDeclaration))

    def _clause(self, children: Children) -> Clause:
        return Clause(children[0].text, _span(children), children[1])

    def exponential_rate(self, children: Children) -> Clause:
        keyword, rate, _, divisor, _ = children
        return Clause(keyword.text, _span(children), (rate, divisor))

    invariant = select = guard = sync = assign = probability = _clause

    def bindings(self, children: Children) -> _List:
        return _List(_nodes(children))

    def binding(self, children: Children) -> ast.SelectBinding:
        return ast.SelectBinding(_span(children), children[0], children[2])

    def synchronisation(self, children: Children) -> ast.SynchronisationLabel:
        if len(children) == 1:
            return ast.SynchronisationLabel(children[0].span, children[0], "")
        channel, direction, value = children
        return ast.SynchronisationLabel(_span(children), channel, direction.text, value)

    def conjunction_list(self, children: Children) -> Any:
        """Conjuncts separated by commas, as in UPPAAL 3.x."""
        return chain("&&", _nodes(children))

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
        return children[0]

    def synchronisation_fragment(self, children: Children) -> Any:
        return children[0]


class _InitialiserItem(tuple[Any, Any]):
    """A designator or None, and the value."""

    __slots__ = ()

    @property
    def span(self) -> Span:
        return _span(list(self))


class _ParameterContinued:
    """A further name after ``int a`` in a parameter list of UPPAAL 3.x."""

    __slots__ = ("dimensions", "name")

    def __init__(self, name: ast.Identifier, dimensions: tuple[Any, ...]) -> None:
        self.name = name
        self.dimensions = dimensions
