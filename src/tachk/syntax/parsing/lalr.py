"""Running LALR tables.

lark computes the tables, this module runs them, some three times as fast as lark does: rules are looked up once instead
of at every reduction, and the long chains of reductions that only pass on a value (an operand is a product is a sum is
a relation ...) are followed once for each place in the tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from tachk.base.records import dataclass
from tachk.syntax.parsing.grammar import Grammar, GrammarRule
from tachk.syntax.parsing.tokens import END, Token

T = TypeVar("T")


class UnexpectedToken(Exception):
    """The token does not fit; the stack is as it was when that was found."""


@dataclass(frozen=True, slots=True)
class _Reduction:
    """Attributes:
    size: how many values the rule takes.
    build: makes one value of them.
    passes_on: the rule takes one value and leaves it as it is.
    """

    size: int
    origin: str
    build: Callable[[list[Any]], Any]
    passes_on: bool


_Step = int | _Reduction
"""A state to go to with the token, or a reduction."""


class _OnDemand(dict[int, T]):
    """Facts about each state of the tables, computed when the state is first met."""

    def __init__(self, compute: Callable[[int], T]) -> None:
        self.compute = compute

    def __missing__(self, state: int) -> T:
        computed = self[state] = self.compute(state)
        return computed


class Tables:
    """The tables of a grammar, with a builder's methods, and the chains of reductions met so far.

    Attributes:
        rows: the step for each terminal.
        gotos: the state behind each rule.
    """

    def __init__(self, grammar: Grammar, builder: object) -> None:
        self._grammar = grammar
        self._builder = builder
        self._reductions = _OnDemand(self._reduction)
        self.rows = _OnDemand(self._steps)
        self.gotos = _OnDemand(self._targets)
        self.chains: dict[tuple[int, int, str], int] = {}

    def ends(self, start: str) -> tuple[int, int]:
        """The first and the last state for a start symbol."""
        return self._grammar.starts[start], self._grammar.ends[start]

    def _steps(self, state: int) -> dict[str, _Step]:
        row = self._grammar.rows[state]
        return {name: step if step >= 0 else self._reductions[~step] for name, step in row.items()}

    def _targets(self, state: int) -> dict[str, int]:
        return {name: step for name, step in self._grammar.rows[state].items() if step >= 0}

    def _reduction(self, number: int) -> _Reduction:
        rule = self._grammar.rules[number]
        return _Reduction(rule.size, rule.origin, _build(rule, self._builder), rule.passes_on and rule.size == 1)

    def end_of_chain(self, below: int, state: int, kind: str, end: int) -> int:
        """The state in which the reductions end that pass on the value between two states, before a terminal."""
        key = below, state, kind
        while isinstance(step := self.rows[state].get(kind), _Reduction) and step.passes_on and state != end:
            state = self.gotos[below][step.origin]
        self.chains[key] = state
        return state


def _build(rule: GrammarRule, builder: object) -> Callable[[list[Any]], Any]:
    """The function that makes one value of those of a rule."""
    make = list if rule.is_inlined else getattr(builder, rule.callback, None)
    if rule.passes_on:
        make = _single if make is None else _single_or(make)
    assert make is not None, f"no method for {rule.callback}"
    return _spread(rule, make) if rule.places or rule.inlined else make


def _single(values: list[Any]) -> Any:
    (value,) = values
    return value


def _single_or(make: Callable[[list[Any]], Any]) -> Callable[[list[Any]], Any]:
    return lambda values: values[0] if len(values) == 1 else make(values)


def _spread(rule: GrammarRule, make: Callable[[list[Any]], Any]) -> Callable[[list[Any]], Any]:
    """Puts None in the places of absent parts, and the values of inlined rules in the place of these."""
    places = rule.places or (0,) * (rule.size + 1)
    inlined = rule.inlined

    def build(values: list[Any]) -> Any:
        spread: list[Any] = []
        for place, value in enumerate(values):
            if places[place]:
                spread += [None] * places[place]
            if place not in inlined:
                spread.append(value)
            elif spread:
                spread += value
            else:
                # A list that grows at its end would otherwise be copied for each element. It is not shared.
                spread = value
        return make(spread + [None] * places[-1] if places[-1] else spread)

    return build


class Stack:
    """The state of a parse: states, and one value for each but the first."""

    def __init__(self, tables: Tables, start: str) -> None:
        self.tables = tables
        first, self.end = tables.ends(start)
        self.states = [first]
        self.values: list[Any] = []

    def feed(self, token: Token) -> Any:
        """Takes one token; after the last one (of type `END`) the value of the whole text is returned.

        Raises:
            UnexpectedToken: the token does not fit.
        """
        tables = self.tables
        rows, gotos, chains, end = tables.rows, tables.gotos, tables.chains, self.end
        states, values = self.states, self.values
        kind = token.type
        while True:
            step = rows[states[-1]].get(kind)
            if step is None:
                raise UnexpectedToken
            if isinstance(step, int):
                states.append(step)
                values.append(token)
                return None
            size = step.size
            if step.passes_on:
                below, state = states[-2], states[-1]
                following = chains.get((below, state, kind))
                states[-1] = tables.end_of_chain(below, state, kind, end) if following is None else following
            else:
                if size:
                    parts = values[-size:]
                    del states[-size:], values[-size:]
                else:
                    parts = []
                value = step.build(parts)
                states.append(gotos[states[-1]][step.origin])
                values.append(value)
            if states[-1] == end and kind == END:
                return values[-1]

    def accepts(self, kinds: Iterable[str], levels: int | None = None) -> bool:
        """True if these terminals could come next, the stack cut to a height."""
        rows, gotos, end = self.tables.rows, self.tables.gotos, self.end
        states = self.states[:levels]
        for kind in kinds:
            while True:
                step = rows[states[-1]].get(kind)
                if step is None:
                    return False
                if isinstance(step, int):
                    states.append(step)
                    break
                if step.size:
                    del states[-step.size :]
                states.append(gotos[states[-1]][step.origin])
                if states[-1] == end and kind == END:
                    return True
        return True

    def takes(self, level: int, kind: str) -> bool:
        """True if the state at a level has a step for a terminal."""
        return kind in self.tables.rows[self.states[level]]

    def choices(self) -> Sequence[str]:
        """The terminals for which the current state has a step."""
        return [name for name in self.tables.rows[self.states[-1]] if name.isupper()]

    def cut(self, height: int) -> None:
        """Forget all states but the lowest ``height``, and their values."""
        del self.states[height:]
        del self.values[height - 1 :]
