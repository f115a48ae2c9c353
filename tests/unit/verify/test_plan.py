"""Which queries share a search."""

from __future__ import annotations

from itertools import starmap

import pytest

from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.model.query import Query
from tachk.verify.plan import Analysis, Task, plan

MODEL = """
int n;
clock g;
clock many[2];
process P() { clock x; init location a { to b; } location b; }
system P;
property first : E<> P.b;
property on_clock : E<> P.x > 3;
property second : A[] n == 0;
property deadlock_free : A[] not deadlock;
property same_clock : A[] P.b imply P.x >= 0;
property other_clock : E<> g > 3;
property stuck_late : E<> deadlock && P.x > 1;
property stuck : E<> deadlock && P.b;
property all_clocks : A[] forall (i : int[0,1]) many[i] <= many[i] + n;
property live : A<> P.b;
property most : sup: n;
"""


def queries() -> dict[str, Query]:
    return {query.name: query for query in load_model(Source("m.ta", MODEL)).queries}


def test_queries_about_the_same_clocks_and_deadlock_share_a_search() -> None:
    known = queries()
    chosen = [known[name] for name in list(known)[:8]]
    assert [[task.query.name for task in search.tasks] for search in plan(starmap(Task, enumerate(chosen)))] == [
        ["first", "second"],
        ["on_clock", "same_clock"],
        ["deadlock_free", "stuck"],
        ["other_clock"],
        ["stuck_late"],
    ]


def test_no_queries_need_no_search() -> None:
    assert plan([]) == ()


@pytest.mark.parametrize("name", ["live", "most"])
def test_what_reachability_cannot_decide_has_no_target(name: str) -> None:
    with pytest.raises(ValueError):
        _ = Task(0, queries()[name]).target


def test_what_reachability_cannot_decide_is_searched_alone() -> None:
    searches = plan(Task(number, queries()[name]) for number, name in enumerate(("live", "most", "live")))
    assert [(search.analysis, len(search.tasks)) for search in searches] == [
        (Analysis.LIVENESS, 1),
        (Analysis.EXTREMES, 1),
        (Analysis.LIVENESS, 1),
    ]
