"""A test suite that kills mutants of a system: a few scripts of inputs.

A mutant stands for the system, in simulated time. The scripts that were found for others are tried first, then tests
with inputs that are chosen as `tachk test` chooses them; the inputs of the first one that fails are a new script. A
mutant that survives is not known to be equivalent.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UnsupportedError, UsageError
from tachk.base.job import StoppedError, check_job, unhurried
from tachk.base.records import dataclass, replace
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tachk.simulation.testing.goals import TestGoal
from tachk.simulation.testing.input_choice import InputChoice, ScriptedInputs
from tachk.simulation.testing.modelled_system import ModelledSystem
from tachk.simulation.testing.mutants import SystemMutant
from tachk.simulation.testing.tester import TestedModel, TestSettings, TestVerdict, confirmed, follow

TESTS = 30
"""So many tests with chosen inputs a mutant gets."""

_POLICIES = (Policy.BOUNDARY, Policy.UNIFORM, Policy.EARLIEST, Policy.LATEST)
"""How a mutant chooses among what it may do: each script is tried with all of them."""
_LENGTH = 20
"""A test lasts so many times the largest constant of the clocks."""

Script = tuple[RecordedEvent, ...]


@dataclass(frozen=True, slots=True)
class SuiteScript:
    """Attributes:
    recording: of the model itself that gets the inputs.
    inputs: how many of the events are inputs.
    kills: the numbers of the mutants that fail with these inputs and with none of the scripts before.
    """

    recording: EventLog
    inputs: int
    kills: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class MutantSuite:
    """Attributes:
    scripts: in the order in which they were found.
    equivalent: the numbers of the mutants that do what the system does: no run takes the edge that they change.
    survived: of those that passed every test.
    inconclusive: of those that no test killed, with the reason why one has no verdict.
    is_at_limit: a limit of the search ended one of these tests.
    unusable: of those that cannot stand for a system, with the reason.
    untried: of those for which there was no time.
    tests: how many tests were run.
    """

    mutants: tuple[SystemMutant, ...]
    scripts: tuple[SuiteScript, ...]
    equivalent: tuple[int, ...]
    survived: tuple[int, ...]
    inconclusive: tuple[tuple[int, str], ...]
    is_at_limit: bool
    unusable: tuple[tuple[int, str], ...]
    untried: tuple[int, ...]
    tests: int

    @property
    def killed(self) -> int:
        """How many mutants the scripts kill."""
        return sum(len(each.kills) for each in self.scripts)


def mutant_suite(
    model: TestedModel,
    mutants: Sequence[SystemMutant],
    scripts: Sequence[Script],
    never_taken: Collection[tuple[int, int]],
    uncertainty: TimestampUncertainty,
    limits: Limits,
) -> MutantSuite:
    """Looks for a test for each mutant.

    Args:
        scripts: inputs that are tried first.
        never_taken: edges that no run takes, by the numbers of process and edge.
        uncertainty: of the tests.
        limits: of the states of each search; where the seconds of the job around it are over, the rest is untried.
    """
    settings = TestSettings(Fraction(_LENGTH * model.instrumented.largest_constant), 0, uncertainty, limits=limits)
    search = _MutantSearch(model, settings, [*scripts])
    killed: dict[int, int] = {}
    survived: list[int] = []
    inconclusive: list[tuple[int, str]] = []
    is_at_limit = False
    unusable: list[tuple[int, str]] = []
    equivalent = tuple(
        number
        for number, mutant in enumerate(mutants)
        if mutant.same_untaken and (mutant.process, mutant.edge) in never_taken
    )
    tried = 0
    for number, mutant in enumerate(mutants):
        if number in equivalent:
            continue
        try:
            found = search.script_for(mutant)
        except (UsageError, UnsupportedError) as error:
            unusable.append((number, str(error)))
        except StoppedError:
            break
        else:
            if found is not None:
                killed[number] = found
            elif search.reason:
                inconclusive.append((number, search.reason))
                is_at_limit |= search.is_at_limit
            else:
                survived.append(number)
        tried = number + 1
    with unhurried():
        found_scripts = tuple(search.suite(killed))
    return MutantSuite(
        tuple(mutants),
        found_scripts,
        equivalent,
        tuple(survived),
        tuple(inconclusive),
        is_at_limit,
        tuple(unusable),
        tuple(number for number in range(tried, len(mutants)) if number not in equivalent),
        search.tests,
    )


class _MutantSearch:
    """Attributes:
    scripts: those found so far.
    tests: how many tests were run.
    reason: why the first test of the last mutant without a verdict has none; empty if each has one.
    is_at_limit: a limit of the search ended one of them.
    """

    def __init__(self, model: TestedModel, settings: TestSettings, scripts: list[Script]) -> None:
        self.model, self.settings, self.scripts = model, settings, scripts
        self.tests = 0
        self.reason, self.is_at_limit = "", False

    def script_for(self, mutant: SystemMutant) -> int | None:
        """The number of a script with which the mutant fails; None if none was found. Raises UsageError and
        UnsupportedError where it cannot stand for a system, StoppedError."""
        self.reason, self.is_at_limit = "", False
        for number, script in enumerate(self.scripts):
            for policy in _POLICIES:
                if self._fails(mutant, self._inputs(script), self._as_long_as(script), policy) is not None:
                    return number
        for seed in range(TESTS):
            goal = (TestGoal.RANDOM, TestGoal.EDGES)[seed % 2]
            settings = replace(self.settings, seed=seed, goal=goal)
            inputs = self._fails(mutant, self.model.inputs(settings), settings, _POLICIES[seed % len(_POLICIES)])
            if inputs is not None:
                self.scripts.append(inputs)
                return len(self.scripts) - 1
        return None

    def _inputs(self, script: Script) -> ScriptedInputs:
        return ScriptedInputs(script, self.settings.uncertainty)

    def _as_long_as(self, script: Script) -> TestSettings:
        """A test that ends a pause after the last input."""
        last = script[-1].time if script else Fraction(0)
        return replace(self.settings, duration=last + 2 * self.model.instrumented.largest_constant)

    def _fails(
        self, mutant: SystemMutant, choice: InputChoice, settings: TestSettings, policy: Policy
    ) -> Script | None:
        """The inputs of a test, if the mutant fails it."""
        check_job()
        self.tests += 1
        system = ModelledSystem(mutant.network, self.model.mapping, self.model.constants, settings.seed, policy)
        run = follow(self.model, system, settings, choice)
        self.is_at_limit |= run.is_at_limit
        if run.is_as_modelled and not run.reason:
            return None
        result = confirmed(self.model, run)
        if result.verdict is TestVerdict.INCONCLUSIVE:
            self.reason = self.reason or result.reason
        return run.sent if result.verdict is TestVerdict.FAIL else None

    def suite(self, killed: dict[int, int]) -> Iterator[SuiteScript]:
        """The scripts that kill a mutant, each with what the model itself does with its inputs."""
        for number, script in enumerate(self.scripts):
            mutants = tuple(mutant for mutant, by in killed.items() if by == number)
            if mutants:
                yield self._played(script, mutants)

    def _played(self, script: Script, mutants: tuple[int, ...]) -> SuiteScript:
        model = self.model
        system = ModelledSystem(model.network, model.mapping, model.constants, 0, Policy.BOUNDARY)
        run = follow(model, system, self._as_long_as(script), self._inputs(script))
        return SuiteScript(run.recording, len(run.sent), mutants)
