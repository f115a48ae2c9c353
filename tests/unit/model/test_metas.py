"""Meta variables that a transition may read before it has written them are ordinary ones."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.diagnostics.span import Source
from tachk.loading.load import load_model

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
    ordinary = [v.name for v in loaded.network.variables if v.name in ("m", "t", "r") and not v.meta]
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


def test_a_receiver_reads_the_cell_of_its_channel() -> None:
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
