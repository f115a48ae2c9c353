"""Models and sets of states in Munta's words.

Munta is not here to say whether it takes them. Munta (commit 62cb1a4) has accepted munta/lift.muntax with the
certificate that tachk makes for it.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from tachk_munta.certificate import certificate_of
from tachk_munta.proofs import MuntaProof, munta_proof
from tachk_munta.weakened import weakened
from tachk_munta.writer import MuntaModel, to_munta

from plugins.munta.tests.munta_interpretation import MuntaInterpretation
from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.meaning.judge.certificate import StateBlock

LIFT = """\
chan ask;
broadcast chan shut;
int[1, 3] floor = 1;
int[0, 1] last;
meta int[0, 3] wanted;

process Caller() {
    clock x;
    init location away {
        to near { guard x >= 2; sync ask!; assign wanted = 3 - floor, last = 1; }
    }
    location near {
        invariant x <= 9;
        to away { sync shut?; assign x = 0; }
    }
}

process Lift() {
    clock y;
    void go() { floor = wanted > 0 ? wanted : floor; }
    init location idle { to moving { sync ask?; assign go(), y = 0; } }
    location moving {
        invariant y <= 4;
        to there { guard y > 1 && y <= 4; }
    }
    committed location there { to idle { guard last != 0; sync shut!; assign last = 0; } }
}

system Caller, Lift;
property second : A[] floor <= 2;
property soon : A[] Lift.there imply Lift.y < 5 && last > 0;
"""


ACCEPTED = Path(__file__).parent


def exported(text: str, number: int = 0) -> MuntaModel:
    model = load_model(Source("model.ta", text))
    return to_munta(model.network, model.queries[number])


def automata(text: str, number: int = 0) -> list[dict[str, object]]:
    found: list[dict[str, object]] = json.loads(exported(text, number).network.text())["automata"]
    return found


def edges(automaton: dict[str, object]) -> list[tuple[object, ...]]:
    given = automaton["edges"]
    assert isinstance(given, list)
    return [tuple(edge.values()) for edge in given]


def proof_of(text: str, number: int = 0) -> MuntaProof | str:
    model = load_model(Source("model.ta", text))
    return munta_proof(model.network, model.queries[number])


def one_process(body: str, query: str = "A[] true", globals_: str = "") -> str:
    return f"{globals_} clock x; process P() {{ {body} }} system P; property q : {query};"


def test_a_model() -> None:
    assert exported(LIFT).network.text() == (ACCEPTED / "lift.muntax").read_text()


def test_the_numbering_of_a_model() -> None:
    assert json.loads(exported(LIFT).network.renaming()) == {
        "vars": {"last": 0, "floor": 1},
        "clocks": {"0": 0, "Caller_x": 1, "Lift_y": 2},
        "processes": {"Caller": 0, "Lift": 1},
        "locations": {"Caller": {"0": 0, "1": 1}, "Lift": {"0": 0, "1": 1, "2": 2}},
    }


def test_a_certificate() -> None:
    """Rows hold locations, then the slots of ask, shut, floor, last, wanted, x and y; floor is 1 less for Munta."""
    rows = np.array([[0, 0, 0, 1, 1, 0, 0, 1, 2], [1, 1, 0, 1, 2, 1, 0, 1, 2]])
    numbers = [np.array(n) for n in ([1, 1], [0, 0], [0, 1], [2 * 3 + 1], [-3])]
    written = certificate_of(exported(LIFT).network, [StateBlock(rows, *numbers)], 2)
    none = (1 << 63) - 1
    free = [1, 1, 1, none, 1, none, none, none, 1]
    moving = [1, -3, 1, 19, 1, 19, 9, -3, 1]  # x <= 9, y <= 4, y - x <= -2, and what follows: x >= 2
    header = (42, 2, 3, 2, 2)
    assert struct.unpack(f">{len(written) // 8}q", written) == (*header, 0, 0, 0, 0, 1, *free, 1, 1, 1, 1, 1, *moving)


def test_clocks_are_tested_by_an_edge_of_its_own_and_of_committed_locations() -> None:
    model = exported(LIFT, 1)
    caller, lift, goal = automata(LIFT, 1)
    bad = [("at_Lift == 2 && Lift_y >= 5", "", ""), ("at_Lift == 2 && last == 0", "", "")]
    assert [edge[2:] for edge in edges(goal)] == bad
    assert [edge[2:] for edge in edges(lift) if edge[1] == 3] == bad
    assert {edge[0] for edge in edges(lift) if edge[1] == 3} == {2}
    assert ("shut!", "last = 0, at_Lift = 0") in [edge[3:] for edge in edges(lift)]
    assert model.network.formula == "E<> Goal.reached || Lift.reached"
    assert len(edges(caller)) == 5


def test_a_deadlock_that_waiting_leads_to_is_one_after_a_pause() -> None:
    text = one_process("init location a { to a { guard x < 3; } }", "A[] !deadlock")
    model = exported(text)
    assert model.asks_deadlock
    assert [edge[:2] for edge in edges(automata(text)[1])] == [(0, 1)]
    safe = one_process("init location a { to a; }", "A[] !deadlock")
    proof = proof_of(safe)
    assert isinstance(proof, MuntaProof)
    words = struct.unpack(f">{len(proof.certificate) // 8}q", proof.certificate)
    assert words[:5] == (42, 2, 1, 0, 2)
    assert words[5:] == (0, 0, 1, 1, 0, 1, 1, 1)


def test_comparisons_that_are_always_or_never_true() -> None:
    text = one_process(
        "init location a { to a { guard x >= 0 && x > -1; } to a { guard x < 0; } to a { guard x <= -2; } "
        "to a { guard x == 2; } }"
    )
    assert [edge[2] for edge in edges(automata(text)[0])] == ["", "x <= 2 && x >= 2"]


def test_functions_and_arrays_are_written_case_by_case() -> None:
    text = one_process(
        "int[0, 2] q[2]; int[0, 2] n; void put(int[0, 2] v) { q[n] = v; n++; } "
        "init location a { to a { select v : int[1, 2]; guard n < 2; assign put(v); } "
        "to a { guard n > 0 && q[n - 1] == 2; assign n = n - 1; } }",
        "A[] P.n <= 2",
    )
    assert [edge[2:] for edge in edges(automata(text)[0])] == [
        ("P_n == 0", "", "P_q_0 = 1, P_n = 1"),
        ("P_n == 1", "", "P_q_1 = 1, P_n = 2"),
        ("P_n == 0", "", "P_q_0 = 2, P_n = 1"),
        ("P_n == 1", "", "P_q_1 = 2, P_n = 2"),
        ("P_n == 1 && P_q_0 == 2", "", "P_n = 0"),
        ("P_n == 2 && P_q_1 == 2", "", "P_n = 1"),
    ]


@pytest.mark.parametrize(
    ("text", "what", "place"),
    [
        (
            one_process("init location a { invariant x <= n; to a; }", globals_="int[0, 3] n;").replace(
                "to a;", "to a { assign n = 2; }"
            ),
            "invariants that depend on variables",
            "x <= n",
        ),
        (one_process("init location a { invariant x' == 0; to a; }"), "clocks that stand still", "x'"),
        (one_process("clock y; init location a { to a { guard x - y > 2; } }"), "comparisons of two clocks", "to a"),
        (one_process("init location a { to a { assign x = 2; } }"), "clocks that are set to another value", "to a"),
        (
            one_process("init location a { to a { guard n > 5; assign n = 3; } }", globals_="int n;"),
            "too many cases",
            "to a",
        ),
        (
            one_process("init location a { to a { sync c!; } to a { sync c?; } }", globals_="urgent chan c;"),
            "urgent channels",
            "c;",
        ),
        (
            one_process(
                "init location a { to a { sync c!; } }",
                globals_="broadcast chan c; clock y; process Q() { init location a { to a { guard y > 2; sync c?; } }}",
            ).replace("system P", "system P, Q"),
            "clock guards on edges that receive",
            "to a { guard",
        ),
        (one_process("init location a { to a; }", "A<> P.a"), "with the meaning that it has here", "A<>"),
        (
            one_process("init location a { to a; }", "A[] x > 3 || !deadlock"),
            "`deadlock` beside other conditions",
            "deadlock",
        ),
        (
            one_process("init location a { to a { sync c!; } }", globals_="chan c, d; chan priority c < d;"),
            "priorities of channels",
            "c, d",
        ),
    ],
)
def test_unsupported_constructs(text: str, what: str, place: str) -> None:
    with pytest.raises(UnsupportedError) as raised:
        exported(text)
    diagnostic = raised.value.diagnostic
    assert diagnostic.code == "E0803"
    assert what in diagnostic.message
    assert text[diagnostic.span.start :].startswith(place)


def test_what_only_hinders_waiting_is_given_up_for_a_proof() -> None:
    text = (
        one_process(
            "init location a { invariant x <= 4 && x <= n; to b { sync go!; assign n = 2; } } location b;",
            "A[] P.n <= 2",
            "urgent chan go[2]; process Q() { init location a { to a { sync go[0]?; } } } int[0, 3] n = 1;",
        )
        .replace("go!", "go[0]!")
        .replace("system P", "system P, Q")
        .replace("P.n", "n")
    )
    model = load_model(Source("model.ta", text))
    network, found = weakened(model.network)
    assert [weakening.text for weakening in found] == [
        "`go` is taken to be an ordinary channel",
        "this part of the invariant of `a` is left out",
    ]
    assert text[found[1].span.start :].startswith("x <= n")
    assert "x <= 4" in to_munta(network, model.queries[0]).network.text()
    proof = munta_proof(model.network, model.queries[0])
    assert isinstance(proof, MuntaProof)
    assert proof.weakenings == found


def test_a_property_that_needs_what_is_given_up_has_no_proof() -> None:
    text = one_process(
        "init location a { invariant x <= n; to b { guard x > 2; } to a { assign n = 2; } } location b;",
        "A[] !P.b",
        "int[1, 2] n = 1;",
    )
    assert api.Model(load_model(Source("model.ta", text)), "model.ta").verify()[0].answer == "holds"
    proof = proof_of(text)
    assert isinstance(proof, str)
    assert "model.ta:1:" in proof
    stuck = text.replace("A[] !P.b", "A[] !deadlock").replace("location b;", "location b { to b; }")
    with pytest.raises(UnsupportedError, match="invariants that depend on variables"):
        proof_of(stuck)


def test_any_model_can_be_exported_with_or_without_a_query() -> None:
    nothing = "process P() { init location a; } system P;"
    model = api.Model(load_model(Source("model.ta", nothing)), "model.ta")
    found = json.loads(api.export(model, "munta"))
    assert found["clocks"] == "none"
    assert edges(found["automata"][0]) == [(0, 0, "", "never?", "")]
    queried = nothing.replace("a;", "a { to b; } location b;") + " property later : A<> P.a; property now : E<> P.b;"
    model = api.Model(load_model(Source("model.ta", queried)), "model.ta")
    assert json.loads(api.export(model, "munta"))["formula"] == "E<> P.b"


def test_the_receiver_has_the_last_word() -> None:
    text = """\
chan c;
int[0, 3] n;
process P() { init location a { to a { sync c!; assign n = 1; } } }
process Q() { init location a { to a { sync c?; assign n = 2; } to a { guard n == 1; } } }
system P, Q;
property q : A[] n != 1;
"""
    assert edges(automata(text)[0]) == [(0, 0, "", "c!", "n = 2")]
    assert edges(automata(text)[1]) == [(0, 0, "n == 1", "", ""), (0, 0, "", "c?", "")]


def test_a_broadcast_that_carries_something_is_a_channel_for_each_message() -> None:
    text = """\
broadcast chan all;
int[0, 2] n;
process S() { init location a { to a { guard n < 2; sync all!; assign n = n + 1; } } }
process R() { int[0, 2] seen; init location a { to a { guard n > 0; sync all?; assign seen = n; } } }
system S, R;
property q : A[] R.seen < 2;
"""
    assert edges(automata(text)[0]) == [(0, 0, "n == 0", "all!", "n = 1"), (0, 0, "n == 1", "all_2!", "n = 2")]
    assert edges(automata(text)[1]) == [
        (0, 0, "n >= 1", "all?", "R_seen = 1"),
        (0, 0, "n >= 1", "all_2?", "R_seen = 2"),
    ]
    assert exported(text).network.broadcast == ("all", "all_2")


def test_receivers_of_one_broadcast_do_not_need_one_another() -> None:
    text = """\
broadcast chan all;
int[0, 2] n;
process S() { init location a { to a { sync all!; } } }
process R(const int[1, 2] k) { init location a { to a { sync all?; assign n = n == 2 ? 0 : n + 1; } } }
system S, R;
property q : A[] n < 2;
"""
    with pytest.raises(UnsupportedError, match="read what another receiver may have written"):
        exported(text)


COUNTER = """\
int n = -1;
process P() { clock x; init location a { to a { guard x >= 1 && n < 3; assign n = n + 1, x = 0; } } }
system P;
property q : A[] n < 5;
"""


def test_a_proof_has_only_the_values_that_variables_take() -> None:
    proof = proof_of(COUNTER)
    assert isinstance(proof, MuntaProof)
    document = json.loads(proof.model)
    assert document["vars"] == "n[0:4]"
    assert "outside" not in proof.model
    assert len(edges(document["automata"][0])) == 4


def test_a_value_outside_the_ranges_is_a_goal() -> None:
    model = load_model(Source("model.ta", COUNTER))
    written = to_munta(model.network, model.queries[0], {0: (-1, 1)}).network
    assert written.formula == "E<> P.outside"
    process = json.loads(written.text())["automata"][0]
    assert edges(process)[-1] == (0, 1, "n == 2 && P_x >= 1", "", "P_x = 0")
    interpretation = MuntaInterpretation(written.text(), written.renaming())
    assert interpretation.is_reached()


def test_a_value_that_an_invariant_excludes_is_no_goal() -> None:
    text = """\
int[0, 3] n;
process P() {
    clock x;
    init location a { to b { guard x > 4; assign n = 2; } to a { guard n < 1; assign n = 1; } }
    location b { invariant x <= 3; to a; }
}
system P;
property q : A[] n < 2;
"""
    proof = proof_of(text)
    assert isinstance(proof, MuntaProof)
    assert json.loads(proof.model)["automata"][0]["nodes"][-1] == {"id": 2, "name": "outside", "invariant": "P_x <= 3"}
    assert MuntaInterpretation(proof.model, proof.renaming).is_proof(proof.certificate)
