"""Reading UPPAAL 2.x and 3.x: a rewrite of the tokens, so that one grammar serves both.

Commas join the conjuncts of guards and invariants, ``const N 5;`` has no type, ``=<`` and ``=>`` are comparisons, and a
process takes its parameters as ``int a, b; const c``, by reference unless they are constants.
"""

from __future__ import annotations

from tachk.base.span import Span
from tachk.syntax.parsing.tokens import Token


def as_legacy(tokens: list[Token], comparisons: dict[str, str], start: str) -> list[Token]:
    """The tokens of an old text as the grammar wants them.

    Args:
        tokens: the tokens, contextual keywords marked.
        comparisons: the terminals of ``<=`` and ``>=``.
        start: the start symbol of the grammar, which tells what the whole text is.
    """
    rewritten = _constants(_conjunctions(_comparisons(tokens, comparisons), start == "constraint_fragment"))
    if start == "parameters_fragment":
        output: list[Token] = []
        _parameter_list(rewritten, 0, 1, output)
        return output
    return _parameters(rewritten)


def _comparisons(tokens: list[Token], terminals: dict[str, str]) -> list[Token]:
    """Join ``=`` and a directly following ``<`` or ``>``, but in properties, which UPPAAL 3.x does not have."""
    output: list[Token] = []
    in_property = False
    for token in tokens:
        in_property = token.type == "PROPERTY" or (in_property and token.text != ";")
        before = output[-1] if output else None
        if (
            before is not None
            and not in_property
            and before.text == "="
            and token.text in ("<", ">")
            and before.span.end == token.span.start
        ):
            text = token.text + "="
            output[-1] = Token(terminals[text], text, before.span.to(token.span))
        else:
            output.append(token)
    return output


def _conjunctions(tokens: list[Token], constraint: bool) -> list[Token]:
    """Turn the commas of guards and of invariants in ``state`` lines into conjunctions."""
    output: list[Token] = []
    guard, state = constraint, False
    depth = 0
    for token in tokens:
        kind = token.type
        if kind == "GUARD":
            guard, depth = True, 0
        elif kind == "STATE":
            state, depth = True, 0
        elif token.text in ("(", "[", "{"):
            depth += 1
        elif token.text in (")", "]", "}"):
            depth -= 1
        elif token.text == ";":
            guard = False
            state = state and depth > 0
        elif token.text == "," and ((guard and depth == 0) or (state and depth == 1)):
            token = Token("LEGACY_AND", ",", token.span)
        output.append(token)
    return output


def _constants(tokens: list[Token]) -> list[Token]:
    """Mark ``const`` where a name without a type follows."""
    output: list[Token] = []
    for index, token in enumerate(tokens):
        if token.type == "CONST" and index + 2 < len(tokens) and tokens[index + 1].type == "NAME":
            following = tokens[index + 2]
            if following.type in ("INTEGER", "EQUALS", "MINUS") or following.text in ("[", "{", ";", ",", ")", ""):
                token = Token("LEGACY_CONST", token.text, token.span, token.doc)
        output.append(token)
    return output


def _parameters(tokens: list[Token]) -> list[Token]:
    """Rewrite the parameter lists of processes."""
    output: list[Token] = []
    index = 0
    while index < len(tokens):
        token = tokens[index]
        output.append(token)
        index += 1
        if token.type != "PROCESS":
            continue
        index = _parameter_list(tokens, index, 0, output)
    return output


def _parameter_list(tokens: list[Token], index: int, depth: int, output: list[Token]) -> int:
    """Append the tokens of a parameter list as the grammar wants them; the index of the first token behind it.

    Args:
        depth: of brackets at the index: 1 within the parentheses of the list.
    """
    constant = False
    while index < len(tokens) and tokens[index].text not in ("{", ""):
        token = tokens[index]
        index += 1
        depth += (token.text in ("(", "[")) - (token.text in (")", "]"))
        before = output[-1].text if output else "("
        following = tokens[index].text if index < len(tokens) else ""
        if depth == 1 and token.text == ";":
            token = Token("COMMA", ",", token.span)
            constant = False
        elif token.type in ("CONST", "LEGACY_CONST"):
            constant = True
        elif depth == 1 and token.type == "NAME" and following in (",", ";", ")", "[", ""):
            if before == ",":
                if constant:
                    output.append(Token("LEGACY_CONST", "const", token.span))
                else:
                    token = Token("LEGACY_PARAMETER", token.text, token.span)
            elif not constant and before not in ("&", "("):
                start = Span(token.span.source, token.span.start, token.span.start)
                output.append(Token("AMPERSAND", "&", start))
        output.append(token)
    if depth == 1 and index < len(tokens):
        output += tokens[index:]
    return index
