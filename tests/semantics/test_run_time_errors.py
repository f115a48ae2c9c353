"""One rule for run-time errors (docs/semantics.md): engine, oracles, concretiser and replay evaluate the same."""

from __future__ import annotations

import pytest

from tachk.diagnostics.span import Source
from tachk.frontend.load import load_model
from tachk.properties.verdict import Verdict
from tachk.properties.verify import verify


def verdict(text: str, query: str) -> Verdict:
    loaded = load_model(Source("model.ta", f"{text}\nproperty Q : {query};"))
    (found,) = verify(loaded.network, loaded.queries)
    return found


CONDITIONAL_RESET = """
    clock x, y; bool flag = true;
    process P() {
        init location I { to A { guard x >= 7; assign flag = false; } }
        location A { to B { assign flag ? (x = 0) : (y = 0); } }
        location B { to C { guard x <= 5; } to D { guard y <= 2 && x >= 9; } }
        location C; location D;
    }
    system P;
"""


@pytest.mark.parametrize(("query", "answer"), [("E<> P.B", "holds"), ("E<> P.C", "fails"), ("E<> P.D", "holds")])
def test_an_update_may_choose_the_clock_that_it_sets(query: str, answer: str) -> None:
    found = verdict(CONDITIONAL_RESET, query)
    assert found.answer.value == answer
    assert (found.trace is not None) is (answer == "holds")
