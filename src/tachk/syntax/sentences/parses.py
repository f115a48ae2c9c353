"""The ways to read a text as a sentence.

A sentence is a row of phrases with conditions and durations between them. Where a condition ends is not known in
advance, since it may contain any word; so all ways to cut the text are followed at once through the tables of the
grammar. They form a graph of (place in the text, state of the parser) whose paths are the parses. Phrases may also be
taken for what resembles them, at a cost; the cheapest path then says what was meant.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heappop, heappush
from itertools import count

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.base.time_units import SPELLINGS
from tachk.syntax.parsing.lalr import Tables
from tachk.syntax.parsing.tokens import END, Token
from tachk.syntax.sentences.tables import START, Phrase, phrases, sentence_tables
from tachk.syntax.sentences.text import Piece

States = tuple[int, ...]
Node = tuple[int, States]

_MOST_NODES = 20_000


@dataclass(frozen=True, slots=True)
class Candidate:
    """A phrase that could stand at some place.

    Attributes:
        end: the index of the piece behind it.
        cost: 0 if it stands there, more if something like it does.
    """

    phrase: Phrase
    end: int
    cost: int


@dataclass(frozen=True, slots=True)
class Correction:
    """The words in the text, and the phrase that they were taken for."""

    span: Span
    phrase: str


@dataclass(frozen=True, slots=True)
class SentenceParse:
    tokens: tuple[Token, ...]
    corrections: tuple[Correction, ...]


@dataclass(frozen=True, slots=True)
class _Step:
    terminal: str
    first: int
    end: int
    cost: int
    phrase: str
    target: Node


def exact_phrases(pieces: Sequence[Piece]) -> list[list[Candidate]]:
    """For each place the phrases that stand there."""
    words = [piece.text.lower() for piece in pieces]
    return [
        [
            Candidate(phrase, place + len(phrase.words), 0)
            for phrase in phrases()
            if tuple(words[place : place + len(phrase.words)]) == phrase.words
        ]
        for place in range(len(words) + 1)
    ]


class SentenceParses:
    """The parses of a text with given candidates for phrases.

    Attributes:
        furthest: the first piece that no parse gets past by means of a phrase, and the terminals expected there.
    """

    def __init__(self, span: Span, pieces: Sequence[Piece], candidates: list[list[Candidate]], lenient: bool) -> None:
        """Args:
        lenient: take a missing full stop as a correction.
        """
        self._span = span
        self._pieces = pieces
        self._candidates = candidates
        self._lenient = lenient
        self._tables = sentence_tables()
        first, _ = self._tables.ends(START)
        self._start: Node = (0, (first,))
        self._steps: dict[Node, list[_Step]] = {}
        self._behind_conditions: set[States] = set()
        self.furthest = 0
        self.expected: set[str] = set()
        self._explore()
        self._remaining = self._costs_to_the_end()

    def __iter__(self) -> Iterator[SentenceParse]:
        """The parses, cheapest first."""
        remaining = self._remaining
        if self._start not in remaining:
            return
        order = count()
        heap: list[tuple[int, int, int, Node, _Path | None]] = [
            (remaining[self._start], next(order), 0, self._start, None)
        ]
        while heap:
            _, _, cost, node, path = heappop(heap)
            if node[0] < 0:
                yield self._parse_along(path)
                continue
            for step in self._steps[node]:
                if step.target in remaining:
                    total = cost + step.cost
                    # Of equal costs the one further on comes first: a depth-first walk.
                    heappush(heap, (total + remaining[step.target], -next(order), total, step.target, (path, step)))

    def _explore(self) -> None:
        pending = [self._start]
        while pending and len(self._steps) < _MOST_NODES:
            node = pending.pop()
            if node in self._steps:
                continue
            steps = self._steps[node] = list(self._steps_from(node))
            pending += [step.target for step in steps if step.target[0] >= 0 and step.target not in self._steps]
        for node in pending:
            self._steps.setdefault(node, [])

    def _steps_from(self, node: Node) -> Iterator[_Step]:
        place, states = node
        accepted = self._tables.rows[states[-1]]
        self._note(node)
        if "CONDITION" in accepted:
            yield from self._conditions(node)
        if "DURATION" in accepted:
            for end in self._durations(place):
                yield from self._step(node, "DURATION", end)
        if place == len(self._pieces):
            if END in accepted:
                yield _Step(END, place, place, 0, "", (-1, ()))
            if "FULL_STOP" in accepted and self._lenient and not self._stopped():
                yield from self._step(node, "FULL_STOP", place, 1, ".")
        elif "FULL_STOP" in accepted and self._pieces[place].kind == "stop":
            yield from self._step(node, "FULL_STOP", place + 1)
        elif "LABEL" in accepted and place + 1 < len(self._pieces) and self._pieces[place + 1].text == ":":
            if self._pieces[place].kind == "word":
                yield from self._step(node, "LABEL", place + 1)
        for candidate in self._candidates[place]:
            if candidate.phrase.terminal in accepted:
                text = candidate.phrase.text if candidate.cost else ""
                yield from self._step(node, candidate.phrase.terminal, candidate.end, candidate.cost, text)

    def _stopped(self) -> bool:
        return bool(self._pieces) and self._pieces[-1].kind == "stop"

    def _step(self, node: Node, terminal: str, end: int, cost: int = 0, phrase: str = "") -> Iterator[_Step]:
        states = _after(self._tables, node[1], terminal)
        if states is not None:
            yield _Step(terminal, node[0], end, cost, phrase, (end, states))

    def _conditions(self, node: Node) -> Iterator[_Step]:
        """A condition reaches to any place at which something can follow it."""
        place, states = node
        after = _after(self._tables, states, "CONDITION")
        if after is None:
            return
        self._behind_conditions.add(after)
        follows = {name for name in self._tables.rows[after[-1]] if _after(self._tables, after, name) is not None}
        end = place
        while end < len(self._pieces) and self._pieces[end].text != "," and self._pieces[end].kind != "stop":
            end += 1
            stop = end == len(self._pieces) and self._lenient
            if end < len(self._pieces):
                stop = self._pieces[end].kind == "stop"
            if (stop and "FULL_STOP" in follows) or any(c.phrase.terminal in follows for c in self._candidates[end]):
                yield _Step("CONDITION", place, end, 0, "", (end, after))

    def _durations(self, place: int) -> Iterator[int]:
        pieces = self._pieces
        if place < len(pieces) and pieces[place].kind in ("number", "word", "group", "quote"):
            yield place + 1
            if place + 1 < len(pieces) and pieces[place + 1].text.lower() in SPELLINGS:
                yield place + 2
            if place + 2 < len(pieces) and [p.text.lower() for p in pieces[place + 1 : place + 3]] in _TIME_UNITS:
                yield place + 3

    def _note(self, node: Node) -> None:
        """Keep what could stand behind the last phrase; a condition reaches as far as one likes and says nothing."""
        place, states = node
        if place >= self.furthest and states not in self._behind_conditions:
            if place > self.furthest:
                self.expected.clear()
            self.furthest = place
            rows = self._tables.rows[states[-1]]
            self.expected.update(name for name in rows if name.isupper() and _after(self._tables, states, name))

    def _costs_to_the_end(self) -> dict[Node, int]:
        sources: dict[Node, list[tuple[Node, int]]] = {}
        for node, steps in self._steps.items():
            for step in steps:
                sources.setdefault(step.target, []).append((node, step.cost))
        goal: Node = (-1, ())
        costs: dict[Node, int] = {}
        heap: list[tuple[int, Node]] = [(0, goal)]
        while heap:
            cost, node = heappop(heap)
            if node not in costs:
                costs[node] = cost
                for source, more in sources.get(node, ()):
                    heappush(heap, (cost + more, source))
        return costs

    def _parse_along(self, path: _Path | None) -> SentenceParse:
        steps: list[_Step] = []
        while path is not None:
            path, step = path
            steps.append(step)
        steps.reverse()
        tokens = tuple(Token(step.terminal, step.phrase, self._span_of(step)) for step in steps)
        corrections = tuple(Correction(self._span_of(step), step.phrase) for step in steps if step.cost)
        return SentenceParse(tokens, corrections)

    def _span_of(self, step: _Step) -> Span:
        pieces, source = self._pieces, self._span.source
        if step.end > step.first:
            return Span(source, pieces[step.first].span.start, pieces[step.end - 1].span.end)
        last = pieces[-1].span.end if pieces else self._span.start
        return Span(source, last, last)


_Path = tuple["_Path | None", _Step]

_TIME_UNITS = (["time", "unit"], ["time", "units"])
"""The words for the time unit of the model or the trace."""


def _after(tables: Tables, states: States, terminal: str) -> States | None:
    """The states of the parser behind a terminal, or None if it does not fit."""
    stack = list(states)
    while True:
        step = tables.rows[stack[-1]].get(terminal)
        if step is None:
            return None
        if isinstance(step, int):
            return (*stack, step)
        if step.size:
            del stack[-step.size :]
        stack.append(tables.gotos[stack[-1]][step.origin])
