"""Explanations on random formulas and traces: every statement in them is true, and says enough."""

from __future__ import annotations

import math
from collections.abc import Iterator
from random import Random

import numpy as np
import pytest

from tachk.api.monitoring import MonitorReport
from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.monitors.compiler import ticks_needed
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.monitors.offline import verdict_on
from tachk.recordings.monitors.record import MonitorRecord
from tachk.recordings.monitors.trace_semantics import HeldValues
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.monitor_program import MonitorNode, MonitorProgram, NodeKind
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.verdict_explanation import TruthReason, horizon, memory
from tests.support.exact_trace import ExactTrace
from tests.support.formulas import FormulaShape, random_formula, random_trace
from tests.support.seeds import enough, seeds

ALL = FormulaShape()


def trace_of(exact: ExactTrace, ticks: int) -> Trace:
    ticks = math.lcm(ticks, exact.end.denominator, *(time.denominator for time in exact.times))
    columns = {
        name: np.array(values, dtype=np.uint8 if isinstance(values[0], bool) else np.float64)
        for name, values in exact.columns.items()
    }
    times = np.array([int(time * ticks) for time in exact.times], dtype=np.int64)
    return Trace("random", times, columns, int(exact.end * ticks), ticks)


def report(seed: int, shape: FormulaShape) -> MonitorReport:
    random = Random(seed)
    formula = random_formula(random, shape, random.choice((1, 2, 3)))
    trace = trace_of(random_trace(random, shape), ticks_needed(formula))
    booleans = [name for name, values in trace.columns.items() if values.dtype.kind == "u"]
    program = compile_formula(formula, trace.columns, trace.ticks_per_unit, booleans=booleans)
    named = NamedFormula("p", "", formula)
    return MonitorReport(
        MonitorRecord(trace, "", (verdict_on(named, program, trace, EvaluationOptions(), HeldValues()),))
    )


def every(reason: TruthReason) -> Iterator[TruthReason]:
    yield reason
    for part in reason.parts:
        yield from every(part)


@pytest.mark.parametrize("start", range(0, 600, 100))
def test_what_is_said_is_true(start: int) -> None:
    for seed in seeds(range(start, start + 100)):
        judged = report(seed, ALL)
        (verdict,) = judged
        assert (verdict.finding is None) == (verdict.measured is Truth.TRUE)
        assert judged.to_text()
        assert judged.to_dict()
        if verdict.finding is None:
            continue
        finding = verdict.finding
        assert finding.blamed
        assert finding.response.value is verdict.measured
        for reason in every(finding.response):
            assert verdict.explainer.signal(reason.node).at(reason.cell) is reason.value, seed
        if finding.trigger is not None and finding.triggered is not None:
            assert finding.triggered[0] <= finding.cell <= finding.triggered[1]
            assert finding.trigger.value is Truth.TRUE


@pytest.mark.parametrize("start", range(1000, 1600, 100))
def test_a_violation_is_certain_when_it_is_said_to_be(start: int) -> None:
    violated = 0
    for seed in seeds(range(start, start + 100)):
        judged = report(seed, ALL)
        (verdict,) = judged
        if verdict.measured is not Truth.FALSE or verdict.finding is None or verdict.finding.decided is None:
            continue
        trace = judged.record.trace
        end = (verdict.finding.decided + 1) // 2
        if end >= trace.end:
            continue
        violated += 1
        rows = int(trace.times.searchsorted(end, side="right"))
        monitor = OnlineMonitor(verdict.program, robustness=False)
        monitor.push(trace.times[:rows], [trace.columns[name][:rows] for name in verdict.program.columns])
        assert monitor.advance(end + 1) is Truth.FALSE, seed
    assert enough(violated > 10)


def node(kind: NodeKind, *operands: int, lower: int = 0, upper: int = -1) -> MonitorNode:
    return MonitorNode(kind, operands, -1, lower, upper)


def test_how_far_a_formula_looks() -> None:
    nodes = (
        node(NodeKind.TRUE),
        node(NodeKind.EVENTUALLY, 0, upper=5),
        node(NodeKind.ONCE, 1, lower=2, upper=7),
        node(NodeKind.AND, 1, 2),
        node(NodeKind.ALWAYS, 3, lower=3),
    )
    program = MonitorProgram((), (), nodes, 1)
    assert horizon(program) == 8
    assert memory(program) == 7


def test_segments_and_searches_of_a_signal() -> None:
    signal = NodeSignal(np.array([0, 3, 5, 9]), np.array([0, 1, 1, 2], dtype=np.uint8), 12)
    assert signal.stretches() == [(0, 2, Truth.FALSE), (3, 8, Truth.TRUE), (9, 11, Truth.UNDETERMINED)]
    assert [signal.at(cell) for cell in (2, 3, 8, 11, 12)] == [
        Truth.FALSE,
        Truth.TRUE,
        Truth.TRUE,
        Truth.UNDETERMINED,
        Truth.UNDETERMINED,
    ]
    assert (signal.first(Truth.TRUE, 0, 11), signal.first(Truth.TRUE, 6, 11), signal.first(Truth.TRUE, 9, 11)) == (
        3,
        6,
        None,
    )
    assert (signal.last(Truth.TRUE, 0, 11), signal.last(Truth.TRUE, 0, 6), signal.last(Truth.FALSE, 3, 11)) == (
        8,
        6,
        None,
    )
    assert (signal.run(7), signal.run(0), signal.run(10)) == ((3, 8), (0, 2), (9, 11))
