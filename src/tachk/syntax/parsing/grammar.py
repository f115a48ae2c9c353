"""A grammar as it is run: terminals, rules and LALR tables, as plain data that can be stored."""

from __future__ import annotations

from typing import NamedTuple


class Terminal(NamedTuple):
    """Attributes:
    text: the only text of the terminal, or None where it has a regular expression.
    """

    name: str
    text: str | None
    regexp: str
    priority: int


class GrammarRule(NamedTuple):
    """Attributes:
    origin: what the rule makes.
    callback: the method of the builder that makes it. A rule whose origin begins with ``_`` has none: its values
        become values of the rule that uses it.
    size: how many values there are.
    places: where the value of an optional part that is absent is None: how many stand before each value, and after
        the last one. Empty where there are no such parts.
    inlined: the values that are lists of values.
    passes_on: a single value is left as it is.
    """

    origin: str
    callback: str
    size: int
    places: tuple[int, ...]
    inlined: frozenset[int]
    passes_on: bool

    @property
    def is_inlined(self) -> bool:
        return self.origin.startswith("_")


class Grammar(NamedTuple):
    """Attributes:
    rows: for each state and symbol the state to go to or, below zero, the complement of the rule to reduce by.
    starts: the first state for each start symbol.
    ends: the last one.
    """

    terminals: tuple[Terminal, ...]
    rules: tuple[GrammarRule, ...]
    rows: dict[int, dict[str, int]]
    starts: dict[str, int]
    ends: dict[str, int]
