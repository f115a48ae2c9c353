"""Feeding tokens to the LALR parser, and going on after an error.

On an error the parser is taken back to a state that accepts the grammar's ERROR terminal (an item, a statement, a
clause), the rest of that construct is passed over, and parsing continues behind it. A single missing bracket or
semicolon is supplied instead. At most `MOST_ERRORS` errors are reported, each at a cost linear in the text.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.job import check_job
from tachk.base.span import Span
from tachk.syntax.parsing.lalr import Stack, UnexpectedToken
from tachk.syntax.parsing.misplaced import Misplaced
from tachk.syntax.parsing.tables import lexer, tables
from tachk.syntax.parsing.tokens import END, Token

MOST_ERRORS = 20
_MOST_RECOVERIES = 60

_SUPPLIED = (";", ")", "]")
_BEGINS_CLAUSE = {"TO", "UNCONTROLLABLE", "INVARIANT", "SELECT", "GUARD", "SYNC", "ASSIGN", "PROBABILITY"}
_OPENING = {"{", "(", "["}
_CLOSING = {"}", ")", "]"}


def drive(start: str, tokens: list[Token]) -> tuple[Any, tuple[Diagnostic, ...]]:
    """Parse tokens from a start symbol of the grammar.

    Returns:
        What the builder made of them, or None if even recovery failed, and the syntax errors.
    """
    return _ParserPass(start, tokens).to_the_end()


class _ParserPass:
    """One pass over the tokens.

    ``inserted`` holds tokens that are not part of the text (supplied ones, ERROR) and come next, the last one first.
    """

    def __init__(self, start: str, tokens: list[Token]) -> None:
        self.start = start
        self.tokens = tokens
        self.stack = Stack(tables(), start)
        self.inserted: list[Token] = []
        self.errors: list[Diagnostic] = []
        self.recoveries = 0
        self.resumed_at = -1

    def to_the_end(self) -> tuple[Any, tuple[Diagnostic, ...]]:
        tokens, inserted = self.tokens, self.inserted
        feed = self.stack.feed
        index = 0
        while True:
            check_job()
            token = inserted[-1] if inserted else tokens[index]
            try:
                result = feed(token)
            except Misplaced as misplaced:
                self.errors.append(misplaced.diagnostic)
                if not self.replace_by_error(token):
                    return None, tuple(self.errors)
                continue
            except UnexpectedToken:
                following = None if inserted else self.recover(index)
                if following is None:
                    return None, tuple(self.errors)
                index = following
                continue
            if token.type == END:
                return result, tuple(self.errors)
            if inserted:
                inserted.pop()
            else:
                index += 1

    def recover(self, index: int) -> int | None:
        """Report the unexpected token and get past it; the index to go on with, or None to give up."""
        from tachk.syntax.parsing.situation import ParseSituation

        self.recoveries += 1
        supplied = self.missing_token(index)
        if index != self.resumed_at:
            accepted = frozenset(name for name in self.stack.choices() if self.stack.accepts([name]))
            begin = self.construct_start()
            from tachk.syntax.parsing.messages import explain  # only texts with mistakes need them

            self.errors.append(explain(ParseSituation(self.tokens, index, accepted, supplied, begin, self.start)))
        if len(self.errors) >= MOST_ERRORS or self.recoveries >= _MOST_RECOVERIES:
            return None
        if supplied is not None:
            self.inserted.append(supplied)
            return index
        begin = self.construct_start()
        first = index if begin is None else min(self.index_at(begin), index)
        end = self.end_of_construct(first, index)
        if end == self.resumed_at and self.tokens[end].type != END:
            end += 1
        if not self.unwind_for(self.tokens[end].type):
            return None
        self.insert_error(first, end)
        self.resumed_at = end
        return end

    def replace_by_error(self, token: Token) -> bool:
        """After a rule refused its parts when the token came: put ERROR in their place. False to give up."""
        self.recoveries += 1
        if len(self.errors) >= MOST_ERRORS or self.recoveries >= _MOST_RECOVERIES or not self.unwind_for(token.type):
            return False
        self.inserted.append(Token("ERROR", "", token.span))
        return True

    # ---- looking ahead ----

    def missing_token(self, index: int) -> Token | None:
        """A bracket or semicolon whose absence alone explains the error."""
        if index == 0:
            return None
        symbols = lexer().symbols
        token, before = self.tokens[index], self.tokens[index - 1]
        for text in _SUPPLIED:
            if text == ";" and not (
                token.text in ("}", "") or token.type in _BEGINS_CLAUSE or _on_next_line(before, token)
            ):
                continue
            if text != ";" and token.text not in (";", "{", ")", "]"):
                continue
            if self.stack.accepts([symbols[text], token.type]):
                return Token(symbols[text], text, Span(before.span.source, before.span.end, before.span.end))
        return None

    # ---- passing over ----

    def construct_start(self) -> int | None:
        """The offset where the innermost construct that can be passed over began; None if it has not begun."""
        start = None
        for level in range(len(self.stack.states) - 1, -1, -1):
            if self.stack.takes(level, "ERROR"):
                break
            if level:
                found = _start_of(self.stack.values[level - 1])
                start = found if found is not None else start
        return start

    def index_at(self, offset: int) -> int:
        return bisect_left(self.tokens, offset, key=lambda token: token.span.start)

    def end_of_construct(self, first: int, index: int) -> int:
        """The index behind the construct that began at ``first`` and broke at ``index``."""
        tokens = self.tokens
        depth = 0
        for token in tokens[first:index]:
            depth += (token.text in _OPENING) - (token.text in _CLOSING)
        depth = max(depth, 0)
        braces_end = tokens[first].type != "PROPERTY"
        while tokens[index].type != END:
            token = tokens[index]
            if token.type in ("PROCESS", "SYSTEM") and index > 0:
                return index
            if token.text in _OPENING:
                depth += 1
            elif token.text in _CLOSING:
                if depth == 0:
                    return index if token.text == "}" else index + 1
                depth -= 1
                if depth == 0 and token.text == "}" and braces_end:
                    return index + 1 + (tokens[index + 1].text == ";")
            elif token.text == ";" and depth == 0:
                return index + 1
            index += 1
        return index

    def unwind_for(self, following: str) -> bool:
        """Pop to the innermost state that accepts ERROR and then the given terminal, or else to the innermost that
        accepts ERROR. False if there is none."""
        stack = self.stack
        candidates = [level for level in range(len(stack.states), 0, -1) if stack.takes(level - 1, "ERROR")]
        if not candidates:
            return False
        # Nesting this deep is absurd; looking at every level of it would take quadratic time.
        candidates = candidates[:30] + candidates[30:][-3:]
        stack.cut(next((n for n in candidates if stack.accepts(["ERROR", following], n)), candidates[0]))
        return True

    def insert_error(self, first: int, end: int) -> None:
        start = self.tokens[first].span
        last = self.tokens[max(end - 1, first)].span
        self.inserted.append(Token("ERROR", "", Span(start.source, start.start, max(start.start, last.end))))


def _on_next_line(before: Token, token: Token) -> bool:
    return "\n" in before.span.source.text[before.span.end : token.span.start]


def _start_of(value: Any) -> int | None:
    """The beginning of the text of a value of the parser's stack; None if it is empty."""
    span = getattr(value, "span", None)
    if span is not None:
        start: int = span.start
        return start
    for child in getattr(value, "children", value if isinstance(value, tuple | list) else ()):
        found = _start_of(child)
        if found is not None:
            return found
    return None
