"""Inputs like those of public bug reports about other tools: each command does what is right, in one table."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

import tachk
from tachk.base.records import dataclass
from tachk.cli.main import app

pytestmark = pytest.mark.drawn


@dataclass(frozen=True, slots=True)
class PublicReport:
    """A command with the files that it reads, its status, and what it has to say and not to say."""

    name: str
    files: dict[str, str | bytes]
    command: tuple[str, ...]
    status: int
    says: tuple[str, ...]
    never: tuple[str, ...] = ()


WAIT = "clock x; process A() { init location s { invariant x <= 5; to t { } } location t; } system A;"
CONSTANT = (
    "const int LIMIT = 4; int level = 1; clock x;"
    " process A() { init location s { invariant x <= 5; to t { } } location t; }"
    " signal low = level < LIMIT; signal room = LIMIT - level; system A; property steady : G (low && room == 3);"
)
RATES = "int d; process A() { state s, t; init s; trans s -> t { assign d = 1; }; } system A;"
BY_ZERO = "const int D = 0; clock x; process A() { state s, t; init s; trans s -> t { guard x >= 5 / D; }; } system A;"
MICRO = (
    "time_unit = 1 us; clock x; process P()"
    " { init location a { invariant x <= 10000000; to a { guard x >= 10000000; assign x = 0; } } } system P;"
)
WIDE = (
    "int[0,65535] n; process P() { init location a"
    " { to a { select i : int[0,65535]; guard i == n + 1 && n < 20; assign n = i; } } } system P;"
)
NO_START = "clock x; process P() { init location a { invariant x >= 1; to b { } } location b; } system P;"
TIME_LOCK = (
    "clock x; process P() { init location a { invariant x <= 5; to b { guard x >= 6; } } location b; } system P;"
)
PLACES = (
    "int i; void f() { (++i)++; ++++i; } process Z() { state s, t; init s; trans s -> t { assign f(); }; } system Z;"
)
STRUCT = (
    "typedef struct { clock t; double d; int n; } s_t; s_t v[2]; process P() { init location a { invariant v[1].t <= 3;"
    " to b { guard v[1].t >= 2; assign v[0].n = 3, v[0].d = 1.5; } } location b; } system P;"
)
WEIGHT = (
    "clock x; process M() { init location s { invariant x <= 4; to b { } } branchpoint b { to t { probability x; }"
    " to u { probability 4 - x; } } location t; location u; } system M;"
)
CHAIN = "int n; process Z() { state s, t; init s; trans s -> t { %s }; } system Z;"
SIGNALS = "time [s],p,q,x\n0,0,0,1\n1,1,0,6\n3,0,1,2\n10,0,0,2\n"
SECOND = 10**9
EPOCH = 1764000000


def messages(topic: str, found: list[tuple[int, object]]) -> bytes:
    """An MCAP file of JSON messages, by their times in nanoseconds."""
    writers = pytest.importorskip("mcap.writer")
    into = io.BytesIO()
    writer = writers.Writer(into)
    writer.start()
    schema = writer.register_schema(name="s", encoding="jsonschema", data=b'{"type": "object"}')
    channel = writer.register_channel(topic=topic, message_encoding="json", schema_id=schema)
    for time, value in found:
        writer.add_message(channel, log_time=time, publish_time=time, data=json.dumps(value).encode())
    writer.finish()
    return into.getvalue()


def counted(times: list[int], name: str = "/a") -> bytes:
    return messages(name, [(time, {"x": row}) for row, time in enumerate(times)])


REPORTS = (
    PublicReport(
        "constant_signal",
        {"m.ta": CONSTANT},
        ("simulate", "m.ta", "--until", "8", "--seed", "4", "--monitor", "m.ta", "--runs", "3"),
        0,
        ("steady: true on 3, false on 0",),
    ),
    PublicReport(
        "constant_values",
        {"m.ta": "int n = 1; " + WAIT},
        ("estimate", "m.ta", "simulate [<=8] {n, 2*n}"),
        0,
        ("n: (0, 1) (8, 1)", "2*n: (0, 2) (8, 2)"),
    ),
    PublicReport(
        "long_formula",
        {"a.csv": SIGNALS},
        ("monitor", "G (" + " && ".join(f"x < {bound}" for bound in range(50, 120)) + ")", "a.csv"),
        0,
        ("1 true",),
        ("File name too long",),
    ),
    PublicReport(
        "requirement_without_signal",
        {"r.stl": "r1: G false\nr2: whenever a, within 5 s, b must be true.\n"},
        ("requirements", "r.stl"),
        10,
        ("2 requirements about a, b", "inconsistent: no run satisfies r1 for ever"),
    ),
    PublicReport(
        "requirement_with_constant",
        {"r.stl": "const N = 3\nr1: G (N > 2)\nr2: G (p -> q)\n"},
        ("requirements", "r.stl"),
        10,
        ("2 requirements about p, q", "redundant: r1 always holds"),
    ),
    PublicReport(
        "requirements_that_forbid_their_trigger",
        {"r.stl": "r1: whenever a is true, b must be true.\nr2: whenever a is true, b must not occur.\n"},
        ("requirements", "r.stl"),
        10,
        ("vacuous: the triggers of r1 and r2 never happen if r1 and r2 hold",),
    ),
    PublicReport(
        "query_with_an_error",
        {"m.ta": RATES, "q.q": "E<> A.t\nA[] 1/d == 1\nA[] d <= 1\n"},
        ("verify", "m.ta", "-q", "q.q", "--trace", "none"),
        20,
        ("  q1        holds ", "? q2        unknown ", "  q3        holds ", "say in the query when it counts"),
    ),
    PublicReport(
        "nanoseconds_in_json_lines",
        {"a.jsonl": '{"t":1764000000123456789,"x":1}\n{"t":1764000001123456790,"x":9}\n'},
        ("monitor", "G (x < 5)", "a.jsonl", "--unit", "ns"),
        10,
        ("`x < 5` is false at 1764000001123456790 ns",),
    ),
    PublicReport(
        "byte_order_mark",
        {"a.jsonl": b'\xef\xbb\xbf{"t":0,"x":1}\n{"t":1,"x":9}\n'},
        ("monitor", "G (x < 5)", "a.jsonl"),
        10,
        ("`x < 5` is false at 1",),
    ),
    PublicReport(
        "long_else_if",
        {
            "m.ta": "int n; void f() { "
            + " else ".join(f"if (n == {value + 1}) n = 0;" for value in range(260))
            + " } "
            + CHAIN[len("int n; ") :] % "assign f();"
        },
        ("verify", "m.ta", "E<> Z.t", "--quiet"),
        0,
        (),
    ),
    PublicReport(
        "long_imply",
        {"m.ta": CHAIN % f"guard {' imply '.join(['n == 0'] * 600)};"},
        ("verify", "m.ta", "E<> Z.t", "--quiet"),
        0,
        (),
    ),
    PublicReport(
        "infinite_cell",
        {"a.csv": "time,x\n0,1\n1,-inf\n2,3\n"},
        ("monitor", "G (x < 5)", "a.csv"),
        0,
        ("true     2 ",),
    ),
    PublicReport(
        "age_of_a_message",
        {"a.csv": "time,stamp\n0.0,0.0\n1.0,0.9\n2.0,1.2\n"},
        ("monitor", "G (time - stamp < 0.5)", "a.csv"),
        10,
        ("is false at 2\n",),
    ),
    PublicReport(
        "statistics_of_verifyta",
        {"m.ta": "int n = 1; " + WAIT, "q.q": "Pr[<=10](<> A.t)\nsimulate [<=10;2] {x, n}\nE<> A.t\n"},
        ("verifyta", "-q", "m.ta", "q.q"),
        0,
        ("Pr(<> ...) in [0.924514,1]", "[0]: (0,1) (10,1)", "Verifying formula 3"),
    ),
    PublicReport(
        "struct_with_a_double",
        {"m.ta": STRUCT},
        ("verify", "m.ta", "E<> P.b && v[0].n == 3"),
        0,
        ("W0406", "1 passed"),
    ),
    PublicReport("assigned_places", {"m.ta": PLACES}, ("verify", "m.ta", "E<> Z.t && i == 4", "--quiet"), 0, ()),
    PublicReport(
        "weight_with_a_clock",
        {"m.ta": WEIGHT},
        ("estimate", "m.ta", "Pr[<=5](<> M.t) >= 0.4", "Pr[<=5](<> M.t) <= 0.6"),
        0,
        ("q1", "q2"),
        ("E0722",),
    ),
    PublicReport(
        "named_formula",
        {"f.stl": "b: G (p -> q)\na: b && G p\n", "a.csv": SIGNALS},
        ("monitor", "f.stl", "a.csv"),
        10,
        ("2 false",),
    ),
    PublicReport(
        "constant_with_a_unit",
        {"f.stl": "const T = 2 s\na: G (p -> F[0, T] q)\n", "a.csv": SIGNALS},
        ("monitor", "f.stl", "a.csv"),
        0,
        ("1 true",),
    ),
    PublicReport(
        "requirement_number",
        {"f.stl": "REQ-1: G (p -> q)\n", "a.csv": SIGNALS},
        ("monitor", "f.stl", "a.csv"),
        10,
        ("REQ-1 is false",),
    ),
    PublicReport(
        "two_parameters",
        {"a.csv": SIGNALS},
        ("mine", "G (rise(p) -> F[0,T s] (x < C))", "a.csv", "--over", "T=0..20", "--over", "C=0..10"),
        2,
        ("one parameter is mined at a time, not 2: T, C",),
    ),
    PublicReport(
        "leading_gap",
        {"a.csv": "time,x\n0,\n1,2\n2,9\n"},
        ("monitor", "G (x < 5)", "a.csv"),
        10,
        ("`x < 5` is false at 2",),
    ),
    PublicReport(
        "decimal_comma",
        {"a.csv": "time;x\n0,0;1,5\n0,5;9,25\n"},
        ("monitor", "G (x < 5)", "a.csv"),
        10,
        ("seen at 0.5: x = 9.25",),
    ),
    PublicReport(
        "microseconds",
        {"m.ta": MICRO},
        ("simulate", "m.ta", "--until", "10 min"),
        0,
        ("1 run until 10 min, 60 transitions",),
    ),
    PublicReport(
        "no_truth_value",
        {"a.csv": "time,ok\n0,1\n1,0.5\n2,-1\n"},
        ("monitor", "G ok", "a.csv"),
        2,
        ("`ok` is not a condition: it is 0.5 at 1",),
    ),
    *(
        PublicReport(f"spelling_{number}", {"a.csv": SIGNALS}, ("monitor", formula, "a.csv"), 2, (help_text,))
        for number, (formula, help_text) in enumerate(
            (
                ("always (p implies eventually[0,5] q)", "the operator is written G"),
                ("alw_[0,5] (x < 3)", "the operator is written G, with the interval right behind it"),
                ("G (p <-> q)", "write `p == q` for conditions"),
                ("p R q", "write `q W (p && q)`"),
            )
        )
    ),
    PublicReport(
        "point_at_the_end",
        {"a.csv": "time,x\n0,0.2\n1,0.3\n"},
        ("monitor", "G (x < 5.)", "a.csv"),
        0,
        ("4.7",),
    ),
    PublicReport(
        "advice_about_parameters",
        {"m.ta": "clock x; process P(int n, clock &c) { state a; init a; } system P;"},
        ("check", "m.ta"),
        2,
        ("write `P1 = P(...);` and put `P1` into the system line",),
    ),
    PublicReport(
        "division_by_zero_in_a_bound",
        {"m.ta": BY_ZERO},
        ("verify", "m.ta", "E<> A.t"),
        20,
        ("1:87: error[E0763]: run-time error: division by zero",),
        ("E0704",),
    ),
    PublicReport(
        "semicolon_behind_a_query",
        {"m.ta": RATES, "q.q": "E<> A.t;\n"},
        ("verify", "m.ta", "-q", "q.q"),
        2,
        ("remove it: a query ends without one", "no query could be read"),
        ("supports none",),
    ),
    PublicReport(
        "missing_brace",
        {"m.ta": "int m;\nvoid f() {\n  if (m == 0) {\n    m = 1;\n}\nvoid g() { m = 2; }\n" + RATES},
        ("check", "m.ta"),
        2,
        ("m.ta:2:10: error[E0113]: this '{' is never closed",),
    ),
    PublicReport("wide_select", {"m.ta": WIDE}, ("verify", "m.ta", "E<> n == 20", "--quiet"), 0, ()),
    PublicReport(
        "no_initial_state",
        {"m.ta": NO_START, "by_hand.run": "0 P: a -> b\n"},
        ("replay", "m.ta", "by_hand.run"),
        2,
        ("m.ta:1:38: error[E0409]",),
    ),
    PublicReport(
        "time_lock",
        {"m.ta": TIME_LOCK},
        ("simulate", "m.ta", "--until", "15", "--monitor", "F[0, 3] P.b"),
        10,
        ("p1: true on 0, false on 1",),
    ),
)


@pytest.mark.parametrize("report", REPORTS, ids=[report.name for report in REPORTS])
def test_a_report_about_another_tool_is_answered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], report: PublicReport
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, content in report.files.items():
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    status = app.main(list(report.command), prog_name="tachk", standalone_mode=False)
    shown = capsys.readouterr()
    text = shown.out + shown.err
    assert status == report.status, text
    assert [words for words in report.says if words not in text] == [], text
    assert [words for words in (*report.never, "Traceback", "defect of tachk") if words in text] == []


MESSAGES: dict[str, tuple[Callable[[], bytes], str, int, str]] = {
    "rolled_over": (
        lambda: counted([EPOCH * SECOND, (EPOCH + 1) * SECOND, 2**64 - 1]),
        "G (a.x < 6)",
        2,
        "message 3 of /a is at 18446744073709551615 ns since 1970, which is beyond what can be counted",
    ),
    "clock_not_set": (
        lambda: counted([0, EPOCH * SECOND]),
        "G (a.x < 6)",
        2,
        "row 0 is at 1970-01-01T00:00:00Z, row 1 at 2025-11-24T16:00:00Z",
    ),
    "nothing_in_range": (
        lambda: messages(
            "/scan",
            [(row * SECOND, {"ranges": [math.inf if row < 4 else 0.2]}) for row in range(6)],
        ),
        "G (scan.ranges[0] > 0.5)",
        10,
        "`scan.ranges[0] > 0.5` is false at 4 s",
    ),
    "heartbeat": (
        lambda: messages("/hb", [(row * SECOND // 10, {"n": 1}) for row in (0, 1, 2, 3, 4, 12, 13, 14)]),
        "G F[0, 0.5 s] arrived(hb)",
        10,
        "is never true from just after 0.4 s to just after 0.9 s",
    ),
    "cut_off": (lambda: counted([0, SECOND, 2 * SECOND])[:-170], "G (a.x < 6)", 0, "m.mcap is cut off"),
}


@pytest.mark.parametrize("name", list(MESSAGES))
def test_a_report_about_messages_is_answered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    content, formula, status, words = MESSAGES[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.mcap").write_bytes(content())
    assert app.main(["monitor", formula, "m.mcap"], prog_name="tachk", standalone_mode=False) == status
    shown = capsys.readouterr()
    assert words in shown.out + shown.err


def test_times_of_32_bits_are_the_decimals_that_they_print_as() -> None:
    numpy = pytest.importorskip("numpy")
    times, values = numpy.array([0, 0.1, 0.2], dtype=numpy.float32), [1, 2, 1]
    assert str(tachk.monitor("F[0.1,0.1] (y > 1)", {"time": times, "y": values})[0].truth) == "true"
    monitor = tachk.Monitor("F[0.1,0.1] (y > 1)")
    for time, value in zip(times, values, strict=True):
        monitor.update(time, {"y": value})
    assert str(monitor.finish()[0].truth) == "true"
