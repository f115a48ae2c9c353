"""Answers to statistical queries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

import numpy as np

from tachk.analysis.fold import known_values
from tachk.analysis.intervals import interval
from tachk.base.arguments import check_proportion
from tachk.base.diagnostics.diagnostic import UnsupportedError, UsageError
from tachk.base.records import dataclass
from tachk.engine.compiler.features import stopwatches
from tachk.engine.simulation.trials import TrialAnswer
from tachk.model.clock_sums import advances_clocks
from tachk.model.expressions import Expression
from tachk.model.floating import DOUBLE
from tachk.model.network import Network
from tachk.model.statistical import (
    ExpectedValue,
    Path,
    PathProperty,
    Probability,
    ProbabilityComparison,
    Scale,
    StatisticalQuery,
    Threshold,
    Trajectories,
)
from tachk.model.types import ClockType
from tachk.simulation.intervals import clopper_pearson
from tachk.simulation.statistics.deciding import Decision, Errors, RatioTest, comparison_test, threshold_test
from tachk.simulation.statistics.means import asymptotic_mean, bounded_mean
from tachk.simulation.statistics.rare import Rare, Splitting, split
from tachk.simulation.statistics.sampling import RunSource, SampledRuns, Sampler, path_sampler, value_sampler
from tachk.simulation.statistics.stopping import MOST_RUNS, StoppingRule, runs_for
from tachk.simulation.statistics.trajectories import Trajectory, picked, trajectories

_ROUND = 256
"""The number of runs that a test draws at once."""
_SECOND = 2**61
"""The number of the first run of what another probability is compared with: other runs, and so independent ones."""
_RUNS_OF_MEANS = 1000


@dataclass(frozen=True, slots=True)
class Settings:
    """Confidence parameters of a statistical query.

    Attributes:
        half_width: of the interval of a probability.
        runs: a fixed number of runs; None: as many as it takes.
        most_runs: after which a test without a decision ends.
        splitting: estimate probabilities by splitting.

    Raises UsageError where the confidence or the half width does not lie between 0 and 1.
    """

    source: RunSource = RunSource()
    confidence: float = 0.95
    half_width: float = 0.05
    runs: int | None = None
    errors: Errors = Errors()
    most_runs: int = 1_000_000
    splitting: Splitting | None = None

    def __post_init__(self) -> None:
        check_proportion("confidence", self.confidence)
        check_proportion("half_width", self.half_width)


@dataclass(frozen=True, slots=True)
class Estimated:
    """A probability.

    Attributes:
        low, high: they contain it at least with the confidence.
        method: ``sequential``: as many runs as it took; ``fixed``: a number that was fixed beforehand.
        always: the sample counts violations of ``[] p``.
    """

    query: StatisticalQuery
    sample: SampledRuns
    low: float
    high: float
    method: str
    always: bool

    @property
    def frequency(self) -> float:
        return _frequency(self.sample, self.always)

    def __repr__(self) -> str:
        return f"<Estimated {self.query.name}: {self.low:.4f} to {self.high:.4f}, {self.sample.runs} runs>"


@dataclass(frozen=True, slots=True)
class Decided:
    """The decision if a probability is large enough.

    Attributes:
        samples: of the probability, and perhaps of the one that it is compared with.
        frequencies: the observed frequency of each.
        interval: for a number of runs that was fixed beforehand.
    """

    query: StatisticalQuery
    decision: Decision
    samples: tuple[SampledRuns, ...]
    frequencies: tuple[float, ...]
    interval: tuple[float, float] | None = None

    def __repr__(self) -> str:
        return f"<Decided {self.query.name}: {self.decision.value}, {sum(each.runs for each in self.samples)} runs>"


@dataclass(frozen=True, slots=True)
class Mean:
    """A mean.

    Attributes:
        low, high: they contain it at least with the confidence, whatever the distribution; None: nothing is known of
            how large the value may be.
        asymptotic: what would contain it if there were very many runs.
        values: where the value certainly lies.
    """

    query: StatisticalQuery
    sample: SampledRuns
    mean: float
    low: float | None
    high: float | None
    asymptotic: tuple[float, float]
    values: tuple[float, float] | None

    def __repr__(self) -> str:
        return f"<Mean {self.query.name}: {self.mean:g}, {self.sample.runs} runs>"


@dataclass(frozen=True, slots=True)
class Split:
    """A probability that splitting found. The interval would contain it with the confidence if there were very many
    replications."""

    query: StatisticalQuery
    rare: Rare
    low: float
    high: float

    def __repr__(self) -> str:
        return f"<Split {self.query.name}: {self.low:g} to {self.high:g}>"


@dataclass(frozen=True, slots=True)
class DrawnRuns:
    """Runs that are shown.

    Attributes:
        picked: all runs on which the condition was evaluated, if one picks runs.
        interval: of the probability that the condition becomes true.
    """

    query: StatisticalQuery
    runs: tuple[Trajectory, ...]
    picked: SampledRuns | None = None
    interval: tuple[float, float] | None = None

    def __repr__(self) -> str:
        return f"<DrawnRuns {self.query.name}: {len(self.runs)} runs>"


Estimate = Estimated | Decided | Mean | Split | DrawnRuns


def estimate(network: Network, query: StatisticalQuery, settings: Settings) -> Estimate:
    """The answer to a query.

    Raises:
        UnsupportedError: the network is not simulated.
        UsageError: the bound is too long, the query measures something else than one clock, or splitting is chosen for
            a query that is not a probability.
        OutOfTimeError: the limit on time is over.
    """
    if settings.splitting is not None and not isinstance(query.question, Probability):
        raise UsageError(
            f"splitting estimates probabilities only, not {query.name}",
            "ask Pr[...](<> p) with --splitting, and the other queries without it",
        )
    match query.question:
        case Probability(path):
            if settings.splitting is not None:
                return _split(network, query, path, settings.splitting, settings)
            return _probability(network, query, path, settings)
        case Threshold() as threshold:
            return _threshold(network, query, threshold, settings)
        case ProbabilityComparison(first, second):
            return _comparison(network, query, (first, second), settings)
        case ExpectedValue() as expectation:
            return _mean(network, query, expectation, settings)
        case Trajectories() as wanted:
            return _drawn(network, query, wanted, settings)
        case never:
            assert_never(never)


def _frequency(sample: SampledRuns, always: bool) -> float:
    """The share of runs on which a path was true; ``always``: the sample counts those on which it was not."""
    share = sample.hits / sample.runs
    return 1 - share if always else share


# ---- probabilities --------------------------------------------------------------------------------------------------


def _probability(network: Network, query: StatisticalQuery, path: PathProperty, settings: Settings) -> Estimated:
    sampler = _sampler_of(network, path, settings.source)
    runs = settings.runs or path.runs
    if runs is None:
        rule = StoppingRule(settings.confidence, settings.half_width)
        if rule.analyses[-1] <= MOST_RUNS:
            low, high = _sequential(sampler, rule)
            return _estimated(query, sampler.sample, low, high, "sequential", path.always)
        runs = runs_for(settings.confidence, settings.half_width)
    sample = sampler.draw_up_to(runs)
    low, high = clopper_pearson(sample.hits, sample.runs, settings.confidence, sample.unknown)
    return _estimated(query, sample, low, high, "fixed", path.always)


def _estimated(
    query: StatisticalQuery, sample: SampledRuns, low: float, high: float, method: str, always: bool
) -> Estimated:
    if always:
        low, high = 1 - high, 1 - low
    return Estimated(query, sample, low, high, method, always)


def _sequential(sampler: Sampler, rule: StoppingRule) -> tuple[float, float]:
    """The interval under a rule. Runs that are unknown are counted twice, as hits and as none; each count stops on its
    own, and gives one end."""
    intervals: dict[bool, tuple[float, float]] = {}
    for analysis, runs in enumerate(rule.analyses):
        sample = sampler.draw_up_to(runs)
        for as_hits in (False, True):
            hits = sample.hits + (sample.unknown if as_hits else 0)
            if as_hits not in intervals and rule.stops(analysis, hits):
                intervals[as_hits] = rule.interval(analysis, hits)
        if len(intervals) == 2:
            break
    return intervals[False][0], intervals[True][1]


def _threshold(network: Network, query: StatisticalQuery, wanted: Threshold, settings: Settings) -> Decided:
    path = wanted.path
    runs = settings.runs or path.runs
    if runs is not None:
        found = _probability(network, query, path, settings)
        at_least = _decided(found.low, found.high, wanted.probability)
        decision = at_least if wanted.at_least else _at_most(found, wanted.probability)
        return Decided(query, decision, (found.sample,), (found.frequency,), (found.low, found.high))
    sampler = _sampler_of(network, path, settings.source)
    tests = {as_hit: threshold_test(wanted.probability, settings.errors) for as_hit in (False, True)}
    decision = Decision.UNKNOWN
    while decision is Decision.UNKNOWN and sampler.sample.runs < settings.most_runs:
        trials = sampler.draw(min(_ROUND, settings.most_runs - sampler.sample.runs))
        for answer in trials.answers.tolist():
            _read(tests, answer, path.always)
        decision = _agreed(tests)
    return Decided(
        query,
        decision if wanted.at_least else _opposite(decision),
        (sampler.sample,),
        (_frequency(sampler.sample, path.always),),
    )


def _read(tests: Mapping[bool, RatioTest], answer: int, always: bool) -> None:
    """Gives a run to both tests: the one that takes an unknown run for a hit, and the other one."""
    for as_hit, test in tests.items():
        test.add(as_hit if answer == TrialAnswer.UNKNOWN else (answer == TrialAnswer.YES) is not always)


def _agreed(tests: Mapping[bool, RatioTest]) -> Decision:
    """It holds if it does although no unknown run is a hit, and fails if it does although all are."""
    if tests[False].decision is Decision.HOLDS:
        return Decision.HOLDS
    return Decision.FAILS if tests[True].decision is Decision.FAILS else Decision.UNKNOWN


def _decided(low: float, high: float, probability: float) -> Decision:
    if low >= probability:
        return Decision.HOLDS
    return Decision.FAILS if high < probability else Decision.UNKNOWN


def _at_most(found: Estimated, probability: float) -> Decision:
    if found.high <= probability:
        return Decision.HOLDS
    return Decision.FAILS if found.low > probability else Decision.UNKNOWN


def _opposite(decision: Decision) -> Decision:
    match decision:
        case Decision.HOLDS:
            return Decision.FAILS
        case Decision.FAILS:
            return Decision.HOLDS
        case Decision.UNKNOWN:
            return decision


def _comparison(
    network: Network, query: StatisticalQuery, paths: tuple[PathProperty, PathProperty], settings: Settings
) -> Decided:
    source = settings.source
    other = RunSource(source.seed, source.first + _SECOND, source.threads, source.most_steps)
    samplers = _sampler_of(network, paths[0], source), _sampler_of(network, paths[1], other)
    tests = {as_hit: comparison_test(settings.errors) for as_hit in (False, True)}
    most = settings.runs or paths[0].runs or settings.most_runs
    decision = Decision.UNKNOWN
    while decision is Decision.UNKNOWN and samplers[0].sample.runs < most:
        count = min(_ROUND, most - samplers[0].sample.runs)
        pairs = zip(*(sampler.draw(count).answers.tolist() for sampler in samplers), strict=True)
        for first, second in pairs:
            _compare(tests, (first, second), paths)
        decision = _agreed(tests)
    samples = samplers[0].sample, samplers[1].sample
    frequencies = tuple(_frequency(sample, path.always) for sample, path in zip(samples, paths, strict=True))
    return Decided(query, decision, samples, frequencies)


def _compare(
    tests: Mapping[bool, RatioTest], answers: tuple[int, int], paths: tuple[PathProperty, PathProperty]
) -> None:
    """Gives a pair of runs to both tests: an unknown run speaks for the first probability, or against it."""
    for in_favour, test in tests.items():
        first, second = (
            is_favoured if answer == TrialAnswer.UNKNOWN else (answer == TrialAnswer.YES) is not path.always
            for answer, path, is_favoured in zip(answers, paths, (in_favour, not in_favour), strict=True)
        )
        if first is not second:
            test.add(first)


def _drawn(network: Network, query: StatisticalQuery, wanted: Trajectories, settings: Settings) -> DrawnRuns:
    sample, numbers = picked(network, wanted, settings.source)
    runs = trajectories(network, wanted, settings.source, numbers)
    if sample is None:
        return DrawnRuns(query, runs)
    interval = clopper_pearson(sample.hits, sample.runs, settings.confidence, sample.unknown)
    return DrawnRuns(query, runs, sample, interval)


def _split(
    network: Network, query: StatisticalQuery, path: PathProperty, splitting: Splitting, settings: Settings
) -> Split:
    rare = split(network, path, settings.source, settings.confidence, splitting)
    reach = rare.half_width(settings.confidence)
    return Split(query, rare, max(0.0, rare.mean - reach), min(1.0, rare.mean + reach))


# ---- means ----------------------------------------------------------------------------------------------------------


def _mean(network: Network, query: StatisticalQuery, wanted: ExpectedValue, settings: Settings) -> Mean:
    sampler, largest_reset = value_sampler(network, wanted, settings.source)
    sample = sampler.draw_up_to(settings.runs or wanted.runs or _RUNS_OF_MEANS)
    values = sample.all_values
    known = values[~np.isnan(values)]
    mean = float(known.mean()) if len(known) else float("nan")
    between = value_range(network, wanted, largest_reset)
    low = high = None
    if between is not None:
        lowest, highest = (np.where(np.isnan(values), end, values) for end in between)
        low, high = bounded_mean(lowest, highest, *between, settings.confidence)
    guess = asymptotic_mean(known, settings.confidence) if len(known) else (-np.inf, np.inf)
    return Mean(query, sample, mean, low, high, guess, between)


def value_range(network: Network, wanted: ExpectedValue, largest_reset: int) -> tuple[float, float] | None:
    """The range in which the measured value certainly lies; None if it is not known."""
    value: Expression = wanted.value
    if value.type == DOUBLE:
        return None
    if isinstance(value.type, ClockType):
        if wanted.bound.scale is not Scale.TIME or not _clocks_count_time(network) or advances_clocks(network):
            return None
        return 0.0, float(wanted.bound.limit) + largest_reset
    low, high = interval(value, known_values(network, [value]))
    return float(low), float(high)


def _clocks_count_time(network: Network) -> bool:
    """True if no clock is faster than time."""
    try:
        list(stopwatches(network))
    except UnsupportedError:
        return False
    return True


def _sampler_of(network: Network, path: PathProperty, source: RunSource) -> Sampler:
    """The runs on which a path property is evaluated. Raises UnsupportedError for a network that cannot be simulated,
    and InputError for a wrong initial value."""
    if isinstance(path, Path):
        return path_sampler(network, path, source)
    from tachk.simulation.statistics.formula_sampler import formula_sampler  # loads the monitors

    return formula_sampler(network, path, source)
