"""Which seeds the random tests get."""

from __future__ import annotations

import pytest

from tests.support.seeds import NUMBERS, Draw, number, one_in, seeds, some


@pytest.fixture(autouse=True)
def _own_draw(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Draw, "number", 3)
    monkeypatch.setattr(Draw, "times", 1)


def test_a_quarter_is_kept_and_the_others_are_of_the_same_kinds() -> None:
    drawn = seeds(range(10, 20))
    assert drawn[:3] == [10, 11, 12]
    assert len(set(drawn)) == 5 and min(drawn[3:]) > 10_000
    assert all(
        (new - old) % divisor == 0 for divisor in range(1, 11) for new, old in zip(drawn, range(10, 15), strict=True)
    )


def test_another_number_draws_other_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    before = seeds(range(8))
    monkeypatch.setattr(Draw, "number", 4)
    assert set(before) & set(seeds(range(8))) == {0, 1}


def test_more_can_be_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Draw, "times", 5)
    assert len(set(seeds(range(8)))) == 2 + 5 * 2


def test_nothing_is_drawn_from_0(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Draw, "number", 0)
    assert seeds(range(8)) == list(range(8))
    assert some(range(8), 3) == [0, 1, 2]


@pytest.mark.parametrize(("count", "drawn"), [(7, 3), (1, 1), (0, 0)])
def test_one_in_three_tests_is_drawn_and_each_comes(count: int, drawn: int, monkeypatch: pytest.MonkeyPatch) -> None:
    tests = [f"a::{n}" for n in range(count)]
    rounds = []
    for seed in range(1, 40):
        monkeypatch.setattr(Draw, "number", seed)
        rounds.append(one_in(3, tests))
    assert {len(some_tests) for some_tests in rounds} == {drawn}
    assert {test for some_tests in rounds for test in some_tests} == set(tests)
    monkeypatch.setattr(Draw, "number", 0)
    assert one_in(3, tests) == tests


def test_the_commit_gives_the_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Draw, "number", None)
    assert 0 < number() <= NUMBERS
