"""Random runs that are judged by formulas, in each cell of a sweep."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from tachk.cli.actions.simulation.formulas import columns_with, formulas_for, truths_on
from tachk.engine.simulation.simulator import RecordedChanges, SimulationOptions
from tachk.model.network import Network
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.runs import Runs
from tachk.simulation.times import horizon_of
from tachk.verify.campaign.job import FormulaCounts


@dataclass(frozen=True, slots=True)
class JudgedRuns:
    """How runs are drawn, and by what they are judged; as for `tachk simulate --monitor`."""

    formulas: str
    until: str
    runs: int
    seed: int

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(formula.name for formula in read_formulas(self.formulas))

    def __str__(self) -> str:
        """All that the answers depend on: what is in a file of formulas may change while its name stays."""
        stated = "; ".join(
            f"{each.name}: {each.text} {dict(each.constants or {})} {dict(each.durations or {})}"
            for each in read_formulas(self.formulas)
        )
        return f"{self.formulas!r} ({stated}), {self.runs} runs until {self.until}, seed {self.seed}"

    def judged(self, network: Network) -> Iterator[FormulaCounts]:
        formulas = formulas_for(self.formulas, network, dict(network.constants))
        runs = Runs(network, columns_with(network, (), formulas))
        truths: dict[str, Counter[Truth]] = {formula.name: Counter() for formula in formulas}
        transitions = 0
        until = horizon_of(self.until, network.time_unit)
        drawing = SimulationOptions(self.seed, until.ticks, ticks_per_unit=until.ticks_per_unit)
        for run in runs.draw(drawing, range(self.runs), RecordedChanges(observed=True)):
            transitions += run.transitions
            told = truths_on(runs.trace(run), formulas) if len(run.times) else {}
            for name, counts in truths.items():
                counts[told.get(name, Truth.UNDETERMINED)] += 1
        for name, counts in truths.items():
            yield FormulaCounts(name, counts[Truth.TRUE], counts[Truth.FALSE], counts[Truth.UNDETERMINED], transitions)
