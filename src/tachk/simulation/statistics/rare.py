"""Probabilities of rare events, by importance splitting.

The levels are distances of discrete states from the goal in the zone graph, in transitions. Each replication is an
estimate that is right on average; the interval is Student's for the mean of replications that are normally distributed,
and so no guarantee.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from tachk.base.arguments import check_argument
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.engine.compiler.hybrid import refuse_hybrid
from tachk.engine.simulation.splitting import Splitter
from tachk.model.network import Network
from tachk.model.statistical import Path, PathProperty
from tachk.simulation.intervals import student_quantile
from tachk.simulation.statistics.sampling import RunSource, lowered_path, trial_question, with_elapsed_time

_BATCH = 4
"""The number of replications that are made at once."""
_LEAST = 16
"""Fewer of them do not show how much they vary."""


@dataclass(frozen=True, slots=True)
class Splitting:
    """The effort of splitting.

    Attributes:
        relative: the half-width of the interval, as a share of the probability.
        effort: runs of each stage.
        most: replications, after which an estimate ends that is not so narrow.
        zones: the number that is explored for the levels.

    Raises UsageError where the share is not a number.
    """

    relative: float = 0.1
    effort: int = 1000
    most: int = 1000
    zones: int = 200_000

    def __post_init__(self) -> None:
        check_argument("relative", self.relative, "float")


@dataclass(frozen=True, slots=True)
class Rare:
    """The result of splitting.

    Attributes:
        probabilities: of each replication.
        levels: how many there are.
        states: discrete ones whose distance was looked for; ``whole``: there are no others.
        unknown: runs that ended before it was known whether they get nearer to the goal.
    """

    probabilities: NDArray[np.float64]
    levels: int
    states: int
    whole: bool
    transitions: int
    unknown: int

    @property
    def mean(self) -> float:
        return float(self.probabilities.mean())

    def half_width(self, confidence: float) -> float:
        """The half-width of the interval of the mean, if replications are normally distributed (Student 1908)."""
        count = len(self.probabilities)
        deviation = float(self.probabilities.std(ddof=1)) / sqrt(count)
        return student_quantile(confidence, count - 1) * deviation


def split(network: Network, path: PathProperty, source: RunSource, confidence: float, splitting: Splitting) -> Rare:
    """The probability of ``<> p`` or ``p U q``.

    Raises:
        UsageError: the goal is not a rare one: it is there at the start, or cannot be reached.
        StoppedError: the limit on time is over.
    """
    if not isinstance(path, Path):
        raise UsageError(
            "splitting has no levels for a formula with several temporal operators",
            "ask without --splitting, or let the model reach a location where the formula is true: Pr[...](<> P.there)",
        )
    if path.always:
        raise UsageError("splitting needs <> or U", "ask for the violation: Pr[...](<> not p)")
    refuse_hybrid(network, "splitting")
    network, path = with_elapsed_time(network, path)
    program, chances = lowered_path(network, path)
    question = trial_question(network, path, program)
    splitter = Splitter(program, chances, splitting.zones)
    levels = splitter.levels
    if not levels.reached:
        whole = "no run reaches the goal" if levels.whole else f"the goal is not among {levels.states} states"
        raise UsageError(f"there are no levels: {whole}", "ask without --splitting")
    probabilities: list[float] = []
    transitions = unknown = 0
    while True:
        check_job()
        numbers = range(len(probabilities), len(probabilities) + _BATCH)
        for probability, steps, lost in splitter.replications(
            question, source.seed, numbers, splitting.effort, source.threads, source.most_steps
        ):
            probabilities.append(probability)
            transitions += steps
            unknown += lost
        found = Rare(np.array(probabilities), levels.top, levels.states, levels.whole, transitions, unknown)
        enough = len(probabilities) >= _LEAST and found.half_width(confidence) <= splitting.relative * found.mean
        if (enough and found.mean > 0) or len(probabilities) >= splitting.most:
            return found
