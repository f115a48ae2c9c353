"""Answers to the statistical queries among the queries of a model or of a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isnan
from time import process_time

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UnsupportedError, UsageError
from tachk.base.job import StoppedError, limited, note_interruption
from tachk.base.records import dataclass, field, replace
from tachk.engine.options import Limits
from tachk.engine.outcome import INTERRUPTED
from tachk.engine.simulation.simulator import SimulationEnding
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.queries.queries import UncheckedQuery, is_statistical
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.model.query import Expectation, Query
from tachk.model.statistical import StatisticalQuery
from tachk.simulation.statistics.deciding import Decision
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimate, Mean, Settings, Split, estimate
from tachk.simulation.statistics.sampling import SampledRuns


@dataclass(frozen=True, slots=True)
class StatisticalAnswer:
    """The answer to one query.

    Attributes:
        number: of the query among all of its run, from 1.
        settings: how sure the answer is to be.
        found: None where there is no answer.
        reason: why there is none, else empty.
        seconds: of the processor.
    """

    query: UncheckedQuery
    number: int
    settings: Settings = field(repr=False)
    found: Estimate | None
    reason: str = ""
    seconds: float = 0.0

    @property
    def is_counted(self) -> bool:
        """True if the answer counts: it is the outcome of a test, or something is expected of it, or it is not as
        expected whatever that is."""
        return isinstance(self.found, Decided) or self.query.expectation is not None or self.met is not True

    @property
    def met(self) -> bool | None:
        """True if the answer is as expected (see `as_expected`); None if there is none."""
        return None if self.found is None else as_expected(self.found, self.query.expectation)


@dataclass(frozen=True, slots=True)
class NoEstimate:
    """A query that was left open, and why."""

    query: StatisticalQuery
    reason: str


def as_expected(found: Estimate, expectation: Expectation | None) -> bool | None:
    """True if an answer is the expected one, or a test without an expectation holds. None: no decision.

    UPPAAL calls every probability, mean and trajectory that it could find satisfied. So these hold, and cannot fail;
    but trajectories that a condition picks fail where there is none, and a mean of no value is not an answer.
    A run-time error in a run is never as expected.
    """
    if has_run_time_error(found):
        return False
    if isinstance(found, DrawnRuns) and found.picked is not None:
        return expectation is None or (expectation is Expectation.HOLDS) is bool(found.runs)
    if isinstance(found, Mean) and isnan(found.mean):
        return None
    if not isinstance(found, Decided):
        return expectation is not Expectation.FAILS
    if found.decision is Decision.UNKNOWN:
        return None
    return found.decision.value == (expectation or Expectation.HOLDS).value


def has_run_time_error(found: Estimate) -> bool:
    """True if some run ended with one."""
    if isinstance(found, DrawnRuns) and any(run.ending is SimulationEnding.FAULT for run in found.runs):
        return True
    return any(sample.endings[SimulationEnding.FAULT] for sample in samples_of(found))


def samples_of(found: Estimate) -> Sequence[SampledRuns]:
    """The samples behind an answer, where it has any."""
    match found:
        case Decided():
            return found.samples
        case DrawnRuns(picked=SampledRuns() as sample):
            return (sample,)
        case DrawnRuns() | Split():
            return ()
        case _:
            return (found.sample,)


def answer_statistical(
    load: Callable[[], LoadedModel],
    formulas: Sequence[Query | UncheckedQuery],
    settings: Settings,
    limits: Limits = Limits(),
) -> dict[int, StatisticalAnswer | UncheckedQuery]:
    """The results of the statistical queries among formulas, by their numbers from 1: an answer, or the query with the
    diagnostics that say what is wrong with it or not supported.

    Args:
        load: reads the model as simulations see it, with floating point variables; called where there is such a query.
        limits: on time and memory, for all of them together.
    """
    question = {number: query for number, query in enumerate(formulas, 1) if is_statistical(query)}
    if not question:
        return {}
    found: dict[int, StatisticalAnswer | UncheckedQuery] = {}
    reason = ""
    try:
        with limited(limits.seconds, limits.memory_bytes):
            loaded = load()
            reader = StatisticalReader(loaded)
            for number, query in question.items():
                found[number] = _answer(loaded, reader, query, number, settings)
    except InputError as error:
        return {number: replace(query, diagnostics=error.diagnostics) for number, query in question.items()}
    except StoppedError as error:
        reason = error.reason
    except KeyboardInterrupt:
        note_interruption()
        reason = INTERRUPTED
    return {
        number: found.get(number) or StatisticalAnswer(query, number, settings, None, reason)
        for number, query in question.items()
    }


def _answer(
    loaded: LoadedModel, reader: StatisticalReader, query: UncheckedQuery, number: int, settings: Settings
) -> StatisticalAnswer | UncheckedQuery:
    began = process_time()
    if loaded.refusals:
        return StatisticalAnswer(query, number, settings, None, loaded.refusals[0].message)
    try:
        question = reader.read(query)
        found = estimate(question.network or loaded.network, question, settings)
    except InputError as error:
        return replace(query, diagnostics=error.diagnostics)
    except UnsupportedError as error:
        return replace(query, diagnostics=(error.diagnostic,))
    except UsageError as error:
        return replace(query, diagnostics=(Diagnostic("E0728", error.message, query.span, error.help),))
    return StatisticalAnswer(query, number, settings, found, seconds=process_time() - began)
