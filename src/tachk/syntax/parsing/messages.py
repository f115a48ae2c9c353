"""Messages about a token that cannot stand where it stands."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.span import Span
from tachk.syntax.formulas.foreign_operators import operator_word
from tachk.syntax.formulas.tokens import PREFIX, WORDS, lacks_full_stop
from tachk.syntax.parsing.contextual import PATHS, SPELLING
from tachk.syntax.parsing.foreign_clauses import foreign_clause, unnamed_event, untyped_constant
from tachk.syntax.parsing.foreign_formulas import foreign_formula, trailing_point
from tachk.syntax.parsing.foreign_words import foreign_word
from tachk.syntax.parsing.situation import CLOSES, ParseSituation, item_start, query_start, until_end
from tachk.syntax.parsing.tables import lexer, terminal_spelling
from tachk.syntax.parsing.tokens import END, Token

_EXPRESSION = {"NAME", "INTEGER", "LPAR", "FORALL", "TRUE"}
_TYPE = {"NAME", "INT", "CLOCK", "STRUCT"}
_CLAUSES = {"SELECT", "GUARD", "SYNC", "ASSIGN"}

_UNMENTIONED = {
    *("ERROR", END, "EXPECT", "UNCHECKED", "LEGACY_CONST", "LEGACY_PARAMETER", "LEGACY_AND", "SENTENCE", "FORMULA"),
    *("FORMULA_PREFIX", "FORMULA_INFIX", "EDGE", "IMPLIES", "INTERVAL_OPEN", "UNIT", "QUOTED"),
}
"""Terminals that the parser accepts in places where no text leads to them, or that would only lengthen a list."""

_NAMED = {
    "INTERVAL_CLOSE": "']' or ')'",
    "INFINITY": "'inf'",
    "NAME": "a name",
    "INTEGER": "a number",
    "STRING": "a string",
    "EQUALS": "'='",
    "OPAQUE_BLOCK": "'{'",
    "QUANTIFIER": "a path quantifier such as 'A[]'",
    END: "the end of the text",
}

_OUTCOMES = {
    **dict.fromkeys(("true", "satisfied", "yes", "pass", "passes", "ok", "hold"), "holds"),
    **dict.fromkeys(("false", "violated", "no", "fail", "unsatisfied"), "fails"),
}

_ITEM_WORDS = ("process", "system", "typedef", "property", "signal", "import", "const", "chan", "clock", "urgent")
_BODY_WORDS = ("location", "state", "init", "trans", "commit", "committed", "urgent", "branchpoint", "clock", "const")


def explain(situation: ParseSituation) -> Diagnostic:
    """The diagnostic for a token that does not fit, by the most specific reason that applies."""
    return (
        _foreign_format(situation)
        or _interface(situation)
        or _temporal_word(situation)
        or foreign_formula(situation)
        or trailing_point(situation)
        or foreign_clause(situation)
        or untyped_constant(situation)
        or unnamed_event(situation)
        or foreign_word(situation)
        or _missing(situation)
        or _brackets(situation)
        or _outcome(situation)
        or _no_query(situation)
        or _reserved(situation)
        or _misspelt(situation)
        or _keyword_as_name(situation)
        or _misplaced_clause(situation)
        or _unexpected(situation)
    )


def _foreign_format(situation: ParseSituation) -> Diagnostic | None:
    if situation.index == 0 and situation.token.text in ("<", "<?"):
        return Diagnostic(
            "E0101",
            "this looks like XML; expected a model as text",
            situation.token.span,
            "UPPAAL saves a model as text under the ending .xta",
        )
    return None


def _interface(situation: ParseSituation) -> Diagnostic | None:
    item = situation.tokens[item_start(situation)]
    if item.text != "IO" or situation.token.text != "{" or situation.tokens[situation.index - 1].type != "NAME":
        return None
    behind = situation.tokens[situation.index :]
    closing = next((token for token in behind if token.text == "}"), situation.token)
    return Diagnostic(
        "E0750",
        "'IO' declarations, which only refinement checking uses, are not supported",
        item.span.to(closing.span),
        "remove the declaration; it has no meaning for verification",
    )


def _missing(situation: ParseSituation) -> Diagnostic | None:
    if situation.supplied is None:
        return None
    text = situation.supplied.text
    before = situation.tokens[situation.index - 1]
    opening = _opening_of(situation, text)
    labels = (Label(opening.span, "to close this one"),) if opening is not None else ()
    after = f" after '{before.text}'" if len(before.text) <= 30 else ""
    return Diagnostic("E0102", f"expected '{text}'{after}", situation.supplied.span, f"add '{text}'", labels)


def _opening_of(situation: ParseSituation, closing: str) -> Token | None:
    stack = _open_brackets(situation.tokens[: situation.index])
    return stack[-1] if stack and closing in CLOSES and stack[-1].text == CLOSES[closing] else None


def _brackets(situation: ParseSituation) -> Diagnostic | None:
    token = situation.token
    stack = _open_brackets(situation.tokens[: situation.index])
    if token.type in (END, "PROCESS", "SYSTEM") and stack:
        there = "the text ends here" if token.type == END else "the next item begins here"
        return Diagnostic(
            "E0113",
            f"this '{stack[-1].text}' is never closed",
            stack[-1].span,
            f"add '{_closing(stack[-1].text)}'",
            (Label(token.span, there),),
        )
    if stack and token.text == "(" and _declares_function(situation) and stack[-1].text == "{":
        label = Label(situation.tokens[situation.index - 1].span, "a function begins here, and none stands in another")
        return Diagnostic("E0113", "this '{' is never closed", stack[-1].span, "add '}'", (label,))
    if token.text == "{" and "OPAQUE_BLOCK" in situation.accepted:
        return Diagnostic("E0113", "this '{' is never closed", token.span, "add '}'")
    if token.text not in CLOSES:
        return None
    if not stack or (token.text != "}" and stack[-1].text == "{" and _is_closed_later(situation)):
        return Diagnostic("E0113", f"this '{token.text}' closes nothing", token.span, "remove it")
    if stack[-1].text != CLOSES[token.text]:
        return Diagnostic(
            "E0113",
            f"this '{stack[-1].text}' is not closed before '{token.text}'",
            stack[-1].span,
            f"add '{_closing(stack[-1].text)}'",
            (Label(token.span, f"'{token.text}' is here"),),
        )
    return None


def _declares_function(situation: ParseSituation) -> bool:
    """True if ``void f(`` or ``int f(`` stands in a block, in which only variables are declared."""
    tokens, index = situation.tokens, situation.index
    if index < 2 or tokens[index - 1].type != "NAME" or "(" in situation.accepted:
        return False
    return tokens[index - 2].text in ("void", "int", "bool", "double") or tokens[index - 2].text == "]"


def _is_closed_later(situation: ParseSituation) -> bool:
    """True if the brace that is open at the token that does not fit is closed, were that token not there."""
    depth = 1
    for token in situation.tokens[situation.index + 1 :]:
        if token.type in ("PROCESS", "SYSTEM"):
            return False
        depth += (token.text == "{") - (token.text == "}")
        if not depth:
            return True
    return False


def _temporal_word(situation: ParseSituation) -> Diagnostic | None:
    """Operators of temporal formulas that are spelt as other tools spell them."""
    begin = 0 if situation.start == "formula_fragment" else query_start(situation)
    if begin is None:
        return None
    tokens = situation.tokens
    if situation.start != "formula_fragment" and lacks_full_stop(until_end(tokens, begin)):
        last = until_end(tokens, begin)[-1]
        end = Span(last.span.source, last.span.end, last.span.end)
        return Diagnostic("E0133", "a sentence ends with a full stop", end, "add '.'")
    for place in range(begin, min(situation.index + 1, len(tokens))):
        token = tokens[place]
        letter = WORDS.get(token.text.lower())
        following = tokens[place + 1].text if place + 1 < len(tokens) else ""
        if letter and token.type == "NAME" and following not in (".", ")", "==", "!=", "<", ">", "<=", ">="):
            return operator_word(token.text, token.span, following)
    arrow = situation.token.text == "->" and tokens[situation.index - 1].text != "<"
    if tokens[begin].type == "QUANTIFIER" and arrow:
        return Diagnostic(
            "E0101",
            "'->' stands in formulas, not in queries",
            situation.token.span,
            _arrow_help(until_end(tokens, begin)),
        )
    return None


def _arrow_help(query: Sequence[Token]) -> str:
    path = query[0].text
    if path != "A[]":
        return "write imply"
    if any(token.text in PREFIX for token in query):
        return f"write G in place of {path}: this is a formula about every run"
    return f"write imply, or G in place of {path} to make this a formula about every run"


def _outcome(situation: ParseSituation) -> Diagnostic | None:
    """``expect true``."""
    tokens, index = situation.tokens, situation.index
    place = next((n for n in (index, index - 1) if n >= 0 and tokens[n].text == "expect"), None)
    if place is None or place + 1 >= len(tokens):
        return None
    outcome = tokens[place + 1]
    meant = _OUTCOMES.get(outcome.text.lower())
    if meant is None:
        return None
    span = tokens[place].span.to(outcome.span)
    message = f"'{outcome.text}' is not what a query can be expected to do"
    return Diagnostic("E0104", message, span, f"write `expect {meant}` right behind the query, before its semicolon")


def _no_query(situation: ParseSituation) -> Diagnostic | None:
    begin = query_start(situation)
    if begin is None or begin > situation.index:
        return None
    token, tokens, index = situation.token, situation.tokens, situation.index
    if begin == index and token.text in ("", ";"):
        return Diagnostic("E0115", "there is no query", token.span, "write, for example, A[] not deadlock")
    if begin < index and token.text in ("", ";") and lexer().symbols["-->"] in situation.accepted:
        return Diagnostic(
            "E0115",
            "this is a condition, not a query",
            tokens[begin].span.to(tokens[index - 1].span),
            "put A[] (always), E<> (possibly), A<> or E[] in front"
            + ("" if any(token.text == "deadlock" for token in tokens) else "; G and F make it a temporal formula"),
        )
    for place in (index - 1, index - 2):
        words = [t.text for t in tokens[place : place + 3]] if place >= begin else [""]
        symbols = words[0] in ("A", "E") and "".join(words[1:]) in ("[]", "<>")
        if symbols or words[0] in PATHS:
            return Diagnostic(
                "E0115",
                "path quantifiers cannot be nested",
                tokens[place].span.to(tokens[place + 2 if symbols else place].span),
                "one A[], A<>, E[] or E<> stands at the beginning of a query; p --> q is the only form with two",
            )
    return None


def _reserved(situation: ParseSituation) -> Diagnostic | None:
    token = situation.token
    if token.type != "RESERVED":
        return None
    if token.text.lower() == "system":
        return Diagnostic("E0104", f"unknown word '{token.text}'", token.span, "write system")
    return Diagnostic("E0114", f"'{token.text}' is reserved in UPPAAL and has no meaning", token.span)


def _misspelt(situation: ParseSituation) -> Diagnostic | None:
    token = situation.token
    if token.type == "NAME" and "NAME" not in situation.accepted:
        found = _close(token.text, _words(situation.accepted))
        if found:
            return _did_you_mean(token, found)
    beginnings: list[tuple[Token, tuple[str, ...]]] = [(situation.tokens[item_start(situation)], _ITEM_WORDS)]
    if situation.construct is not None:
        construct = situation.construct
        first = next((t for t in situation.tokens if t.span.start >= construct), token)
        beginnings.insert(0, (first, (*_BODY_WORDS, *_ITEM_WORDS)))
    for first, words in beginnings:
        found = _close(first.text, words, 0.75)
        if first.type == "NAME" and first is not token and found and found != first.text:
            return _did_you_mean(first, found)
    return None


def _did_you_mean(token: Token, found: str) -> Diagnostic:
    return Diagnostic("E0104", f"unknown word '{token.text}'", token.span, f"did you mean '{found}'?")


def _close(word: str, candidates: Iterable[str], cutoff: float = 0.6) -> str | None:
    from difflib import get_close_matches

    matches = get_close_matches(word, list(candidates), 1, cutoff)
    return matches[0] if matches else None


def _keyword_as_name(situation: ParseSituation) -> Diagnostic | None:
    token = situation.token
    in_formula = situation.start == "formula_fragment"
    after_letter = in_formula and situation.index > 0 and situation.tokens[situation.index - 1].text in PREFIX
    if token.text not in lexer().keywords or "INT" in situation.accepted:
        return None
    if "NAME" not in situation.accepted and not after_letter:
        return None
    if token.type in ("AND", "OR", "IMPLY", "XOR"):
        return None
    return Diagnostic(
        "E0103",
        f"'{token.text}' is a keyword and cannot be used as a name",
        token.span,
        f"if it names a column or signal, write `{token.text}`"
        if in_formula
        else f"choose another name, for example '{token.text}_'",
    )


def _misplaced_clause(situation: ParseSituation) -> Diagnostic | None:
    token = situation.token
    if token.type in _CLAUSES and not _CLAUSES & situation.accepted and "TO" in situation.accepted:
        return Diagnostic(
            "E0101",
            f"'{token.text}' belongs to an edge, not to a location",
            token.span,
            f"write it in the braces of an edge: to Target {{ {token.text} ...; }}",
        )
    return None


def _unexpected(situation: ParseSituation) -> Diagnostic:
    token = situation.token
    found = "the end of the text" if token.type == END else f"'{_short(token.text)}'"
    wanted = expectations(situation.accepted)
    if wanted is None:
        return Diagnostic("E0101", f"{found} does not fit here", token.span)
    return Diagnostic("E0101", f"expected {wanted}, found {found}", token.span)


def expectations(accepted: frozenset[str]) -> str | None:
    """The accepted terminals in words, or None if they are too many to be of help."""
    rest = set(accepted) - _UNMENTIONED
    words: list[str] = []
    if rest >= _EXPRESSION:
        words.append("an expression")
        rest -= _begins_expression()
    if rest >= _TYPE or (rest >= _TYPE - {"NAME"} and words):
        words.append("a declaration" if "TYPEDEF" in rest else "a type")
        rest -= _begins_type()
    operators = rest & _operators()
    if len(operators) > 6:
        words.append("an operator")
        rest -= operators
    if len(rest) > 6:
        return None
    spelling = {**terminal_spelling(), **SPELLING}
    words += sorted(_NAMED.get(name) or f"'{spelling.get(name, name.lower())}'" for name in rest)
    words = list(dict.fromkeys(words))
    if not words:
        return None
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " or " + words[-1]


def _begins_expression() -> set[str]:
    symbols = lexer().symbols
    prefixes = {symbols[text] for text in ("-", "+", "!", "++", "--", "(")}
    words = {
        *("NAME", "INTEGER", "FLOAT", "STRING", "TRUE", "FALSE", "NOT", "DEADLOCK"),
        *("FORALL", "EXISTS", "SUM", "FOREACH", "SPAWN"),
    }
    return prefixes | words


def _begins_type() -> set[str]:
    return {
        *("NAME", "INT", "BOOL", "CLOCK", "CHAN", "VOID", "SCALAR", "STRUCT", "CONST", "META", "URGENT", "BROADCAST"),
        *("HYBRID", "TYPEDEF", "DYNAMIC"),
    }


def _operators() -> set[str]:
    symbols = lexer().symbols
    opening = {symbols[text] for text in "([.'"}
    no_operators = ("{", "}", "(", ")", "[", "]", ";", ":", ",", "->", "-u->")
    binary = {name for text, name in symbols.items() if text not in no_operators}
    return binary | opening | {"AND", "OR", "XOR", "IMPLY", "EQUALS", "ASSIGNMENT_OPERATOR"}


def _words(accepted: frozenset[str]) -> list[str]:
    spelling = {**terminal_spelling(), **SPELLING}
    return [spelling[name] for name in sorted(accepted) if spelling.get(name, "").isidentifier()]


def _open_brackets(tokens: Sequence[Token]) -> list[Token]:
    """The brackets that are open behind the tokens; one that is closed wrongly counts as closed."""
    stack: list[Token] = []
    for token in tokens:
        if token.text in ("(", "[", "{"):
            stack.append(token)
        elif token.text in CLOSES and stack:
            stack.pop()
    return stack


def _closing(opening: str) -> str:
    return next(closing for closing, other in CLOSES.items() if other == opening)


def _short(text: str) -> str:
    return text if len(text) <= 30 else text[:27] + "..."
