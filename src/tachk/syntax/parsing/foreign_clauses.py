"""Clauses of edges and declarations as C, UPPAAL's editor and other tools write them: what to write here."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.syntax.parsing.situation import ParseSituation
from tachk.syntax.parsing.tokens import END, Token

_ASSIGNMENTS = ("=", ":=", "+=", "-=", "*=", "/=", "++", "--")
_COMPARISONS = ("<", "<=", ">", ">=", "==", "!=", "&&", "||", "and", "or")
_GUARDS = ("when", "if", "where", "condition", "provided")
_SIGNS = {"send": "!", "emit": "!", "raise": "!", "receive": "?", "recv": "?", "wait": "?", "await": "?", "on": "?"}
_RESETS = ("reset", "set", "do", "update", "effect", "action")


def untyped_constant(situation: ParseSituation) -> Diagnostic | None:
    """``const N = 3;``."""
    tokens, index = situation.tokens, situation.index
    if situation.token.text not in ("=", ":=") or index < 2 or tokens[index - 2].text != "const":
        return None
    span = tokens[index - 2].span.to(tokens[index - 1].span)
    text = f"const int {tokens[index - 1].text} = {_until(tokens, index + 1)};"
    return Diagnostic("E0101", f"`{span.text}` has no type", span, f"write `{text}`")


def unnamed_event(situation: ParseSituation) -> Diagnostic | None:
    """``visible press;``."""
    tokens, index = situation.tokens, situation.index
    begin = next((n for n in range(index - 1, -1, -1) if tokens[n].text in (";", "{", "visible")), index)
    if situation.token.text != ";" or tokens[begin].text != "visible" or "AS" not in situation.accepted:
        return None
    channel = tokens[begin + 1].text
    columns = ", ".join(each.text for each in tokens[begin + 2 : index] if each.type == "NAME")
    clause = tokens[begin].span.to(tokens[index - 1].span)
    return Diagnostic(
        "E0101",
        "a visible channel needs the name of its event",
        clause,
        f"write `{clause.text} as {channel}({columns});`",
    )


def foreign_clause(situation: ParseSituation) -> Diagnostic | None:
    """The diagnostic for an edge whose clauses lack their words, or have others; None where that is not it."""
    tokens, index = situation.tokens, situation.index
    if situation.token.text in ("guard", "sync", "assign", "select") and tokens[index - 2].text == "to":
        written = re.sub(r";? (guard|sync|assign) ", r"; \1 ", _until(tokens, index))
        message = f"the clauses of an edge stand in braces, and '{situation.token.text}' stands outside"
        help_ = f"write `to {tokens[index - 1].text} {{ {written}; }}`"
        return Diagnostic("E0101", message, _clause(tokens, index - 2, index), help_)
    if "SYNC" in situation.accepted or ("ASSIGN" in situation.accepted and "GUARD" in situation.accepted):
        return _bare_clause(situation)
    if situation.token.text == "->" and (first := _clause_before(situation)) is not None:
        if tokens[first].text == "guard":
            update = _until(tokens, index + 1)
            guard = Span(situation.token.span.source, tokens[first].span.start, tokens[index - 1].span.end)
            help_ = f"write `{guard.text}; assign {update};`"
            return Diagnostic("E0101", "'->' does not fit here", _clause(tokens, first, index), help_)
    return None


def _bare_clause(situation: ParseSituation) -> Diagnostic | None:
    tokens, index, token = situation.tokens, situation.index, situation.token
    following = tokens[index + 1].text if index + 1 < len(tokens) else ""
    text = _until(tokens, index)
    if token.type in ("NAME", "IF", "DO") or token.text in _GUARDS:
        clause = _clause(tokens, index, index)
        if token.text in _GUARDS:
            return _unknown(token, clause, f"write `{_guarded(tokens, index + 1)}`")
        if token.text in _RESETS and (tokens[index + 1].type == "NAME" or following in ("(", "{")):
            rest = _without_parentheses(_until(tokens, index + 1 + (following == "{")))
            update = rest if any(sign in rest for sign in _ASSIGNMENTS) else f"{rest} = 0"
            return _unknown(token, clause, f"write `assign {update};`")
        if token.text in _SIGNS and tokens[index + 1].type == "NAME":
            channel = _until(tokens, index + 1).rstrip("!?")
            return _unknown(token, clause, f"write `sync {channel}{_SIGNS[token.text]};`")
        if following in ("!", "?"):
            message = "a synchronisation begins with `sync`"
            return Diagnostic("E0101", message, clause, f"write `sync {text};`")
        if any(sign in following for sign in _ASSIGNMENTS):
            return _update(situation, text)
        if following in _COMPARISONS:
            return Diagnostic("E0101", "a condition begins with `guard`", clause, f"write `guard {text};`")
    return None


def _update(situation: ParseSituation, text: str) -> Diagnostic:
    """An assignment that lacks its word, perhaps behind one that has it."""
    tokens, index = situation.tokens, situation.index
    before = _clause_before(situation, behind=True)
    joined = before is not None and tokens[before].text == "assign"
    first = before if before is not None and joined else index
    help_ = f"write `assign {text};`"
    if joined:
        written = tokens[first].span.to(tokens[index - 2].span)
        help_ = f"write `{written.text}, {text};`: commas join assignments"
    return Diagnostic("E0101", "an update begins with `assign`", _clause(tokens, first, index), help_)


def _clause_before(situation: ParseSituation, behind: bool = False) -> int | None:
    """The index of the word that begins the clause in which the token stands, or the one before it."""
    tokens = situation.tokens
    place = situation.index - (2 if behind else 1)
    while place >= 0 and tokens[place].text not in (";", "{", "}"):
        if tokens[place].text in ("guard", "assign", "sync", "select"):
            return place
        place -= 1
    return None


def _until(tokens: Sequence[Token], begin: int) -> str:
    """The text up to the end of a clause."""
    end = _end(tokens, begin)
    return "" if end == begin else " ".join(tokens[begin].span.to(tokens[end - 1].span).text.split())


def _end(tokens: Sequence[Token], begin: int) -> int:
    """The index behind the last token of a clause, where its semicolon should stand."""
    end = begin
    while end < len(tokens) and tokens[end].text not in (";", "{", "}") and tokens[end].type != END:
        end += 1
    return end


def _clause(tokens: Sequence[Token], first: int, begin: int) -> Span:
    """The clause that begins at ``first`` and breaks at ``begin``, with its semicolon, as in ``reset {x};``."""
    end = _end(tokens, begin)
    if end > begin and tokens[end].text == "{":
        inner = _end(tokens, end + 1)
        end = inner + 1 if tokens[inner].text == "}" else end
    last = end if tokens[end].text == ";" else end - 1
    return tokens[first].span.to(tokens[max(last, begin)].span)


def _without_parentheses(text: str) -> str:
    return text[1:-1].strip() if text.startswith("(") and text.endswith(")") and text.count("(") == 1 else text


def _guarded(tokens: Sequence[Token], begin: int) -> str:
    """The clauses for a condition, behind which an update may stand: ``(x > 3) x = 0``."""
    closing = begin
    if tokens[begin].text == "(":
        depth = 0
        while tokens[closing].type != END:
            depth += (tokens[closing].text == "(") - (tokens[closing].text == ")")
            if not depth:
                break
            closing += 1
        update = _until(tokens, closing + 1)
        if tokens[closing + 1].type == "NAME" and any(sign in update for sign in _ASSIGNMENTS):
            condition = " ".join(tokens[begin].span.to(tokens[closing].span).text.split())
            return f"guard {_without_parentheses(condition)}; assign {update};"
    return f"guard {_without_parentheses(_until(tokens, begin))};"


def _unknown(token: Token, clause: Span, help_: str) -> Diagnostic:
    return Diagnostic("E0104", f"unknown word '{token.text}'", clause, help_)
