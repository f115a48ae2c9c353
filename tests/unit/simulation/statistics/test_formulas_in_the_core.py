"""Formulas that the core evaluates on runs while it draws them, against the monitors of recorded traces."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
import pytest

from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, RecordedRows, SimulationOptions
from tachk.model.expressions import BOOL, Binary, Constant, Expression, LocationTest, Reference
from tachk.model.network import Network
from tachk.model.run_formulas import RunFormula, RunOperator, RunWindow
from tachk.model.statistical import FormulaPath, RunBound, Scale
from tachk.model.types import IntType
from tachk.recordings.traces.certainty import is_certainly_false
from tachk.recordings.traces.core_monitor import monitor_truth
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.columns import Column
from tachk.simulation.monitored import ObservedColumn, monitored_formula
from tachk.simulation.runs import Runs
from tachk.simulation.statistics.formula_sampler import conditions_of, formula_program, formula_sampler
from tachk.simulation.statistics.sampling import RunSource
from tests.support import Shape, random_case
from tests.support.seeds import seeds

RUNS = 12
UNTIL = 12
SHAPES = (Shape(), Shape(hurried=0.3), Shape(exact=0.6, language=True), Shape(processes=2, hurried=0.1))
PREFIX = (RunOperator.EVENTUALLY, RunOperator.ALWAYS, RunOperator.ONCE, RunOperator.HISTORICALLY)


def window(random: Random) -> RunWindow:
    grid = random.choice([1, 2, 3])
    lower = Fraction(random.randrange(4 * grid), grid)
    upper = None if random.random() < 0.15 else lower + Fraction(random.randrange(5 * grid), grid)
    return RunWindow(lower, upper, random.random() < 0.7, random.random() < 0.7)


def drawn_condition(random: Random, network: Network) -> Expression:
    numbers = [variable for variable in network.all_variables() if isinstance(variable.type, IntType)]
    if numbers and random.random() < 0.4:
        variable = random.choice(numbers)
        assert isinstance(variable.type, IntType)
        value = random.randint(variable.type.low, variable.type.high)
        operator = random.choice([BinaryOperator.EQUAL, BinaryOperator.LESS, BinaryOperator.GREATER_EQUAL])
        return Binary(operator, Reference(variable), Constant(value), BOOL)
    if random.random() < 0.05:
        return Constant(random.randrange(2), BOOL)
    process = random.randrange(len(network.processes))
    return LocationTest(process, random.randrange(len(network.processes[process].locations)))


def drawn_formula(random: Random, network: Network, depth: int) -> RunFormula:
    def operand() -> RunFormula | Expression:
        if depth > 1 and random.random() < 0.7:
            return drawn_formula(random, network, depth - 1)
        return drawn_condition(random, network)

    kind = random.random()
    if kind < 0.45:
        return RunFormula(random.choice(PREFIX), (operand(),), window(random))
    if kind < 0.6:
        operator = random.choice([RunOperator.UNTIL, RunOperator.SINCE])
        return RunFormula(operator, (operand(), operand()), window(random))
    if kind < 0.8:
        return RunFormula(random.choice([RunOperator.AND, RunOperator.OR]), (operand(), operand()))
    if kind < 0.9:
        return RunFormula(random.choice([RunOperator.RISE, RunOperator.FALL]), (operand(),))
    if kind < 0.95 and not isinstance(condition := drawn_condition(random, network), Constant):
        return RunFormula(RunOperator.CHANGE, (condition,))
    return RunFormula(RunOperator.NOT, (operand(),))


def recorded_truths(network: Network, formula: RunFormula, drawing: SimulationOptions) -> list[Truth]:
    """The truths on runs that are recorded first."""
    conditions = conditions_of(formula)
    runs = Runs(network, [Column(str(number), condition) for number, condition in enumerate(conditions)])
    program = formula_program(formula, conditions, drawing.ticks_per_unit)
    truths = []
    for run in runs.draw(drawing, range(RUNS), RecordedChanges(observed=True)):
        if not len(run.times):
            truths.append(Truth.UNDETERMINED)
            continue
        trace = runs.trace(run).refined(program.ticks_per_unit)
        found = monitor_truth(program, trace).verdict
        unsure = found is Truth.FALSE and not is_certainly_false(program, trace)
        truths.append(Truth.UNDETERMINED if unsure else found)
    return truths


@pytest.mark.parametrize("seed", seeds(range(120)))
def test_truths_are_those_of_recorded_runs(seed: int) -> None:
    random = Random(seed)
    network = random_case(random, SHAPES[seed % len(SHAPES)]).network
    drawing = SimulationOptions(seed, UNTIL * TICKS_PER_UNIT, steps=random.choice([300, 3, 60]))
    for _ in range(5):
        formula = drawn_formula(random, network, 3)
        try:
            expected = recorded_truths(network, formula, drawing)
        except (InputError, UnsupportedError):
            return
        path = FormulaPath(RunBound(Scale.TIME, Fraction(UNTIL)), None, formula)
        source = RunSource(seed, threads=1 + seed % 2, most_steps=drawing.steps)
        assert formula_sampler(network, path, source).draw(RUNS).answers.tolist() == expected, formula


@pytest.mark.parametrize("seed", seeds(range(20)))
def test_rows_stay_as_they_are_recorded(seed: int) -> None:
    random = Random(seed)
    network = random_case(random, SHAPES[seed % len(SHAPES)]).network
    drawing = SimulationOptions(seed, UNTIL * TICKS_PER_UNIT, steps=200)
    formulas = [drawn_formula(random, network, 2) for _ in range(2)]
    conditions = tuple(dict.fromkeys(each for formula in formulas for each in conditions_of(formula)))
    columns = [Column(str(number), condition) for number, condition in enumerate(conditions)]
    try:
        runs = Runs(network, columns)
        expected = [recorded_truths(network, formula, drawing) for formula in formulas]
    except (InputError, UnsupportedError):
        return
    given = [
        monitored_formula(
            formula_program(formula, conditions, TICKS_PER_UNIT),
            list(map(ObservedColumn, range(len(columns)))),
            drawing,
        )
        for formula in formulas
    ]
    recorded = list(runs.draw(drawing, range(RUNS), RecordedChanges(observed=True)))
    for rows in (RecordedRows.VIOLATING, RecordedRows.ALL):
        drawn = runs.simulator.monitored(drawing, range(RUNS), given, rows)
        truths = np.array([drawn.truths(number) for number in range(len(formulas))])
        assert truths.tolist() == expected
        for number, run in enumerate(recorded):
            record = drawn.record(number)
            whole = rows is RecordedRows.ALL or (truths[:, number] == Truth.FALSE).any()
            assert record.times().tolist() == run.times.tolist()[0 if whole else -1 :]
            assert record.observed().tolist() == run.observed[0 if whole else -1 :].reshape(-1).tolist()
            assert (record.end, record.transitions, record.lasts) == (run.end, run.transitions, run.lasts)
