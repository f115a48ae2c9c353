"""Texts to sentences.

A text is a sentence if exactly one of its parses has conditions and durations that can be read and parts that go
together. Otherwise what is reported is, in this order: parses that differ in meaning; parts in the wrong order or
that do not go together; a phrase that resembles one of the grammar; a condition that cannot be read; what was expected.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice, pairwise

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Source, Span
from tachk.syntax.formulas.tokens import is_sentence, lacks_full_stop
from tachk.syntax.parsing.lalr import Stack
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.parsing.tokens import END, Token
from tachk.syntax.sentences.conditions import Unreadable
from tachk.syntax.sentences.order import assemble
from tachk.syntax.sentences.parses import Correction, SentenceParse, SentenceParses, exact_phrases
from tachk.syntax.sentences.printer import print_sentence
from tachk.syntax.sentences.similar_phrases import similar_phrases
from tachk.syntax.sentences.tables import START, opening_words, sentence_tables, spelling
from tachk.syntax.sentences.text import Piece, cut
from tachk.syntax.sentences.tree import Sentence

Diagnostics = tuple[Diagnostic, ...]

_MOST_PARSES = 100


@dataclass(frozen=True, slots=True)
class _ParseOutcome:
    """The result of a parse.

    Attributes:
        fault: 0 none, 1 in the order of the parts, 2 in what goes together, 3 in what is a condition or a duration,
            4 in the syntax of one.
    """

    sentence: Sentence | None
    diagnostics: Diagnostics
    corrections: tuple[Correction, ...]
    fault: int


def parse_sentence(source: Source | Span) -> tuple[Sentence | None, Diagnostics]:
    """Read a sentence with its full stop, or the part of a text that holds one.

    Returns:
        The sentence, every part with its place in the source, and what is wrong; None where anything is.
    """
    span = source if isinstance(source, Span) else Span(source, 0, len(source.text))
    pieces, errors = cut(span)
    if errors:
        return None, errors
    if not pieces:
        return None, (Diagnostic("E0006", "there is no sentence", span),)
    span = pieces[0].span.to(pieces[-1].span)
    behind = next((after for piece, after in pairwise(pieces) if piece.kind == "stop"), None)
    if behind is not None:
        help = "write a sentence for each property"
        return None, (Diagnostic("E0144", "the text goes on behind the full stop", behind.span, help),)
    parses = SentenceParses(span, pieces, exact_phrases(pieces), lenient=False)
    outcomes = [_outcome(span, parse) for parse in islice(parses, _MOST_PARSES)]
    sound = _different(outcome.sentence for outcome in outcomes if outcome.fault == 0)
    if len(sound) == 1:
        return sound[0], ()
    if sound:
        return None, (_ambiguous(span, sound),)
    return None, _why_not(span, pieces, parses, outcomes)


def with_full_stop(text: str) -> str:
    """The text of an argument, completed if it is a sentence that only lacks its full stop."""
    *tokens, _ = lexer().cut(Source("", text)).tokens
    outcome = any(first.text == "expect" and second.text in ("holds", "fails") for first, second in pairwise(tokens))
    return f"{text}." if not outcome and not is_sentence(tokens) and lacks_full_stop(tokens) else text


def _outcome(span: Span, parse: SentenceParse) -> _ParseOutcome:
    stack = Stack(sentence_tables(), START)
    try:
        parts = None
        for token in parse.tokens:
            parts = stack.feed(Token(token.type, token.text, token.span))
    except Unreadable as unreadable:
        known = all(found.code in ("E0134", "E0144", "E0146") for found in unreadable.diagnostics)
        return _ParseOutcome(None, unreadable.diagnostics, parse.corrections, 3 if known else 4)
    assert parts is not None, "a parse ends with the end of the text"
    sentence, found = assemble(span, parts)
    fault = 0 if not found else 1 if sentence is not None else 2
    return _ParseOutcome(sentence, found, parse.corrections, fault)


def _different(sentences: Iterable[Sentence | None]) -> list[Sentence]:
    found: list[Sentence] = []
    for sentence in sentences:
        if sentence is not None and sentence not in found:
            found.append(sentence)
    return found


def _why_not(
    span: Span, pieces: tuple[Piece, ...], parses: SentenceParses, outcomes: list[_ParseOutcome]
) -> Diagnostics:
    best = min(outcomes, key=lambda outcome: (outcome.fault, len(outcome.diagnostics)), default=None)
    if best is not None and best.fault < 3:
        return _with_rewording(best)
    similar = SentenceParses(span, pieces, similar_phrases(pieces), lenient=True)
    meant = [_outcome(span, parse) for parse in islice(similar, _MOST_PARSES)]
    meant = [outcome for outcome in meant if outcome.corrections]
    intended = next((outcome for outcome in meant if outcome.fault == 0), None)
    if intended is None and best is not None:
        return _unreadable(best, pieces)
    intended = intended or min(meant, key=lambda outcome: outcome.fault, default=None)
    if intended is not None:
        return _suggestion(intended)
    return (_unexpected(span, pieces, parses),)


def _with_rewording(outcome: _ParseOutcome) -> Diagnostics:
    if outcome.sentence is None:
        return outcome.diagnostics
    first, *others = outcome.diagnostics
    help = f"did you mean: {print_sentence(outcome.sentence)}"
    return (Diagnostic(first.code, first.message, first.span, help, first.labels), *others)


def _suggestion(outcome: _ParseOutcome) -> Diagnostics:
    whole = None if outcome.sentence is None else f"did you mean: {print_sentence(outcome.sentence)}"
    found = []
    for correction in outcome.corrections:
        if correction.phrase == ".":
            found.append(Diagnostic("E0133", "a sentence ends with a full stop", correction.span, whole or "add '.'"))
        else:
            written = " ".join(correction.span.text.split())
            message = f"unknown phrase '{written}'; did you mean '{correction.phrase}'?"
            found.append(Diagnostic("E0141", message, correction.span, whole))
        whole = None
    return tuple(found)


def _ambiguous(span: Span, sentences: list[Sentence]) -> Diagnostic:
    first, second = (print_sentence(sentence) for sentence in sentences[:2])
    return Diagnostic(
        "E0145",
        "this sentence can be read in two ways",
        span,
        f"put conditions in parentheses: either {first} or {second}",
    )


def _unexpected(span: Span, pieces: tuple[Piece, ...], parses: SentenceParses) -> Diagnostic:
    place, expected = parses.furthest, parses.expected - {END}
    if "CONDITION" in expected and len(expected) > 5:
        help = "a condition that must be true is missing, as in 'whenever p is true, within 5 s, q must be true.'"
    else:
        names = sorted({spelling(name) for name in expected})
        help = "expected " + ", ".join(names[:-1]) + " or " * (len(names) > 1) + names[-1] if names else ""
    if place < len(pieces):
        at = pieces[place].span
        if place and pieces[place - 1].kind == "number" and pieces[place].kind == "word":
            units = "the units are ns, us, ms, s, min, h and d"
            return Diagnostic("E0135", f"'{at.text[:30]}' is not a unit of time", at, units)
        return Diagnostic("E0140", f"cannot read this sentence from '{at.text[:30]}' onwards", at, help or None)
    end = Span(span.source, span.end, span.end)
    return Diagnostic("E0140", "the sentence is not complete", end, help or None)


def _unreadable(outcome: _ParseOutcome, pieces: tuple[Piece, ...]) -> Diagnostics:
    """The reason why a condition cannot be read; if a word of the sentence stands in it, that is the reason."""
    musts = [piece for piece in pieces if piece.text.lower() == "must"]
    if len(musts) > 1:
        help = "write two sentences, or join the conditions: 'p and q must be true'"
        return (Diagnostic("E0144", "the sentence has a second 'must'", musts[1].span, help),)
    first, *others = outcome.diagnostics
    if first.span.text.lower() in opening_words():
        help = "join conditions inside: 'whenever p and q is true', not 'whenever p is true and q is true'"
        message = f"'{first.span.text}' has no place in a condition"
        return (Diagnostic("E0140", message, first.span, help), *others)
    return outcome.diagnostics
