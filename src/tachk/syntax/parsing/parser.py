"""Texts to syntax trees.

Every function returns what could be read together with all diagnostics. Where there is an error the tree is incomplete
(or None) and must not be used for more than, say, an outline; `InputError` is raised by the layers above, which know
whether anything else is worth reporting first.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, Severity
from tachk.base.records import replace
from tachk.base.span import Source, Span
from tachk.syntax import ast
from tachk.syntax.parsing.contextual import resolve_document, resolve_fragment, resolve_query
from tachk.syntax.parsing.depth import bracket_errors, nesting_errors
from tachk.syntax.parsing.documentation import documented, lost_documentation
from tachk.syntax.parsing.driver import drive
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.parsing.tokens import Lexed, Token


def as_legacy(tokens: list[Token], comparisons: dict[str, str], start: str) -> list[Token]:
    """The tokens of an old text as the grammar wants them.

    Args:
        tokens: the tokens, contextual keywords marked.
        comparisons: the terminals of ``<=`` and ``>=``.
        start: the start symbol of the grammar, which says what the whole text is.
    """
    rewritten = _constants(_conjunctions(_comparisons(tokens, comparisons), start == "constraint_fragment"))
    if start == "parameters_fragment":
        output: list[Token] = []
        behind = _parameter_list(rewritten, 0, 1, output)
        return [*output, *rewritten[behind:]]
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
    return index


Diagnostics = tuple[Diagnostic, ...]


def parse_document(
    source: Source, strict_xta: bool = False, types: frozenset[str] = frozenset()
) -> tuple[ast.Document | None, Diagnostics]:
    """Read a model.

    A text that is not modern XTA but is UPPAAL 3.x is read as that, with warning W0101 and ``Document.legacy`` set.

    Args:
        source: the text.
        strict_xta: report everything that is not plain XTA.
        types: names of types that the text uses but other files define; they are not contextual keywords here.
    """
    items, lexed, diagnostics, legacy = _read(source, "document", partial(resolve_document, types=types))
    if items is None:
        return None, diagnostics
    span = Span(source, 0, len(source.text))
    document = ast.Document(span, items, _comments_beside(items, lexed), legacy)
    diagnostics += lost_documentation(document)
    if strict_xta:
        from tachk.syntax.parsing.strict import additions

        diagnostics += additions(document)
    return document, diagnostics


def parse_declarations(source: Source | Span) -> tuple[tuple[Any, ...], Diagnostics]:
    """The text of a UPPAAL ``declaration`` or ``instantiation`` element."""
    items, _, diagnostics, _ = _read(source, "declarations_fragment", resolve_fragment)
    return items or (), diagnostics


def parse_system(source: Source | Span) -> tuple[tuple[Any, ...], Diagnostics]:
    """The text of a UPPAAL ``system`` element: declarations, instantiations, the system line, progress and gantt."""
    items, _, diagnostics, _ = _read(source, "document", resolve_document)
    return items or (), diagnostics


def parse_parameters(source: Source | Span) -> tuple[tuple[ast.Parameter, ...], Diagnostics]:
    """A parameter list without its parentheses."""
    value, _, diagnostics, _ = _read(source, "parameters_fragment", resolve_fragment)
    return value or (), diagnostics


def parse_select(source: Source | Span) -> tuple[tuple[ast.SelectBinding, ...], Diagnostics]:
    """A ``select`` label: ``i : int[0,3], j : id_t``."""
    value, _, diagnostics, _ = _read(source, "select_fragment", resolve_fragment)
    return value or (), diagnostics


def parse_constraint(source: Source | Span) -> tuple[ast.Expression | None, Diagnostics]:
    """A ``guard`` or ``invariant`` label; None if it is empty."""
    value, _, diagnostics, _ = _read(source, "constraint_fragment", resolve_fragment)
    return value, diagnostics


def parse_rate(source: Source | Span) -> tuple[tuple[ast.Expression, ast.Expression | None] | None, Diagnostics]:
    """An ``exponentialrate`` label, ``r`` or ``r : q``, as both parts; None if it is empty."""
    value, _, diagnostics, _ = _read(source, "rate_fragment", resolve_fragment)
    return value, diagnostics


def parse_synchronisation(source: Source | Span) -> tuple[ast.SynchronisationLabel | None, Diagnostics]:
    """A ``synchronisation`` label; None if it is empty."""
    value, _, diagnostics, _ = _read(source, "synchronisation_fragment", resolve_fragment)
    return value, diagnostics


def parse_assignment(source: Source | Span) -> tuple[tuple[ast.Expression, ...], Diagnostics]:
    """An ``assignment`` label: expressions separated by commas."""
    value, _, diagnostics, _ = _read(source, "assignment_fragment", resolve_fragment)
    return value or (), diagnostics


def parse_expression(source: Source | Span) -> tuple[ast.Expression | None, Diagnostics]:
    """One expression, such as the value of ``-D NAME=expr``."""
    value, _, diagnostics, _ = _read(source, "expression", resolve_fragment)
    return value, diagnostics


def parse_query(source: Source, start: int = 0, end: int | None = None) -> tuple[ast.QueryEntry | None, Diagnostics]:
    """One query, or the part of a text that holds one."""
    lexed = lexer().cut(source, start, end)
    deep = bracket_errors(lexed.tokens)
    if deep:
        return None, (*lexed.errors, *deep)
    value, errors = drive("query", _without_unread(resolve_query(lexed.tokens), lexed))
    return _unless_deep(value, lexed, _all_errors(lexed, errors))


def _read(
    source: Source | Span, start: str, resolve: Callable[[list[Token]], list[Token]]
) -> tuple[Any, Lexed, Diagnostics, bool]:
    """Value, tokens and comments, diagnostics, and whether the text could only be read as UPPAAL 3.x."""
    lexed = lexer().cut(source.source, source.start, source.end) if isinstance(source, Span) else lexer().cut(source)
    deep = bracket_errors(lexed.tokens)
    if deep:
        return None, lexed, (*lexed.errors, *deep), False
    tokens = _without_unread(resolve(lexed.tokens), lexed)
    value, errors = drive(start, tokens)
    if errors and not lexed.errors:
        old_tokens = as_legacy([replace(token) for token in tokens], lexer().symbols, start)
        old_value, old_errors = drive(start, old_tokens)
        if not old_errors:
            from tachk.syntax.parsing.old_precedence import regrouped

            value, diagnostics = _unless_deep(old_value, lexed, ())
            return value, lexed, (_legacy_warning(errors[0]), *regrouped(tokens), *diagnostics), True
    value, diagnostics = _unless_deep(value, lexed, _all_errors(lexed, errors))
    return value, lexed, diagnostics, False


def _without_unread(tokens: list[Token], lexed: Lexed) -> list[Token]:
    """The tokens; unknown characters within queries of other analyses, such as ``Pr[#<=10]``, are not errors, while
    names in backticks outside formulas are."""
    for token in tokens:
        if token.type == "QUOTED" and token.text.startswith("`"):
            where = Span(token.span.source, token.span.start, token.span.start + 1)
            lexed.errors.append(
                Diagnostic("E0002", "the character '`' cannot be used here", where, "only formulas have such names")
            )
    unread = [token.span for token in tokens if token.type in ("UNCHECKED", "SENTENCE")]
    if unread and lexed.errors:
        lexed.errors = [
            error
            for error in lexed.errors
            if error.code != "E0002" or not any(span.start <= error.span.start < span.end for span in unread)
        ]
    return tokens


def _all_errors(lexed: Lexed, errors: Diagnostics) -> Diagnostics:
    """Lexical and syntax errors in the order of the text; of a line with a lexical error only that."""

    def line(diagnostic: Diagnostic) -> int:
        return diagnostic.span.source.line_column(diagnostic.span.start)[0]

    spoilt = {line(error) for error in lexed.errors}
    errors_left = [*lexed.errors, *(error for error in errors if line(error) not in spoilt)]
    return tuple(sorted(errors_left, key=lambda error: error.span.start))


def _unless_deep(value: Any, lexed: Lexed, diagnostics: Diagnostics) -> tuple[Any, Diagnostics]:
    """Refuse trees that recursive passes could not walk."""
    deep = nesting_errors(lexed.tokens, value)
    return (None, diagnostics + deep) if deep else (value, diagnostics)


def comments_within(span: Span) -> tuple[ast.Comment, ...]:
    """All comments of a part of a text, in order."""
    lexed = lexer().cut(span.source, span.start, span.end)
    comments = (*lexed.comments, *(comment for docs in lexed.docs.values() for comment in docs))
    return tuple(sorted(comments, key=lambda comment: comment.span.start))


def _comments_beside(items: tuple[ast.Item, ...], lexed: Lexed) -> tuple[ast.Comment, ...]:
    """The comments that no node holds: not the documentation of a node, not inside a block that is kept as text."""
    held = {node.span.start for item in items for node in documented(item) if node.doc}
    loose = [comment for offset, docs in lexed.docs.items() if offset not in held for comment in docs]
    raw = [item.span for item in items if isinstance(item, ast.GanttDeclaration | ast.ForeignImport)]
    raw += [
        declaration.span
        for item in items
        if isinstance(item, ast.Template)
        for declaration in item.declarations
        if isinstance(declaration, ast.ForeignImport)
    ]
    comments = [c for c in (*lexed.comments, *loose) if not any(span.start <= c.span.start < span.end for span in raw)]
    return tuple(sorted(comments, key=lambda comment: comment.span.start))


def _legacy_warning(first: Diagnostic) -> Diagnostic:
    return Diagnostic(
        "W0101",
        "this text is read as UPPAAL 3.x, where commas join conditions and constants have no type",
        first.span,
        "tachk fmt writes it in today's syntax",
    )


def has_errors(diagnostics: Diagnostics) -> bool:
    """True if any of the diagnostics is more than a warning."""
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)
