"""Formulas in ``Pr(...)`` are true, false and open on as many runs as `tachk simulate --monitor` says."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from random import Random

import pytest

import tachk
from tachk.engine.simulation.simulator import RecordedChanges, SimulationEnding, SimulationOptions
from tachk.engine.simulation.simulator import time_bound as ticks_until
from tachk.logic.horizon import horizon
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.columns import chosen_columns
from tachk.simulation.formulas import truths_on
from tachk.simulation.runs import Runs
from tachk.simulation.statistics.estimate import Estimated
from tachk.syntax.formula import Always, Eventually, Formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.walk import nodes_of_kind
from tests.support.formulas import FLAGS, FormulaShape, random_formula

pytestmark = pytest.mark.drawn

FLAGGED = """
{unit}
{flags}
int[0, 1] count;
process Flips(bool &flag, const int least, const int most) {{
    clock x;
    init location off {{
        invariant x <= most;
        to on {{ guard x >= least; assign x = 0, flag = true; }}
    }}
    location on {{
        invariant x <= most;
        to off {{ guard x >= least; assign x = 0, flag = false; }}
        to passing;
    }}
    committed location passing {{ to off {{ assign x = 0, flag = false; }} }}
}}
process Ends() {{
    clock x;
    init location begun {{
        invariant x <= 2;
        to begun {{ guard x >= 1; assign x = 0; }}
        to begun {{ guard x >= 1; assign x = 0, count = count + 1; }}
        to stuck {{ guard x >= 1; }}
    }}
    location stuck {{ invariant x <= 3; }}
}}
{instances}
system {names}, Ends;
"""
SHAPE = FormulaShape(depth=2, numeric=False, unbounded=False)


def flagged(unit: str = "") -> tachk.Model:
    instances = "\n".join(f"P{n} = Flips({flag}, {1 + n % 2}, {2 + n});" for n, flag in enumerate(FLAGS))
    flags = "\n".join(f"bool {flag};" for flag in FLAGS)
    names = ", ".join(f"P{n}" for n in range(len(FLAGS)))
    return tachk.loads(FLAGGED.format(unit=unit, flags=flags, instances=instances, names=names))


def monitored(
    model: tachk.Model, formula: Formula, until: Fraction, runs: int, seed: int
) -> tuple[Counter[Truth], Counter[SimulationEnding]]:
    """The verdicts of ``tachk simulate --monitor`` and how its runs end."""
    network = model.network
    end = ticks_until(until)
    drawn = Runs(network, chosen_columns(network, FLAGS))
    named = (NamedFormula("p", "", formula, unit=network.time_unit),)
    drawing = SimulationOptions(seed, end.ticks, ticks_per_unit=end.ticks_per_unit)
    truths: Counter[Truth] = Counter()
    endings: Counter[SimulationEnding] = Counter()
    for run in drawn.draw(drawing, range(runs), RecordedChanges(observed=True)):
        truths[truths_on(drawn.trace(run), named)["p"]] += 1
        endings[run.ending] += 1
    return truths, endings


@pytest.mark.parametrize("unit", ["", "time_unit = 10 ms;"])
def test_runs_are_evaluated_as_monitors_judge_them(unit: str) -> None:
    model, random, runs = flagged(unit), Random(5), 12
    seen: Counter[Truth] = Counter()
    ended: Counter[SimulationEnding] = Counter()
    for number in range(40):
        formula = random_formula(random, SHAPE, 2)
        reach = horizon(formula)
        assert reach is not None
        bound = random.choice((None, 2, 6))
        until = reach if bound is None else min(reach, Fraction(bound))
        if not any(True for _ in nodes_of_kind(formula, Always, Eventually)):
            continue  # no operator at all, or UPPAAL's U
        text = f"Pr({print_formula(formula)})" if bound is None else f"Pr[<={bound}]({print_formula(formula)})"
        (found,) = model.estimate(text, runs=runs, seed=number)
        assert isinstance(found, Estimated)
        truths, endings = monitored(model, formula, until, runs, number)
        sample = found.sample
        assert (sample.hits, sample.unknown) == (truths[Truth.TRUE], truths[Truth.UNDETERMINED]), (text, number)
        seen += truths
        ended += endings
    assert all(seen[truth] > 10 for truth in Truth)
    assert {SimulationEnding.HORIZON, SimulationEnding.TIME_LOCK, SimulationEnding.FAULT} <= set(ended)
