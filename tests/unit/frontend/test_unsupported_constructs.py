"""A model with constructs that tachk does not check: read and written like any other, never analysed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.base.span import Source
from tachk.cli.commands.check import run_check
from tachk.cli.commands.convert import ConvertArguments, run_convert
from tachk.cli.exit_status import ExitStatus
from tachk.cli.verification import VerifyArguments, run_verify
from tachk.formats.catalogue import export_model
from tachk.formats.loading.load import load_model
from tests.support.queries import elaborate_queries

MODEL = """int n;
const int N = 3;
double level = 0.5;

process P() {
    init location s {
        to s { guard n < N && level < 9; assign n++, level = level * 2; }
    }
}

system P;
property bounded : A[] n <= 3;
property high : E<> level > 1;
"""
OTHER = (
    MODEL.replace("double level = 0.5;", "")
    .replace(" && level < 9", "")
    .replace(", level = level * 2", "")
    .replace("level > 1", "n > 1")
)


@pytest.fixture
def path(tmp_path: Path) -> str:
    file = tmp_path / "model.ta"
    file.write_text(MODEL)
    return str(file)


def test_no_analysis_gets_the_network() -> None:
    loaded = load_model(Source("m.ta", MODEL))
    assert [refusal.code for refusal in loaded.refusals[:1]] == ["E0750"]
    assert loaded.refusals[0].span.text == "level"
    with pytest.raises(UnsupportedError) as caught:
        _ = loaded.network
    assert caught.value.diagnostic is loaded.refusals[0]
    assert loaded.heading.processes == ()
    assert loaded.heading.constants == (("N", 3),)


@pytest.mark.parametrize("format_", ["dot", "json", "tchecker"])
def test_a_format_made_from_the_network_is_rejected(format_: str) -> None:
    with pytest.raises(UnsupportedError):
        export_model(load_model(Source("m.ta", MODEL)), format_)


def test_every_query_is_reported(path: str) -> None:
    report = tachk.load(path).verify()
    assert [(v.query.name, v.answer) for v in report] == [("bounded", tachk.Answer.UNKNOWN)]
    assert report[0].unsupported is not None
    assert report[0].unsupported.message == "the floating point variable `level` is not supported here"
    assert [query.name for query in report.record.not_checked] == ["high"]
    assert report.record.not_checked[0].diagnostics[0].span.text == "level"
    assert report.met is None


def test_a_model_whose_only_query_is_rejected_has_not_met_it(tmp_path: Path) -> None:
    file = tmp_path / "model.ta"
    file.write_text(MODEL.replace("property bounded : A[] n <= 3;\n", ""))
    assert tachk.load(file).verify().met is None


def test_queries_given_with_it_are_reported_too(path: str) -> None:
    report = tachk.load(path).verify("E<> n == 2", "E<> level > 2")
    assert [v.answer for v in report] == [tachk.Answer.UNKNOWN]
    assert [query.text for query in report.record.not_checked] == ["E<> level > 2"]


def test_a_query_that_is_rejected_keeps_no_other_from_being_checked(tmp_path: Path) -> None:
    file = tmp_path / "model.ta"
    file.write_text(OTHER + "property half : E<> n > sin(0.5);\n")
    model = tachk.load(file)
    assert model.refusals == ()
    report = model.verify()
    assert [v.answer for v in report] == [tachk.Answer.HOLDS, tachk.Answer.HOLDS]
    assert [query.name for query in report.record.not_checked] == ["half"]


def test_a_mistake_is_still_an_error() -> None:
    with pytest.raises(InputError) as caught:
        load_model(Source("m.ta", MODEL.replace("n < N &&", "m < N &&")))
    assert {"E0201", "E0750"} <= {found.code for found in caught.value.diagnostics}
    with pytest.raises(InputError):
        elaborate_queries(load_model(Source("m.ta", MODEL)), "E<> m > 1")


def test_commands_say_it_and_end_with_3(path: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_check((path,), ()) is ExitStatus.UNSUPPORTED
    assert "floating point variable `level` is not supported" in capsys.readouterr().err
    assert run_verify(VerifyArguments((path,))) is ExitStatus.UNSUPPORTED
    printed = capsys.readouterr()
    assert (printed.out + printed.err).count("model.ta:7:31: error[E0750]") == 1
    assert "bounded cannot be checked:" in printed.out
    assert "high cannot be checked:" in printed.out
    assert "holds" not in printed.out


def test_the_text_goes_to_uppaal_and_back(path: str, tmp_path: Path) -> None:
    xml, again = tmp_path / "model.xml", tmp_path / "again.ta"
    assert run_convert(ConvertArguments(path, xml)) is ExitStatus.AS_EXPECTED
    loaded = load_model(str(xml))
    assert [refusal.span.text for refusal in loaded.refusals] == [
        refusal.span.text for refusal in load_model(path).refusals
    ]
    assert run_convert(ConvertArguments(str(xml), again)) is ExitStatus.AS_EXPECTED
    text = again.read_text()
    assert "double level = 0.5;" in text
    assert "level = level * 2" in text
    assert "E<> level > 1" in text
    assert "a query that is wrong" not in text


def test_a_dynamic_template_is_kept(tmp_path: Path) -> None:
    text = (
        "dynamic Q(int a);\nprocess Q(int a) { init location s; }\n"
        "process P() { init location s { to s { assign spawn Q(1); } } }\nsystem P;\n"
    )
    loaded = load_model(Source("m.ta", text))
    assert {refusal.code for refusal in loaded.refusals} == {"E0750"}
    assert "dynamic Q" in export_model(loaded, "xta").text


def labels(text: str) -> str:
    return f"process P() {{ init location s {{ to s {{ {text} }} }} }}\nsystem P;\n"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("clock x;\nprocess P() { init location s { invariant x' == 2; } }\nsystem P;", "2"),
        ("clock x, y;\nprocess P() { init location s { invariant x' == y; } }\nsystem P;", "y"),
        ("clock x, y;\n" + labels("assign x = y - 1;"), "x = y - 1"),
        ("clock x, y;\n" + labels("assign x = 2 * y;"), "2 * y"),
        ("chan c;\n" + labels("sync c;"), "c"),
        (
            (
                "chan c, d; process P() { init location s { to b { sync d?; } } "
                "branchpoint b { to s { sync c!; } } } system P;"
            ),
            "c!",
        ),
    ],
)
def test_what_has_no_symbolic_meaning_is_rejected(text: str, named: str) -> None:
    loaded = load_model(Source("m.ta", text))
    assert [refusal.span.text.removeprefix("sync ") for refusal in loaded.refusals] == [named]


def test_a_template_that_is_not_used_keeps_nothing_from_being_checked() -> None:
    text = "process Q() { const int n = fint(sin(1)); init location s; }\nprocess P() { init location s; }\nsystem P;\n"
    loaded = load_model(Source("m.ta", text))
    assert loaded.refusals == ()
    assert [(warning.code, warning.span.text) for warning in loaded.warnings] == [("W0405", "sin")]
    assert [process.name for process in loaded.network.processes] == ["P"]


LEFT_OUT = """int n;
double cost = 0.5;
hybrid clock energy;

process P() {
    clock x;
    init location s {
        invariant x <= 5 && energy' == 2 * n + cost;
        to s { guard x >= 5; assign cost = cost + sqrt(energy) * n, n = 1 - n, x = 0; }
    }
}

system P;
property once : E<> n == 1;
property dear : E<> cost > 1;
"""


def test_what_nothing_checked_reads_is_left_out(tmp_path: Path) -> None:
    file = tmp_path / "model.ta"
    file.write_text(LEFT_OUT)
    model = tachk.load(file)
    assert model.refusals == ()
    assert [(warning.code, warning.span.text) for warning in model.warnings] == [("W0406", "cost"), ("W0406", "energy")]
    process = model.network.processes[0]
    assert process.locations[0].rates == ()
    assert len(process.edges[0].updates) == 2
    report = model.verify()
    assert [v.answer for v in report] == [tachk.Answer.HOLDS]
    assert [query.name for query in report.record.not_checked] == ["dear"]
    assert report.met is None


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("guard x >= 5", "guard x >= 5 && cost < 2"),
        ("invariant x <= 5", "invariant x <= 5 && energy <= 9"),
        ("n = 1 - n", "n = cost > 1"),
        ("x = 0;", "x = cost;"),
        ("double cost = 0.5;", "double cost = 0.5;\nint f() { return cost > 1 ? 1 : 0; }\nint a = f();"),
        ("energy' == 2 * n + cost", "x' == cost"),
    ],
)
def test_whatever_else_uses_it_is_rejected(before: str, after: str) -> None:
    loaded = load_model(Source("m.ta", LEFT_OUT.replace(before, after)))
    assert "E0750" in {refusal.code for refusal in loaded.refusals}
    with pytest.raises(UnsupportedError):
        _ = loaded.network


@pytest.mark.parametrize("value", ["n++", "1 / n", "tab[n]"])
def test_what_changes_something_or_may_fail_stays(value: str) -> None:
    text = LEFT_OUT.replace("cost = cost + sqrt(energy) * n", f"cost = {value}")
    loaded = load_model(Source("m.ta", f"int tab[2];\n{text}"))
    assert loaded.refusals == ()
    assert len(loaded.network.processes[0].edges[0].updates) == 3


@pytest.mark.parametrize(
    "rate", ["rate(energy, n) / n", "energy * tab[n]", "sum (i : int[0,1]) tab[i]", "abs(n) * sqrt(energy)"]
)
def test_the_rate_of_a_hybrid_clock_is_never_computed(rate: str) -> None:
    declarations = "int tab[2];\ndouble rate(double a, double b) { if (a > b) return a - b; else return 0.0; }\n"
    text = declarations + LEFT_OUT.replace("2 * n + cost", rate).replace("property dear", "// property dear")
    loaded = load_model(Source("m.ta", text))
    assert loaded.refusals == ()
    assert loaded.network.processes[0].locations[0].rates == ()


def test_a_name_in_the_rate_of_a_hybrid_clock_must_be_known() -> None:
    with pytest.raises(InputError) as caught:
        load_model(Source("m.ta", LEFT_OUT.replace("2 * n + cost", "2 * m + cost")))
    assert ("E0201", "m") in [(found.code, found.span.text) for found in caught.value.diagnostics]


def test_an_empty_type_is_an_error_only_where_it_is_used(find: Any) -> None:
    declaration = "typedef int[5,4] none;"
    assert find(declaration) == []
    assert find(declaration + " none v;") == [("E0604", "int[5,4]")]
    assert find(declaration + " int a[none];") == [("E0604", "int[5,4]")]
    assert find(declaration + " typedef none other; other v;") == [("E0604", "int[5,4]")]


def test_scalar_sets_inside_types_stay_different(find: Any) -> None:
    text = (
        "typedef struct { scalar[3] m; } one; typedef struct { scalar[3] m; } two;\n"
        "one a; two b; void f() { a.m = b.m; }"
    )
    assert find(text) == [("E0302", "a.m = b.m")]


def test_a_template_without_locations_is_written_and_read(tmp_path: Path) -> None:
    loaded = load_model(Source("m.ta", "process P() { int n; }\nsystem P;\n"))
    again = load_model(Source("again.xta", export_model(loaded, "xta").text))
    assert [refusal.message for refusal in again.refusals] == [refusal.message for refusal in loaded.refusals]


FUNCTIONS = """int n;
double level = 0.5;
int rounded() { return level > 0.5 ? 1 : 0; }
int next(int i) { return (i + 1) % 3; }

process P() {
    init location s {
        to s { assign n = next(n); }
    }
}

system P;
property bounded : A[] n <= 2;
property high : E<> rounded() == 1;
"""


def test_a_function_that_nothing_checked_calls_is_left_out() -> None:
    loaded = load_model(Source("m.ta", FUNCTIONS))
    assert loaded.refusals == ()
    assert [(warning.code, warning.span.text) for warning in loaded.warnings] == [
        ("W0406", "level"),
        ("W0407", "rounded"),
    ]
    assert [query.name for query in loaded.queries] == ["bounded"]
    (query,) = loaded.unchecked
    assert [(found.code, found.span.text) for found in query.diagnostics] == [("E0750", "rounded")]
    assert query.diagnostics[0].labels[0].span.text == "level"


@pytest.mark.parametrize(
    ("before", "after", "refused"),
    [
        ("n = next(n)", "n = rounded()", "rounded"),
        ("(i + 1) % 3", "rounded()", "next"),
    ],
)
def test_what_calls_such_a_function_is_rejected(before: str, after: str, refused: str) -> None:
    loaded = load_model(Source("m.ta", FUNCTIONS.replace(before, after)))
    assert [refusal.span.text for refusal in loaded.refusals] == [refused]


LIBRARY = """import "lib.so" { int f(int x); /* int h(); */ int g = c_g(int a, int b); };
int n;
"""


@pytest.mark.parametrize(
    ("guard", "expected"),
    [("n < 1", []), ("f(n) < 1", [("E0750", "f")]), ("g(n, 2) < 1", [("E0750", "g")])],
)
def test_functions_of_a_foreign_library_are_rejected_where_they_are_called(
    guard: str, expected: list[tuple[str, str]]
) -> None:
    loaded = load_model(
        Source("m.ta", f"{LIBRARY}process P() {{ init location s {{ to s {{ guard {guard}; }} }} }} system P;")
    )
    assert [(refusal.code, refusal.span.text) for refusal in loaded.refusals] == expected
    assert [warning.code for warning in loaded.warnings] == ["W0407"]
    assert LIBRARY.splitlines()[0] in export_model(loaded, "xta").text


def test_a_foreign_library_declares_nothing_else(find: Any) -> None:
    assert find(f"{LIBRARY} int m = h();")[1:] == [("E0201", "h")]


@pytest.mark.parametrize("system", ["system P, L;", "system L;", "K = L();\nsystem P, K;"])
def test_message_sequence_charts_in_the_system_line_are_rejected(system: str) -> None:
    template = '<template><name>P</name><location id="a"><name>A</name></location><init ref="a"/></template>'
    queries = "<queries><query><formula>E&lt;&gt; P.A</formula><comment/></query></queries>"
    text = f"<nta>{template}<lsc><name>L</name></lsc><system>{system}</system>{queries}</nta>"
    loaded = load_model(Source("m.xml", text))
    assert [(d.code, d.message) for d in loaded.refusals] == [
        ("E0750", f"`{'L' if 'K' not in system else name}` is a message sequence chart, which is not supported")
        for name in (("L", "K") if "K" in system else ("L",))
    ]
