"""Budgets of strategies, changed for a test."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tachk.verify import strategies

TABLES = ("REACHABILITY", "LIVENESS")


def with_states(monkeypatch: pytest.MonkeyPatch, name: str, states: int) -> None:
    """The strategy of this name stores so many states at most."""
    tables = {table: getattr(strategies, table) for table in TABLES}
    assert any(row.name == name for rows in tables.values() for row in rows)
    for table, rows in tables.items():
        changed = tuple(replace(row, states=states) if row.name == name else row for row in rows)
        monkeypatch.setattr(strategies, table, changed)
