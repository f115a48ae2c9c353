"""Budgets of strategies, changed for a test, and options with one of them switched off."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from tachk.engine import taking_turns, zone
from tachk.engine.options import Options
from tachk.engine.portfolio import PORTFOLIO
from tachk.verify import over_approximations, strategies
from tachk.verify.strategy import Strategy

TABLES = ("REACHABILITY", "SMT", "LIVENESS", "EXTREMES")
ALWAYS_ANSWER = ("zones", "smt", "bounded", "any-run", "recurring", "long-delays", "bisection")
"""Without these there may be no answer."""


def rows() -> Iterator[Strategy]:
    for table in TABLES:
        yield from getattr(strategies, table)


def each_switched_off() -> dict[str, Options]:
    """Options for which an answer may take more states, but is the same."""
    names = [row.name for row in (*rows(), *PORTFOLIO) if row.name not in ALWAYS_ANSWER]
    return {f"without {name}": Options().off(name) for name in names}


@contextmanager
def changed(change: Callable[[Strategy], Strategy]) -> Iterator[None]:
    """The tables with each strategy changed."""
    with pytest.MonkeyPatch.context() as patch:
        for table in TABLES:
            patch.setattr(strategies, table, tuple(map(change, getattr(strategies, table))))
        yield


def with_states(monkeypatch: pytest.MonkeyPatch, name: str, states: int) -> None:
    """The strategy of this name stores so many states at most."""
    assert name in {row.name for row in rows()}
    for table in TABLES:
        of_table = getattr(strategies, table)
        monkeypatch.setattr(
            strategies, table, tuple(replace(row, states=states) if row.name == name else row for row in of_table)
        )


def with_search_budgets(monkeypatch: pytest.MonkeyPatch, name: str | None = None, **budget: Any) -> None:
    """Changes fields of the search of the portfolio of this name; without a name, of those that have a budget.

    Where it says after how much work, there is no turn before."""
    budget = {"early_work": 0, **budget} if "after" in budget else budget
    chosen = [row.name for row in PORTFOLIO if (row.is_bounded if name is None else row.name == name)]
    rows = [replace(row, **budget) if row.name in chosen else row for row in zone.PORTFOLIO]
    for module in (zone, taking_turns):
        monkeypatch.setattr(module, "PORTFOLIO", tuple(rows))


@contextmanager
def without_first_tries() -> Iterator[None]:
    """What large networks are searched for is searched for in small ones, too."""
    with changed(lambda row: replace(row, states=0) if row.preliminary else row), pytest.MonkeyPatch.context() as patch:
        patch.setattr(over_approximations, "WORTH_CARRYING_OVER", 0)
        yield


def switched(options: Options, on: bool, *names: str) -> Options:
    """The options with what has these names switched on or off."""
    return options.on(*names) if on else options.off(*names)
