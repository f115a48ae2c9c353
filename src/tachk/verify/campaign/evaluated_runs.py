"""Random runs on which formulas are evaluated, in each cell of a sweep."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Source
from tachk.engine.simulation.simulator import RecordedChanges, RecordedRows, SimulationOptions
from tachk.model.network import Network
from tachk.recordings.monitors.formulas import formula_source, formulas_in
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.formulas import columns_with, formulas_about
from tachk.simulation.monitored import evaluated
from tachk.simulation.runs import Runs
from tachk.simulation.times import parsed_time_bound


@dataclass(frozen=True, slots=True)
class FormulaCounts:
    """On how many runs a formula is true, false, and neither for certain; and how many transitions they have."""

    name: str
    true: int
    false: int
    undetermined: int
    transitions: int


@dataclass(frozen=True, slots=True)
class EvaluatedRuns:
    """Random runs and the formulas that are evaluated on them, as of `tachk simulate --monitor`.

    Attributes:
        source: the text of the formulas, as `tachk.recordings.monitors.formulas.formula_source` reads it: other
            processes and machines do not need the file, which may change meanwhile.
        until: the length of the runs, such as ``100`` or ``2 h``.

    Raises UsageError where no run is to be drawn.
    """

    source: Source
    until: str = "100"
    runs: int = 100
    seed: int = DEFAULT_SEED

    def __post_init__(self) -> None:
        if self.runs < 1:
            raise UsageError(f"runs={self.runs}: formulas need at least one run")

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the formulas. Raises InputError and UsageError for a text that states none."""
        return tuple(formula.name for formula in formulas_in(self.source))

    def __str__(self) -> str:
        """All that the answers depend on: what is in a file of formulas may change while its name stays."""
        stated = "; ".join(
            f"{each.name}: {each.text} {dict(each.constants or {})} {dict(each.durations or {})}"
            for each in formulas_in(self.source)
        )
        return f"{stated}, {self.runs} runs until {self.until}, seed {self.seed}"

    def counts(self, network: Network, chosen: Mapping[str, int]) -> Iterator[FormulaCounts]:
        """The truth of the formulas on the runs of a cell.

        Args:
            chosen: the constants whose values are chosen for the cell. They count in the place of constants of a file
                of formulas, too.
        """
        formulas = formulas_about(self.source, network, chosen)
        runs = Runs(network, columns_with(network, (), formulas))
        truths: dict[str, Counter[Truth]] = {formula.name: Counter() for formula in formulas}
        transitions = 0
        until = parsed_time_bound(self.until, network.time_unit)
        drawing = SimulationOptions(self.seed, until.ticks, ticks_per_unit=until.ticks_per_unit)
        recorded = RecordedChanges(observed=True)
        for run, results in evaluated(runs, formulas, drawing, range(self.runs), recorded, RecordedRows.NONE):
            transitions += run.transitions
            for name, counts in truths.items():
                counts[results.get(name, Truth.UNDETERMINED)] += 1
        for name, counts in truths.items():
            yield FormulaCounts(name, counts[Truth.TRUE], counts[Truth.FALSE], counts[Truth.UNDETERMINED], transitions)


def evaluated_runs(given: str | os.PathLike[str], until: str, runs: int, seed: int) -> EvaluatedRuns:
    """The formulas that are evaluated in each cell.

    Raises InputError and UsageError for what cannot be read.
    """
    return EvaluatedRuns(formula_source(given), until, runs, seed)
