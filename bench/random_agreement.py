"""Random networks through all engines: `python -m bench.random_agreement COUNT SEED [FEATURE=VALUE ...]`.

Prints how often each engine reached which conclusion, and every disagreement with the seed that reproduces it.
On each network obligations are compared, too: whether a run avoids a goal for ever, and whether one does in which time
diverges.

Features are the fields of `tests.support.Shape`, for instance ``priorities=True clocks=2``. Without any, the shapes in
`SHAPES` take turns. ``smt=N`` asks the second engine too, for runs of up to N steps. Ctrl-C ends it with what is
known so far. Exit status 1 after a disagreement.

    python -m bench.random_agreement COUNT SEED verdicts

compares whole verdicts with and without each reduction, on small networks, many with interchangeable processes
(`tests.support.reductions.verdict_agreement`). One reduction alone and one combination are tried on each; they take
turns.
"""

from __future__ import annotations

import ast
import sys
import time
from collections import Counter
from dataclasses import replace
from random import Random

from tachk.model.expressions import BOOL, Constant
from tachk.verify.verdict import Answer
from tests.support import Shape, random_case
from tests.support.agreement import VARIANTS, Effort, compare
from tests.support.endless.diverging_agreement import compare_diverging
from tests.support.liveness_agreement import compare_obligation
from tests.support.obligations import random_obligations
from tests.support.reductions.verdict_agreement import compare_verdicts, random_questions, ways_of
from tests.support.strategies import without_first_tries

SHAPES = (
    Shape(),
    Shape(clocks=2),
    Shape(priorities=True),
    Shape(diagonals=True, clocks=2),
    Shape(priorities=True, diagonals=True, clocks=2, constant=3),
    Shape(strict=False, deadlocks=False),
    Shape(stopwatches=True),
    Shape(language=True, faults=0.08, clocks=2),
    Shape(language=True, faults=0.08, exact=0.4, processes=2, clocks=2, constant=3),
    Shape(language=True, faults=0.08, clocks_on_broadcast=True, locations=3, clocks=2),
    Shape(language=True, faults=1.0, processes=3, locations=3, clocks=1),
    Shape(language=True, faults=0.3, priorities=True, clocks=2),
    Shape(language=True, faults=0.08, exact=0.3, diagonals=True, clocks=2, constant=3, processes=2),
    Shape(language=True, faults=0.08, stopwatches=True, clocks=2),
    Shape(language=True, faults=0.3, receivers=1, blockers=1, processes=2, clocks=1, locations=3),
)

_EFFORT = Effort(reference=250, sampled=500)
_VARIANTS = 4
"""How many of the engine's options are switched in each network; they take turns."""


def main(arguments: list[str]) -> int:
    count, seed = int(arguments[0]), int(arguments[1])
    if arguments[2:] == ["verdicts"]:
        return compare_reductions(range(seed, seed + count))
    features = dict(argument.split("=", 1) for argument in arguments[2:])
    unrolled = features.pop("smt", None)
    effort = replace(_EFFORT, unrolled=None if unrolled is None else int(unrolled))
    given = Shape(**{name: ast.literal_eval(value) for name, value in features.items()}) if features else None
    conclusions: Counter[tuple[str, str]] = Counter()
    wrong, faults, started = 0, 0, time.monotonic()
    done = 0
    try:
        for number in range(seed, seed + count):
            shape = given or SHAPES[number % len(SHAPES)]
            case = random_case(Random(number), shape)
            nothing = Constant(0, BOOL)  # to be sure that everything is explored, and every run-time error met
            variants = [VARIANTS[(number + turn) % len(VARIANTS)] for turn in range(_VARIANTS)]
            agreement = compare(replace(case, predicates=(*case.predicates, nothing)), variants, effort)
            faults += any(outcome.fault is not None for outcome in agreement.outcomes.values())
            for name, outcome in agreement.outcomes.items():
                conclusions.update((name, goal.status.value) for goal in outcome.goals)
            for problem in agreement.problems:
                wrong += 1
                print(f"seed {number}, {shape}: {problem}", flush=True)
            lasting = [option for option in variants if not option.shortest]
            for obligation in random_obligations(Random(number), case):
                found = compare_obligation(case, obligation, lasting, _EFFORT)
                for name, outcome in found.outcomes.items():
                    conclusions[f"{name}, obligation", outcome.status.value] += 1
                diverging = compare_diverging(case, obligation, lasting[:1], _EFFORT)
                for name, answer in diverging.answers.items():
                    conclusions[f"{name}, time diverges", answer.value] += 1
                for problem in (*found.problems, *diverging.problems):
                    wrong += 1
                    print(f"seed {number}, {shape}, obligation: {problem}", flush=True)
            done += 1
    except KeyboardInterrupt:
        pass  # what is known so far is told
    for (name, status), times in sorted(conclusions.items()):
        print(f"{times:8} {status:12} {name}")
    print(f"{done} networks, {faults} with run-time errors, {wrong} disagreements, {time.monotonic() - started:.0f} s")
    return 1 if wrong else 0


def compare_reductions(seeds: range) -> int:
    """Prints how often which verdicts were compared, and every disagreement."""
    with without_first_tries():
        return _compare_reductions(seeds)


def _compare_reductions(seeds: range) -> int:
    compared: Counter[tuple[str, str]] = Counter()
    fewer: Counter[str] = Counter()
    wrong, networks, runs, started = 0, Counter[str](), 0, time.monotonic()
    try:
        for seed in seeds:
            questions = random_questions(seed)
            found = compare_verdicts(questions, ways_of(seed))
            networks[questions.kind] += 1
            plain = found.verdicts["no reduction"]
            for name, verdicts in found.verdicts.items():
                for one, other in zip(plain, verdicts, strict=True):
                    if Answer.UNKNOWN not in (one.answer, other.answer):
                        compared[name, other.query.kind.value] += 1
                        fewer[name] += other.statistics.states_stored < one.statistics.states_stored
                    runs += other.trace is not None
            for problem in found.problems:
                wrong += 1
                print(f"seed {seed}, {questions.kind}: {problem}", flush=True)
    except KeyboardInterrupt:
        pass  # what is known so far is told
    for name in dict.fromkeys(name for name, _ in compared):
        kinds = ", ".join(f"{kind} {times}" for (way, kind), times in sorted(compared.items()) if way == name)
        print(f"{name:26} {fewer[name]:6} with fewer states of {kinds}")
    print(f"{sum(networks.values())} networks ({', '.join(f'{n} {kind}' for kind, n in networks.items())}), ", end="")
    print(f"{runs} runs replayed, {wrong} disagreements, {time.monotonic() - started:.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
