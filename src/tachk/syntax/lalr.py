"""Running LALR tables.

lark builds the tables, this module runs them, some three times as fast as lark does: rules are looked up once instead
of at every reduction, and the long chains of reductions that only pass on a value (an operand is a product is a sum is
a relation ...) are followed once for each place in the tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from lark.parsers.lalr_analysis import Shift
from lark.parsers.lalr_parser_state import ParseConf

from tachk.syntax.tokens import END, Token


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


class Tables:
    """What lark computed for one start symbol, and the chains of reductions met so far."""

    def __init__(self, computed: ParseConf[int]) -> None:
        reductions = {
            id(rule): _Reduction(
                len(rule.expansion),
                rule.origin.name,
                computed.callbacks[rule],
                rule.options.expand1 and rule.alias is None and len(rule.expansion) == 1,
            )
            for row in computed.states.values()
            for action, rule in row.values()
            if action is not Shift
        }
        self.rows: dict[int, dict[str, _Step]] = {
            state: {name: what if action is Shift else reductions[id(what)] for name, (action, what) in row.items()}
            for state, row in computed.states.items()
        }
        self.start = computed.start_state
        self.end = computed.end_state
        self.chains: dict[tuple[int, int, str], int] = {}

    def goto(self, state: int, name: str) -> int:
        target = self.rows[state][name]
        assert isinstance(target, int)
        return target

    def end_of_chain(self, below: int, state: int, kind: str) -> int:
        """The state in which the reductions end that pass on the value between two states, before a terminal."""
        key = below, state, kind
        while isinstance(step := self.rows[state].get(kind), _Reduction) and step.passes_on and state != self.end:
            state = self.goto(below, step.origin)
        self.chains[key] = state
        return state


class Stack:
    """The state of a parse: states, and one value for each but the first."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.states = [tables.start]
        self.values: list[Any] = []

    def feed(self, token: Token) -> Any:
        """Take one token; after the last one (of type `END`) the value of the whole text is returned.

        Raises:
            UnexpectedToken: the token does not fit.
        """
        rows, chains, end = self.tables.rows, self.tables.chains, self.tables.end
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
                states[-1] = self.tables.end_of_chain(below, state, kind) if following is None else following
            else:
                if size:
                    parts = values[-size:]
                    del states[-size:], values[-size:]
                else:
                    parts = []
                value = step.build(parts)
                states.append(self.tables.goto(states[-1], step.origin))
                values.append(value)
            if states[-1] == end and kind == END:
                return values[-1]

    def accepts(self, kinds: Iterable[str], levels: int | None = None) -> bool:
        """Whether these terminals could come next, the stack cut to a height."""
        rows, end = self.tables.rows, self.tables.end
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
                states.append(self.tables.goto(states[-1], step.origin))
                if states[-1] == end and kind == END:
                    return True
        return True

    def takes(self, level: int, kind: str) -> bool:
        """Whether the state at a level has a step for a terminal."""
        return kind in self.tables.rows[self.states[level]]

    def choices(self) -> Sequence[str]:
        """The terminals for which the current state has a step."""
        return [name for name in self.tables.rows[self.states[-1]] if name.isupper()]

    def cut(self, height: int) -> None:
        """Forget all states but the lowest ``height``, and their values."""
        del self.states[height:]
        del self.values[height - 1 :]
