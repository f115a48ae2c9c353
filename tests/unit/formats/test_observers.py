"""Temporal properties on their way to UPPAAL."""

from __future__ import annotations

from tachk.base.span import Source
from tachk.formats.catalogue import export_model
from tachk.formats.exported import Exported, Writing
from tachk.formats.loading.load import load_model
from tachk.verify.verify import verify

MODEL = """
typedef int[0, 1] id_t;
time_unit = 1 s;
signal busy = exists (i : id_t) Train(i).Cross;

process Gate(const int DELAY) {
    clock x;
    int[0, 3] opened = 0;
    init location Down {
        invariant x <= DELAY;
        to Up { guard x >= 2; assign x = 0, opened = (opened + 1) % 4; }
    }
    location Up { invariant x <= 6; to Down { assign x = 0; } }
}

process Train(const id_t id) {
    clock y;
    init location Safe { to Turn { guard y > 2; assign y = 0; } }
    branchpoint Turn { to Cross { probability 1; } to Safe { probability 1; } }
    location Cross { invariant y <= 3; to Safe { assign y = 0; } }
}

process Lamp() { init location Off { to On; } location On; }

left = Gate(3);
right = Gate(4);

property opens "the gates open in turn" : G(left.Down -> F[0,3] right.Up) expect fails;
property counted : G(rise(left.Up) && left.opened == 1 -> F[0,6 s] left.Down) expect holds;
property passes : whenever busy becomes true, within 3 s, !Train(1).Cross must be true. expect holds;
property lit : G(Lamp.On -> G[0,2] Lamp.On) expect holds;
property stops : A[] not deadlock;
property plain : A[] left.opened <= 3 expect holds;

system left, right, Train, Lamp;
"""


def exported(text: str, format_: str = "xta", observers: bool = True) -> Exported:
    return export_model(load_model(Source("model.ta", text)), format_, Writing(observers=observers))


def test_the_exported_model_has_the_same_verdicts() -> None:
    original = load_model(Source("model.ta", MODEL))
    written = load_model(Source("model.xml", exported(MODEL, "xml").text))
    asked = [query for query in original.queries if query.observer is not None]
    before = {verdict.query.name: verdict.answer for verdict in verify(original.network, asked, trace=False)}
    queries = [query for query in written.queries if query.name in before]
    after = {verdict.query.name: verdict.answer for verdict in verify(written.network, queries, trace=False)}
    assert after == before


def test_locations_and_variables_that_observers_look_at_are_repeated_in_global_variables() -> None:
    text = exported(MODEL).text
    assert "bool Train_Cross[id_t] = { false, false };" in text
    assert "bool left_Down = true;" in text
    assert "process Gate(const int DELAY, bool &in_Down, bool &in_Up, int[0, 3] &out_opened) {" in text
    assert "left = Gate(3, left_Down, left_Up, left_opened);" in text
    assert "opened = (opened + 1) % 4, in_Down = false, in_Up = true, out_opened = opened;" in text
    assert "Turn -> Cross { assign Train_Cross[id] = true; probability 1; }" in text
    assert "Off -> On { assign Lamp_On = true; }" in text


def test_one_observer_is_chosen_for_each_run() -> None:
    text = exported(MODEL).text
    assert "Choice -> Chosen { select number : int[1, 4]; assign observed = number; }" in text
    assert "Asleep -> Idle { guard observed == 1; sync now!; }" in text
    alone = exported("process P() { init location A; } system P; property p : G P.A;").text
    assert "observed" not in alone
    assert "system P, Observer_p;" in alone


def test_queries_say_which_formula_they_are_about() -> None:
    queries = exported(MODEL, "q").text
    assert "A[] !Observer_opens.Bad\n/* EXPECT:F */" in queries
    assert "opens: the gates open in turn\nG (left.Down -> F[0, 3] right.Up)" in queries
    assert "whenever busy becomes true, within 3 s, !Train(1).Cross must be true.\nG (rise(busy)" in queries


def test_a_question_about_deadlocks_is_set_aside_where_observers_can_always_act() -> None:
    assert "/* UPPAAL does not check: A[] !deadlock */" in exported(MODEL, "q").text
    assert "\nA[] !deadlock\n" in exported(MODEL, "q", observers=False).text


def test_without_observers_temporal_properties_are_comments() -> None:
    text = exported(MODEL, "q", observers=False).text
    assert "/* UPPAAL does not check: G (left.Down -> F[0, 3] right.Up) */" in text
    assert "Observer" not in exported(MODEL, observers=False).text


def test_what_only_a_run_without_end_violates_stays_a_comment() -> None:
    model = "process P() { init location A { to A; } } system P; property endless : G(P.A -> F !P.A);"
    found = exported(model, "q")
    assert "UPPAAL does not check" in found.text
    assert any("`endless` stays a comment: a run without end" in step.text for step in found.steps)


def test_what_cannot_be_repeated_stays_a_comment_with_the_reason() -> None:
    model = """
    process P(const int n) { int a[2] = { 1, 2 }; init location A { to A; } }
    P1 = P(1); P2(const int[0, 1] k) = P(k);
    property array : G(P1.a[0] == 1);
    property partial : G P2(0).A;
    property nested : G (rise(H[0, 3] P1.A) -> P1.A);
    system P1, P2;
    """
    found = exported(model, "q")
    assert found.text.count("UPPAAL does not check") == 3
    reasons = [step.text for step in found.steps if "stays a comment" in step.text]
    assert "`array` stays a comment: `P1.a` is neither a location nor a variable of one number" in reasons
    assert any(reason.startswith("`partial` stays a comment") for reason in reasons)
    assert "`nested` stays a comment: tachk does not check it" in reasons


def test_a_model_that_is_not_checked_whole_gets_no_observers() -> None:
    text = MODEL + "clock h; process Q() { init location A { to A { assign h += 1; } } }\n"
    found = exported(text.replace("system left", "system Q, left"), "xml")
    assert found.text.count("UPPAAL does not check") == 4
    assert {step.text for step in found.steps if "stays a comment" in step.text} == {
        f"`{name}` stays a comment: something in the model is not checked"
        for name in ("opens", "counted", "passes", "lit")
    }


def test_comments_stay_where_they_are_beside_what_observers_declare() -> None:
    text = MODEL.replace("    clock x;", "    // how long the gate has rested\n    clock x;", 1)
    xml = exported(text, "xml").text
    assert xml.index("int[0, 4] observed") < xml.index("how long the gate has rested") < xml.index("clock x;")
    assert xml.index("<template>") < xml.index("how long the gate has rested")
