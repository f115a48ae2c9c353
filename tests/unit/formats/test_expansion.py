"""What tachk adds to UPPAAL's language, written out: the text, and that it means the same."""

from __future__ import annotations

import pytest

from tachk.base import operators
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.network import network_to_json
from tachk.formats.plain.expansion import expand
from tachk.formats.uppaal.export import print_xta
from tachk.formats.uppaal.query_file import print_queries
from tachk.frontend.loaded import LoadedModel
from tachk.syntax.query_files import parse_queries


def load(text: str, **constants: int) -> LoadedModel:
    return load_model(Source("model.ta", text), constants)


def xta(model: LoadedModel, *definitions: str) -> str:
    return print_xta(expand(model, definitions))


def behaviour(model: LoadedModel) -> object:
    """The network without documentation, signals and time unit, which have no place in XTA."""
    network = network_to_json(model.network)
    for process in network["processes"]:
        for part in (*process["locations"], *process["edges"]):
            part.pop("doc")
    return {**network, "signals": None, "time_unit": None}


def assert_same_in_xta(text: str) -> str:
    model = load(text)
    written = xta(model)
    assert behaviour(load_model(Source("model.xta", written), strict_xta=True)) == behaviour(model)
    return written


LAMP = """\
time_unit = 10 ms;
const int LONG = 5;    // how long is long
typedef int[0, 2] level_t;
broadcast urgent chan press;
level_t level = 0;

/// a lamp
process Lamp() {
    clock y;

    /// dark
    init location Off {
        to On { sync press?; assign y = 0, level = 1; }
    }

    location On {
        invariant y <= 10;
        exponential_rate 3;
        /// again, quickly
        to Choice { guard y < LONG; sync press?; }
        to Off { guard y >= LONG; assign level = 0; }
    }

    urgent location Flash { to Off; }
    committed location Gone;

    branchpoint Choice {
        to Flash { probability 3; }
        to Gone { probability 1; assign level = 2; }
    }
}

process Hand() {
    init location Idle { to Idle { select i : level_t; guard i == level; sync press!; } }
}

signal bright = level > 0;
system Lamp, Hand;

property light "the lamp can shine" : E<> bright && Lamp.On expect holds;
property never : A[] level < 2 expect fails;
"""


def test_a_model_in_xta() -> None:
    assert (
        assert_same_in_xta(LAMP)
        == """\
// one time unit is 10 ms

const int LONG = 5;  // how long is long
typedef int[0, 2] level_t;
urgent broadcast chan press;
level_t level = 0;

// a lamp
process Lamp() {
    clock y;

    state
        // dark
        Off,
        On { y <= 10 ; 3 },
        Flash,
        Gone;
    branchpoint Choice;
    commit Gone;
    urgent Flash;
    init Off;
    trans
        Off -> On { sync press?; assign y = 0, level = 1; },
        // again, quickly
        On -> Choice { guard y < LONG; sync press?; },
        On -> Off { guard y >= LONG; assign level = 0; },
        Flash -> Off { },
        Choice -> Flash { probability 3; },
        Choice -> Gone { assign level = 2; probability 1; };
}

process Hand() {
    state
        Idle;
    init Idle;
    trans
        Idle -> Idle { select i : level_t; guard i == level; sync press!; };
}

system Lamp, Hand;
"""
    )


def test_its_properties_in_a_query_file() -> None:
    text = print_queries(expand(load(LAMP)).queries)
    assert (
        text
        == """\
/*
light: the lamp can shine
*/
E<> level > 0 && Lamp.On
/* EXPECT:T */

/*
never
*/
A[] level < 2
/* EXPECT:F */
"""
    )
    entries, diagnostics = parse_queries(Source("model.q", text))
    assert not diagnostics
    assert [entry.expectation for entry in entries] == ["holds", "fails"]


def test_values_over_channels() -> None:
    written = assert_same_in_xta("""\
typedef struct { int kind; bool last; } packet_t;
chan c, d[2];
process S(const int[0,1] me) {
    packet_t p;
    init location A {
        to A { sync c!me + 1; assign p.kind = 1; }
        to A { sync d[me]!p; }
    }
}
process R() {
    int n;
    packet_t p;
    init location A {
        to A { sync c?n; assign n = n + 1; }
        to A { select i : int[0, 1]; sync d[i]?p; }
    }
}
system S, R;
""")
    assert "meta int c_value;" in written
    assert "meta packet_t d_value[2];" in written
    assert "sync c!; assign c_value = me + 1, p.kind = 1;" in written
    assert "select i : int[0, 1]; sync d[i]?; assign p = d_value[i];" in written


def test_values_over_channels_that_are_parameters() -> None:
    text = """\
chan line[2];
process S(chan &out, const int v) { init location A { to A { sync out!v; } } }
process R(chan &in) { int n; init location A { to A { sync in?n; } } }
Half(chan &c) = S(c, 7);
s = Half(line[1]);
r = R(line[1]);
system s, r;
"""
    written = xta(load(text))
    assert "process S(chan &out, const int v, int &out_value)" in written
    assert "Half(chan &c, int &c_value) = S(c, 7, c_value);" in written
    assert "r = R(line[1], line_value[1]);" in written
    assert_same_in_xta(text)


def test_a_local_channel_cannot_carry_values_in_uppaal() -> None:
    model = load("process P() { broadcast chan c; init location A { to A { sync c!1; } } }\nsystem P;")
    with pytest.raises(UnsupportedError, match="E0801: values pass over `c`"):
        expand(model)


def test_an_operator_that_no_version_has_is_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "int n; process P() { state A; init A; trans A -> A { assign n = n ** 2; }; } system P;"
    assert "n ** 2" in xta(load(text))
    row = operators._ROWS[BinaryOperator.POWER]._replace(since=None)
    monkeypatch.setitem(operators._ROWS, BinaryOperator.POWER, row)
    with pytest.raises(UnsupportedError, match=r"UPPAAL has no operator `\*\*`") as caught:
        expand(load(text))
    assert (caught.value.diagnostic.code, caught.value.diagnostic.span.text) == ("E0801", "n ** 2")


def test_the_variable_of_a_channel_avoids_names_of_templates() -> None:
    written = assert_same_hidden("""\
chan c;
process S() { int c_value; init location A { to A { sync c!1; assign c_value = 2; } } }
process R() { int n; init location A { to A { sync c?n; } } }
system S, R;
""")
    assert "meta int c_value_1;" in written
    assert "assign c_value_1 = 1, c_value = 2;" in written


def assert_same_hidden(text: str) -> str:
    written = xta(load(text))
    load_model(Source("model.xta", written), strict_xta=True)
    return written


def test_signals_are_written_out_without_capture() -> None:
    model = load("""\
typedef int[0, 1] id_t;
int i = 1;
signal busy = i > 0;
signal twice = busy && i < 5;
process P() { init location A; }
system P;
property p : A[] forall (i : id_t) i < 2 imply !twice;
""")
    (query,) = print_queries(expand(model).queries).strip().splitlines()[3:]
    assert query == "A[] forall (i_1 : id_t) i_1 < 2 imply !(i > 0 && i < 5)"


def test_constants_from_outside_are_written_down() -> None:
    model = load("const int N = 2, M = 1; const bool B = false;\nprocess P() { state a; init a; }\nsystem P;", N=7, B=1)
    assert xta(model, "N", "B").startswith("const int N = 7, M = 1;\nconst bool B = true;\n")


def test_names_that_a_version_rejects_are_replaced_everywhere() -> None:
    written_model = load("""\
int exit_1 = 0;
int location = 1;
process P() { state exit, IO; init exit; trans exit -> IO { assign location = exit_1; }; }
system P;
property p : E<> P.exit && location == 1;
""")
    plain = expand(written_model)
    assert "exit_2 -> IO_1 { assign location_1 = exit_1; };" in print_xta(plain)
    assert "E<> P.exit_2 && location_1 == 1" in print_queries(plain.queries)
    assert [step.kind for step in plain.steps].count("name") == 3


def test_built_in_names_of_version_5_are_written_out() -> None:
    text = assert_same_in_xta("""\
int8_t a = INT8_MAX;
process P() { state s; init s; }
system P;
""")
    assert text.startswith("int[-128, 127] a = 127;\n")


def test_uppaal_3_becomes_todays_syntax() -> None:
    model = load(
        "const N 5;\nprocess P { clock x, y; state a; init a; trans a -> a { guard x > N, y > N; }; }\nsystem P;"
    )
    assert "const int N = 5;" in xta(model)
    assert "guard x > N && y > N;" in xta(model)


def test_imports_stand_in_their_place(tmp_path: object) -> None:
    from pathlib import Path

    folder = Path(str(tmp_path))
    (folder / "lib.ta").write_text("const int N = 3;\nprocess P() { init location A { to A; } }\n")
    (folder / "model.ta").write_text('import "lib.ta";\nint[0, N] n;\nsystem P;\n')
    plain = expand(load_model(folder / "model.ta"))
    assert print_xta(plain).startswith("const int N = 3;")
    assert [step.text for step in plain.steps if step.kind == "import"] == [
        "the declarations of `lib.ta` stand in its place"
    ]
