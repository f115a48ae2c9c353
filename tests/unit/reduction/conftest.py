"""Fixtures for tests of symmetry."""

from __future__ import annotations

import pytest

from tachk.engine.symmetry import transpositions


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """The transpositions whose proof has been tried, in the order of the tries."""
    found: list[object] = []
    transposition_of = transpositions.transposition_of

    def counted(*given: object) -> object:
        found.append(given)
        return transposition_of(*given)

    monkeypatch.setattr(transpositions, "transposition_of", counted)
    return found
