"""A model that is asked several times, which keeps what it has compiled."""

from __future__ import annotations

import tachk

MODEL = """int n = 0;
process P() {
    state a, b;
    init a;
    trans a -> b { assign n = 1 - n; }, b -> a { assign n = 1 - n; };
}
system P;
property first : E<> 1 / n == 2;
property second : E<> 1 / n == 2;
"""


def test_run_time_errors_of_equal_queries_are_reported_at_the_place_of_each() -> None:
    model = tachk.loads(MODEL)
    for _ in range(2):
        places = []
        for report in (model.verify(property="first"), model.verify(property="second"), model.verify("E<> 1 / n == 2")):
            (verdict,) = report
            assert verdict.fault is not None
            places.append(str(verdict.fault.span))
        assert places == ["<text>:8:22", "<text>:9:23", "<query>:1:5"]


def test_answers_do_not_depend_on_what_was_asked_before() -> None:
    model = tachk.loads(MODEL)
    queries = ("E<> n == 1", "A[] n == 0", "E<> P.b and n == 0", "A[] P.a or n == 1")
    fresh = [tachk.loads(MODEL).verify(query)[0].answer for query in queries]
    for _ in range(2):
        assert [model.verify(query)[0].answer for query in queries] == fresh
