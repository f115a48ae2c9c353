"""Feeding tokens to the LALR parser, and going on after an error.

On an error the parser is taken back to a state that accepts the grammar's ERROR terminal (an item, a statement, a
clause), the rest of that construct is passed over, and parsing continues behind it. A single missing bracket or
semicolon is supplied instead. Every step consumes a token or shortens the stack, so the work is linear in the text for
each of at most `MOST_ERRORS` errors.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

from lark.exceptions import UnexpectedToken
from lark.parsers.lalr_interactive_parser import InteractiveParser
from lark.parsers.lalr_parser_state import ParserState

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.diagnostics.span import Span
from tachk.syntax.messages import Situation, explain
from tachk.syntax.misplaced import Misplaced
from tachk.syntax.tables import parser_tables, terminal_spelling
from tachk.syntax.tokens import END, Token

MOST_ERRORS = 20

_SUPPLIED = (";", ")", "]")
_OPENING = {"{", "(", "["}
_CLOSING = {"}", ")", "]"}


def drive(start: str, tokens: list[Token]) -> tuple[Any, tuple[Diagnostic, ...]]:
    """Parse tokens from a start symbol of the grammar.

    Returns:
        What the builder made of them, or None if even recovery failed, and the syntax errors.
    """
    parser = parser_tables().parse_interactive("", start=start)
    return _Run(parser, tokens).to_the_end()


class _Run:
    """One pass over the tokens; the only mutable thing is here."""

    def __init__(self, parser: InteractiveParser, tokens: list[Token]) -> None:
        self.parser = parser
        self.state: ParserState[Any] = parser.parser_state
        self.tokens = tokens
        self.errors: list[Diagnostic] = []

    def to_the_end(self) -> tuple[Any, tuple[Diagnostic, ...]]:
        tokens = self.tokens
        feed = self.state.feed_token
        index = 0
        while True:
            token = tokens[index]
            is_end = token.type == END
            try:
                result = feed(token, is_end)  # type: ignore[arg-type]
            except Misplaced as misplaced:
                self.errors.append(misplaced.diagnostic)
                if not self.reduce_to_error(tokens[index], tokens[index]):
                    return None, tuple(self.errors)
                continue
            except UnexpectedToken:
                following = self.recover(index)
                if following is None or len(self.errors) >= MOST_ERRORS:
                    return None, tuple(self.errors)
                index = following
                continue
            if is_end:
                return result, tuple(self.errors)
            index += 1

    def recover(self, index: int) -> int | None:
        """Report the unexpected token and get past it; the index to go on with, or None to give up."""
        supplied = self.missing_token(index)
        self.errors.append(explain(self.situation(index, supplied)))
        if supplied is not None:
            self.state.feed_token(supplied)  # type: ignore[arg-type]
            return index
        abandoned = self.unwind()
        if abandoned is None:
            return None
        begin = min(bisect_left(self.tokens, abandoned, key=lambda token: token.span.start), index)
        end = self.end_of_construct(begin, index)
        first = self.tokens[begin]
        if end == begin and self.tokens[end].type != END:
            end += 1
        self.feed_error(first, self.tokens[max(end - 1, begin)])
        return end

    def situation(self, index: int, supplied: Token | None) -> Situation:
        return Situation(self.tokens, index, frozenset(self.accepted()), supplied, self.construct_start())

    def accepted(self) -> set[str]:
        return {name for name in self.parser.choices() if name.isupper() and self.would_accept([name])}

    def would_accept(self, kinds: list[str]) -> bool:
        """Whether the parser could take these terminals next."""
        trial = self.state.copy(deepcopy_values=False)
        trial.parse_conf = _without_callbacks(trial.parse_conf)
        try:
            for kind in kinds:
                trial.feed_token(Token(kind, "", _NO_PLACE), kind == END)  # type: ignore[arg-type]
        except UnexpectedToken:
            return False
        return True

    def missing_token(self, index: int) -> Token | None:
        """A bracket or semicolon whose absence alone explains the error."""
        terminals = {text: name for name, text in terminal_spelling().items()}
        token = self.tokens[index]
        before = self.tokens[index - 1] if index else None
        if before is None:
            return None
        place = Span(before.span.source, before.span.end, before.span.end)
        for text in _SUPPLIED:
            kinds = [terminals[text], token.type]
            if text == ";" and not _on_next_line(before, token) and token.text not in ("}", ""):
                continue
            if text != ";" and token.type != "SEMICOLON" and token.text not in ("{", ")", "]"):
                continue
            if self.would_accept(kinds):
                return Token(terminals[text], text, place)
        return None

    def construct_start(self) -> int | None:
        """Where the innermost construct that could be passed over began, without touching the parser."""
        states = self.parser.parser_state.parse_conf.states
        start = None
        for depth in range(len(self.state.state_stack) - 1, -1, -1):
            if "ERROR" in states[self.state.state_stack[depth]]:
                return start
            if depth:
                found = _start_of(self.state.value_stack[depth - 1])
                start = found if found is not None else start
        return start

    def unwind(self) -> int | None:
        """Pop to a state that accepts ERROR. The offset where the popped text began, or None if there is no state."""
        states = self.state.parse_conf.states
        offset = None
        while self.state.state_stack:
            if "ERROR" in states[self.state.state_stack[-1]]:
                return offset if offset is not None else 1 << 62
            if not self.state.value_stack:
                return None
            found = _start_of(self.state.value_stack.pop())
            self.state.state_stack.pop()
            offset = found if found is not None else offset
        return None

    def reduce_to_error(self, first: Token, last: Token) -> bool:
        """After a rule refused its parts: put ERROR in their place."""
        if self.unwind() is None:
            return False
        self.feed_error(first, last)
        return True

    def feed_error(self, first: Token, last: Token) -> None:
        span = Span(first.span.source, first.span.start, max(first.span.start, last.span.end))
        self.state.feed_token(Token("ERROR", "", span))  # type: ignore[arg-type]

    def end_of_construct(self, begin: int, index: int) -> int:
        """The index behind the construct that began at ``begin`` and broke at ``index``."""
        tokens = self.tokens
        depth = 0
        for token in tokens[begin:index]:
            depth += (token.text in _OPENING) - (token.text in _CLOSING)
        depth = max(depth, 0)
        while tokens[index].type != END:
            token = tokens[index]
            if token.type in ("PROCESS", "SYSTEM") and index > begin:
                return index
            if token.text in _OPENING:
                depth += 1
            elif token.text in _CLOSING:
                if depth == 0:
                    return index if token.text == "}" else index + 1
                depth -= 1
                if depth == 0 and token.text == "}":
                    return index + 1
            elif token.text == ";" and depth == 0:
                return index + 1
            index += 1
        return index


_NO_PLACE: Any = None


def _without_callbacks(configuration: Any) -> Any:
    from copy import copy

    bare = copy(configuration)
    bare.callbacks = {}
    return bare


def _on_next_line(before: Token, token: Token) -> bool:
    return "\n" in before.span.source.text[before.span.end : token.span.start]


def _start_of(value: Any) -> int | None:
    """Where the text of a value of the parser's stack begins; None if it is empty."""
    span = getattr(value, "span", None)
    if span is not None:
        start: int = span.start
        return start
    for child in getattr(value, "children", value if isinstance(value, tuple | list) else ()):
        found = _start_of(child)
        if found is not None:
            return found
    return None
