from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.span import Source
from tachk.cli.main import app
from tachk.formats.catalogue import export_model
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.network import network_from_json, network_to_json, same_network
from tachk.formats.network_text import expression_text
from tachk.model.fault import RuntimeErrorKind

MODEL = """
const double HALF = 0.5;
const double RATE = HALF * 3 + 1 / 2;
const double BIG = 4503599627370497.0;
const string NAME = "front";
const int N = 7;
int[0,9] n;
process P() {{ init location a {{ to a {{ guard {guard}; assign n = {value}; }} }} }}
system P;
property p : A[] n == 0;
property q : E<> n == {value};
"""


def answers(guard: str = "true", value: str = "1") -> list[str]:
    return [verdict.answer.value for verdict in tachk.loads(MODEL.format(guard=guard, value=value)).verify()]


@pytest.mark.parametrize(
    ("guard", "truth"),
    [
        ("HALF < 1", True),
        ("HALF * 2 == 1", True),
        ("RATE == 1.5", True),  # 1 / 2 divides integers
        ("RATE > N", False),
        ("-HALF <= -0.5", True),
        ("0.1 + 0.2 == 0.3", False),  # as doubles are
        ("1.0 / 3 * 3 == 1.0", True),
        ("sqrt(2.25) == 1.5", True),
        ("fmax(HALF, 2) == 2.0 && fmin(HALF, 2) == 0.5", True),
        ("floor(-1.5) == -2 && ceil(-1.5) == -1 && trunc(-1.5) == -1 && round(-1.5) == -2", True),
        ("round(BIG) == BIG", True),
        ("fabs(-HALF) != HALF", False),
        ('NAME == "front"', True),
        ('NAME != "front"', False),
        ('"back" == NAME', False),
    ],
)
def test_comparisons_are_decided_when_the_model_is_read(guard: str, truth: bool) -> None:
    assert answers(guard) == (["fails", "holds"] if truth else ["holds", "fails"])


@pytest.mark.parametrize(
    ("value", "whole"),
    [
        ("fint(round(0.49999999999999994))", 0),
        ("fint(RATE)", 1),
        ("fint(RATE * N) - 4", 6),
        ("fint(9.99)", 9),
        ("fint(-0.5) + 2", 2),
        ("fint(round(HALF))", 1),
    ],
)
def test_fint_makes_an_integer(value: str, whole: int) -> None:
    model = tachk.loads(MODEL.format(guard="true", value=value))
    assert model.verify(f"E<> n == {whole}")[0].answer.value == "holds"


def found_in(text: str) -> list[str]:
    try:
        found = tachk.loads(text).refusals
    except tachk.InputError as error:
        found = error.diagnostics
    return [each.code for each in found]


@pytest.mark.parametrize(
    ("guard", "codes"),
    [
        ("sin(HALF) < 1", ["E0750"]),  # libraries round it differently
        ("random(1.0) < 2", ["E0750"]),
        ("NAME < HALF", ["E0750"]),
        ("NAME", ["E0750"]),
        ("HALF % 2 == 0", ["E0750"]),
        ("x < HALF", ["E0750"]),
        ("HALF", ["E0305"]),
        ("n[HALF] == 0", ["E0306"]),
        ("sqrt(HALF, HALF) == 0", ["E0308"]),
        ("fabs(x) == 0", ["E0309"]),
        ("HALF.high == 0", ["E0307"]),
        ("1e999 > 0", ["E0605"]),
    ],
)
def test_what_is_rejected(guard: str, codes: list[str]) -> None:
    text = MODEL.format(guard=guard, value="1").replace("process P() {", "process P() { clock x;")
    assert found_in(text) == codes


@pytest.mark.parametrize(
    ("label", "code"),
    [
        ("assign n = HALF", "E0302"),
        ("assign x = HALF", "E0750"),
        ("assign n++, m = twice(HALF)", "E0302"),
        ("assign n = half(HALF)", "E0309"),
        ("guard NUMBERS == NUMBERS", "E0750"),
        ("guard forall (i : int[0,1]) NUMBERS[i] < 3 && (sum (i : int[0,1]) NUMBERS[i]) > 1", "E0750"),
    ],
)
def test_what_does_not_fit(label: str, code: str) -> None:
    text = f"""const double HALF = 0.5; const double NUMBERS[2] = {{0.5, 1}}; int n, m;
    double twice(double d) {{ return 2 * d; }} int half(int k) {{ return k / 2; }}
    process P() {{ clock x; init location a {{ to a {{ {label}; }} }} }} system P;"""
    assert found_in(text) == [code]


@pytest.mark.parametrize(
    ("guard", "truth"),
    [
        ("n < 1.5", True),
        ("n * HALF >= 0.5", False),
        ("(n == 0 ? HALF : 2) == 0.5", True),
        ("LIST[n] + LIST[n + 1] == 2.0", True),
        ("M_PI > 3.14159 && M_E < 2.7183", True),
        ("TWICE == 1", True),
    ],
)
def test_comparisons_may_depend_on_the_state(guard: str, truth: bool) -> None:
    constants = "const double LIST[2] = { 0.75, 1.25 }; double twice(double d) { return 2 * d; }\n"
    text = MODEL.format(guard=guard, value="1").replace(
        "int[0,9] n;", constants + "const double TWICE = twice(HALF); int[0,9] n;"
    )
    answers = [verdict.answer.value for verdict in tachk.loads(text).verify()]
    assert answers == (["fails", "holds"] if truth else ["holds", "fails"])


@pytest.mark.parametrize("guard", ["1.0 / n > 1", "sqrt(n - 1) == 0", "fint(1e10 + n) == 0", "1e308 * (n + 10) > 0"])
def test_a_number_without_a_value_is_a_run_time_error(guard: str) -> None:
    verdict = tachk.loads(MODEL.format(guard=guard, value="1")).verify()[0]
    assert verdict.answer is tachk.Answer.UNKNOWN
    assert verdict.fault is not None and verdict.fault.kind is RuntimeErrorKind.NOT_FINITE


def test_functions_change_what_is_left_out_and_nothing_else_sees_it() -> None:
    model = tachk.loads("""int n; double cost;
    int step(int k) { double d = k; cost = cost + d; return fint(d / 2); }
    process P() { init location a { to a { guard n < 5; assign n = n + 1 + step(n); } } }
    system P; property p : A[] n <= 7; property q : E<> n == 7;""")
    assert [(w.code, w.span.text) for w in model.warnings] == [("W0406", "cost")]
    assert [v.answer.value for v in model.verify()] == ["holds", "holds"]


def test_a_function_that_reads_a_variable_that_changes_is_rejected_with_its_callers() -> None:
    model = tachk.loads("""int n; double cost;
    int step() { return fint(cost); }
    process P() { init location a { to a { assign n = step(); } } } system P; property p : A[] n == 0;""")
    (refusal,) = model.refusals
    assert (refusal.code, refusal.span.text) == ("E0750", "step")
    assert refusal.labels[0].span.text == "cost"


def test_a_struct_of_doubles_is_left_out_as_a_double_is() -> None:
    text = "struct { double d; double n; } pair;\nprocess P() { init location a; } system P; property p : A[] P.a;"
    assert found_in(text) == []


def test_double_parameters_of_templates_are_constants() -> None:
    model = tachk.loads("""int n;
    process P(const double rate) { init location a { to a { guard n * rate < 2; assign n++; } } }
    A = P(0.75); system A; property p : E<> n == 3; property q : A[] n <= 3;""")
    assert [v.answer.value for v in model.verify()] == ["holds", "holds"]


def test_the_second_engine_rejects_numbers_and_zones_have_certificates(tmp_path: Path) -> None:
    text = """int n;
    int half(int k) { double d = k; return fint(round(d / 2)); }
    process P() { init location a { to a { guard half(n) < 3; assign n = n + 1; } } }
    system P; property p : A[] n <= 5;"""
    model = tachk.loads(text)
    assert model.verify(options=tachk.Options(engine=tachk.Engine.SMT))[0].answer is tachk.Answer.UNKNOWN
    file = tmp_path / "m.ta"
    file.write_text(text)
    certificate = tmp_path / "c.json"
    runner = CliRunner()
    assert runner.invoke(app, ["verify", str(file), "--certificate", str(certificate)]).exit_code == 0
    assert runner.invoke(app, ["certify", str(file), str(certificate)]).exit_code == 0


def test_numbers_are_written_as_they_were(tmp_path: Path) -> None:
    text = MODEL.format(guard="n * HALF < 1.5e0 && fmin(n, 2) == LIST[1]", value="fint(HALF + n)")
    text = text.replace("int[0,9] n;", "const double LIST[2] = { 0.75, 1.25 }; int[0,9] n;")
    loaded = load_model(Source("m.ta", text))
    xml = Source("m.xml", export_model(loaded, "xml").text)
    assert same_network(load_model(xml).network, loaded.network)
    written = network_from_json(json.loads(json.dumps(network_to_json(loaded.network))))
    assert same_network(written, loaded.network)
    guard = loaded.network.processes[0].edges[0].guard
    assert guard is not None
    assert expression_text(guard, loaded.network) == "n * 0.5 < 1.5 && n <? 2.0 == LIST[1]"


def test_constants_with_a_value_need_no_warning_and_variables_do() -> None:
    assert tachk.loads(MODEL.format(guard="true", value="1")).warnings == ()
    text = """double d = 0.5; string s = "x";
    process P() { init location a { to a { assign d = d * 2, s = "y"; } } }
    system P;"""
    model = tachk.loads(text)
    assert [(w.code, w.span.text) for w in model.warnings] == [("W0406", "d"), ("W0406", "s")]
    assert model.refusals == ()
