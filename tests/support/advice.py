"""What a printed help says to write, applied to the text that it is about.

Each rule is a pattern for whole helps and what it does: the texts that the reader could have after it. A help that
matches none of `RULES` must match one of `NO_REPLACEMENTS`, which need a thought of the reader.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span

Advice = Callable[[Diagnostic, re.Match[str]], Iterator[str]]


@dataclass(frozen=True)
class AdviceRule:
    """Attributes:
    pattern: of the whole help.
    apply: from what the pattern matched to the mended texts.
    codes: the rule holds for these only; empty: for all.
    """

    pattern: str
    apply: Advice
    codes: frozenset[str] = frozenset()


def mended(diagnostic: Diagnostic) -> list[str] | None:
    """The texts with what the help says to write; None where no rule knows the help."""
    for rule in RULES:
        if rule.codes and diagnostic.code not in rule.codes:
            continue
        match = re.fullmatch(rule.pattern, diagnostic.help or "")
        if match is not None:
            return list(rule.apply(diagnostic, match))
    return None


def needs_thought(diagnostic: Diagnostic) -> bool:
    """Whether the help names nothing that could be written as it stands."""
    return any(re.fullmatch(pattern, diagnostic.help or "") for pattern in NO_REPLACEMENTS)


def _put(span: Span, text: str) -> str:
    whole = span.source.text
    return whole[: span.start] + text + whole[span.end :]


def _line(span: Span) -> Span:
    text = span.source.text
    start = text.rfind("\n", 0, span.start) + 1
    end = text.find("\n", span.start)
    return Span(span.source, start, len(text) if end < 0 else end)


# ---- what the rules do ----------------------------------------------------------------------------------------------


def _each(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """Each group in place of what is marked."""
    for text in match.groups():
        if text is not None:
            yield _put(diagnostic.span, text)


def _remove(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    yield _put(diagnostic.span, "")


def _each_named(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """Each name of a list in place of what is marked."""
    for name in re.split(r", | or | and ", match[1]):
        yield _put(diagnostic.span, name.strip("`"))


def _add(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """The group where it is missing: at what is marked if that is empty, at the label, or at the end."""
    span = diagnostic.span
    if span.start < span.end:
        label = diagnostic.labels[0].span if diagnostic.labels else None
        line = _line(span).end if diagnostic.code == "E0004" else len(span.source.text)
        place = line if label is None else label.start
        span = Span(span.source, place, place)
    yield _put(span, match[1])


def _in_front(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """Each group in front of what is marked."""
    start = Span(diagnostic.span.source, diagnostic.span.start, diagnostic.span.start)
    for text in match.groups():
        if text is not None:
            yield _put(start, f"{text} ")


def _above(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """A declaration at the top, on the same line, so that lines keep their numbers."""
    yield _put(Span(diagnostic.span.source, 0, 0), f"{match[1]} ")


def _swap(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """The second group by the first, all over the line."""
    line = _line(diagnostic.span)
    assert match[2] in line.text
    yield _put(line, line.text.replace(match[2], match[1]))


def _within(old: str) -> Advice:
    """Each group for a text within what is marked."""

    def apply(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
        for text in match.groups():
            if text is not None:
                yield _put(diagnostic.span, diagnostic.span.text.replace(old, text))

    return apply


def _both_brackets(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    line = _line(diagnostic.span)
    yield _put(line, line.text.replace("{", "(").replace("}", ")"))


_OPERAND = r"(?:[FG] )?\w+"


def _operands(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """The last group, a formula about p and q, in place of what is marked and the operands beside it."""
    text = diagnostic.span.source.text
    before = re.search(rf"({_OPERAND})\s*\Z", text[: diagnostic.span.start])
    behind = re.match(rf"\s*({_OPERAND})", text[diagnostic.span.end :])
    assert before is not None and behind is not None
    names = {"p": before[1], "q": behind[1]}
    formula = re.sub(r"\b[pq]\b", lambda name: names[name[0]], match[match.lastindex or 0])
    yield text[: before.start()] + formula + text[diagnostic.span.end + behind.end() :]


def _sentences(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """Each group in place of the line."""
    for text in match.groups():
        yield _put(_line(diagnostic.span), text)


def _rule(pattern: str, apply: Advice, codes: str = "") -> AdviceRule:
    return AdviceRule(pattern, apply, frozenset(codes.split()))


def _bounded(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """``p W[a, b] q`` by its two parts."""
    text, span = diagnostic.span.source.text, diagnostic.span
    interval = re.search(r"\[(\w+), ?(\w+)\]", span.text)
    before = re.search(r"(\S+) W\Z", text[: span.start])
    behind = re.match(r" ([\w.]+)", text[span.end :])
    assert interval is not None and before is not None and behind is not None
    names = {"p": before[1], "q": behind[1], "a": interval[1], "b": interval[2]}
    formula = re.sub(r"\b[pqab]\b", lambda name: names[name[0]], match[1])
    yield text[: before.start()] + formula + text[span.end + behind.end() :]


def _behind(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    """Each group right behind what is marked."""
    for text in match.groups():
        yield _put(diagnostic.span, f"{diagnostic.span.text}{text}")


def _by_reference(diagnostic: Diagnostic, match: re.Match[str]) -> Iterator[str]:
    yield _put(diagnostic.span, re.sub(r"(\w+)\Z", r"&\1", diagnostic.span.text))


def _rule(pattern: str, apply: Advice, codes: str = "") -> AdviceRule:
    return AdviceRule(pattern, apply, frozenset(codes.split()))


_QUOTED = r"`([^`]+)`"
_TEXT = "E0002 E0101 E0104 E0130 E0134 E0204"
"""Codes of mistakes in words and signs, whose help begins with what stands in place of them."""

RULES = (
    _rule(r"remove (?:it|one|the declaration)\b.*", _remove, "E0101 E0107 E0113 E0750"),
    _rule(r"leave the brackets out, or write (\[0, 5\])", lambda d, m: iter((*_each(d, m), *_remove(d, m)))),
    _rule(r"did you mean: (.+\.)", _sentences),
    _rule(r"put conditions in parentheses: either (.+\.) or (.+\.)", _sentences),
    _rule(r"did you mean ['`]([^'`]+)['`]\?", _each),
    _rule(r"add ['`]?([^'` ]+)['`]?", _add, "E0102 E0113 E0003 E0004 E0133"),
    _rule(r"write ([^`' ]+) for '[^']+'(?:, (\S+) for '[^']+')?", _each),
    _rule(rf"for `p R q` write {_QUOTED}: .*", _operands),
    _rule(rf"write {_QUOTED} for conditions, and {_QUOTED} for formulas", _operands),
    _rule(r"write `(p == q)`", _operands),
    _rule(r"write \( and \) in place of \{ and \}", _both_brackets),
    _rule(r"(?:a formula speaks about one run: )?write ([^`( ]+) in place of (\S+?)(?:: .*)?", _swap),
    _rule(r"write (imply)(?:, or G in place of A\[\] to make .*)?", _each),
    _rule(rf"write {_QUOTED}(?:: commas join assignments| right behind the query, .*)?", _each, f"{_TEXT} E0750"),
    _rule(r"write (\[0, 5\]) for 'within 5', (\[5, 5\]) for 'after exactly 5'", _each),
    _rule(r"write (\(p U.*) for a bounded one", _bounded),
    _rule(r"write (?!it )([^`'(].*)", _each, _TEXT),
    _rule(r"the operator is written (\w)(?:[,;] .*)?", _each),
    _rule(
        r"put (A\[\]) \(always\), (E<>) \(possibly\), (A<>) or (E\[\]) in front(?:; (G) and (F) make .*)?", _in_front
    ),
    _rule(r"write, for example, (.+)", _in_front),
    _rule(r"compare with (==)", _within("=")),
    _rule(r"`=` assigns; write `(==)` to compare|move the assignment to an update, or write `(==)` .*", _within("=")),
    _rule(r"write `(<)` or `(>)`; where a guard means both, use two edges", _within("!=")),
    _rule(r"write `(!)` to send or `(\?)` to receive", _behind),
    _rule(r"compare the clock with a bound, as in `x( <= 5)`", _behind),
    _rule(r"pass it by reference: put `&` in front of the name", _by_reference),
    _rule(rf"declare it above: {_QUOTED}", _above),
    _rule(rf"say what a time unit is with {_QUOTED} in the model, .*", _above),
    _rule(r"choose another name, for example '(\w+)'", _each),
    _rule(rf"say which, for example {_QUOTED}", _each),
    _rule(rf"say of which process: {_QUOTED}(?: or {_QUOTED})?", _each),
    _rule(r"there are (`.+`)", _each_named),
    _rule(r"(?:its|the) locations are (.+)", _each_named),
    _rule(rf"use a range such as {_QUOTED}, .*", _each),
    _rule(r"a comment begins with (//)", _each),
)

NO_REPLACEMENTS = (
    r"[^`'\[\]]*",
    # the dots, or e, i and value, stand for what only the reader knows
    r".*[`'][^`']*\.\.\.[^`']*[`'].*",
    r".*an integer expression `e`.*|choose one of them: `many\[i\]`|write `c!value`",
    # what to do is said, and only named by what is quoted
    r"declare it `const`, or use .*|add a (?:`return` at its end|value for .*)|write `init` in front of one location",
    r"combine comparisons of clocks with .*|add an edge with .*|write at least `init location idle;`",
    r"tachk tries every place; .*|a channel has no value; .*|made from `P` and running: `Q`|give `n` a smaller range",
    r"there is no next instant .*|parentheses may be missing, or .* is meant.*|ask for A\[\] not deadlock .*",
    r"one A\[\], A<>, E\[\] or E<> stands at the beginning .*|leave the unit out; .*|in XML, .*|tachk fmt writes .*",
    r"declare it in the 'state' line|if it names a column or signal, .*",
    # sentences
    r".*, as in 'whenever .*'|expected 'at least', .*|begin with 'initially' .*|'must not occur for 5 s' excludes .*",
    r"write two sentences.*|say with 'after c', .*|leave out the (?:time|scope).*|write 'becomes true' or .*",
    r"join conditions inside: .*",
)
"""Helps that need a thought of the reader, or quote what is an example."""
