"""What is asked of some of several interchangeable processes, asked of all of them."""

from __future__ import annotations

import pytest

import tachk
from tachk import Limits, Options
from tachk.engine.symmetry.symmetrised_query import MOST_IMAGES, symmetrised_query
from tests.support.strategies import with_states


@pytest.fixture(autouse=True)
def _asked_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not only where there are many states."""
    with_states(monkeypatch, "few-states", 0)


TEXT = """
const int N = 4;
typedef int[1, N] id_t;
int[0, N] owner = %s;
bool flag[N + 1];
process P(const id_t me) {
    clock x;
    init location L { to M { guard owner == 0; assign owner = me, flag[me] = true; } }
    location M { to L { guard owner == me && x > 2; assign owner = 0, x = 0, flag[me] = false; } }
}
system P;
"""


def symmetrised(*queries: str, text: str = TEXT % 0) -> tuple[list[str], list[bool], list[int]]:
    """The answers, whether they come from a question to all processes, and how many of these were exchanged."""
    options = Options().off("pruning")
    verdicts = list(tachk.loads(text).verify(*queries, options=options))
    plain = tachk.loads(text).verify(*queries, options=options.off("symmetry"))
    assert [verdict.answer for verdict in verdicts] == [verdict.answer for verdict in plain]
    assert [verdict.notes for verdict in verdicts] == [verdict.notes for verdict in plain]
    statistics = [verdict.statistics for verdict in verdicts]
    answers = [verdict.answer.value for verdict in verdicts]
    return answers, [each.asked_of_all for each in statistics], [each.interchangeable for each in statistics]


@pytest.mark.parametrize(
    "query",
    [
        "E<> P(1).M && P(2).M",
        "E<> P(2).M && P(1).M || P(3).M && P(4).M",
        "E<> flag[1] && flag[2]",
        "E<> owner == 1 && 2 == owner",
        "E<> P(1).M && owner != 1",
        "E<> P(1).M && flag[2]",
        "E<> P(1).M && P(2).x < 3 && P(2).M",
        "E<> P(1).M && exists (i : id_t) i != 1 && P(i).M",
    ],
)
def test_unreachable_for_all_is_unreachable(query: str) -> None:
    assert symmetrised(query) == (["fails"], [True], [4])
    assert symmetrised(query.replace("E<> ", "A[] !(") + ")")[0] == ["holds"]


def test_what_is_reached_is_searched_for_as_it_was_asked() -> None:
    model = tachk.loads(TEXT % 0)
    (verdict,) = model.verify("E<> P(3).M")
    assert (verdict.answer.value, verdict.statistics.asked_of_all) == ("holds", False)
    assert verdict.trace is not None
    assert verdict.trace.states[-1].discrete.locations == (0, 0, 1, 0)


def test_questions_about_each_process_share_a_search() -> None:
    queries = [f"A[] P({number}).M imply owner == {number}" for number in range(1, 5)]
    answers, of_all, exchanged = symmetrised(*queries)
    assert answers == ["holds"] * 4
    assert of_all == [True] * 4
    assert exchanged == [4] * 4


def test_one_alternative_is_enough() -> None:
    later = "P(3).L && P(3).x == 0 && P(4).x > 2"
    assert symmetrised(f"E<> P(1).M && P(2).M || {later}")[0] == ["holds"]
    assert symmetrised(f"E<> {later} || P(1).M && P(2).M")[0] == ["holds"]


def test_one_that_cannot_be_asked_of_all_does_not_keep_the_others_from_it() -> None:
    answers, of_all, _ = symmetrised("E<> P(1).M && P(2).M", "E<> P(1).M && owner > 1")
    assert answers == ["fails", "fails"]
    assert of_all == [True, False]


def test_one_that_is_reached_does_not_keep_the_others_from_it() -> None:
    answers, of_all, _ = symmetrised("E<> P(1).M && P(2).M", "E<> P(1).M && P(1).x > 7", "E<> owner == 2 && P(1).M")
    assert answers == ["fails", "holds", "fails"]
    assert of_all == [True, False, True]


FIRST_ONLY = """
typedef int[1, 4] id_t;
int[0, 4] owner = 1;
process P(const id_t me) {
    init location L { to M { guard owner == me; } }
    location M { to M { assign owner = me; } }
}
system P;
"""


def test_the_initial_state_may_prefer_one_of_them() -> None:
    assert symmetrised("E<> P(2).M", "E<> P(1).M", text=FIRST_ONLY)[0] == ["fails", "holds"]
    assert symmetrised("E<> P(2).M && owner == 0", text=FIRST_ONLY)[:2] == (["fails"], [True])


def test_what_holds_for_no_reason_is_reported_also_where_there_would_be_one_for_others() -> None:
    (verdict,) = tachk.loads(FIRST_ONLY).verify("A[] P(2).M imply owner != 0")
    assert verdict.notes == ("holds only because `P(2).M` is never true",)
    assert symmetrised("A[] P(2).M imply owner != 0")[:2] == (["holds"], [True])


def test_many_images_are_not_asked_for() -> None:
    text = TEXT.replace("N = 4", "N = 40") % 0
    model = tachk.loads(text)
    (verdict,) = model.verify("E<> P(1).M && P(2).M", limits=Limits(states=10_000))
    assert MOST_IMAGES < 40 * 39 // 2
    assert (verdict.answer.value, verdict.statistics.asked_of_all) == ("fails", False)


def test_where_few_states_are_enough_it_is_asked_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    with_states(monkeypatch, "few-states", 100)
    assert symmetrised("E<> P(1).M && P(2).M", "E<> P(1).M")[1] == [False, False]
    with_states(monkeypatch, "few-states", 3)
    assert symmetrised("E<> P(1).M && P(2).M", "E<> P(1).M")[1] == [True, False]


def test_limits_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    with_states(monkeypatch, "few-states", 3)
    (verdict,) = tachk.loads(TEXT % 0).verify("E<> P(1).M && P(2).M", limits=Limits(states=1))
    assert (verdict.answer.value, verdict.reason) == ("unknown", "state limit")


def test_questions_that_name_nobody_stay_as_they_are() -> None:
    model = tachk.loads(TEXT % 0)
    (verdict,) = model.verify("E<> exists (i : id_t) P(i).M && owner != i")
    assert verdict.query.target is not None
    assert symmetrised_query(model.network, [verdict.query.target], []) is None
    assert not verdict.statistics.asked_of_all
