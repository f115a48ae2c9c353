"""The expressions and statements of TChecker's format."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import dataclass

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.exact_numbers import is_whole
from tachk.base.operators import COMPARISONS, BinaryOperator, PrefixOperator
from tachk.base.span import Source, Span
from tachk.syntax import ast

_TOKEN = re.compile(r"\s+|(?P<number>\d+)|(?P<name>[A-Za-z_][\w.]*)|(?P<sign>&&|[=!<>]=|[-+*/%<>=!()\[\];,])")
_WORDS = frozenset({"if", "then", "else", "end", "while", "do", "nop", "local"})

DEPTH = 60
"""Parentheses and statements may be nested that deep."""


@dataclass(frozen=True, slots=True)
class TCheckerToken:
    kind: str
    text: str
    span: Span


class TCheckerExpressionReader:
    """Reads one expression or list of statements; every method raises InputError for anything else.

    Attributes:
        names: what the names of the file are in the document; others are left as they are.
    """

    def __init__(self, source: Source, start: int, end: int, names: Mapping[str, str]) -> None:
        self.source = source
        self.end = end
        self.names = dict(names)
        self.words = list(self._cut(start, end))
        self.place = 0
        self.depth = 0

    def _cut(self, start: int, end: int) -> Iterator[TCheckerToken]:
        while start < end:
            found = _TOKEN.match(self.source.text, start, end)
            if found is None:
                raise failure(f"unexpected character {self.source.text[start]!r}", Span(self.source, start, start + 1))
            if found.lastgroup is not None:
                kind = "word" if found.group() in _WORDS else found.lastgroup
                yield TCheckerToken(kind, found.group(), Span(self.source, found.start(), found.end()))
            start = found.end()

    # ---- words ------------------------------------------------------------------------------------------------------

    def peek(self) -> str:
        return self.words[self.place].text if self.place < len(self.words) else ""

    def take(self, text: str = "") -> TCheckerToken:
        """The next word, which must be the given one."""
        if self.place >= len(self.words):
            wanted = f", `{text}` is missing" if text else ""
            raise failure(f"the text ends too early{wanted}", Span(self.source, self.end, self.end))
        word = self.words[self.place]
        if text and word.text != text:
            raise failure(f"expected `{text}`, found `{word.text}`", word.span)
        self.place += 1
        return word

    def finish(self) -> None:
        if self.place < len(self.words):
            word = self.words[self.place]
            raise failure(f"unexpected `{word.text}`", word.span)

    @contextmanager
    def _deeper(self) -> Iterator[None]:
        """One level of nesting; an error where there are too many for recursion."""
        self.depth += 1
        if self.depth > DEPTH:
            raise failure("this is nested too deep", Span(self.source, self.end, self.end))
        yield
        self.depth -= 1

    # ---- expressions ------------------------------------------------------------------------------------------------

    def expression(self) -> ast.Expression:
        """A conjunction."""
        with self._deeper():
            return self._binary(self._comparison, {BinaryOperator.AND})

    def _comparison(self) -> ast.Expression:
        if self.peek() == "!":
            sign = self.take()
            with self._deeper():
                operand = self._comparison()
            return ast.UnaryExpression(sign.span.to(operand.span), PrefixOperator.NOT, operand)
        return self._binary(self.sum, COMPARISONS)

    def sum(self) -> ast.Expression:
        """Sums and what binds more strongly."""
        return self._binary(self._product, {BinaryOperator.ADD, BinaryOperator.SUBTRACT})

    def _product(self) -> ast.Expression:
        return self._binary(self._prefixed, {BinaryOperator.MULTIPLY, BinaryOperator.DIVIDE, BinaryOperator.MODULO})

    def _binary(self, operand: Callable[[], ast.Expression], operators: Set[BinaryOperator]) -> ast.Expression:
        result = operand()
        while self.peek() in operators:
            operator = BinaryOperator(self.take().text)
            right = operand()
            result = ast.BinaryExpression(result.span.to(right.span), operator, result, right)
        return result

    def _prefixed(self) -> ast.Expression:
        if self.peek() == BinaryOperator.SUBTRACT:
            sign = self.take()
            with self._deeper():
                operand = self._prefixed()
            span = sign.span.to(operand.span)
            if isinstance(operand, ast.IntegerLiteral):
                return ast.IntegerLiteral(span, -operand.value)
            return ast.UnaryExpression(span, PrefixOperator.MINUS, operand)
        return self._primary()

    def _primary(self) -> ast.Expression:
        word = self.take()
        if word.kind == "number":
            if not is_whole(word.text):
                raise failure(f"the number {word.text[:20]}… is too large", word.span)
            return ast.IntegerLiteral(word.span, int(word.text))
        if word.kind == "name":
            return self._place(word)
        if word.text == "(":
            inner = self._conditional(self.take()) if self.peek() == "if" else self.expression()
            self.take(")")
            return inner
        if word.text == "if":
            return self._conditional(word)
        raise failure(f"unexpected `{word.text}`", word.span)

    def _conditional(self, first: TCheckerToken) -> ast.Expression:
        with self._deeper():
            condition = self.expression()
            self.take("then")
            then = self.sum()
            self.take("else")
            otherwise = self.sum()
        return ast.ConditionalExpression(first.span.to(otherwise.span), condition, then, otherwise)

    def _place(self, word: TCheckerToken) -> ast.Expression:
        name = ast.NameExpression(word.span, self.names.get(word.text, word.text))
        if self.peek() != "[":
            return name
        self.take("[")
        with self._deeper():
            index = self.sum()
        return ast.IndexExpression(word.span.to(self.take("]").span), name, index)

    # ---- statements -------------------------------------------------------------------------------------------------

    def block(self, *ends: str) -> ast.BlockStatement:
        """Statements up to one of some words, or to the end of the text."""
        start = self.words[self.place].span if self.place < len(self.words) else Span(self.source, self.end, self.end)
        declarations: list[ast.VariableDeclaration] = []
        statements: list[ast.Statement] = []
        with self._deeper():
            while self.peek() and self.peek() not in ends:
                if self.peek() == ";":
                    self.take()
                elif self.peek() == "local":
                    self._local(declarations, statements)
                else:
                    statements.append(self._statement())
        return ast.BlockStatement(start, tuple(declarations), tuple(statements))

    def _statement(self) -> ast.Statement:
        word = self.take()
        match word.text:
            case "nop":
                return ast.EmptyStatement(word.span)
            case "if":
                condition = self.expression()
                self.take("then")
                then = self.block("else", "end")
                otherwise = None
                if self.peek() == "else":
                    self.take()
                    otherwise = self.block("end")
                return ast.IfStatement(word.span.to(self.take("end").span), condition, then, otherwise)
            case "while":
                condition = self.expression()
                self.take("do")
                body = self.block("end")
                return ast.WhileStatement(word.span.to(self.take("end").span), condition, body)
            case _:
                pass
        if word.kind != "name":
            raise failure(f"a statement cannot begin with `{word.text}`", word.span)
        return self._assignment(self._place(word))

    def _assignment(self, target: ast.Expression) -> ast.Statement:
        self.take("=")
        value = self.sum()
        span = target.span.to(value.span)
        return ast.ExpressionStatement(span, ast.AssignmentExpression(span, None, target, value))

    def _local(self, declarations: list[ast.VariableDeclaration], statements: list[ast.Statement]) -> None:
        """``local v``, ``local v = e``, ``local v[n]``: declared where the block begins, assigned in its place."""
        self.take("local")
        word = self.take()
        identifier = ast.Identifier(word.span, self.names.get(word.text, word.text))
        dimensions: tuple[ast.Expression, ...] = ()
        if self.peek() == "[":
            self.take("[")
            dimensions = (self.sum(),)
            self.take("]")
        low, high = ast.IntegerLiteral(word.span, -(2**31)), ast.IntegerLiteral(word.span, 2**31 - 1)
        type_ = ast.TypeExpression(word.span, (), ast.RangeType(word.span, low, high))
        declarator = ast.Declarator(word.span, identifier, dimensions)
        declarations.append(ast.VariableDeclaration(word.span, type_, (declarator,)))
        if self.peek() == "=":
            statements.append(self._assignment(ast.NameExpression(word.span, identifier.name)))


def failure(message: str, span: Span) -> InputError:
    return InputError([Diagnostic("E0820", message, span)])
