"""Random formulas and traces through all monitors: `python -m bench.monitor_agreement COUNT SEED [FEATURE=VALUE ...]`.

The offline monitors have to agree with the oracle (`tests.support.exact_monitor`) on truth and robustness at every
instant, however the trace is cut into portions; the online monitor on the verdict after every portion, on the moment of
the decision and on the first violation, with bounds of the robustness that hold the final value and never widen.

Prints how the verdicts are distributed, and every disagreement: its seed and the smallest case that shows it. Features
are the fields of `tests.support.formulas.FormulaShape`, for instance ``depth=2 past=False``. Without any, the shapes in
`SHAPES` take turns. Exit status 1 after a disagreement.
"""

from __future__ import annotations

import ast
import sys
import time
from collections import Counter
from functools import partial
from random import Random

from tachk.syntax.formulas.printer import print_formula
from tests.support.exact_monitor import verdict
from tests.support.formulas import FormulaShape, MonitoringCase, random_monitoring_case
from tests.support.monitor_input import always, truth_of
from tests.support.offline_agreement import offline_problems
from tests.support.online_agreement import online_problems
from tests.support.smaller_cases import describe, reduced

SHAPES = (
    FormulaShape(),
    FormulaShape(depth=2),
    FormulaShape(depth=4, bound=2, rows=6),
    FormulaShape(grid=1, rows=12),
    FormulaShape(depth=2, grid=3, gap=2),
    FormulaShape(depth=2, unbounded=False, rows=16, gap=2),
    FormulaShape(depth=2, bound=1, rows=10, gap=1, constants=0.1),
)


def main(arguments: list[str]) -> int:
    count, seed = int(arguments[0]), int(arguments[1])
    features = dict(argument.split("=", 1) for argument in arguments[2:])
    given = FormulaShape(**{name: ast.literal_eval(value) for name, value in features.items()}) if features else None
    verdicts: Counter[str] = Counter()
    wrong, started = 0, time.monotonic()
    for number in range(seed, seed + count):
        case = case_of(number, given or SHAPES[number % len(SHAPES)])
        verdicts[truth_of(verdict(case.formula, case.trace)).word] += 1
        problems = disagreements(case, number)
        if problems:
            wrong += 1
            print(f"seed {number}: {print_formula(case.formula)}: {'; '.join(problems)}")
            small = reduced(case, partial(disagreements, number=number))
            print(f"  {print_formula(small.formula)} on {describe(small.trace)}", flush=True)
    for word, times in sorted(verdicts.items()):
        print(f"{times:8} {word}")
    print(f"{count} formulas with traces, {wrong} disagreements, {time.monotonic() - started:.0f} s")
    return 1 if wrong else 0


def case_of(number: int, shape: FormulaShape) -> MonitoringCase:
    """Every third formula is one that demands something of every instant."""
    case = random_monitoring_case(Random(number), shape)
    return MonitoringCase(always(case.formula), case.trace) if number % 3 == 0 else case


def disagreements(case: MonitoringCase, number: int) -> tuple[str, ...]:
    refinement = (1, 1, 2, 5)[number % 4]
    return (*offline_problems(case, refinement, number), *online_problems(case, refinement, number))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
