"""From a formula over the columns of a trace to the program that monitors run.

Connectives inside atoms become nodes like those of the formula; implication, exclusive or, comparison of two
conditions and weak until are written out in simpler operators; what occurs twice is computed once.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import lcm

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, InternalError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.operators import COMPARISONS, CONNECTIVES, BinaryOperator, PrefixOperator
from tachk.base.span import Span
from tachk.recordings.monitors.texts import Texts
from tachk.recordings.traces.arrivals import arrivals_of
from tachk.recordings.traces.monitor_program import (
    UNBOUNDED,
    AtomRelation,
    MonitorAtom,
    MonitorNode,
    MonitorProgram,
    NodeKind,
    ValueInstruction,
    ValueOperator,
)
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tachk.syntax.chains import LONGEST_FROM_LEFT
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.printing.expression_printer import print_expression, quoted
from tachk.syntax.walk import nodes_of_kind

LAST_TICK = 2**58
"""The durations of a formula add up to less than this number of ticks."""

RELATIONS = {each: AtomRelation[each.name] for each in COMPARISONS}
ARITHMETIC = {each: ValueOperator[each.name] for each in BinaryOperator if each.name in ValueOperator.__members__}
EXTREMES = {"min": ValueOperator.MINIMUM, "max": ValueOperator.MAXIMUM}
COLUMN_NAMES = (ast.NameExpression, ast.MemberExpression, ast.IndexExpression)


def compile(
    formula: syntax.Formula,
    columns: Collection[str],
    ticks_per_unit: int,
    *,
    booleans: Collection[str] | None = None,
    texts: Texts | None = None,
) -> MonitorProgram:
    """The monitor of a formula whose durations are numbers, in time units of the trace.

    Args:
        columns: the names that the formula may use.
        ticks_per_unit: how many ticks make one time unit of the trace.
        booleans: the columns that hold truth values, if that is known: `a == b` of two such columns has infinite
            robustness, and one of them compared with a number is a number. Without it a column that is compared with a
            condition is taken for a truth value, any other one for a number.
        texts: the columns that hold texts; None: those are not known that are not compared with a text.

    Raises:
        InputError: unknown columns, constructs without meaning on traces, durations that are not whole ticks.
    """
    compiler = _Compiler(columns, ticks_per_unit, booleans, texts)
    compiler.formula(formula)
    if sum(max(node.lower, node.upper) for node in compiler.nodes) >= LAST_TICK:
        message = f"the durations of this formula add up to more than 2**58 ticks, {ticks_per_unit} to a time unit"
        compiler.findings.append(Diagnostic("E0903", message, formula.span))
    if compiler.findings:
        raise InputError(compiler.findings)
    return MonitorProgram(
        tuple(compiler.column_numbers), tuple(compiler.atoms), tuple(compiler.nodes), compiler.ticks_per_unit
    )


def ticks_needed(formula: syntax.Formula) -> int:
    """The smallest number of ticks in a time unit for which every duration is a whole number of ticks."""
    durations = nodes_of_kind(formula, syntax.Duration)
    return lcm(*(_number(duration).denominator for duration in durations))


def columns_read(formula: syntax.Formula) -> frozenset[str]:
    """The names of the columns that a formula speaks about, known or not."""
    return frozenset(name for atom in nodes_of_kind(formula, syntax.Atom, syntax.Change) for name in _names(atom))


def changed_columns(formulas: Collection[syntax.Formula]) -> frozenset[str]:
    """The columns of which formulas say only that they change: they may hold numbers or texts."""
    changes = [change for formula in formulas for change in nodes_of_kind(formula, syntax.Change)]
    others: list[object] = [atom for formula in formulas for atom in nodes_of_kind(formula, syntax.Atom)]
    others += [change for change in changes if not isinstance(change.expression, COLUMN_NAMES)]
    bare = {column_name(each.expression) for each in changes if isinstance(each.expression, COLUMN_NAMES)}
    return frozenset(bare.difference(name for other in others for name in _names(other)))


def _names(node: object) -> Iterator[str]:
    """Members and elements count as a whole, so that `P.loc` does not name `P`."""
    inside: set[int] = set()
    inside.update(id(call.function) for call in nodes_of_kind(node, ast.CallExpression))
    for call in nodes_of_kind(node, ast.CallExpression):
        if (argument := arrival_argument(call)) is not None:
            inside.update(id(part) for part in nodes_of_kind(call, *COLUMN_NAMES))
            yield arrivals_of(column_name(argument))
    for expression in nodes_of_kind(node, *COLUMN_NAMES):
        if id(expression) not in inside:
            inside.update(id(part) for part in nodes_of_kind(expression, *COLUMN_NAMES))
            yield column_name(expression)


def arrival_argument(
    expression: ast.Expression,
) -> ast.NameExpression | ast.MemberExpression | ast.IndexExpression | None:
    """The column of ``arrived(hb)``; None for other expressions."""
    match expression:
        case ast.CallExpression(function=ast.NameExpression(name="arrived"), arguments=(argument,)):
            return argument if isinstance(argument, COLUMN_NAMES) else None
        case _:
            return None


def column_name(expression: ast.NameExpression | ast.MemberExpression | ast.IndexExpression) -> str:
    """The name of the column that an expression stands for."""
    return expression.name if isinstance(expression, ast.NameExpression) else print_expression(expression)


def _number(duration: syntax.Duration) -> Fraction:
    if duration.unit or not isinstance(duration.value, Fraction):
        raise InternalError("durations have to be numbers in the unit of the trace before a formula is compiled")
    return duration.value


_EQUALITIES = (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL)


class _NotCompiled(Exception):
    """A part of the formula has been reported."""


@dataclass(slots=True)
class _Compiler:
    columns: Collection[str]
    ticks_per_unit: int
    booleans: Collection[str] | None
    texts: Texts | None
    column_numbers: dict[str, int] = field(default_factory=dict)
    atoms: dict[MonitorAtom, int] = field(default_factory=dict)
    nodes: list[MonitorNode] = field(default_factory=list)
    numbers: dict[tuple[object, ...], int] = field(default_factory=dict)
    findings: list[Diagnostic] = field(default_factory=list)

    def formula(self, formula: syntax.Formula) -> int:
        """The number of the node of a formula. After a finding the number of some node."""
        text = print_formula(formula)
        match formula:
            case syntax.TruthConstant(value=value):
                return self._truth(value)
            case syntax.Atom(expression=expression):
                return self._reported(lambda: self.condition(expression))
            case syntax.Change(expression=expression):
                return self._reported(lambda: self._change(expression, text))
            case syntax.Not(operand=operand):
                return self._node(NodeKind.NOT, text, self.formula(operand))
            case syntax.And(operands=operands):
                return self._node(NodeKind.AND, text, *[self.formula(operand) for operand in operands])
            case syntax.Or(operands=operands):
                return self._node(NodeKind.OR, text, *[self.formula(operand) for operand in operands])
            case syntax.Implies(left=left, right=right):
                return self._implication(text, self.formula(left), self.formula(right))
            case syntax.Rise(operand=operand):
                return self._node(NodeKind.RISE, text, self.formula(operand))
            case syntax.Fall(operand=operand):
                return self._node(NodeKind.FALL, text, self.formula(operand))
            case syntax.Eventually(interval=interval, operand=operand):
                return self._temporal(NodeKind.EVENTUALLY, text, interval, self.formula(operand))
            case syntax.Always(interval=interval, operand=operand):
                return self._temporal(NodeKind.ALWAYS, text, interval, self.formula(operand))
            case syntax.Once(interval=interval, operand=operand):
                return self._temporal(NodeKind.ONCE, text, interval, self.formula(operand))
            case syntax.Historically(interval=interval, operand=operand):
                return self._temporal(NodeKind.HISTORICALLY, text, interval, self.formula(operand))
            case syntax.Until(interval=interval, left=left, right=right):
                return self._temporal(NodeKind.UNTIL, text, interval, self.formula(left), self.formula(right))
            case syntax.Since(interval=interval, left=left, right=right):
                return self._temporal(NodeKind.SINCE, text, interval, self.formula(left), self.formula(right))
            case syntax.WeakUntil(left=left, right=right):
                first, second = self.formula(left), self.formula(right)
                until = self._node(NodeKind.UNTIL, text, first, second)
                return self._node(NodeKind.OR, text, until, self._node(NodeKind.ALWAYS, text, first))

    def condition(self, expression: ast.Expression, shown: str | None = None) -> int:
        """The number of the node of a condition on one state, which reports show as it is written or as given."""
        text = shown or print_expression(expression)
        match expression:
            case ast.BooleanLiteral(value=value):
                return self._truth(value)
            case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
                return self._node(NodeKind.NOT, text, self.condition(operand))
            case ast.BinaryExpression(operator=operator) if operator in CONNECTIVES:
                return self._joined(expression, text)
            case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in RELATIONS and (
                self._is_text(left) or self._is_text(right)
            ):
                differs = self._differing_texts(expression, left, right)
                return differs if operator == BinaryOperator.NOT_EQUAL else self._node(NodeKind.NOT, text, differs)
            case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in RELATIONS:
                self._refuse_bare_text(operator, left, right)
                if operator in {BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL} and self._compares_truth(left, right):
                    first = self.condition(left, _end_of_chain(left))
                    same = self._equivalence(text, first, self.condition(right))
                    return same if operator == BinaryOperator.EQUAL else self._negation(same)
                self._refuse_chain(expression, left, right)
                return self._atom(MonitorAtom(RELATIONS[operator], self._value(left), self._value(right), text))
            case _:
                if (argument := arrival_argument(expression)) is not None:
                    return self._arrival(expression.span, argument)
                code = self._value(expression)
                if not isinstance(expression, (*COLUMN_NAMES, ast.IntegerLiteral)):
                    message = f"{quoted(expression)} is a number, not a condition"
                    help_ = f"compare it, as in {quoted(expression)[:-1]} > 0`"
                    raise self._report("E0902", message, expression.span, help_)
                return self._atom(MonitorAtom(AtomRelation.TRUTH, code, (), text))

    def _joined(self, whole: ast.BinaryExpression, text: str) -> int:
        """The node of conditions joined by connectives, link by link of a chain; the links of a long one are shown
        without what stands before them, for all their texts would be as long as its square."""
        links: list[ast.BinaryExpression] = []
        first: ast.Expression = whole
        while isinstance(first, ast.BinaryExpression) and first.operator.level == whole.operator.level:
            links.append(first)
            first = first.left
        joined = self.condition(first)
        for link in reversed(links):
            if link is whole:
                shown = text
            elif len(links) <= LONGEST_FROM_LEFT:
                shown = print_expression(link)
            else:
                shown = f"... {link.operator} {print_expression(link.right)}"
            joined = self._link(link.operator, shown, joined, self.condition(link.right))
        return joined

    def _link(self, operator: BinaryOperator, text: str, first: int, second: int) -> int:
        match operator:
            case BinaryOperator.AND:
                return self._node(NodeKind.AND, text, first, second)
            case BinaryOperator.OR:
                return self._node(NodeKind.OR, text, first, second)
            case BinaryOperator.IMPLY:
                return self._implication(text, first, second)
            case BinaryOperator.XOR:
                return self._negation(self._equivalence(text, first, second))
            case _:
                raise InternalError(f"monitors do not know the connective {operator}")

    def _is_text(self, expression: ast.Expression) -> bool:
        if isinstance(expression, COLUMN_NAMES):
            return self.texts is not None and column_name(expression) in self.texts.columns
        return isinstance(expression, ast.StringLiteral)

    def _differing_texts(self, whole: ast.BinaryExpression, left: ast.Expression, right: ast.Expression) -> int:
        """The node of `left != right` of texts: their numbers differ. The robustness is infinite, as of all truth."""
        if whole.operator not in _EQUALITIES:
            raise self._report("E0902", f"{quoted(whole)}: texts have no order", whole.span, "use == or !=")
        code = (*self._text_number(left), *self._text_number(right), ValueInstruction(ValueOperator.SUBTRACT))
        text = print_expression(replace(whole, operator=BinaryOperator.NOT_EQUAL))
        return self._atom(MonitorAtom(AtomRelation.TRUTH, code, (), text))

    def _text_number(self, side: ast.Expression) -> tuple[ValueInstruction, ...]:
        """The number of a text; of one that does not occur on the trace -1."""
        if isinstance(side, ast.StringLiteral):
            labels = () if self.texts is None else self.texts.labels
            number = labels.index(side.value) if side.value in labels else -1
            return (ValueInstruction(ValueOperator.CONSTANT, float(number)),)
        if isinstance(side, COLUMN_NAMES) and (self.texts is None or self._is_text(side)):
            return (ValueInstruction(ValueOperator.COLUMN, float(self._column(side))),)
        if isinstance(side, COLUMN_NAMES):
            self._column(side)  # reported if it is not there at all
        message = f"{quoted(side)} is not a text, and cannot be compared with one"
        raise self._report("E0902", message, side.span, None)

    def _change(self, expression: ast.Expression, text: str) -> int:
        """A condition changes where it or its negation falls; anything else where its value becomes another."""
        if is_condition(expression):
            changing = self.condition(expression)
            return self._node(
                NodeKind.OR,
                text,
                self._node(NodeKind.FALL, text, changing),
                self._node(NodeKind.FALL, text, self._negation(changing)),
            )
        value = self._text_number(expression) if self._is_text(expression) else self._value(expression)
        atom = MonitorAtom(AtomRelation.TRUTH, value, (), print_expression(expression))
        return self._node(NodeKind.CHANGE, text, atom=self._atom_number(atom))

    def _arrival(
        self,
        place: Span,
        argument: ast.NameExpression | ast.MemberExpression | ast.IndexExpression,
    ) -> int:
        """Something arrives where the number of arrivals changes, or at the beginning: see
        `tachk.recordings.traces.arrivals`.
        """
        topic = column_name(argument)
        name = arrivals_of(topic)
        if name not in self.columns:
            help_ = did_you_mean(topic, self.columns) or f"the columns are: {', '.join(self.columns) or 'none'}"
            raise self._report("E0901", f"the trace does not show when `{topic}` arrives", place, help_)
        number = self.column_numbers.setdefault(name, len(self.column_numbers))
        count = (ValueInstruction(ValueOperator.COLUMN, float(number)),)
        zero = (ValueInstruction(ValueOperator.CONSTANT, 0.0),)
        changes = self._node(
            NodeKind.CHANGE, name, atom=self._atom_number(MonitorAtom(AtomRelation.TRUTH, count, (), name))
        )
        begins = self._node(NodeKind.RISE, "rise(true)", self._truth(True))
        at_once = self._atom(MonitorAtom(AtomRelation.LESS, count, zero, f"{name} at the beginning"))
        return self._node(NodeKind.OR, name, changes, self._node(NodeKind.AND, name, begins, at_once))

    def _compares_truth(self, left: ast.Expression, right: ast.Expression) -> bool:
        return (is_condition(left) or is_condition(right) or self.booleans is not None) and all(
            is_condition(side) or self._may_be_boolean(side) for side in (left, right)
        )

    def _may_be_boolean(self, expression: ast.Expression) -> bool:
        return isinstance(expression, COLUMN_NAMES) and (
            self.booleans is None or column_name(expression) in self.booleans
        )

    def _refuse_bare_text(self, operator: BinaryOperator, left: ast.Expression, right: ast.Expression) -> None:
        """``state == idle``, where `idle` is not a column."""
        for side, other in ((left, right), (right, left)):
            if operator not in _EQUALITIES or not isinstance(side, ast.NameExpression) or side.name in self.columns:
                continue
            known = isinstance(other, COLUMN_NAMES) and column_name(other) in self.columns
            if known and did_you_mean(side.name, self.columns) is None:
                help_ = f'if it is a text, write "{side.name}"; the columns are: {", ".join(self.columns)}'
                raise self._report("E0901", f"the trace has no column `{side.name}`", side.span, help_)

    def _refuse_chain(self, whole: ast.Expression, left: ast.Expression, right: ast.Expression) -> None:
        for side in (left, right):
            if isinstance(side, ast.BinaryExpression) and side.operator in RELATIONS:
                message = f"{quoted(whole)} compares the truth of a comparison"
                help = "join two comparisons with `&&`, as in `0 < x && x < 5`"
                raise self._report("E0904", message, whole.span, help)

    def _value(self, expression: ast.Expression) -> tuple[ValueInstruction, ...]:
        """Instructions that leave the value of an expression."""
        match expression:
            case ast.NameExpression() | ast.MemberExpression() | ast.IndexExpression():
                if self._is_text(expression):
                    message = f"{quoted(expression)} holds texts, not numbers"
                    help_ = f'compare it, as in `{print_expression(expression)} == "ready"`'
                    raise self._report("E0902", message, expression.span, help_)
                return (ValueInstruction(ValueOperator.COLUMN, float(self._column(expression))),)
            case ast.IntegerLiteral(value=value) | ast.BooleanLiteral(value=value):
                return (ValueInstruction(ValueOperator.CONSTANT, float(value)),)
            case ast.FloatLiteral(text=text):
                return (ValueInstruction(ValueOperator.CONSTANT, float(text)),)
            case ast.UnaryExpression(operator=PrefixOperator.PLUS, operand=operand):
                return self._value(operand)
            case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
                return (*self._value(operand), ValueInstruction(ValueOperator.NEGATE))
            case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in ARITHMETIC:
                return (*self._value(left), *self._value(right), ValueInstruction(ARITHMETIC[operator]))
            case ast.CallExpression(function=ast.NameExpression(name="abs"), arguments=(argument,)):
                return (*self._value(argument), ValueInstruction(ValueOperator.ABSOLUTE))
            case ast.CallExpression(
                function=ast.NameExpression(name="min" | "max" as name), arguments=(first, *others)
            ):
                code = list(self._value(first))
                for other in others:
                    code += [*self._value(other), ValueInstruction(EXTREMES[name])]
                return tuple(code)
            case _ if is_condition(expression):
                message = f"{quoted(expression)} is a condition, not a number"
                raise self._report("E0902", message, expression.span, None)
            case _:
                message = f"{quoted(expression)} has no meaning on a trace"
                raise self._report("E0902", message, expression.span, _hint(expression))

    def _column(self, expression: ast.NameExpression | ast.MemberExpression | ast.IndexExpression) -> int:
        name = column_name(expression)
        if name not in self.columns:
            at_t = name.removesuffix("[t]")
            help = f"write `{at_t}`: a name stands for the value at each instant" if at_t in self.columns else None
            help = help or did_you_mean(name, self.columns) or f"the columns are: {', '.join(self.columns) or 'none'}"
            raise self._report("E0901", f"the trace has no column `{name}`", expression.span, help)
        return self.column_numbers.setdefault(name, len(self.column_numbers))

    def _atom(self, atom: MonitorAtom) -> int:
        return self._node(NodeKind.ATOM, atom.text, atom=self._atom_number(atom))

    def _atom_number(self, atom: MonitorAtom) -> int:
        return self.atoms.setdefault(atom, len(self.atoms))

    def _truth(self, value: bool) -> int:
        return self._node(NodeKind.TRUE if value else NodeKind.FALSE, "true" if value else "false")

    def _negation(self, operand: int) -> int:
        return self._node(NodeKind.NOT, f"!({self.nodes[operand].text})", operand)

    def _implication(self, text: str, left: int, right: int) -> int:
        return self._node(NodeKind.OR, text, self._negation(left), right)

    def _equivalence(self, text: str, left: int, right: int) -> int:
        both = self._node(NodeKind.AND, text, left, right)
        return self._node(
            NodeKind.OR, text, both, self._node(NodeKind.AND, text, self._negation(left), self._negation(right))
        )

    def _temporal(self, kind: NodeKind, text: str, interval: syntax.Interval, *operands: int) -> int:
        upper = interval.upper
        return self._node(
            kind,
            text,
            *operands,
            lower=self._ticks(interval.lower),
            upper=UNBOUNDED if upper is None else self._ticks(upper),
            lower_closed=interval.lower_closed,
            upper_closed=interval.upper_closed or upper is None,
        )

    def _ticks(self, duration: syntax.Duration) -> int:
        ticks = _number(duration) * self.ticks_per_unit
        if ticks.denominator == 1 and ticks >= 0:
            return int(ticks)
        message = f"the duration {duration.value} is not representable with {self.ticks_per_unit} ticks in a time unit"
        self.findings.append(Diagnostic("E0903", message, duration.span))
        return 0

    def _node(
        self,
        kind: NodeKind,
        text: str,
        *operands: int,
        atom: int = -1,
        lower: int = 0,
        upper: int = UNBOUNDED,
        lower_closed: bool = True,
        upper_closed: bool = True,
    ) -> int:
        """The number of the node, which is the one made before if there is one like it."""
        key = (kind, operands, atom, lower, upper, lower_closed, upper_closed)
        if key not in self.numbers:
            self.numbers[key] = len(self.nodes)
            self.nodes.append(MonitorNode(kind, operands, atom, lower, upper, lower_closed, upper_closed, text))
        return self.numbers[key]

    def _reported(self, make: Callable[[], int]) -> int:
        try:
            return make()
        except _NotCompiled:
            return self._truth(False)

    def _report(self, code: str, message: str, span: Span, help: str | None) -> _NotCompiled:
        self.findings.append(Diagnostic(code, message, span, help))
        return _NotCompiled()


def is_condition(expression: ast.Expression) -> bool:
    """True if an expression is true or false by its form."""
    match expression:
        case ast.UnaryExpression(operator=operator):
            return operator == PrefixOperator.NOT
        case ast.BinaryExpression(operator=operator):
            return operator in CONNECTIVES or operator in RELATIONS
        case _:
            return isinstance(expression, ast.BooleanLiteral)


def _end_of_chain(expression: ast.Expression) -> str | None:
    """A long chain without what stands before its last link, for the texts of all links would be as long as its square.
    None for a short one."""
    inner: ast.Expression = expression
    for _ in range(LONGEST_FROM_LEFT):
        if not isinstance(inner, ast.BinaryExpression):
            return None
        inner = inner.left
    assert isinstance(expression, ast.BinaryExpression)
    return f"... {expression.operator} {print_expression(expression.right)}"


def _hint(expression: ast.Expression) -> str | None:
    match expression:
        case ast.ConditionalExpression():
            return "write the two cases with `&&` and `||`"
        case ast.CallExpression():
            return "the functions are abs, min and max"
        case ast.BinaryExpression(operator=BinaryOperator.BIT_AND):
            return "conditions are joined by &&"
        case ast.BinaryExpression(operator=BinaryOperator.BIT_OR):
            return "conditions are joined by ||"
        case _:
            return None
