"""Function declarations and statements."""

from __future__ import annotations

from typing import assert_never

from tachk.base.records import replace
from tachk.frontend.context import Context
from tachk.frontend.dropped import checked_part_of_update, declare_dropped_function
from tachk.frontend.expressions.initialisers import initialiser
from tachk.frontend.expressions.places import converted
from tachk.frontend.expressions.typed_expressions import comma, condition, expression, type_reader
from tachk.frontend.expressions.typing import can_assign, describe, is_data, is_integral
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.scope import BrokenSymbol, EmptyTypeSymbol, FunctionSymbol, Scope, Symbol, TypeSymbol, ValueSymbol
from tachk.model.expressions import (
    BOOL,
    Assert,
    Block,
    Constant,
    Declare,
    Evaluate,
    Expression,
    Function,
    If,
    Iterate,
    Reference,
    Return,
    Statement,
    Variable,
    VariableKind,
    While,
)
from tachk.model.floating import variable_type
from tachk.model.types import ScalarType, Type, VoidType
from tachk.syntax import ast


def declare_function(node: ast.FunctionDeclaration, scope: Scope, context: Context) -> None:
    """Elaborates a function and declares its name. A function whose only mistake is something that is refused is left
    out, so that only what calls it is refused."""
    found, own = context.findings, DiagnosticCollector()
    outer = context.in_function
    context.findings, context.in_function = own, True
    try:
        symbol = _function(node, scope, context)
    finally:
        context.findings, context.in_function = found, outer
    reasons = [diagnostic for diagnostic in own.sorted() if diagnostic.is_unsupported]
    if reasons and not own.has_mistakes:
        declare_dropped_function(node, reasons, scope, context)
        return
    found.extend(own.sorted())
    scope.declare(node.name, symbol, found)


def _function(node: ast.FunctionDeclaration, scope: Scope, context: Context) -> Symbol:
    reader = type_reader(scope, context)
    result = reader.type(node.result)
    parameters = [_parameter(p, scope, context) for p in node.parameters]
    broken = BrokenSymbol(node.name.span)
    if result is not None and not (isinstance(result, VoidType) or is_data(result)):
        context.error("E0315", node.result.span, f"a function cannot return a {describe(result)}")
        return broken
    function = _with_parameters(node, result, parameters, scope, context)
    if function is None:
        return broken
    context.record_function(function)
    scalars = _scalar_references(node, parameters)
    if scalars and not context.effects[function].writes:
        # Without side effects `const T&` means the same as a copy, and a copy takes any expression as its argument.
        copies = [replace(p, reference=False) if p in scalars else p for p in parameters if p is not None]
        function = _with_parameters(node, result, list(copies), scope, context)
        if function is None:
            return broken
        context.record_function(function)
    return FunctionSymbol(function, node.name.span)


def _scalar_references(node: ast.FunctionDeclaration, parameters: list[Variable | None]) -> set[Variable]:
    return {
        variable
        for variable, parameter in zip(parameters, node.parameters, strict=True)
        if variable is not None
        and parameter.reference
        and "const" in parameter.type.prefixes
        and (is_integral(variable.type) or isinstance(variable.type, ScalarType))
    }


def _parameter(node: ast.Parameter, scope: Scope, context: Context) -> Variable | None:
    written = type_reader(scope, context).parameter(node)
    if written is None:
        return None
    type_ = variable_type(written)
    if isinstance(type_, VoidType) or not (node.reference or is_data(type_)):
        context.error(
            "E0315",
            node.span,
            f"a {describe(type_)} cannot be passed by value",
            None if isinstance(type_, VoidType) else "pass it by reference: put `&` in front of the name",
        )
        return None
    return Variable(node.name.name, type_, VariableKind.FRAME, reference=node.reference, span=node.name.span)


def _with_parameters(
    node: ast.FunctionDeclaration,
    result: Type | None,
    parameters: list[Variable | None],
    scope: Scope,
    context: Context,
) -> Function | None:
    recursive = Scope(scope, "", {node.name.name: FunctionSymbol(None, node.name.span)})
    inner = Scope(recursive, f"function `{node.name.name}`")
    for variable, parameter in zip(parameters, node.parameters, strict=True):
        symbol: Symbol = BrokenSymbol(parameter.name.span)
        if variable is not None:
            constant = "const" in parameter.type.prefixes
            symbol = ValueSymbol(
                Reference(variable), not constant, "constant parameter" if constant else "parameter", variable.span
            )
        inner.declare(parameter.name, symbol, context.findings)
    body = _FunctionBody(result, inner, context).block(node.body, inner)
    if body is None or result is None or None in parameters:
        return None
    if not isinstance(result, VoidType) and not _returns(body):
        context.error(
            "E0311",
            node.name.span,
            f"`{node.name.name}` can end without returning a value",
            "add a `return` at its end",
        )
        return None
    return Function(node.name.name, tuple(p for p in parameters if p is not None), result, body, node.name.span)


def _returns(statement: Statement) -> bool:
    """True if control cannot pass the statement without returning."""
    match statement:
        case Return():
            return True
        case Block(statements):
            return any(_returns(inner) for inner in statements)
        case If(_, then, otherwise):
            return otherwise is not None and _returns(then) and _returns(otherwise)
        case Iterate(_, body):
            return _returns(body)
        case While(test, body, test_first):
            endless = isinstance(test, Constant) and test.value != 0
            return endless or (not test_first and _returns(body))
        case Evaluate() | Declare() | Assert():
            return False


class _FunctionBody:
    """Elaborates the statements of one function."""

    def __init__(self, result: Type | None, scope: Scope, context: Context) -> None:
        self.result = result
        self.scope = scope
        self.context = context

    def block(self, node: ast.BlockStatement, inner: Scope) -> Block | None:
        """A block whose declarations go into the given scope."""
        done: list[Statement] = []
        broken = False
        for declaration in node.declarations:
            if isinstance(declaration, ast.TypedefDeclaration):
                declare_types(declaration, inner, self.context)
                continue
            declared = self._variables(declaration, inner)
            if declared is None:
                broken = True
            else:
                done.extend(declared)
        for statement in node.statements:
            result = self.statement(statement, inner)
            if result is None:
                broken = True
            else:
                done.append(result)
        return None if broken else Block(tuple(done))

    def _variables(self, node: ast.VariableDeclaration, scope: Scope) -> list[Statement] | None:
        reader = type_reader(scope, self.context)
        base = None if node.type is None else reader.type(node.type)
        constant = node.type is None or "const" in node.type.prefixes
        done: list[Statement] = []
        broken = False
        for declarator in node.declarators:
            type_ = None if base is None else reader.dimensions(base, declarator.dimensions)
            value: Expression | None = None
            if type_ is not None and not is_data(type_):
                self.context.error("E0315", declarator.span, f"a function cannot declare a {describe(type_)}")
                type_ = None
            if type_ is not None and declarator.initialiser is not None:
                value = initialiser(declarator.initialiser, type_, scope, self.context)
                if value is None:
                    type_ = None
            elif type_ is not None and constant:
                self.context.error("E0607", declarator.name.span, f"constant `{declarator.name.name}` needs a value")
                type_ = None
            if type_ is not None and not self.context.allow_variable(type_, declarator.span):
                type_ = None
            symbol: Symbol = BrokenSymbol(declarator.name.span)
            if type_ is None:
                broken = True
            elif constant and isinstance(value, Constant):
                symbol = ValueSymbol(value, False, "constant", declarator.name.span)
            else:
                variable = Variable(declarator.name.name, type_, VariableKind.FRAME, span=declarator.name.span)
                done.append(Declare(variable, value))
                kind = "constant" if constant else "variable"
                symbol = ValueSymbol(Reference(variable), not constant, kind, declarator.name.span)
            scope.declare(declarator.name, symbol, self.context.findings)
        return None if broken else done

    def statement(self, node: ast.Statement, scope: Scope) -> Statement | None:
        match node:
            case ast.BlockStatement():
                return self.block(node, Scope(scope))
            case ast.ExpressionStatement(_, inner):
                remaining = checked_part_of_update(inner, scope)
                if remaining is None:
                    return Block(())
                value = expression(remaining, scope, self.context)
                return None if value is None else Evaluate(value)
            case ast.EmptyStatement():
                return Block(())
            case ast.IfStatement(_, test, then, otherwise):
                checked = condition(test, scope, self.context)
                first = self.statement(then, scope)
                second = None if otherwise is None else self.statement(otherwise, scope)
                if checked is None or first is None or (otherwise is not None and second is None):
                    return None
                return If(checked, first, second)
            case ast.WhileStatement(_, test, body):
                return self._loop(condition(test, scope, self.context), self.statement(body, scope), True)
            case ast.DoStatement(_, body, test):
                return self._loop(condition(test, scope, self.context), self.statement(body, scope), False)
            case ast.ForStatement():
                return self._for(node, scope)
            case ast.IterationStatement(_, name, type_, body):
                bounded = type_reader(scope, self.context).bounded(type_, "an iteration")
                symbol: Symbol = BrokenSymbol(name.span)
                variable = None
                if bounded is not None:
                    variable = Variable(name.name, bounded, VariableKind.BOUND, span=name.span)
                    symbol = ValueSymbol(Reference(variable), False, "loop variable", name.span)
                inside = self.statement(body, Scope(scope, "", {name.name: symbol}))
                return None if variable is None or inside is None else Iterate(variable, inside)
            case ast.ReturnStatement():
                return self._return(node, scope)
            case ast.AssertStatement(_, test):
                checked = condition(test, scope, self.context)
                return None if checked is None else Assert(checked)
            case _ as never:
                assert_never(never)

    def _loop(self, test: Expression | None, body: Statement | None, test_first: bool) -> Statement | None:
        return None if test is None or body is None else While(test, body, test_first)

    def _for(self, node: ast.ForStatement, scope: Scope) -> Statement | None:
        before = [expression(e, scope, self.context) for e in node.initial]
        test: Expression | None = Constant(1, BOOL, node.span)
        if node.condition:
            test = comma(node.condition, node.condition[0].span.to(node.condition[-1].span), scope, self.context)
        step = [expression(e, scope, self.context) for e in node.step]
        body = self.statement(node.body, scope)
        if test is None or body is None or None in before or None in step:
            return None
        round_ = Block((body, *(Evaluate(e) for e in step if e is not None)))
        return Block((*(Evaluate(e) for e in before if e is not None), While(test, round_)))

    def _return(self, node: ast.ReturnStatement, scope: Scope) -> Statement | None:
        if node.value is None:
            if self.result is None or isinstance(self.result, VoidType):
                return Return()
            self.context.error("E0312", node.span, f"this function returns {describe(self.result)}, not nothing")
            return None
        value = expression(node.value, scope, self.context)
        if value is None or self.result is None:
            return None
        if isinstance(self.result, VoidType):
            self.context.error("E0312", node.value.span, "a `void` function cannot return a value")
            return None
        if not can_assign(self.result, value.type):
            self.context.error(
                "E0312", node.value.span, f"this function returns {describe(self.result)}, not {describe(value.type)}"
            )
            return None
        return Return(converted(value, self.result))


def declare_types(node: ast.TypedefDeclaration, scope: Scope, context: Context) -> None:
    """Declares the names of a typedef."""
    for declarator in node.declarators:
        own = DiagnosticCollector()
        inner = replace(context, findings=own)
        reader = type_reader(scope, inner)
        base = reader.declared(node.type, declarator.name.name)
        type_ = None if base is None else reader.dimensions(base, declarator.dimensions)
        context.scalar_sets = inner.scalar_sets
        found = own.sorted()
        symbol: Symbol = BrokenSymbol(declarator.name.span)
        if type_ is not None:
            symbol = TypeSymbol(type_, declarator.name.span)
        elif isinstance(node.type.base, ast.RangeType) and {diagnostic.code for diagnostic in found} == {"E0604"}:
            symbol, found = EmptyTypeSymbol(found, declarator.name.span), ()
        context.findings.extend(found)
        scope.declare(declarator.name, symbol, context.findings)
