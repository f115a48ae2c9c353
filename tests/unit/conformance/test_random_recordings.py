"""Recordings cut from random runs are accepted; of changed ones the engine says what a second definition says."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

import tachk
from tests.unit.conformance.small_models import csv_of, is_run, mutated, random_machine, random_run, text_of


@pytest.mark.parametrize("seed", range(6))
def test_engine_agrees_with_judge(seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    hidden = seed % 3 == 2
    machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
    model = tachk.loads(text_of(machines, hidden))
    file = tmp_path / "events.csv"
    for case in range(8):
        events, end = random_run(random, machines, 14, hidden)
        tolerance, late = random.randrange(2), random.randrange(3)
        if case % 4:
            events = mutated(random, events, end)
        expected = is_run(machines, events, end, tolerance, late, hidden)
        assert expected or case % 4, "a run of the model"
        file.write_text(csv_of(events, end), encoding="utf-8")
        found = tachk.conform(model, file, str(tolerance), str(late))
        assert found.accepted is expected, f"seed {seed}, case {case}"
