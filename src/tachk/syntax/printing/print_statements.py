"""Function bodies in canonical layout."""

from __future__ import annotations

from typing import Any, assert_never

from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression, print_expressions, print_type, print_variables
from tachk.syntax.printing.writer import Writer


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
    """Whether a following ``else`` would belong to an ``if`` at the end of the statement."""
    match node:
        case ast.IfStatement(otherwise=otherwise):
            return otherwise is None or _takes_else(otherwise)
        case ast.WhileStatement(body=body) | ast.ForStatement(body=body) | ast.IterationStatement(body=body):
            return _takes_else(body)
        case _:
            return False
