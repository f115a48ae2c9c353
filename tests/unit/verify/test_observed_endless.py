"""Temporal properties that only a run without end violates: what counts as such a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.verify.observed_liveness import FLEETING
from tachk.verify.verify import verify

pytestmark = pytest.mark.drawn

Answers = Callable[..., dict[str, str]]

# `Assumed` fails where W can be passed in no time: that does not break the assumption.
PROPERTIES = """
property Comes : F P.Q;
property Answered : G (P.W -> F P.Q);
property Again : G F P.A;
property Sentence : whenever P.W is true, eventually, P.Q must be true.;
property Assumed : G !P.W -> G P.A;
"""


@pytest.mark.parametrize(
    ("locations", "failing"),
    [
        pytest.param(
            "init location A { invariant x <= 1; to W; } location W { invariant x <= 2; to Q; } location Q;",
            {"Again", "Assumed"},
            id="comes to rest",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to W; } location W { invariant x <= 2; to Q; }
            location Q { invariant x <= 3; to A { guard x >= 3; assign x = 0; } }""",
            {"Assumed"},
            id="goes round",
        ),
        pytest.param(
            "init location A { invariant x <= 1; to W; } location W { to Q; } location Q;",
            {"Comes", "Answered", "Again", "Sentence", "Assumed"},
            id="may wait for ever",
        ),
        pytest.param(
            "init location A { invariant x <= 1; to W; } location W { invariant x <= 2; } location Q;",
            {"Comes", "Answered", "Again", "Sentence"},
            id="time stops",
        ),
        pytest.param(
            "init location A { invariant x <= 1; to W; } location W { invariant x <= 2; to W; to Q; } location Q;",
            {"Comes", "Answered", "Again", "Sentence", "Assumed"},
            id="takes steps for ever without time",
        ),
        pytest.param("init location A; location W; location Q;", {"Comes"}, id="never triggered"),
        pytest.param(
            "init location A { invariant x <= 1; to Q; } location Q; location W;", {"Again", "Assumed"}, id="leaves A"
        ),
    ],
)
def test_runs_without_end(locations: str, failing: set[str], answers: Answers) -> None:
    found = answers(f"process P() {{ clock x; {locations} }} system P; {PROPERTIES}")
    assert {name for name, answer in found.items() if answer == "fails"} == failing
    assert {answer for name, answer in found.items() if name not in failing} <= {"holds"}


@pytest.mark.parametrize(
    ("declarations", "locations", "formulas"),
    [
        pytest.param(
            "",
            "init location A { invariant x <= 1; to B { guard x >= 1; } } "
            "committed location B { to A { assign x = 0; } } location C;",
            {
                "G (P.A -> F P.C)": "fails",
                "F P.C": "fails",
                "G F P.C": "fails",
                "G (rise(P.A) -> F P.C)": "fails",
                "F P.A -> F P.C": "fails",
                "G (P.A -> (P.A U P.C))": "fails",
                "whenever P.A, eventually P.C must be true.": "fails",
                "G (P.A -> F P.B)": "holds",
                "G F P.A": "holds",
            },
            id="what asks lapses in a committed location only",
        ),
        pytest.param(
            "",
            "init committed location A; location B;",
            {"G F P.B": "fails", "F G P.B": "fails", "F P.B": "fails", "G (P.A -> F P.B)": "fails", "F G P.A": "holds"},
            id="ends in a committed location",
        ),
        pytest.param(
            "",
            "init committed location A { to A; } location B;",
            {"G F P.B": "fails", "F G P.B": "fails", "F P.B": "fails", "G (P.A -> F P.B)": "fails", "F G P.A": "holds"},
            id="takes steps for ever in a committed location",
        ),
        pytest.param(
            "chan c;",
            "init location Idle { invariant x <= 1; to Send { guard x >= 1; } } "
            "committed location Send { to Done { sync c!; } } location Done { to Idle { assign x = 0; } }",
            {
                "G F P.Idle": "fails",
                "F G P.Idle": "fails",
                "whenever P.Send, eventually P.Done must be true.": "fails",
                "F P.Send": "holds",
            },
            id="ends in a committed location without a partner",
        ),
        pytest.param("", "init location A { to B; } location B;", {"F P.A": "holds"}, id="is there at first"),
        pytest.param(
            "",
            "init location A { invariant x <= 1; to Q { guard x >= 1; } } committed location Q { to R; } location R;",
            {"F P.Q": "holds", "G (P.A -> F P.Q)": "holds", "F P.A -> F P.Q": "holds", "F G P.Q": "fails"},
            id="is there for no time",
        ),
        pytest.param(
            "",
            "init location A { invariant x <= 1; to Q { guard x >= 1; } } committed location Q { to R; } location R;",
            {"true U P.Q": "holds", "!(G !P.Q)": "fails", "P.A U P.Q": "fails", "G !P.Q": "holds"},
            id="is there for no time, in other operators",
        ),
        pytest.param(
            "",
            "init location A { invariant x <= 3; to Q { guard x >= 3; } } "
            "committed location Q { to A2; } committed location A2 { to R; } location R;",
            {"G (P.A || P.A2 -> F P.Q)": "holds"},
            id="what asked lasted before, and is there for no time behind the answer",
        ),
        pytest.param(
            "",
            "init urgent location A { to B; } location B; location C;",
            {"G (P.A -> F P.C)": "holds", "G (P.A -> F false)": "holds"},
            id="what asks is there for no time",
        ),
        pytest.param(
            "",
            "init urgent location A; location B;",
            {"G (P.A -> F P.B)": "fails", "G (P.A -> F false)": "fails", "G !P.A": "holds"},
            id="what asks is there when nothing can happen any more",
        ),
        pytest.param(
            "",
            "init committed location A { to B; } committed location B { to A; } location C;",
            {"G (P.A -> F P.C)": "fails", "G (P.A -> F P.B)": "holds", "F G P.A": "fails", "G F P.C": "fails"},
            id="what asks comes again and again at one instant",
        ),
        pytest.param(
            "",
            "init location A { to Q; } committed location Q { to A; } location C;",
            {"F P.Q -> F P.C": "fails", "F P.C -> F P.Q": "holds", "G P.A -> F P.C": "fails"},
            id="an assumption about what is there for no time",
        ),
    ],
)
def test_where_no_time_passes(declarations: str, locations: str, formulas: dict[str, str], answers: Answers) -> None:
    properties = "\n".join(f"property p{number} : {formula};" for number, formula in enumerate(formulas))
    found = answers(f"{declarations} process P() {{ clock x; {locations} }} system P; {properties}")
    assert found == {f"p{number}": answer for number, answer in enumerate(formulas.values())}


def test_what_is_there_for_no_time_counts_as_for_the_query_and_is_noted() -> None:
    model = load_model(
        Source(
            "m.ta",
            """
            process P() {
                clock x;
                init location A { invariant x <= 1; to Q { guard x >= 1; } }
                committed location Q { to A { assign x = 0; } }
            }
            system P;
            property Formula : F P.Q;
            property Query : A<> P.Q;
            """,
        )
    )
    formula, query = verify(model.network, model.queries)
    assert formula.answer.value == query.answer.value == "holds"
    assert formula.notes == (FLEETING,)


def test_what_lasts_for_ever_from_later_on_is_searched_for(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 1; to B { guard x >= 1; } }
        location B { invariant x <= 2; to C; }
        location C;
    }
    system P;
    property Later : G[0,1] !P.B || F[5,inf) P.B;
    """
    assert answers(text) == {"Later": "fails"}


# `Assumed`: that W is there for no time does not break the assumption, so that runs without Q violate it.
RECURRENT = """
property Settles : F G P.A;
property Leaves : F G !P.A;
property Fair : (G F P.W) -> G F P.Q;
property Stable : G (P.Q -> F G P.Q);
property Assumed : (G (P.W -> F P.Q)) -> F P.Q;
"""


@pytest.mark.parametrize(
    ("locations", "failing"),
    [
        pytest.param(
            "init location A { invariant x <= 1; to W; } location W { invariant x <= 2; to Q; } location Q;",
            {"Settles"},
            id="comes to rest",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to W { guard x >= 1; } } location W { invariant x <= 2; to Q; }
            location Q { invariant x <= 3; to A { guard x >= 3; assign x = 0; } }""",
            {"Settles", "Leaves", "Stable"},
            id="goes round",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to A { guard x >= 1; assign x = 0; } to Q { guard x >= 1; } }
            committed location Q { to A { assign x = 0; } } location W;""",
            {"Leaves", "Assumed"},
            id="is elsewhere for no time",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to A { guard x >= 1; assign x = 0; } to Q; }
            committed location Q { to A; } location W;""",
            {"Settles", "Leaves", "Stable", "Assumed"},
            id="is elsewhere again and again without time",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to A { guard x >= 1; assign x = 0; } to Q { guard x >= 1; } }
            urgent location Q { to A { assign x = 0; } } location W;""",
            {"Leaves", "Assumed"},
            id="is elsewhere for no time, with others able to act",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to W { guard x >= 1; assign x = 0; } to Q; }
            location W { invariant x <= 1; to A { guard x >= 1; assign x = 0; } } location Q;""",
            {"Settles", "Leaves", "Fair"},
            id="need not come to Q",
        ),
        pytest.param(
            "init location A { invariant x <= 1; } location W; location Q;", {"Leaves", "Assumed"}, id="time stops in A"
        ),
        pytest.param(
            "init location A { invariant x <= 1; to W; } location W { invariant x <= 1; } location Q;",
            {"Settles", "Fair"},
            id="time stops elsewhere",
        ),
        pytest.param(
            """init location A { invariant x <= 1; to W { guard x >= 1; } } location W { invariant x <= 1; to V; }
            location V { invariant x <= 1; to W; } location Q;""",
            {"Settles", "Fair", "Assumed"},
            id="takes steps for ever without time",
        ),
    ],
)
def test_what_happens_again_and_again(locations: str, failing: set[str], answers: Answers) -> None:
    found = answers(f"process P() {{ clock x; {locations} }} system P; {RECURRENT}")
    assert {name for name, answer in found.items() if answer == "fails"} == failing


def test_fairness_may_be_asked_of_runs_in_which_time_diverges() -> None:
    model = load_model(
        Source(
            "m.ta",
            """
            process P() {
                clock x;
                init location A { invariant x <= 1; to A; to W { guard x >= 1; assign x = 0; } }
                location W { invariant x <= 1; to A { guard x >= 1; assign x = 0; } }
            }
            system P;
            property leaves : F G P.A;
            property stays : F G !P.W -> F G P.A;
            property fair : G F P.A -> G F P.W;
            """,
        )
    )
    plain = verify(model.network, model.queries)
    assert [verdict.answer.value for verdict in plain] == ["fails", "holds", "fails"]
    diverging = verify(model.network, [replace(query, non_zeno=True) for query in model.queries])
    assert [verdict.answer.value for verdict in diverging] == ["fails", "holds", "holds"]
    trace = diverging[0].trace
    assert trace is not None and trace.loop_start is not None
    assert trace.states[-1].time > trace.states[trace.loop_start].time
