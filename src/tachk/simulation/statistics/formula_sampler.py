"""Runs on which a formula with several temporal operators is evaluated, as monitors do on recorded traces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm

import numpy as np

from tachk.engine.compiler.features import check_simulated
from tachk.engine.compiler.lower import lower_simulation
from tachk.engine.simulation.simulator import SimulationOptions, Simulator, counted_endings
from tachk.engine.simulation.trials import TrialAnswer, Trials
from tachk.model.expressions import Constant, Expression
from tachk.model.floating import DOUBLE
from tachk.model.network import Network
from tachk.model.run_formulas import RunFormula, RunOperator
from tachk.model.statistical import FormulaPath
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
from tachk.simulation.monitored import ObservedColumn, monitored_formula
from tachk.simulation.statistics.sampling import RunSource, Sampler, reach_of


def formula_sampler(network: Network, path: FormulaPath, source: RunSource) -> Sampler:
    """The runs that a monitor evaluates: each ends soon after the truth of the formula is known.

    Raises UnsupportedError for a network that cannot be simulated, InputError for a wrong initial value, and UsageError
    for runs that are too long for the bounds of the formula.
    """
    check_simulated(network)
    conditions = conditions_of(path.formula)
    program, chances = lower_simulation(network, conditions)
    simulator = Simulator(program, chances)
    reach = reach_of(path.bound, network, program)
    assert reach.until is not None
    drawing = SimulationOptions(
        source.seed, reach.until, steps=source.most_steps, threads=source.threads, ticks_per_unit=reach.ticks_per_unit
    )
    columns = [ObservedColumn(number, condition.type == DOUBLE) for number, condition in enumerate(conditions)]
    formula = monitored_formula(formula_program(path.formula, conditions, reach.ticks_per_unit), columns, drawing)

    def trials(numbers: range) -> Trials:
        drawn = simulator.monitored(drawing, numbers, [formula], until_decided=True)
        answers, endings = drawn.truths(0), drawn.endings()
        return Trials(
            answers,
            drawn.ends(),
            int(drawn.transitions().sum()),
            np.full(len(answers), np.nan),
            counted_endings(endings[answers != TrialAnswer.YES]),
            simulator.first_fault(drawn),
        )

    return Sampler(trials, source.first, reach.ticks_per_unit)


def conditions_of(formula: RunFormula) -> tuple[Expression, ...]:
    """The conditions in a formula that have to be observed."""
    return tuple(dict.fromkeys(_conditions(formula)))


def _conditions(formula: RunFormula) -> Iterable[Expression]:
    for operand in formula.operands:
        if isinstance(operand, RunFormula):
            yield from _conditions(operand)
        elif not isinstance(operand, Constant):
            yield operand


def formula_program(formula: RunFormula, conditions: tuple[Expression, ...], ticks_per_unit: int) -> MonitorProgram:
    """The program of a formula, in ticks so fine that they count the times of runs and its own bounds.

    Args:
        ticks_per_unit: of the runs.
    """
    ticks = lcm(ticks_per_unit, *(bound.denominator for bound in _bounds(formula)))
    compiler = _RunCompiler(conditions, ticks)
    compiler.node(formula)
    numbers = range(len(conditions))
    return MonitorProgram(tuple(map(str, numbers)), tuple(map(_atom, numbers)), tuple(compiler.nodes), ticks)


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
    ticks: int
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
