"""The distributions that models draw from, against their distribution functions."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import accumulate

import numpy as np
import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationEnding, SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.simulation.columns import all_columns
from tachk.simulation.runs import Runs

RUNS = 3000


def _erlang(stages: int, scale: float) -> Callable[[float], float]:
    return lambda x: 1 - math.exp(-x / scale) * sum((x / scale) ** k / math.factorial(k) for k in range(stages))


def _poisson(mean: float) -> Callable[[float], float]:
    terms = [math.exp(k * math.log(mean) - mean - math.lgamma(k + 1)) for k in range(200)]
    sums = list(accumulate(terms))
    return lambda x: sums[int(x)]


def _triangular(x: float) -> float:
    return (x - 1) ** 2 / 6 if x < 2 else 1 - (7 - x) ** 2 / 30  # from 1 to 7, most probable at 2


DISTRIBUTIONS: dict[str, Callable[[float], float]] = {
    "random_normal(3, 2)": lambda x: (1 + math.erf((x - 3) / (2 * math.sqrt(2)))) / 2,
    "random_gamma(3, 1.5)": _erlang(3, 1.5),
    "random_gamma(0.5, 2)": lambda x: math.erf(math.sqrt(x / 2)),
    "random_beta(2, 3)": lambda x: 6 * x**2 - 8 * x**3 + 3 * x**4,
    "random_beta(0.5, 0.5)": lambda x: 2 / math.pi * math.asin(math.sqrt(x)),
    "random_weibull(1.7, 2)": lambda x: 1 - math.exp(-((x / 2) ** 1.7)),
    "random_arcsine(-1, 4)": lambda x: 2 / math.pi * math.asin(math.sqrt((x + 1) / 5)),
    "random_tri(1, 2, 7)": _triangular,
    "random_poisson(3.5)": _poisson(3.5),
    "random_poisson(42)": _poisson(42),
}


def _values(expressions: list[str], runs: int) -> tuple[np.ndarray, set[SimulationEnding]]:
    declared = " ".join(f"double v{n};" for n in range(len(expressions)))
    assigned = ", ".join(f"v{n} = {expression}" for n, expression in enumerate(expressions))
    process = f"process P() {{ committed init location A {{ to B {{ assign {assigned}; }} }} location B; }}"
    text = f"{declared} {process} system P;"
    network = load_model(Source("<text>", text), keeps_doubles=True).network
    drawn = Runs(network, [column for column in all_columns(network) if column.floating])
    found = list(drawn.draw(SimulationOptions(11, TICKS_PER_UNIT), range(runs), RecordedChanges(observed=True)))
    return np.array([run.observed[-1].view(np.float64) for run in found]), {run.ending for run in found}


def test_what_is_drawn_has_the_distribution() -> None:
    values, endings = _values(list(DISTRIBUTIONS), RUNS)
    assert endings == {SimulationEnding.HORIZON}
    for (name, function), column in zip(DISTRIBUTIONS.items(), values.T, strict=True):
        known = np.sort(column)
        expected = np.array([function(float(x)) for x in known])
        if name.startswith("random_poisson"):
            seen = np.searchsorted(known, known, side="right") / RUNS
            distance = np.abs(seen - expected).max()
        else:
            steps = np.arange(RUNS)
            distance = max(np.abs(expected - steps / RUNS).max(), np.abs(expected - (steps + 1) / RUNS).max())
        assert distance < 1.95 / math.sqrt(RUNS), name  # Kolmogorov, 0.999


@pytest.mark.parametrize(
    "wrong",
    ["random_gamma(-1, 2)", "random_beta(0, 1)", "random_weibull(1, 0)", "random_poisson(-1)", "random_tri(1, 9, 2)"],
)
def test_parameters_that_a_distribution_does_not_have_are_run_time_errors(wrong: str) -> None:
    assert _values([wrong], 1)[1] == {SimulationEnding.FAULT}


def test_a_guard_does_not_draw_even_in_a_function() -> None:
    text = """
        bool lucky() { double d = random(1); return d < 0.5; }
        process P() { init location A { to A { guard lucky(); } } } system P;
    """
    with pytest.raises(InputError) as caught:
        load_model(Source("<text>", text), keeps_doubles=True)
    assert [found.code for found in caught.value.diagnostics] == ["E0313"]
