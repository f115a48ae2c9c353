"""Networks made of pieces, whose answers are known without a search; `bench/tiled_agreement.py` tries large ones."""

from __future__ import annotations

from collections import Counter
from random import Random

import pytest

import tachk
from tests.support.reductions.verdict_agreement import ALONE, BY_DEFAULT, NO_REDUCTION, TOGETHER
from tests.support.seeds import enough, seeds
from tests.support.tiled_networks import Guard, Interval, Step, Tile, random_goal, random_tiled_network

pytestmark = pytest.mark.drawn

WAYS = {"default": BY_DEFAULT, "no reduction": NO_REDUCTION, **ALONE, **TOGETHER}


@pytest.mark.parametrize("way", WAYS)
def test_answers_are_those_of_the_pieces(way: str) -> None:
    answers: Counter[bool] = Counter()
    for seed in seeds(range(16)):
        random = Random(seed)
        network = random_tiled_network(random, random.randint(2, 5), random.randint(1, 3), 4, 6)
        goals = [random_goal(random, network) for _ in range(3)]
        report = tachk.loads(network.text).verify(
            *map(network.query, goals), options=WAYS[way], limits=tachk.Limits(states=20_000)
        )
        for goal, verdict in zip(goals, report.record.verdicts, strict=True):
            if verdict.answer is not tachk.Answer.UNKNOWN:
                reached = verdict.answer is tachk.Answer.HOLDS
                assert reached == network.reached(goal), f"seed {seed}: {network.query(goal)}"
                answers[reached] += 1
    assert enough(min(answers[True], answers[False]) > 4)


def test_moments_of_a_piece() -> None:
    """It leaves its first location in (1, 3], is slower on the way round, and does not wait for longer than to 7."""
    tile = Tile(
        (Guard(None, (3, True)), Guard(), Guard(None, (4, True))),
        (
            Step(0, 2, Guard((1, False)), resets=True),
            Step(0, 1, Guard((3, True)), resets=False),
            Step(1, 2, Guard((9, True)), resets=True),
        ),
    )
    assert tile.moments([0]) == {Interval(0, True, 3, True)}
    assert tile.moments([1]) == {Interval(3, True, float("inf"), False)}
    assert tile.moments([2]) == {Interval(1, False, 7, True), Interval(9, True, float("inf"), False)}
    assert tile.moments([2], Guard((4, True))) == {Interval(5, False, 7, True), Interval(13, True, float("inf"), False)}
