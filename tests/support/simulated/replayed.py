"""Formulas on simulated runs, and on the replays of these runs from their files: one verdict."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from tachk.base.records import dataclass
from tachk.base.span import Source
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationEnding, SimulationOptions
from tachk.meaning.run_view import RunNames
from tachk.model.random_networks import Shape, random_case
from tachk.recordings.monitors.formulas import NamedFormula, read_formulas
from tachk.recordings.monitors.offline import evaluate_formulas
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_files import open_trace
from tachk.simulation.columns import columns_for
from tachk.simulation.runs import Runs, steps_of
from tachk.simulation.stepping.replaying import replay_submitted
from tachk.simulation.stepping.run_file import read_run_file, steps_text
from tachk.simulation.stepping.signals import signals_of
from tests.support.simulated.proved import FORMS, formula_over

SHAPES = (
    Shape(processes=2, locations=3, clocks=2, constant=3, deadlocks=False, hurried=0.3),
    Shape(processes=2, locations=3, clocks=2, constant=2, deadlocks=False, strict=True, hurried=0.2),
    Shape(processes=3, locations=3, clocks=1, constant=2, deadlocks=False, hurried=0.5),
    Shape(processes=2, locations=3, clocks=2, constant=2, deadlocks=False, stopwatches=True),
    Shape(processes=2, locations=3, clocks=1, constant=2, deadlocks=False, language=True, faults=0.4, hurried=0.3),
)


@dataclass(frozen=True, slots=True)
class JudgedTwice:
    """A formula on a run. ``refusal``: why the file is not a run; empty if it is one."""

    seed: int
    run: int
    ending: SimulationEnding
    formula: str
    simulated: Truth
    replayed: Truth
    refusal: str = ""

    @property
    def agrees(self) -> bool:
        return not self.refusal and self.simulated is self.replayed


def judged_twice(seed: int, runs: int = 4, formulas: int = 4) -> Iterator[JudgedTwice]:
    """The verdicts about runs of a random network that end early: after some steps, by an error, a dead end or time."""
    random = Random(seed)
    network = random_case(random, SHAPES[seed % len(SHAPES)]).network
    texts = [formula_over(form, random, network) for form in random.sample(FORMS, formulas)]
    read = [formula for text in texts for formula in read_formulas(text)]
    drawn = Runs(network, columns_for(network, (), (name for formula in read for name in formula.columns)))
    drawing = SimulationOptions(
        seed,
        random.choice((3, 20)) * TICKS_PER_UNIT,
        random.choice(tuple(Policy)),
        steps=random.choice((0, 1, 2, 5, 20)),
    )
    names = RunNames(network)
    for run in drawn.draw(drawing, range(runs), RecordedChanges(actions=True, observed=True)):
        if run.ending is SimulationEnding.INITIAL or not len(run.times):
            continue
        steps = read_run_file(Source("a.run", steps_text(names, steps_of(run))))
        replayed = replay_submitted(names, steps)
        again = signals_of(names, drawn.columns, replayed.trace, "again").trace
        pairs = zip(read, _truths(read, drawn.trace(run)), _truths(read, again), strict=True)
        refusal = "" if replayed.refusal is None else replayed.refusal.reason.message
        for formula, one, other in pairs:
            yield JudgedTwice(seed, run.number, run.ending, formula.text, one, other, refusal)


def _truths(formulas: list[NamedFormula], trace: Trace) -> list[Truth]:
    return [
        verdict.truth
        for verdict in evaluate_formulas(formulas, open_trace(trace), EvaluationOptions(robustness=False)).verdicts
    ]
