"""Whether tests find changed systems: ``python -m bench.tested_mutants COUNT SEED [TESTS]``.

COUNT random models are changed in one place each: a bound of a guard or of an invariant, a reset, where an edge leads
or what it does; one edge is lost, or one more is there. The changed model stands for the system, in up to TESTS (100)
tests by the model, which differ in their seeds and in when the system acts within its bounds. An oracle that knows
neither zones nor the tester goes through all runs at whole times together with all states in which the model may be
then: it says whether the change can be seen at whole times within 14 time units. What can be seen between whole times
alone it does not see: that all bounds are closed decides this for runs (Henzinger, Manna, Pnueli, "What good are
digital clocks?", 1992), and not for what one machine can do and another one cannot. No machine acts without end in no
time.

Prints how many changes that can be seen were found, in how many tests, and each one that was not; exit status 1 after
a test that failed without a change that the oracle sees. Ctrl-C ends it with what is known so far.
"""

from __future__ import annotations

import sys
from collections import Counter
from fractions import Fraction
from random import Random

import tachk
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform_file import constants_of
from tachk.simulation.testing.modelled_system import ModelledSystem
from tachk.simulation.testing.tester import TestedModel, TestSettings, TestVerdict, confirmed, follow
from tests.support.tested_machines import can_be_distinguished, is_zeno, mutated_machine
from tests.unit.recordings.conformance.small_models import Machine, random_machine, text_of
from tests.unit.simulation.testing.test_followed_system import with_anyone

_LENGTH = 60
"""Of a test, in time units: several times as long as the oracle goes."""
_POLICIES = (Policy.BOUNDARY, Policy.BOUNDARY, Policy.UNIFORM, Policy.LATEST)


def first_failure(model: Machine, system: Machine, tests: int) -> int | None:
    """The number of the first of some tests of a system by a model that fails."""
    own, other = (tachk.loads(with_anyone(text_of((each,), hidden=False), 1)) for each in (model, system))
    mapping, stands = own.loaded.recording, other.loaded.recording
    assert mapping is not None and stands is not None
    tested = TestedModel.of(own.network, mapping, constants_of(own.loaded))
    for seed in range(tests):
        policy = _POLICIES[seed % len(_POLICIES)]
        settings = TestSettings(
            Fraction(_LENGTH), seed, TimestampUncertainty.of(Fraction(0), Fraction(0)), limits=Limits(states=10_000)
        )
        running = ModelledSystem(other.network, stands, constants_of(other.loaded), seed, policy)
        run = follow(tested, running, settings, tested.inputs(settings))
        if not run.reason and not run.is_as_modelled and confirmed(tested, run).verdict is TestVerdict.FAIL:
            return seed
    return None


def main(arguments: list[str]) -> int:
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    count, first = map(int, arguments[:2])
    tests = int(arguments[2]) if len(arguments) == 3 else 100
    found: Counter[str] = Counter()
    needed: list[int] = []
    try:
        for seed in range(first, first + count):
            random = Random(seed)
            model = random_machine(random)
            system = model
            while not all(
                any(edge.label == "out" for edge in each.edges) and not is_zeno(each) for each in (model, system)
            ):
                model = random_machine(random)
                system = mutated_machine(random, model)
            visible = can_be_distinguished(model, system)
            number = first_failure(model, system, tests)
            match visible, number:
                case True, None:
                    found["can be seen, not found"] += 1
                    print(f"seed {seed}: not found in {tests} tests", flush=True)
                case True, _:
                    found["can be seen, found"] += 1
                    assert number is not None
                    needed.append(number + 1)
                case False, None:
                    found["cannot be seen, passed"] += 1
                case False, _:
                    found["accused without reason"] += 1
                    print(f"seed {seed}: test {number} fails, though nothing can be seen", flush=True)
    except KeyboardInterrupt:
        pass  # what is known so far is printed
    for what, times in sorted(found.items()):
        print(f"{what:26}{times:8,}")
    if needed:
        needed.sort()
        print(f"tests until a change was found: median {needed[len(needed) // 2]}, at most {needed[-1]}")
    return 1 if found["accused without reason"] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
