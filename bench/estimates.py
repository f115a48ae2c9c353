"""What statistics promise: `coverage` computes how often intervals contain the probability under every rule that is
offered, `known` compares estimates with closed forms and with other programs' answers, `rare` those of splitting.

    python bench/estimates.py coverage|known|rare
"""

from __future__ import annotations

import sys
from math import exp, factorial
from time import monotonic

import numpy as np

import tachk
from tachk.base.span import Source as Text
from tachk.frontend.loaded import elaborate_query_file
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.simulation.statistics.estimate import Estimated, Mean, Settings, Split, estimate
from tachk.simulation.statistics.rare import Splitting
from tachk.simulation.statistics.sampling import RunSource
from tachk.simulation.statistics.stopping import Floats, Places, StoppingRule

CONFIDENCES = (0.9, 0.95, 0.99, 0.999)
HALF_WIDTHS = (0.2, 0.1, 0.05, 0.02)
TRIED = 400
"""Probabilities, ends of intervals among them, at which the coverage is computed."""


def coverage() -> None:
    """The least coverage and the widest interval of each rule, and how many runs it takes."""
    print("confidence  epsilon  least coverage  widest / (2 epsilon)  runs at 0  runs at most")
    for confidence in CONFIDENCES:
        for half_width in HALF_WIDTHS:
            rule = StoppingRule(confidence, half_width)
            last = len(rule.analyses) - 1
            lower = rule.places(last)
            place = {runs: analysis for analysis, runs in enumerate(rule.analyses)}
            intervals = [
                rule.interval(place[int(runs)], int(hits)) for runs, hits in zip(lower.runs, lower.hits, strict=True)
            ]
            lows, highs = (np.array(ends) for ends in zip(*intervals, strict=True))
            ends = np.unique(np.concatenate((lows, highs, 1 - lows, 1 - highs)))
            tried = np.unique(np.clip(np.concatenate((ends - 1e-9, ends + 1e-9)), 1e-12, 0.5))
            tried = tried[:: max(1, len(tried) // TRIED)]
            least = min(_coverage(lower, lows, highs, float(p)) for p in tried)
            first = next(analysis for analysis in range(last + 1) if rule.stops(analysis, 0))
            widest = float((highs - lows).max()) / (2 * half_width)
            print(
                f"{confidence:10}  {half_width:7}  {least:14.6f}  {widest:20.4f}  {rule.analyses[first]:9}  "
                f"{rule.analyses[-1]:12}",
                flush=True,
            )


def _coverage(lower: Places, lows: Floats, highs: Floats, probability: float) -> float:
    """Hits and misses are alike: the places with more hits than misses are those with fewer of the other kind."""
    below = lower.probabilities(probability)[(lows <= probability) & (probability <= highs)].sum()
    mirrored = lower.probabilities(1 - probability)
    own = 2 * lower.hits < lower.runs
    return float(below + mirrored[own & (lows <= 1 - probability) & (1 - probability <= highs)].sum())


# ---- models with known answers --------------------------------------------------------------------------------------

QUEUE = """
broadcast chan arrive;
int[0, 1000] waiting = 0;
process Source() { init location On { exponential_rate 1 : 2; to On { sync arrive!; assign waiting = waiting + 1; } } }
process Server() {
    init location Idle { to Busy { sync arrive?; } }
    location Busy { exponential_rate 1; to Next { assign waiting = waiting - 1; } }
    committed location Next { to Idle { guard waiting == 0; } to Busy { guard waiting > 0; } }
}
system Source, Server;
"""
RACE = """
int[0, 3] winner = 0;
process P(const int[1, 3] me, const int rate) {
    init location Wait { exponential_rate rate; to Done { guard winner == 0; assign winner = me; } }
    location Done;
}
A = P(1, 1); B = P(2, 2); C = P(3, 5);
system A, B, C;
"""
LOSSES = """
int[0, 1000] sent = 0;
process Sender() {
    clock x;
    init location Send { invariant x <= 1; to way { guard x >= 1; assign x = 0, sent = sent + 1; } }
    location Done;
    branchpoint way { to Send { probability 7; } to Done { probability 3; } }
}
system Sender;
"""
RUIN = """
const int GOAL = 8;
const int START = 3;
const int UP = 3;
const int DOWN = 2;
int[0, GOAL] money = START;
process Gambler() {
    init location Play { exponential_rate 10; to toss { guard money > 0 && money < GOAL; } }
    branchpoint toss {
        to Play { probability UP; assign money = money + 1; }
        to Play { probability DOWN; assign money = money - 1; }
    }
}
system Gambler;
"""
UNIFORM = """
int[0, 12] n;
clock x;
process P() { init location A { invariant x <= 2; to A { guard n < 12; assign n = n + 1, x = 0; } } }
system P;
"""
ARRIVALS = """
int[0, 12] n;
process P() { init location A { exponential_rate 1; to A { guard n < 12; assign n = n + 1; } } }
system P;
"""
IN_A_ROW = """
int[0, 12] lost;
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
# The exact values are those that PRISM's collection of models states.
BRP = """
const int N = 16;
const int MAX = 2;
int[0, N + 1] frame = 1;
int[0, MAX + 1] tries;
process Sender() {
    clock x;
    init location Frame { invariant x <= 1; to sent { guard x >= 1; assign x = 0; } }
    location Got { invariant x <= 1; to answered { guard x >= 1; assign x = 0; } }
    location Next { invariant x <= 0; to Frame { guard frame < N; assign frame = frame + 1, tries = 0; }
                    to Done { guard frame == N; } }
    location Again { invariant x <= 0; to Frame { guard tries < MAX; assign tries = tries + 1; }
                     to Failed { guard tries == MAX; } }
    location Done;
    location Failed;
    branchpoint sent { to Got { probability 98; } to Again { probability 2; } }
    branchpoint answered { to Next { probability 99; } to Again { probability 1; } }
}
system Sender;
"""

DIE = """
const int HEADS[7] = {1, 3, 5, 1, -2, -4, -6};
const int TAILS[7] = {2, 4, 6, -1, -3, -5, 2};
int[-6, 6] place = 0;
int[0, 1000] flips = 0;
process Coin() {
    clock x;
    init location Hand { invariant x <= 1; to air { guard x >= 1 && place >= 0; assign x = 0, flips = flips + 1; }
                         to Hand { guard x >= 1 && place < 0; assign x = 0; } }
    branchpoint air {
        to Hand { probability 1; assign place = HEADS[place]; }
        to Hand { probability 1; assign place = TAILS[place]; }
    }
}
system Coin;
"""
"""Knuth's and Yao's die, thrown with a coin: the face is -place."""


def _transient_queue(most: int, until: float, steps: int = 20_000) -> float:
    """The probability that a queue with arrivals 1/2 and services 1 reaches so many within a time: uniformisation."""
    rate = 1.5
    state = np.zeros(most + 1)
    state[0] = 1.0
    reached, weight = 0.0, exp(-rate * until)
    for n in range(steps):
        reached += weight * state[most]
        moved = np.zeros(most + 1)
        moved[1:] += state[:-1] * (0.5 / rate)
        moved[: most - 1] += state[1:most] * (1.0 / rate)
        moved[0] += state[0] * (1.0 / rate)
        moved[most] += state[most]
        state = moved
        weight *= rate * until / (n + 1)
        if n > rate * until + 60 and weight < 1e-18:
            break
    return reached


def _row(losses: int, messages: int) -> float:
    state = [1.0] + [0.0] * losses
    for _ in range(messages):
        state = [
            sum(state[:losses]) * 0.9,
            *(state[k - 1] * 0.1 for k in range(1, losses)),
            state[losses - 1] * 0.1 + state[losses],
        ]
    return state[losses]


WON = (1 - (2 / 3) ** 3) / (1 - (2 / 3) ** 8)
KNOWN = (
    ("M/M/1, 5 waiting within 100", QUEUE, "Pr[<=100](<> waiting >= 5)", _transient_queue(5, 100)),
    ("race of exponentials, rate 5 of 8", RACE, "Pr[<=100](<> winner == 3)", 5 / 8),
    ("race of exponentials, within 1/8", RACE, "Pr[<=0.125](<> winner > 0)", 1 - exp(-1)),
    ("geometric losses, 3 or more", LOSSES, "Pr[<=100](<> sent >= 3)", 0.49),
    ("geometric losses, mean", LOSSES, "E[<=1000; 20000](max: sent)", 1 / 0.3),
    ("gambler's ruin", RUIN, "Pr[<=1000](<> money == GOAL)", WON),
    ("five uniform delays within 3", UNIFORM, "Pr[<=3](<> n == 5)", (1.5**5 - 5 * 0.5**5) / factorial(5)),
    ("arrivals of Poisson, 3 or more", ARRIVALS, "Pr[<=2](<> n == 3)", 1 - exp(-2) * (1 + 2 + 2)),
    ("losses in a row, 2 of 20", IN_A_ROW, "Pr[#<=20](<> lost == 2)", _row(2, 20)),
    ("bounded retransmission, N 16, MAX 2", BRP, "Pr[<=1000](<> Sender.Failed)", 4.2333344360436463e-4),
    ("a die from a coin, a six", DIE, "Pr[<=1000](<> place == -6)", 1 / 6),
    ("a die from a coin, flips", DIE, "E[<=1000; 20000](max: flips)", 11 / 3),
)

RARE = (
    ("gambler with 1, 30 before 0", RUIN, {"GOAL": 30, "START": 1, "UP": 1}, "Pr[<=1000](<> money == GOAL)",
     1 / (2**30 - 1)),
    ("nine losses in a row of 20", IN_A_ROW, {}, "Pr[#<=20](<> lost == 9)", _row(9, 20)),
    ("12 arrivals within 1", ARRIVALS, {}, "Pr[<=1](<> n == 12)", 1 - sum(exp(-1) / factorial(k) for k in range(12))),
    ("nine uniform delays within 1", UNIFORM, {}, "Pr[<=1](<> n == 9)", 0.5**9 / factorial(9)),
    ("30 waiting within 100", QUEUE, {}, "Pr[<=100](<> waiting >= 30)", _transient_queue(30, 100)),
    ("bounded retransmission, N 16, MAX 3", BRP, {"MAX": 3}, "Pr[<=1000](<> Sender.Failed)", 1.2617766032502142e-5),
    ("bounded retransmission, N 16, MAX 5", BRP, {"MAX": 5}, "Pr[<=1000](<> Sender.Failed)", 1.1205147161661327e-8),
)  # fmt: skip


def _answer(text: str, constants: dict[str, int], query: str, settings: Settings) -> object:
    model = tachk.loads(text, **constants)
    _, unchecked = elaborate_query_file(model.loaded, Text("<query>", query))
    return estimate(model.network, StatisticalReader(model.loaded).read(unchecked[0]), settings)


def known() -> None:
    """Intervals of confidence 0.999 from 200,000 runs, beside the exact value."""
    settings = Settings(RunSource(seed=1, threads=2), 0.999, runs=200_000)
    for name, text, query, exact in KNOWN:
        found = _answer(text, {}, query, settings)
        assert isinstance(found, Estimated | Mean)
        low, high = (found.low, found.high) if isinstance(found, Estimated) else found.asymptotic
        assert low is not None and high is not None
        print(f"{name:40} {exact:.6g}  {low:.6g} to {high:.6g}  {'' if low <= exact <= high else 'MISSED'}", flush=True)


def rare() -> None:
    for name, text, constants, query, exact in RARE:
        began = monotonic()
        found = _answer(text, constants, query, Settings(RunSource(seed=1, threads=2), splitting=Splitting()))
        assert isinstance(found, Split)
        half = (found.high - found.low) / 2
        print(
            f"{name:40} {exact:.4g}  {found.rare.mean:.4g}  {half / found.rare.mean:.1%}  "
            f"{len(found.rare.probabilities)} replications, {found.rare.transitions} transitions, "
            f"{monotonic() - began:.1f} s, {(found.rare.mean - exact) / half:+.2f} half-widths off",
            flush=True,
        )


if __name__ == "__main__":
    {"coverage": coverage, "known": known, "rare": rare}[sys.argv[1]]()
