"""Runs that go on for ever, or cannot go on: what `A<>`, `E[]` and `-->` count."""

from __future__ import annotations

import pytest

from tachk.api import model as api
from tachk.base.span import Source
from tachk.engine.options import Extrapolation, Options
from tachk.formats.loading.load import load_model
from tachk.verify.verdict import Answer

OPTIONS = (
    Options(),
    Options(extrapolation=Extrapolation.MAX),
    Options(subsumption=False),
    Options(pack_clocks=0, vector=False),
)


def holds(model: str, query: str) -> bool:
    """The one answer of all options about ``P``, a process with the clocks x and y."""
    text = f"int n = 0; process P() {{ clock x, y; {model} }} system P; property asked : {query};"
    answers = set()
    for options in OPTIONS:
        (verdict,) = api.Model(load_model(Source("m.ta", text)), "m.ta").verify(options=options).record.verdicts
        answers.add(verdict.answer)
    assert len(answers) == 1
    answer = answers.pop()
    assert answer is not Answer.UNKNOWN
    return answer is Answer.HOLDS


ROUND = (
    "init location a {{ invariant x <= 5; to b {{ guard x >= {least}; assign x = 0; }} }}"
    "location b {{ invariant x <= 5; to a {{ assign x = 0; }} {more} }} location c;"
)


@pytest.mark.parametrize(
    ("model", "query", "expected"),
    [
        pytest.param(ROUND.format(least=1, more=""), "A<> P.b", True, id="an invariant that forces a transition"),
        pytest.param(ROUND.format(least=1, more="to c;"), "A<> P.c", False, id="a loop"),
        pytest.param(ROUND.format(least=0, more="to c;"), "A<> P.c", False, id="a loop that need take no time"),
        pytest.param(ROUND.format(least=1, more="to c;"), "E[] !P.c", True, id="a loop that keeps a predicate"),
        pytest.param("init location a { to b; } location b;", "A<> P.b", False, id="waiting for ever"),
        pytest.param(
            "init location a { invariant x - y <= 3; to b; } location b;",
            "A<> P.b",
            False,
            id="a difference of clocks does not bound time",
        ),
        pytest.param(
            "init location a { invariant y <= 3; to a { guard x >= 1; assign x = 0; } to b { guard y >= 3; } }"
            "location b;",
            "A<> P.b",
            True,
            id="a loop that time ends",
        ),
        pytest.param("init urgent location a { to b; } location b;", "A<> P.b", True, id="no time to wait"),
        pytest.param("init committed location a { } location b;", "A<> P.b", False, id="a committed dead end"),
        pytest.param(
            "init location a { invariant x <= 2; to b { guard x >= 3; } } location b;",
            "A<> P.b",
            False,
            id="an invariant that stops time too early",
        ),
        pytest.param(
            "init location a { invariant x < 3; to b { guard x == 3; } } location b;",
            "A<> P.b",
            False,
            id="just too early",
        ),
        pytest.param("init location a;", "A<> P.x >= 7", True, id="a clock grows"),
        pytest.param(
            "init location a { to a { assign x = 0; } }", "A<> P.x >= 7", False, id="a clock is reset in time"
        ),
        pytest.param("init location a { invariant x <= 6; }", "A<> P.x >= 7", False, id="a clock is stopped in time"),
        pytest.param("init location a { invariant x <= 7; }", "A<> P.x >= 7", True, id="a clock is stopped just there"),
        pytest.param(
            "init location a { invariant x <= 9; to b { guard x > 3; } } location b;",
            "A<> P.x == 3",
            True,
            id="true for a moment",
        ),
        pytest.param(
            "init location a { invariant x <= 9; to b { guard x >= 3; } } location b;",
            "A<> P.a && 2 < P.x && P.x < 3",
            True,
            id="true in an open interval",
        ),
        pytest.param(
            "init location a { invariant x <= 9; to b { guard x >= 2; } } location b;",
            "A<> P.a && 2 < P.x && P.x < 3",
            False,
            id="left at the open end of an interval",
        ),
        pytest.param(
            "init location a { to b { guard x > 0; assign y = 0; } } location b { invariant y < 9; to c; }location c;",
            "P.b --> P.x > 5 || P.c",
            True,
            id="two ways to become true",
        ),
        pytest.param(ROUND.format(least=1, more=""), "P.a --> P.b", True, id="an answer to every request"),
        pytest.param(ROUND.format(least=1, more="to c;"), "P.b --> P.a", False, id="a request before leaving"),
        pytest.param("init location a;", "P.a && P.x > 3 --> P.x >= 8", True, id="a request of a moment"),
        pytest.param("init location a;", "P.x > 9 --> P.x < 3", False, id="an answer that came before"),
        pytest.param(
            "init location a { invariant x < 5; to b { guard x >= 4; assign y = 0; } }"
            "urgent location b { to c; } location c { invariant y <= 3; to d { guard y >= 2; assign x = 0; } }"
            "location d { invariant x <= 1; to d { assign x = 0; } }",
            "A<> P.x >= 5",
            True,
            id="constants of a goal count as lower and as upper bounds",
        ),
        pytest.param(
            "init location a { invariant x <= 2; to b { guard x >= 2; } }"
            "urgent location b { to c { guard x >= 1; } } location c;",
            "A<> P.c",
            True,
            id="stuck in a widened zone only",
        ),
        pytest.param("init location a { invariant x <= 3; } ", "A<> deadlock", True, id="stuck from the beginning"),
        pytest.param(
            "init location a { invariant x <= 9; to b { guard x >= 3 && x <= 5; } } location b;",
            "A<> deadlock && P.a",
            False,
            id="time to leave before the deadlock",
        ),
        pytest.param(
            "init location a { invariant x <= 9; to b { guard x >= 3 && x <= 5; } } location b;",
            "A<> deadlock",
            True,
            id="a deadlock by waiting or behind the transition",
        ),
        pytest.param(
            "init location a { invariant x < 1; to b { assign x = 0; } }"
            "location b { invariant x < 1; to c { guard y >= 1; } } location c;",
            "A<> deadlock",
            True,
            id="what avoids a deadlock comes in parts, from one of which delays lead to another",
        ),
        pytest.param(
            "init location a { to a; to b; } location b;", "deadlock --> P.b", True, id="a deadlock as a request"
        ),
        pytest.param(
            "init location a { to a; to b; } location b;", "E[] !deadlock", True, id="no deadlock on some run"
        ),
        pytest.param("init location a { to b; } location b;", "E[] !deadlock", True, id="no deadlock while waiting"),
        pytest.param(
            "init location a { invariant x <= 1; to b; } location b;", "E[] !deadlock", False, id="forced into one"
        ),
        pytest.param("init location a;", "n == 1 --> n == 2", True, id="no request"),
        pytest.param("init location a;", "P.a --> P.a", True, id="answered at once"),
    ],
)
def test_what_a_run_avoids_for_ever(model: str, query: str, expected: bool) -> None:
    assert holds(model, query) is expected
