"""How often things happen in runs, against closed forms.

The seeds are fixed. A frequency of n runs may be 4.5 standard deviations away from the probability: with a wrong seed
that would happen to one in about 150,000 of them.
"""

from __future__ import annotations

from collections import Counter
from math import exp, sqrt

import pytest

import tachk
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.simulation.columns import chosen_columns
from tachk.simulation.runs import Runs


def _last_values(text: str, name: str, runs: int, until: float, policy: Policy = Policy.STOCHASTIC) -> Counter[int]:
    """How many runs end with each value of a variable."""
    network = tachk.loads(text).network
    simulated = Runs(network, chosen_columns(network, [name]))
    drawing = SimulationOptions(1, int(until * TICKS_PER_UNIT), policy)
    return Counter(
        int(run.observed[-1, 0]) for run in simulated.draw(drawing, range(runs), RecordedChanges(observed=True))
    )


def _agrees(count: int, runs: int, probability: float) -> bool:
    return abs(count - runs * probability) <= 4.5 * sqrt(runs * probability * (1 - probability))


MM1 = """
broadcast chan arrive;
int[0, 10000] waiting = 0;
process Source() {
    init location On { exponential_rate 1 : 2; to On { sync arrive!; assign waiting = waiting + 1; } }
}
process Server() {
    init location Idle { to Busy { sync arrive?; } }
    location Busy { exponential_rate 1; to Next { assign waiting = waiting - 1; } }
    committed location Next { to Idle { guard waiting == 0; } to Busy { guard waiting > 0; } }
}
system Source, Server;
"""


def test_the_queue_of_one_server_is_geometric() -> None:
    # Load 1/2. Within 200 units the distribution is the stationary one but for exp(-200 (1 - sqrt(1/2))^2) = 4e-8.
    runs = 4000
    found = _last_values(MM1, "waiting", runs, until=200)
    for waiting in range(5):
        assert _agrees(found[waiting], runs, 0.5 * 0.5**waiting)


RACE = """
int[0, 3] winner = 0;
process P(const int[1, 3] me, const int rate) {
    init location Wait { exponential_rate rate; to Done { guard winner == 0; assign winner = me; } }
    location Done;
}
A = P(1, 1); B = P(2, 2); C = P(3, 5);
system A, B, C;
"""


def test_a_race_of_exponential_delays_is_won_by_rates() -> None:
    runs = 20_000
    found = _last_values(RACE, "winner", runs, until=100)
    for winner, rate in ((1, 1), (2, 2), (3, 5)):
        assert _agrees(found[winner], runs, rate / 8)


def test_an_exponential_delay_has_its_distribution() -> None:
    runs = 20_000
    found = _last_values(RACE, "winner", runs, until=0.1)
    assert _agrees(found[0], runs, exp(-0.8))


UNIFORM = """
int[0, 2] winner = 0;
process P(const int[1, 2] me, const int low, const int high) {
    clock x;
    init location Wait { invariant x <= high; to Done { guard x >= low; assign winner = winner == 0 ? me : winner; } }
    location Done;
}
A = P(1, 2, 6); B = P(2, 4, 8);
system A, B;
"""


@pytest.mark.parametrize("policy", [Policy.STOCHASTIC, Policy.UNIFORM])
def test_uniform_delays_race(policy: Policy) -> None:
    # B in [4, 8] is before A in [2, 6] only if both lie in [4, 6], each with probability 1/2, and then half the time.
    runs = 20_000
    found = _last_values(UNIFORM, "winner", runs, until=20, policy=policy)
    assert _agrees(found[2], runs, 1 / 8)


LOSSES = """
int[0, 1000] sent = 0;
const double kept = 0.3;
process Sender() {
    clock x;
    init location Send { invariant x <= 1; to way { guard x >= 1; assign x = 0, sent = sent + 1; } }
    location Done;
    branchpoint way { to Send { probability 1 - kept; } to Done { probability kept; } }
}
system Sender;
"""


def test_the_number_of_losses_is_geometric() -> None:
    runs = 20_000
    found = _last_values(LOSSES, "sent", runs, until=100)
    for sent in range(1, 8):
        assert _agrees(found[sent], runs, 0.7 ** (sent - 1) * 0.3)


RUIN = """
const int GOAL = 8;
int[0, GOAL] money = 3;
process Gambler() {
    init location Play { exponential_rate 10; to toss { guard money > 0 && money < GOAL; } }
    branchpoint toss {
        to Play { probability 3; assign money = money + 1; }
        to Play { probability 2; assign money = money - 1; }
    }
}
system Gambler;
"""


def test_the_gambler_is_ruined_as_often_as_known() -> None:
    runs = 10_000
    found = _last_values(RUIN, "money", runs, until=200)
    ratio = 2 / 3
    won = (1 - ratio**3) / (1 - ratio**8)
    assert _agrees(found[8], runs, won)
    assert found[0] + found[8] == runs


CHOICE = """
int[0, 3] chosen = 0;
process P() {
    init location A {
        to B { assign chosen = 1; }
        to B { assign chosen = 2; }
        to way;
    }
    location B;
    branchpoint way { to B { probability 1; assign chosen = 3; } to B { probability 3; assign chosen = 0; } }
}
system P;
"""


def test_the_ways_of_a_branchpoint_share_the_chance_of_one_edge() -> None:
    runs = 20_000
    found = _last_values(CHOICE, "chosen", runs, until=100)
    for chosen, probability in ((1, 1 / 3), (2, 1 / 3), (3, 1 / 12), (0, 1 / 4)):
        assert _agrees(found[chosen], runs, probability)


RECEIVERS = """
chan c;
int[0, 3] who = 0;
process S() { init location A { to B { sync c!; } } location B; }
process R(const int[1, 3] me) { init location A { to B { sync c?; assign who = me; } } location B; }
X = R(1); Y = R(2); Z = R(3);
system S, X, Y, Z;
"""


def test_each_receiver_is_as_likely() -> None:
    runs = 12_000
    found = _last_values(RECEIVERS, "who", runs, until=100)
    for receiver in (1, 2, 3):
        assert _agrees(found[receiver], runs, 1 / 3)


RELEASE = """
int[0, 1] released = 0;
int[0, 2] result = 0;
process P() {
    clock x;
    init location A { invariant x <= 1; to B { guard x >= 1; assign released = 1; } }
    location B;
}
process Q() { init location A { to B { guard released == 1; assign result = 1; } } location B; }
system P, Q;
"""


def test_a_process_begins_to_wait_when_another_one_lets_it_act() -> None:
    runs = 10_000
    found = _last_values(RELEASE, "result", runs, until=2)
    assert _agrees(found[1], runs, 1 - exp(-1))
