"""Probabilities of what hardly ever happens, by splitting, against closed forms."""

from __future__ import annotations

from math import exp, factorial
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.span import Source as Text
from tachk.cli.main import app
from tachk.frontend.loaded import elaborate_query_file
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.model.statistical import Probability
from tachk.simulation.statistics.rare import Rare, Splitting, split
from tachk.simulation.statistics.sampling import RunSource

SEED = RunSource(seed=1)
CHEAP = Splitting(0.15, 300)


def rare(model: str, query: str, source: RunSource = SEED, splitting: Splitting = CHEAP) -> Rare:
    loaded = tachk.loads(model)
    _, unchecked = elaborate_query_file(loaded.loaded, Text("<query>", query))
    question = StatisticalReader(loaded.loaded).read(unchecked[0]).question
    assert isinstance(question, Probability)
    return split(loaded.network, question.path, source, 0.95, splitting)


RUIN = """
const int GOAL = 16;
int[0, GOAL] money = 1;
process Gambler() {
    init location Play { exponential_rate 10; to toss { guard money > 0 && money < GOAL; } }
    branchpoint toss {
        to Play { probability 1; assign money = money + 1; }
        to Play { probability 2; assign money = money - 1; }
    }
}
system Gambler;
"""

ARRIVALS = """
int[0, 9] n;
process P() { init location A { exponential_rate 1; to A { guard n < 9; assign n = n + 1; } } }
system P;
"""

UNIFORM = """
int[0, 9] n;
clock x;
clock age;
process P() { init location A { invariant x <= 2; to A { guard n < 9; assign n = n + 1, x = 0; } } }
system P;
"""

LOSSES = """
int[0, 8] lost;
process Link() {
    clock x;
    init location Idle { invariant x <= 1; to send { guard x >= 1; assign x = 0; } }
    branchpoint send {
        to Idle { probability 9; assign lost = 0; }
        to Idle { probability 1; assign lost = lost + 1; }
    }
}
system Link;
"""


HURRIED = """
int[0, 1] unused;
process Other() { init location A { exponential_rate 1; to A { assign unused = 1 - unused; } } }
process Twice() {
    init location Far { exponential_rate 1; to first; }
    committed location Near { to second; }
    location Late { exponential_rate 1; to Won; }
    location Won;
    location Lost;
    branchpoint first { to Near { probability 1; } to Lost { probability 9; } }
    branchpoint second { to Late { probability 1; } to Lost { probability 9; } }
}
system Other, Twice;
"""


def _in_a_row(losses: int, messages: int) -> float:
    """The probability of so many losses in a row, each with probability 0.1, among so many messages."""
    state = [1.0] + [0.0] * losses
    for _ in range(messages):
        state = [
            sum(state[:losses]) * 0.9,
            *(state[k - 1] * 0.1 for k in range(1, losses)),
            state[losses - 1] * 0.1 + state[losses],
        ]
    return state[losses]


@pytest.mark.parametrize(
    ("model", "query", "expected"),
    [
        (RUIN, "Pr[<=1000](<> money == GOAL)", 1 / (2**16 - 1)),
        (ARRIVALS, "Pr[<=1](<> n == 6)", 1 - sum(exp(-1) / factorial(k) for k in range(6))),
        (UNIFORM, "Pr[<=1](<> n == 5)", 0.5**5 / factorial(5)),
        # The last delay is uniform on 0 to 2 and longer than 1: only that ends in a state with x > 1.
        (UNIFORM, "Pr[age<=2](<> n == 4 && x > 1)", 0.5**4 / factorial(4) * 0.5),
        # Part of the way ends in a committed location of the second process.
        (HURRIED, "Pr[<=100](<> Twice.Won)", 0.01),
        (LOSSES, "Pr[#<=20](<> lost == 5)", _in_a_row(5, 20)),
        (LOSSES, "Pr[<=20](<> lost == 5)", _in_a_row(5, 20)),
    ],
)
def test_estimates_agree_with_closed_forms(model: str, query: str, expected: float) -> None:
    found = rare(model, query)
    # The interval of confidence 0.95 is at most 15 % wide to each side: three of them are far enough for any seed.
    assert abs(found.mean - expected) <= 2 * found.half_width(0.95)
    assert found.half_width(0.95) <= 0.15 * found.mean
    assert found.whole


ONE_OR_NONE = """
int[0, 1] up;
int[0, 1] done;
process Door() {
    clock x;
    init location Shut { invariant x <= 1; to tried { guard x >= 1; } }
    location Open;
    location Broken;
    branchpoint tried { to Open { probability 1; assign up = 1; } to Broken { probability 299; } }
}
process Guest() {
    clock y;
    init location Away { invariant y <= 4; to Here { guard y >= 2; assign done = 1; } }
    location Here;
}
system Door, Guest;
"""


def test_runs_that_begin_again_at_one_state_do_not_wait_alike() -> None:
    # Of 300 runs about one opens the door; whether the guest comes in time is drawn anew for each that begins there.
    found = rare(ONE_OR_NONE, "Pr[<=3](<> up == 1 && done == 1)", splitting=Splitting(0.15, 300))
    opened = [probability * 300 for probability in found.probabilities if probability > 0]
    halves = [share for share in opened if 0.3 < share % 1 < 0.7]
    assert len(halves) > len(opened) / 4


def test_threads_make_no_difference() -> None:
    one, three = (rare(ARRIVALS, "Pr[<=1](<> n == 5)", RunSource(seed=3, threads=threads)) for threads in (1, 3))
    assert one.probabilities.tolist() == three.probabilities.tolist()
    other = rare(ARRIVALS, "Pr[<=1](<> n == 5)", RunSource(seed=4))
    assert one.probabilities.tolist() != other.probabilities.tolist()


def test_what_has_to_be_true_until_then() -> None:
    found = rare(LOSSES, "Pr[#<=5](lost < 1 U lost == 5)")
    assert found.mean == 0


def test_levels_are_distances() -> None:
    found = rare(LOSSES, "Pr[#<=20](<> lost == 5)", splitting=Splitting(0.5, 50))
    assert (found.levels, found.states) == (5, 9)


@pytest.mark.parametrize("query", ["Pr[<=5](<> n == 3 && n == 4)", "Pr[<=5]([] n < 3)"])
def test_what_has_no_levels_is_rejected(query: str) -> None:
    with pytest.raises(UsageError):
        rare(ARRIVALS, query)


def test_the_interval_of_few_replications_is_that_of_student() -> None:
    found = Rare(np.array([1.0, 3.0] * 8), 3, 10, True, 0, 0)
    assert found.half_width(0.95) == pytest.approx(2.1314 * (16 / 15) ** 0.5 / 4, rel=1e-4)


@pytest.mark.parametrize("query", ["Pr[<=9](<> P.b) >= 0.5", "E[<=9; 5](max: n)", "simulate [<=9; 2] {n}"])
def test_what_is_no_probability_is_not_split(tmp_path: Path, query: str) -> None:
    model = tmp_path / "m.ta"
    model.write_text("int n = 0; process P() { init location a { to b; } location b; } system P;")
    done = CliRunner().invoke(app, ["estimate", str(model), query, "--splitting"])
    assert (done.exit_code, "splitting estimates probabilities only" in done.stderr) == (2, True)
