"""Runs on which a formula with several temporal operators is evaluated, as monitors do on recorded traces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm

import numpy as np

from tachk.base.time_units import length_of
from tachk.engine.simulation.simulator import RecordedChanges, Simulated, SimulationEnding, SimulationOptions
from tachk.engine.simulation.trials import TrialAnswer, Trials
from tachk.model.expressions import Constant, Expression
from tachk.model.floating import DOUBLE
from tachk.model.network import Network
from tachk.model.run_formulas import RunFormula, RunOperator
from tachk.model.statistical import FormulaPath
from tachk.recordings.traces.certainty import is_certainly_false
from tachk.recordings.traces.core_monitor import monitor_truth
from tachk.recordings.traces.monitor_program import (
    UNBOUNDED,
    AtomRelation,
    MonitorAtom,
    MonitorNode,
    MonitorProgram,
    NodeKind,
    ValueInstruction,
    ValueOperator,
)
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.simulation.columns import Column
from tachk.simulation.runs import Runs
from tachk.simulation.statistics.sampling import RunSource, Sampler, reach_of

_ANSWERS = {Truth.TRUE: TrialAnswer.YES, Truth.FALSE: TrialAnswer.NO, Truth.UNDETERMINED: TrialAnswer.UNKNOWN}


def formula_sampler(network: Network, path: FormulaPath, source: RunSource) -> Sampler:
    """The runs that a monitor evaluates. Raises UnsupportedError for a network that cannot be simulated, and InputError
    for a wrong initial value."""
    conditions = tuple(dict.fromkeys(_conditions(path.formula)))
    columns = [
        Column(str(number), condition, floating=condition.type == DOUBLE) for number, condition in enumerate(conditions)
    ]
    runs = Runs(network, columns)
    reach = reach_of(path.bound, network, runs.program)
    assert reach.until is not None
    drawing = SimulationOptions(
        source.seed, reach.until, steps=source.most_steps, threads=source.threads, ticks_per_unit=reach.ticks_per_unit
    )
    truth = _RunEvaluator(network, path.formula, conditions).truth

    def trials(numbers: range) -> Trials:
        drawn = runs.draw(drawing, numbers, RecordedChanges(observed=True))
        return _trials([(run, truth(runs.trace(run)) if len(run.times) else Truth.UNDETERMINED) for run in drawn])

    return Sampler(trials, source.first, reach.ticks_per_unit)


def _trials(evaluated: list[tuple[Simulated, Truth]]) -> Trials:
    endings: Counter[SimulationEnding] = Counter(run.ending for run, truth in evaluated if truth is not Truth.TRUE)
    return Trials(
        np.array([_ANSWERS[truth] for _, truth in evaluated], dtype=np.int8),
        np.array([run.end for run, _ in evaluated], dtype=np.int64),
        sum(run.transitions for run, _ in evaluated),
        np.full(len(evaluated), np.nan),
        dict(endings),
        next((run.fault for run, _ in evaluated if run.fault is not None), None),
    )


def _conditions(formula: RunFormula) -> Iterable[Expression]:
    for operand in formula.operands:
        if isinstance(operand, RunFormula):
            yield from _conditions(operand)
        elif not isinstance(operand, Constant):
            yield operand


@dataclass(slots=True)
class _RunEvaluator:
    """Attributes:
    programs: by the ticks of a time unit of the trace.
    """

    network: Network
    formula: RunFormula
    conditions: tuple[Expression, ...]
    programs: dict[int, MonitorProgram] = field(default_factory=dict)

    def truth(self, trace: Trace) -> Truth:
        """The truth of the formula on a run, as `tachk.recordings.monitors.offline` computes it."""
        program = self._program(trace)
        finer = trace.refined(program.ticks_per_unit)
        found = monitor_truth(program, finer).verdict
        return Truth.UNDETERMINED if found is Truth.FALSE and not is_certainly_false(program, finer) else found

    def _program(self, trace: Trace) -> MonitorProgram:
        if trace.ticks_per_unit not in self.programs:
            own, shown = length_of(self.network.time_unit), length_of(trace.unit)
            unit = Fraction(1) if own is None or shown is None else own / shown
            bounds = [bound * unit for bound in _bounds(self.formula)]
            ticks = lcm(trace.ticks_per_unit, *(bound.denominator for bound in bounds))
            compiler = _RunCompiler(self.conditions, unit * ticks)
            compiler.node(self.formula)
            numbers = range(len(self.conditions))
            columns, atoms = tuple(map(str, numbers)), tuple(map(_atom, numbers))
            self.programs[trace.ticks_per_unit] = MonitorProgram(columns, atoms, tuple(compiler.nodes), ticks)
        return self.programs[trace.ticks_per_unit]


def _bounds(formula: RunFormula) -> Iterable[Fraction]:
    yield formula.window.lower
    if formula.window.upper is not None:
        yield formula.window.upper
    for operand in formula.operands:
        if isinstance(operand, RunFormula):
            yield from _bounds(operand)


def _atom(number: int) -> MonitorAtom:
    return MonitorAtom(AtomRelation.TRUTH, (ValueInstruction(ValueOperator.COLUMN, float(number)),), (), str(number))


@dataclass(slots=True)
class _RunCompiler:
    """Attributes:
    ticks: of a time unit of the model.
    """

    conditions: tuple[Expression, ...]
    ticks: Fraction
    nodes: list[MonitorNode] = field(default_factory=list)
    numbers: dict[MonitorNode, int] = field(default_factory=dict)

    def node(self, part: RunFormula | Expression) -> int:
        """The number of the node of a formula or a condition."""
        if isinstance(part, Constant):  # known also where a run has ended
            return self._added(MonitorNode(NodeKind.TRUE if part.value else NodeKind.FALSE))
        if not isinstance(part, RunFormula):
            return self._added(MonitorNode(NodeKind.ATOM, atom=self.conditions.index(part)))
        if part.operator is RunOperator.CHANGE:
            (watched,) = part.operands
            assert not isinstance(watched, RunFormula)
            return self._added(MonitorNode(NodeKind.CHANGE, atom=self.conditions.index(watched)))
        operands = tuple(self.node(operand) for operand in part.operands)
        window = part.window
        upper = UNBOUNDED if window.upper is None else int(window.upper * self.ticks)
        return self._added(
            MonitorNode(
                NodeKind[part.operator.name],
                operands,
                lower=int(window.lower * self.ticks),
                upper=upper,
                lower_closed=window.lower_closed,
                upper_closed=window.upper_closed,
            )
        )

    def _added(self, node: MonitorNode) -> int:
        if node not in self.numbers:
            self.numbers[node] = len(self.nodes)
            self.nodes.append(node)
        return self.numbers[node]
