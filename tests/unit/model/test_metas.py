"""Meta variables that a transition may read before it has written them are ordinary ones."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.base.span import Source
from tachk.engine.compiler.lower import lower
from tachk.formats.loading.load import load_model
from tachk.formats.network_document import network_document
from tachk.formats.network_json.network import network_from_json, network_to_json
from tachk.model.variable_layout import variable_layout
from tachk.syntax.printing.printer import print_document

DECLARATIONS = """
typedef struct { int a; int b; } pair_t;
meta int m; meta int t[2]; meta pair_t r; pair_t w; int n; chan c, d, e[2]; bool flag;
int twice(int v) { m = v; return m + m; }
int maybe(int v) { if (flag) return v; m = v; return m; }
int left() { return m; }
void count() { int i; for (m = 0; m < 2; m++) { n = n + m; } }
void table() { int i; for (i = 0; i < 2; i++) t[i] = i; n = t[1]; }
"""


def lasting(own: str, other: str = "") -> list[str]:
    text = f"""{DECLARATIONS}
        process P() {{ state s; init s; trans s -> s {{ {own} }}; }}
        process Q() {{ state s; init s; trans s -> s {{ {other} }}; }}
        system P, Q;"""
    loaded = load_model(Source("m.ta", text))
    ordinary = [v.name for v in loaded.network.variables if v.name in ("m", "t", "r") and not loaded.network.resets(v)]
    warned = [d.span.text for d in loaded.warnings if d.code == "W0408"]
    assert warned == ordinary
    return ordinary


@pytest.mark.parametrize(
    "updates",
    [
        "m = 3, n = m",
        "m = n, m++, n = m",
        "n = twice(2) + m",
        "count()",
        "n = (m = 2) + m",
        "n = flag ? (m = 1) : (m = 2), n = m",
        "r = w, n = r.b",
        "m = 1, t[m] = 2",
        "m = maybe(1)",
        "t[0] = 1, n = t[0]",
        "r.a = 1, n = r.a",
        "t[0] = 1, t[0]++",
        "r.b = 1, r.a = 2, w = r",
    ],
)
def test_written_before_it_is_read(updates: str) -> None:
    assert lasting(f"assign {updates};") == []


@pytest.mark.parametrize(
    ("edge", "names"),
    [
        ("assign n = m;", ["m"]),
        ("assign m++;", ["m"]),
        ("assign m += 1;", ["m"]),
        ("guard m == 0; assign m = 1;", ["m"]),
        ("assign n = left();", ["m"]),
        ("assign n = maybe(1), n = m;", ["m"]),
        ("assign n = flag ? (m = 1) : 2, n = m;", ["m"]),
        ("assign flag = flag && (m = 1) > 0, n = m;", ["m"]),
        ("assign t[0] = 1, n = t[1];", ["t"]),
        ("assign t[0] = 1, n = t[n];", ["t"]),
        ("assign t[n] = 1, n = t[n];", ["t"]),
        ("assign table();", ["t"]),
        ("assign r.a = 1, n = r.b;", ["r"]),
        ("assign r.a = 1, w = r;", ["r"]),
        ("assign t[m] = 1;", ["m"]),
    ],
)
def test_read_before_it_is_written(edge: str, names: list[str]) -> None:
    assert lasting(edge) == names


def test_a_receiver_reads_what_every_sender_has_written() -> None:
    assert lasting("sync c!; assign m = 2;", "sync c?; assign n = m;") == []
    assert lasting("sync c!; assign n = 2;", "sync c?; assign n = m;") == ["m"]
    assert lasting("sync d!; assign m = 2;", "sync c?; assign n = m;") == []  # nobody sends on c
    assert lasting("sync c!; }, s -> s { sync c!; assign m = 2;", "sync c?; assign n = m;") == ["m"]


def test_a_receiver_reads_the_slot_of_its_channel() -> None:
    receive = "select j : int[0,1]; sync e[j]?; assign n = t[j];"
    assert lasting("select i : int[0,1]; sync e[i]!; assign t[i] = 2;", receive) == []
    assert lasting("sync e[1]!; assign t[1] = 2;", receive) == []
    assert lasting("sync e[1]!; assign t[0] = 2;", receive) == ["t"]
    assert lasting("sync e[1]!; assign t[1] = 2;", "sync e[1]?; assign n = t[0];") == ["t"]


def test_a_value_that_lasts_is_seen_by_a_later_transition(tmp_path: Path) -> None:
    file = tmp_path / "m.ta"
    file.write_text(
        "meta int m; process P() { state A, B, C; init A; "
        "trans A -> B { assign m = 5; }, B -> C { guard m == 5; }; } system P;"
    )
    (verdict,) = tachk.load(file).verify("E<> P.C")
    assert verdict.answer is tachk.Answer.HOLDS
    assert verdict.trace is not None


def test_what_lasts_is_a_part_of_the_state_everywhere() -> None:
    text = """meta int[0,3] kept, reset;
        process P() { state s; init s; trans s -> s { guard kept == 0; assign reset = 1, kept = reset; }; }
        system P;"""
    network = load_model(Source("m.ta", text)).network
    kept, reset = network.variables
    assert (network.resets(kept), network.resets(reset)) == (False, True)
    assert variable_layout(network).meta == (False, True)
    program, _ = lower(network, [])
    assert [(slot.name, slot.meta) for slot in program.slots if slot.name in ("kept", "reset")] == [
        ("kept", False),
        ("reset", True),
    ]
    again = network_from_json(network_to_json(network))
    assert [again.resets(variable) for variable in again.variables] == [False, True]
    written = print_document(network_document(network, "m.ta"))
    assert "meta int[0, 3] reset" in written and "meta int[0, 3] kept" not in written


def test_a_variable_of_a_template_lasts_in_all_processes_or_in_none() -> None:
    text = """chan c, d; int n;
        process S() { state s; init s; trans s -> s { sync c!; }; }
        process R(chan &heard) { meta int m; state s; init s; trans s -> s { sync heard?; assign n = m; }; }
        A = R(c);
        B = R(d);
        system S, A, B;"""
    loaded = load_model(Source("m.ta", text))
    assert sorted(variable.name for variable in loaded.network.lasting) == ["A.m", "B.m"]
    assert [d.code for d in loaded.warnings].count("W0408") == 1


def test_a_value_over_a_channel_is_reset_even_where_one_of_the_same_name_lasts() -> None:
    text = """chan c; int n; meta int c_value;
        process S() { state s; init s; trans s -> s { sync c!1; assign n = c_value; }; }
        process R() { state s; init s; trans s -> s { sync c?n; }; }
        system S, R;"""
    network = load_model(Source("m.ta", text)).network
    assert [variable.name for variable in network.lasting] == ["c_value"]
    assert [v.name for v in network.variables if network.resets(v)] == ["c_value_1"]
