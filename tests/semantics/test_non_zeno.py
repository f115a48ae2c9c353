"""Which runs count with --non-zeno: those in which time diverges, and those that end."""

from __future__ import annotations

import pytest

from tachk.api import model as api
from tachk.base.span import Source
from tachk.engine.options import Extrapolation, Options
from tachk.formats.loading.load import load_model
from tachk.model.run import Ending
from tachk.verify.verdict import Answer, Verdict
from tests.support.strategies import with_states

pytestmark = pytest.mark.drawn

OPTIONS = (
    Options(),
    Options(extrapolation=Extrapolation.MAX),
    Options(subsumption=False),
    Options(pack_clocks=0, vector=False),
)


def verdicts(text: str, query: str, non_zeno: bool = True) -> list[Verdict]:
    """Those of all options, which give the same answer."""
    model = api.Model(load_model(Source("m.ta", text)), "m.ta")
    found = [model.verify(query, non_zeno=non_zeno, options=options).record.verdicts[0] for options in OPTIONS]
    assert len({verdict.answer for verdict in found}) == 1
    return found


def holds(text: str, query: str, non_zeno: bool = True) -> bool:
    answer = verdicts(text, query, non_zeno)[0].answer
    assert answer is not Answer.UNKNOWN
    return answer is Answer.HOLDS


def process(body: str) -> str:
    return f"process P() {{ clock x, y; {body} }} system P;"


WAITING = "init location a {{ invariant x <= 3; to a {loop} to b {{ guard x >= 1; }} }} location b;"


@pytest.mark.parametrize(
    ("loop", "diverges"),
    [
        pytest.param(";", False, id="no clock at all"),
        pytest.param("{ assign y = 0; }", False, id="a reset of a clock that nobody looks at"),
        pytest.param("{ assign x = 0; }", True, id="a reset without a guard: rounds may take time"),
        pytest.param("{ guard x >= 2; assign x = 0; }", True, id="a guard and a reset"),
        pytest.param("{ guard x >= 2; assign y = 0; }", False, id="a guard on a clock that is never reset"),
        pytest.param("{ guard y < 1; assign y = 0; }", False, id="the invariant's clock is never reset"),
        pytest.param("{ guard x == 0; assign x = 0; }", False, id="the clock is 0 whenever it is reset"),
        pytest.param("{ guard x < 1; assign x = 0; }", True, id="rounds of less than one time unit"),
    ],
)
def test_a_loop_counts_if_time_can_diverge_in_it(loop: str, diverges: bool) -> None:
    model = process(WAITING.format(loop=loop))
    assert not holds(model, "A<> P.b", non_zeno=False)
    for query in ("A<> P.b", "true --> P.b", "P.a --> P.b", "AF P.b"):
        assert holds(model, query) is not diverges
    assert holds(model, "E[] P.a") is diverges


def test_runs_that_end_count() -> None:
    locked = process("init location a { invariant x <= 3; to a { guard x < 2; } to b { guard x >= 4; } } location b;")
    (verdict, *_) = verdicts(locked, "A<> P.b")
    assert verdict.answer is Answer.FAILS and verdict.trace is not None and verdict.trace.ending is Ending.STUCK
    waiting = process("init location a { to a; to b; } location b;")
    (verdict, *_) = verdicts(waiting, "A<> P.b")
    assert verdict.answer is Answer.FAILS and verdict.trace is not None and verdict.trace.ending is Ending.IDLE


def test_a_run_that_ends_is_found_behind_a_loop_that_does_not_count() -> None:
    model = process(
        "init location a { invariant x <= 3; to a; to c { guard x >= 1; } to b { guard x >= 1; } }"
        "location b; location c { invariant x <= 3; to c { guard x < 2; } }"
    )
    (verdict, *_) = verdicts(model, "A<> P.b")
    assert verdict.answer is Answer.FAILS and verdict.trace is not None and verdict.trace.ending is Ending.STUCK


def test_what_is_stuck_in_a_widened_zone_only_is_not_stuck() -> None:
    model = process(
        "init location a { invariant x <= 2; to a; to b { guard x >= 2; } }"
        "urgent location b { to c { guard x >= 1; } } location c;"
    )
    assert not holds(model, "A<> P.c", non_zeno=False)
    assert holds(model, "A<> P.c")


def test_where_only_zeno_runs_lead_on_nothing_is_left_to_violate() -> None:
    model = process("init location a { invariant x <= 3; to a; } location b;")
    (verdict, *_) = verdicts(model, "A<> P.b")
    assert verdict.answer is Answer.HOLDS
    assert verdict.notes == ("only runs with infinitely many transitions in finite time would give another answer",)


def test_the_run_that_is_shown_takes_time_in_each_round() -> None:
    (verdict, *_) = verdicts(process(WAITING.format(loop="{ assign x = 0; }")), "A<> P.b")
    trace = verdict.trace
    assert trace is not None and trace.ending is Ending.PERIODIC and trace.loop_start is not None
    assert trace.states[-1].time > trace.states[trace.loop_start].time
    assert len(trace.initial.clocks) == 2 and all(step.transition is not None for step in trace.steps)


def test_time_may_diverge_in_a_loop_with_committed_and_urgent_steps() -> None:
    """The step that takes time is not the one that has priority."""
    model = """
        urgent chan now; chan priority default < now; int[0, 1] n = 0;
        process P() { clock x;
            init location a { invariant x <= 2; to b { guard x >= 2; assign x = 0, n = 1; } }
            committed location b { to c; }
            location c { invariant x <= 1; to a { sync now!; } } }
        process Q() { init location a { to a { guard n == 1; sync now?; assign n = 0; } } }
        system P, Q;
    """
    (verdict, *_) = verdicts(model, "A<> false")
    assert verdict.answer is Answer.FAILS
    assert not holds(model, "A<> P.a && P.x > 2")
    assert holds(model, "P.a --> P.b")


def test_urgent_steps_alone_take_no_time() -> None:
    model = """
        urgent chan now;
        process P() { init location a { to a { sync now!; } } }
        process Q() { init location a { to a { sync now?; } } }
        system P, Q;
    """
    assert not holds(model, "A<> false", non_zeno=False)
    assert holds(model, "A<> false")
    late = model.replace(
        "init location a { to a { sync now!; } }",
        """clock x;
        init location b { invariant x <= 2; to a { guard x >= 2; } }
        location a { to a { sync now!; } }""",
        1,
    )
    assert holds(late, "A<> false")


def test_formulas_without_deadline_speak_of_the_same_runs() -> None:
    model = process("init location a { invariant x <= 3; to a; to b { guard x >= 1; } } location b;")
    for formula in ("F P.b", "G (P.a -> F P.b)", "G F P.b"):
        assert not holds(model, formula, non_zeno=False), formula
        assert holds(model, formula), formula


def test_with_a_deadline_only_its_runs_count() -> None:
    model = process("init location a { invariant x <= 3; to a; to b { guard x >= 1; } } location b;")
    assert not holds(model, "A<>[<= 5] P.b", non_zeno=False)
    assert holds(model, "A<>[<= 5] P.b")
    assert not holds(model, "A<>[<= 2] P.b")
    assert verdicts(model, "P.a -->[<= 5] P.b")[0].unsupported is not None


def test_long_delays_decide_where_short_ones_take_too_many_states(monkeypatch: pytest.MonkeyPatch) -> None:
    model = process(WAITING.format(loop="{ guard x < 1; assign x = 0; }"))
    with_states(monkeypatch, "short-delays", 0)
    assert not holds(model, "A<> P.b")
    assert holds(process(WAITING.format(loop=";")), "A<> P.b")


def test_it_makes_no_difference_for_single_states() -> None:
    model = process("init location a { invariant x <= 3; to a; } location b;")
    for query in ("E<> P.a", "A[] P.a", "sup: P.x", "G P.a"):
        (verdict, *_) = verdicts(model, query)
        assert "no difference" in verdict.notes[-1]
