"""Shorter tests that fail as a test did: delta debugging of its inputs.

Zeller, Hildebrandt, "Simplifying and isolating failure-inducing input" (2002), algorithm ddmin. The system is started
anew for each try, and gets what is left of the inputs at the same times. Any failure counts: the shortest test that
fails is wanted, not the same fault.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from time import monotonic

from tachk.base.records import dataclass, replace
from tachk.recordings.conformance.events import RecordedEvent
from tachk.simulation.testing.input_choice import ScriptedInputs
from tachk.simulation.testing.system_adapter import SystemAdapter
from tachk.simulation.testing.tester import TestedModel, TestResult, TestRun, TestVerdict, confirmed, follow


@dataclass(frozen=True, slots=True)
class Shortening:
    """Attributes:
    result: of the shortest test that fails.
    inputs: how many the test had that was shortened.
    tries: how many tests were run.
    is_repeated: the same inputs made the system fail again; otherwise the result is that of the first test.
    is_minimal: without any one of its inputs the test does not fail; False where the time was over before that was
        known.
    """

    result: TestResult
    inputs: int
    tries: int
    is_repeated: bool
    is_minimal: bool


def shorten(
    model: TestedModel, open_system: Callable[[], SystemAdapter], run: TestRun, result: TestResult, seconds: float
) -> Shortening:
    """Looks for a shorter test that fails.

    Args:
        open_system: gives the system for one test.
        run, result: of the test that failed.
        seconds: no try begins later.
    """
    tries = _Tries(model, open_system, run, monotonic() + seconds)
    best = tries.failing(run.sent)
    if best is None:
        return Shortening(result, len(run.sent), tries.count, False, False)
    parts = 2
    while best[0].sent:
        inputs = best[0].sent
        parts = min(parts, len(inputs))
        shorter = next((found for rest in _complements(inputs, parts) if (found := tries.failing(rest))), None)
        if tries.is_over:
            break
        if shorter is not None:
            best, parts = shorter, max(parts - 1, 2)
        elif parts < len(inputs):
            parts = min(2 * parts, len(inputs))
        else:
            return Shortening(best[1], len(run.sent), tries.count, True, True)
    return Shortening(best[1], len(run.sent), tries.count, True, not best[0].sent)


def _complements(inputs: Sequence[RecordedEvent], parts: int) -> Sequence[Sequence[RecordedEvent]]:
    """The inputs without one part of them, for each of so many parts."""
    borders = [len(inputs) * part // parts for part in range(parts + 1)]
    return [(*inputs[:first], *inputs[last:]) for first, last in pairwise(borders) if first < last]


class _Tries:
    """Tests with some of the inputs of one that failed.

    Attributes:
        count: how many were run.
        is_over: there was no time for one that was wanted.
    """

    def __init__(self, model: TestedModel, open_system: Callable[[], SystemAdapter], run: TestRun, ends: float) -> None:
        self._model = model
        self._open_system = open_system
        spread = run.settings.uncertainty.width + 1
        self._settings = replace(run.settings, duration=run.recording.end + spread)
        self._ends = ends
        self.count = 0
        self.is_over = False

    def failing(self, inputs: Sequence[RecordedEvent]) -> tuple[TestRun, TestResult] | None:
        """The test with these inputs; None if it does not fail, or there is no time for it."""
        if monotonic() >= self._ends:
            self.is_over = True
            return None
        self.count += 1
        run = follow(
            self._model, self._open_system(), self._settings, ScriptedInputs(inputs, self._settings.uncertainty)
        )
        if run.reason or run.is_as_modelled:
            return None
        result = confirmed(self._model, run)
        return (run, result) if result.verdict is TestVerdict.FAIL else None
