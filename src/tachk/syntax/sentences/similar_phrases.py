"""Misspellings and other wordings of the phrases of a sentence."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import lru_cache

from tachk.syntax.sentences.parses import Candidate, exact_phrases
from tachk.syntax.sentences.tables import Phrase, phrases
from tachk.syntax.sentences.text import Piece

_MODALS = frozenset({"shall", "should", "will", "has", "have", "needs", "ought"})

_WORDINGS = {
    "whenever": (
        *("when", "if", "once", "every time", "each time", "as soon as", "as often as", "at any point of time when"),
        *("at any time when", "upon", "in case", "given"),
    ),
    "while": ("during", "as long as", "so long as", "in mode", "when in"),
    "after": ("following", "since"),
    "before": ("until", "prior to", "up to"),
    "initially": ("at the beginning", "at first", "at start", "at the start", "in the beginning", "at time 0"),
    "globally": ("in general", "everywhere"),
    "always": ("at every instant", "it is always the case that", "in every state", "forever", "at each instant"),
    "within": (
        *("in", "inside", "in less than", "in at most", "after at most", "no later than", "not later than", "in under"),
        *("at the latest after", "during the next", "in the next", "within the next", "within at most"),
    ),
    "with a delay of at most": (
        *("with a delay of", "with a delay at most", "with a maximum delay of", "with a delay of up to"),
        *("with a delay of less than", "with a delay of maximum", "with a delay of no more than"),
    ),
    "with a delay of between": ("with a delay from", "with a delay of from"),
    "with no delay": ("without a delay", "without any delay", "with zero delay", "with 0 delay"),
    "immediately": ("at once", "instantly", "at the same time", "simultaneously", "instantaneously"),
    "eventually": ("finally", "sometime", "some time later", "sooner or later", "at some time", "at some point"),
    "becomes true": (
        *("gets true", "turns true", "goes true", "goes high", "becomes high", "rises", "is set", "becomes 1"),
        *("starts to hold", "becomes satisfied", "starts"),
    ),
    "becomes false": ("gets false", "turns false", "goes low", "falls", "is reset", "becomes 0", "ends"),
    "changes": ("is changed", "changes value", "changes its value"),
    "is true": ("holds", "is satisfied", "is high", "is the case", "was true", "are true", "is active"),
    "is false": ("does not hold", "is not true", "is low", "is not satisfied", "fails"),
    "and stays true for": (
        *("and remains true for", "and stays for", "and holds for", "and is true for", "and keeps true for"),
        *("for", "and stays so for", "and stays high for"),
    ),
    "must be true": (
        *("must hold", "must become true", "must be the case", "must be satisfied", "must be high", "must be"),
        *("must be set", "holds", "is true", "must get true", "must come true", "must always be true"),
        *("must always hold", "must also be true", "must be valid", "must have to be true", "must to be true"),
    ),
    "must be false": ("must not be true", "must not hold", "must never be true", "must be low", "must never hold"),
    "must stay true": ("must remain true", "must hold", "must be true", "must keep true", "must last", "must stay"),
    "must stay true until": (
        *("must remain true until", "must hold until", "must be true until", "must stay true till"),
        *("must stay true up to", "must stay until"),
    ),
    "must stay true from then on": ("must remain true from then on", "must be true from then on", "must stay true"),
    "must not occur": ("must never occur", "must not happen", "must never happen", "cannot occur", "may not occur"),
    "must occur": ("must happen", "must be reached", "must occur at least once", "occurs", "must occur once"),
    "must occur at least every": ("must occur every", "must recur every", "must be true at least every"),
    "must have been true": ("must have held", "must have occurred", "must have happened", "must have been"),
    "within the last": ("in the last", "during the last", "within the previous", "within the past"),
    "must be less than": ("must be always less than", "must be below", "must always be below", "must stay below"),
    "must be greater than": ("must be always greater than", "must be above", "must always be above", "must exceed"),
    "must be at most": ("must be always at most", "must not exceed", "must never exceed", "must be no more than"),
    "must be at least": ("must be always at least", "must be no less than", "must never be less than"),
    "must be inside": ("must be always inside", "must be within", "must always be within", "must stay between"),
    "must be outside": ("must be always outside", "must never be inside", "must never be between"),
    "at least": ("no less than", "not less than", "more than", "a minimum of", "minimum", "min"),
    "at most": ("no more than", "not more than", "less than", "up to", "a maximum of", "maximum", "max"),
    "later": ("afterwards", "after that", "thereafter"),
    "then": ("it follows that", "so"),
    "until": ("till", "up to"),
    "counting from": ("starting at", "counting", "from", "reference", "relative to", "with reference"),
}


def similar_phrases(pieces: Sequence[Piece]) -> list[list[Candidate]]:
    """For each place the phrases that stand there, and those that something like it stands for."""
    words = [piece.text.lower() if piece.kind == "word" or piece.text == "-" else "" for piece in pieces]
    candidates = exact_phrases(pieces)
    for place in range(len(words)):
        here = {(c.phrase.terminal, c.end): c for c in candidates[place]}
        for phrase in phrases():
            for end, cost in _resemblances(words, place, phrase):
                key = phrase.terminal, end
                if key not in here or cost < here[key].cost:
                    here[key] = Candidate(phrase, end, cost)
        candidates[place] = list(here.values())
    return candidates


def _resemblances(words: Sequence[str], place: int, phrase: Phrase) -> Iterator[tuple[int, int]]:
    """The ends of texts that begin at a place and resemble a phrase, each with its distance from it."""
    target = phrase.text
    length = len(phrase.words)
    for wording in _WORDINGS.get(target, ()):
        other = wording.split()
        if words[place : place + len(other)] == other:
            yield place + len(other), 2
    for size in range(max(1, length - 1), length + 2):
        if place + size > len(words):
            break
        passage = words[place : place + size]
        if "" in passage:
            break
        if passage[0] in _MODALS and phrase.words[0] == "must":
            # "shall be true", "has to be true", "is going to" aside.
            rest = passage[2:] if len(passage) > 1 and passage[1] == "to" else passage[1:]
            if tuple(rest) == phrase.words[1:]:
                yield place + size, 1
            continue
        text = " ".join(passage)
        most = _tolerance(target)
        if most and abs(len(text) - len(target)) <= most and _least_distance(text, target) <= most:
            cost = _distance(text, target, most)
            if 0 < cost <= most:
                yield place + size, cost


def _tolerance(phrase: str) -> int:
    return 0 if len(phrase) < 4 else 1 if len(phrase) < 6 else 2 if len(phrase) < 12 else 3


def _least_distance(one: str, other: str) -> int:
    """The number of letters that one text has and the other lacks: a cheap lower bound of their distance."""
    here, there = _letters(one), _letters(other)
    return max((here - there).total(), (there - here).total())


@lru_cache(maxsize=2000)
def _letters(text: str) -> Counter[str]:
    return Counter(text)


def _distance(one: str, other: str, most: int) -> int:
    """The number of insertions, deletions, replacements and swaps of neighbours between two texts, if at most that."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, left in enumerate(one, 1):
        earlier, before, row = before, row, [i]
        for j, right in enumerate(other, 1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (left != right))
            if i > 1 and j > 1 and left == other[j - 2] and one[i - 2] == right:
                cost = min(cost, earlier[j - 2] + 1)
            row.append(cost)
        if min(row) > most:
            return most + 1
    return row[-1]
