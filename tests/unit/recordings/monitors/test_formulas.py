"""Formulas from texts, files and models; bounds in the unit of the trace; constants of the model."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.main import app
from tachk.recordings.monitors.formulas import check_order, in_trace_units, read_formulas
from tachk.recordings.traces.node_signal import Truth
from tachk.syntax.formulas.printer import print_formula

FILE = """\
# what the plant is judged by
response "it answers": G (p -> F[0, 180 s] q)  // in three minutes

never: G !(p
    // a comment in the middle
    && q)
G x < 3   // without a name
quiet:
    Whenever p becomes true,
    within 5 s, q must be true.
"""

MODEL = """\
time_unit = 100 ms;
const int D = 20;
const int LIMIT = -3;
int n;
process P() { init location A; }
signal hot = n > 3;
system P;
property answered "hot in time" : G (P.A -> F[0, D] hot);
property cold : G (P.A -> F[0, 500 ms] n > LIMIT);
property reachable : E<> P.A;
"""


def codes(error: pytest.ExceptionInfo[InputError]) -> list[str]:
    return [f"{found.code} {found.span}" for found in error.value.diagnostics]


def test_files_hold_named_formulas_and_sentences(tmp_path: Path) -> None:
    path = tmp_path / "plant.stl"
    path.write_text(FILE)
    read = read_formulas(path)
    assert [(f.name, f.title, f.text) for f in read] == [
        ("response", "it answers", "G (p -> F[0, 180 s] q)"),
        ("never", "", "G !(p && q)"),
        ("p3", "", "G (x < 3)"),
        ("quiet", "", "G (rise(p) -> F[0, 5 s] q)"),
    ]
    assert read[3].sentence == "Whenever p becomes true, within 5 s, q must be true."
    assert [sorted(f.columns) for f in read] == [["p", "q"], ["p", "q"], ["x"], ["p", "q"]]


LONG = "G (" + " && ".join(["x < 5"] * 40) + ")"
"""Longer than the name of any file."""


def test_a_formula_is_no_file_name_however_long_it_is() -> None:
    trace = {"time": [0, 1], "x": [1.0, 2.0]}
    assert tachk.monitor(LONG, trace).truth is Truth.TRUE
    assert tachk.Monitor(LONG).update(0, x=1) is Truth.UNDETERMINED
    assert tachk.mine(LONG.replace("5", "C"), [trace], {"C": (0, 9)}).value == 2
    with pytest.raises(InputError):
        read_formulas("G (x < 5\0)")


def test_a_trace_whose_name_is_too_long_is_rejected_as_one_that_is_not_there() -> None:
    for name in ("a" * 300, "a" * 300 + ".csv", "a" * 5000):
        with pytest.raises(UsageError):
            tachk.monitor("G (x < 5)", name)


def test_only_a_file_of_formulas_is_their_source() -> None:
    assert tachk.monitor("G (x < 5.5)", {"time": [0], "x": [1]}).record.formulas == ""


@pytest.mark.parametrize("command", ["monitor", "monitor --find", "plot", "explain", "requirements", "simulate"])
def test_every_command_takes_a_long_formula(command: str, tmp_path: Path) -> None:
    trace, model = tmp_path / "a.csv", tmp_path / "m.ta"
    trace.write_text("time,x\n0,1\n1,2\n")
    model.write_text("int x; process P() { init location A; } system P;")
    arguments = {
        "monitor": [LONG, str(trace)],
        "monitor --find": [LONG.replace("5", "C"), str(trace), "--find", "C=0..9"],
        "plot": [LONG, str(trace), "-o", str(tmp_path / "a.svg")],
        "simulate": [str(model), "--until", "2", "--monitor", LONG],
        "explain": [LONG],
        "requirements": [LONG],
    }
    assert CliRunner().invoke(app, [command.split()[0], *arguments[command]]).exit_code == 0


def test_every_mistake_of_a_file_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "bad.stl"
    path.write_text("a: G (p\nb: G q\nb: F q\nc: F[2] q\n")
    with pytest.raises(InputError) as error:
        read_formulas(path)
    assert codes(error) == [f"E0113 {path}:1:6", f"E0202 {path}:3:1", f"E0130 {path}:4:5"]


def test_bounds_are_converted_to_the_unit_of_the_trace() -> None:
    (formula,) = read_formulas("G (p -> F[500 ms, 2 s] H[0, 5] q)")
    assert print_formula(in_trace_units(formula, ["p", "q"], "ms")) == "G (p -> F[500, 2000] H[0, 5] q)"
    with pytest.raises(InputError) as error:
        in_trace_units(formula, ["p", "q"], "")
    assert (
        error.value.diagnostics[0].help
        == "say what one unit of the trace's time is: --unit s, unit='s', or time [s] in the header"
    )


def test_a_model_gives_its_formulas_its_unit_and_its_constants(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    path.write_text(MODEL)
    answered, cold = read_formulas(str(path))
    assert (answered.name, answered.title) == ("answered", "hot in time")
    columns = ["P.A", "hot", "n"]
    assert print_formula(in_trace_units(answered, columns, "s")) == "G (P.A -> F[0, 2] hot)"
    assert print_formula(in_trace_units(cold, columns, "ms")) == "G (P.A -> F[0, 500] (n > -3))"
    assert print_formula(in_trace_units(answered, columns, "")) == "G (P.A -> F[0, 20] hot)"
    assert print_formula(in_trace_units(cold, [*columns, "LIMIT"], "ms")) == "G (P.A -> F[0, 500] (n > LIMIT))"


def test_a_file_without_a_system_line_is_read_without_asking_what_its_names_mean(tmp_path: Path) -> None:
    (tmp_path / "units.ta").write_text("time_unit = 1 s;\nconst int D = 21 / 2 * 2, A[2] = {1, 2};\n")
    (tmp_path / "list.ta").write_text(
        'import "units.ta";\nsignal hot = Vessel.Hot;\n'
        "property warm : Whenever hot is true, within D s, cold must be true.;\n"
        "property late : G (hot -> F[0, D] cold);\n"
    )
    formulas = read_formulas(tmp_path / "list.ta")
    assert [f.name for f in formulas] == ["warm", "late"]
    assert print_formula(in_trace_units(formulas[1], ["hot", "cold"], "ms")) == "G (hot -> F[0, 20000] cold)"


@pytest.mark.parametrize(
    ("bound", "value"),
    [("2 * D", "40"), ("(D - 5)", "15"), ("D / 8", "2.5"), ("D / 3 * 3", "20"), ("-D + 30", "10"), ("0.5 * D", "10")],
)
def test_bounds_may_be_computed_from_constants(tmp_path: Path, bound: str, value: str) -> None:
    path = tmp_path / "m.ta"
    path.write_text(MODEL.replace("F[0, D]", f"F[0, {bound}]"))
    formula = read_formulas(path)[0]
    assert print_formula(in_trace_units(formula, ["P.A", "hot"], "")) == f"G (P.A -> F[0, {value}] hot)"


@pytest.mark.parametrize(("bound", "code"), [("M", "E0201"), ("1 / 0", "E0602"), ("f(1)", "E0602")])
def test_bounds_that_are_no_numbers(bound: str, code: str) -> None:
    (formula,) = read_formulas(f"F[0, {bound}] q")
    with pytest.raises(InputError) as error:
        in_trace_units(formula, ["q"], "s")
    assert error.value.diagnostics[0].code == code


def test_rejections(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no file"):
        read_formulas("gone.stl")
    (tmp_path / "only.stl").write_text("// nothing\n")
    with pytest.raises(UsageError, match="there is no formula"):
        read_formulas(tmp_path / "only.stl")
    (tmp_path / "m.ta").write_text(MODEL.partition("property")[0])
    with pytest.raises(UsageError, match="contains no property"):
        read_formulas(tmp_path / "m.ta")


def test_a_trace_in_the_place_of_the_formulas_is_recognised(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,a\n0,1\n", encoding="utf-8")
    with pytest.raises(UsageError, match="is a trace, no file of formulas"):
        read_formulas(str(path))


@pytest.mark.parametrize("trace", ["a.csv", "a.txt", "a.vcd", "a.parquet", "a.tsv"])
@pytest.mark.parametrize("formulas", ["a.stl", "a.ta", "a.xml"])
def test_formulas_and_trace_exchanged(trace: str, formulas: str, tmp_path: Path) -> None:
    for name in (trace, formulas):
        (tmp_path / name).write_text("time,p\n0,1\n")
    with pytest.raises(UsageError, match="is a trace, no file of formulas") as refusal:
        check_order(tmp_path / trace, str(tmp_path / formulas))
    assert refusal.value.help == "the formulas come first, then the trace"
    check_order(tmp_path / formulas, tmp_path / trace)


def test_names_get_values_from_definitions_and_from_lines_of_the_file(tmp_path: Path) -> None:
    trace = {"t": [0, 1, 4], "p": [1, 0, 0], "q": [0, 0, 1], "x": [1, 2, 3]}
    path = tmp_path / "plant.stl"
    path.write_text("const T = 2.5\nconst MAX = 3;\nin_time: G (p -> F[0, T] q)\nlow: G (x <= MAX)\n")
    assert [verdict.truth for verdict in tachk.monitor(path, trace)] == [Truth.FALSE, Truth.TRUE]
    changed = tachk.monitor(path, trace, constants={"T": 4, "MAX": "2.5"})
    assert [verdict.truth for verdict in changed] == [Truth.TRUE, Truth.FALSE]
    assert tachk.monitor("G (p -> F[0, T] (x > L))", trace, constants={"T": 4, "L": 2.5}).truth is Truth.TRUE
    monitor = tachk.Monitor("G (x <= L)", constants={"L": 2})
    monitor.update(0, x=3)
    assert monitor.advance(1) is Truth.FALSE
    assert monitor.columns == ("x",)


def test_a_definition_that_means_nothing_is_rejected() -> None:
    trace = {"t": [0], "x": [1]}
    with pytest.raises(UsageError, match="no formula has this name"):
        tachk.monitor("G (x < L)", trace, constants={"LL": 4})
    with pytest.raises(UsageError, match="a column of this name"):
        tachk.monitor("G (x < L)", trace, constants={"x": 4})
    with pytest.raises(UsageError, match="expected a number"):
        tachk.monitor("G (x < L)", trace, constants={"L": "many"})


def test_constants_of_a_model_can_be_changed_with_what_is_computed_from_them(tmp_path: Path) -> None:
    path = tmp_path / "part.ta"
    path.write_text("const int N = 1;\nconst int T = 2 * N;\nproperty q : G (p -> F[0, T] q);\n")
    trace = {"t": [0, 1, 4], "p": [1, 0, 0], "q": [0, 0, 1]}
    assert tachk.monitor(path, trace).truth is Truth.FALSE
    assert tachk.monitor(path, trace, constants={"N": 2}).truth is Truth.TRUE
    with pytest.raises(UsageError, match="no such constant"):
        tachk.monitor(path, trace, constants={"M": 2})


TRACE = {"time": [0, 1, 3, 10], "p": [0, 1, 0, 0], "q": [0, 0, 1, 0], "x": [1, 6, 2, 2]}


def truths(tmp_path: Path, text: str, unit: str = "s", scale: int = 1, **given: Any) -> dict[str, str]:
    """The verdicts of a file on the trace, whole and row by row, which are the same."""
    file = tmp_path / "a.stl"
    file.write_text(text, encoding="utf-8")
    times = [scale * time for time in TRACE["time"]]
    whole = tachk.monitor(str(file), {**TRACE, "time": times}, unit=unit, **given)
    found = {each.name: each.truth.word for each in whole}
    monitor = tachk.Monitor(str(file), unit=unit, **given)
    for row, time in enumerate(times):
        monitor.update(time, {name: TRACE[name][row] for name in "pqx"})
    assert {each.name: each.truth.word for each in monitor.finish()} == found
    return found


def test_formulas_name_each_other_in_any_order(tmp_path: Path) -> None:
    text = "a: b && G (x < 9)\nb: G (p -> F[0, 2] q)\nc: !b || `R-1`\nR-1: G !b\n"
    assert truths(tmp_path, text) == {"a": "true", "b": "true", "c": "false", "R-1": "false"}
    assert read_formulas(str(tmp_path / "a.stl"))[0].text == "b && G (x < 9)"


def test_a_column_comes_before_a_formula_of_its_name(tmp_path: Path) -> None:
    # `q` occurs in the formula of this name, so it is a column everywhere.
    assert truths(tmp_path, "q: G (p -> q)\na: F q\n") == {"q": "false", "a": "true"}
    file = tmp_path / "b.stl"
    file.write_text("q: G (p -> x > 5)\na: G q\n", encoding="utf-8")
    assert [each.truth.word for each in tachk.monitor(str(file), TRACE, unit="s")] == ["true", "false"]
    # Row by row the columns are not known beforehand, so nothing is taken for the other in silence.
    with pytest.raises(UsageError, match="`q` is a column and a formula of the file"):
        tachk.Monitor(str(file)).update(0, p=0, x=1, q=1)
    trace = tmp_path / "a.csv"
    trace.write_text("time,p,x,q\n0,0,1,0\n1,1,6,0\n3,0,2,1\n", encoding="utf-8")
    for more in ([], ["--online"]):
        assert CliRunner().invoke(app, ["monitor", str(file), str(trace), *more]).exit_code == 10


@pytest.mark.parametrize("text", ["a: b\nb: a\n", "a: G a\n", "a: b\nb: c\nc: F b\n"])
def test_a_circle_of_names_has_no_meaning(text: str, tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as refusal:
        tachk.monitor(str(file), TRACE)
    assert {found.code for found in refusal.value.diagnostics} == {"E0901"}


@pytest.mark.parametrize(
    ("lines", "bound", "unit"),
    [
        ("const T = 2 s", "T", "s"),
        ("const T = 2 s", "T", "ms"),
        ("const T = 2000ms;", "T", "s"),
        ("const T = 1.0 seconds\nconst U = 2 * T", "U", "s"),
        ("const U = T + 500 * M\nconst T = 1.5 s\nconst M = 1 ms", "U", "s"),
        ("const N = 1/2\nconst T = 4 * N", "T", "s"),
        ("const T = (3 - 1) s", "T", "s"),
        ("const R = U / T\nconst T = 3 s\nconst U = 6 s", "R", "s"),
        ("const double T = 2", "T s", "s"),
    ],
)
def test_constants_have_units_and_are_computed_from_each_other(
    lines: str, bound: str, unit: str, tmp_path: Path
) -> None:
    text = f"{lines}\na: G (rise(p) -> F[0, {bound}] q)\nb: G (rise(p) -> F[0, {bound}) q)\n"
    assert truths(tmp_path, text, unit, 1000 if unit == "ms" else 1) == {"a": "true", "b": "false"}


def test_a_constant_with_a_unit_is_a_number_of_units_of_the_trace_in_conditions(tmp_path: Path) -> None:
    text = "const T = 6 ms\na: G (x <= T)\nb: G (x < T)\n"
    assert truths(tmp_path, text, unit="ms") == {"a": "true", "b": "false"}
    assert truths(tmp_path, text, unit="us") == {"a": "true", "b": "true"}


def test_definitions_change_what_is_computed_from_them(tmp_path: Path) -> None:
    text = "const T = 1 s\nconst U = T * 2\na: G (rise(p) -> F[0, U] q)\n"
    assert truths(tmp_path, text) == {"a": "true"}
    assert truths(tmp_path, text, constants={"T": 0.5}) == {"a": "false"}
    assert truths(tmp_path, text, constants={"U": 1}) == {"a": "false"}
    with pytest.raises(UsageError, match="no formula has this name"):
        truths(tmp_path, text, constants={"V": 1})


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("const T = 2 parsecs", "E0135"),
        ("const T = U", "E0201"),
        ("const T = U\nconst U = T", "E0602"),
        ("const T = 2 s\nconst T = 3 s", "E0202"),
        ("const T = 2 s\nconst U = T + 1", "E0134"),
        ("const T = 2 s\nconst U = T * T", "E0134"),
        ("const T = 2 s\nconst U = T s", "E0602"),
        ("const T = 1 / 0", "E0602"),
        ("const T = (p && q)", "E0602"),
        ("const T = ", "E0101"),
        ("const T = 2 s\nb: F[0, T s] p", "E0134"),
    ],
)
def test_constants_that_have_no_value(lines: str, code: str, tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_text(f"{lines}\na: G p\n", encoding="utf-8")
    with pytest.raises(InputError) as refusal:
        read_formulas(str(file))
    assert code in {found.code for found in refusal.value.diagnostics}


def test_a_constant_with_a_unit_needs_that_of_the_trace(tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_text("const T = 2 s\na: G (p -> F[0, T] q)\n", encoding="utf-8")
    with pytest.raises(UsageError, match="the constant `T` has a unit") as refusal:
        tachk.monitor(str(file), TRACE)
    assert "--unit s" in str(refusal.value.help)


@pytest.mark.parametrize("name", ["REQ-1", "REQ-1.2", "REQ_1.2", "1.2", "SYS/REQ-7", "a", "F"])
def test_names_of_requirements(name: str, tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_text(f'{name}: G (p -> q)\n{name}.b "a title": F q\n', encoding="utf-8")
    assert [(each.name, each.title) for each in read_formulas(str(file))] == [(name, ""), (f"{name}.b", "a title")]
    assert [each.name for each in tachk.monitor(str(file), TRACE, select=[name])] == [name]


def test_what_is_no_name_is_said_to_be_none(tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_text("REQ 1: G (p -> q)\n", encoding="utf-8")
    with pytest.raises(InputError) as refusal:
        read_formulas(str(file))
    (found,) = refusal.value.diagnostics
    assert (found.span.text, found.message) == ("REQ 1", "`REQ 1` is not a name of a formula")
    assert "REQ-1.2" in str(found.help)


@pytest.mark.parametrize(
    ("formula", "place", "help"),
    [
        ("always (p -> q)", "always", "the operator is written G;"),
        ("always (p implies q)", "always", "the operator is written G;"),
        ("always (p implies eventually[0,5] q)", "always", "the operator is written G;"),
        ("always[0,5] (p -> q)", "always", "the operator is written G, with the interval right behind it"),
        ("G (p -> eventually (q))", "eventually", "the operator is written F;"),
        ("[]_[0,5] p", "[]_", "the operator is written G, with the interval right behind it"),
        ("p release q", "release", "q W (p && q)"),
        ("next p", "next", "no next instant"),
        ("F{<=5} p", "F{<=5}", "write F[0, 5]"),
        ("F<5 p", "F<5", "write F[0, 5)"),
    ],
)
def test_spellings_of_other_tools_are_translated(formula: str, place: str, help: str) -> None:
    with pytest.raises(InputError) as refusal:
        read_formulas(formula)
    found = refusal.value.diagnostics[0]
    assert (found.span.text, help in str(found.help)) == (place, True), found.help


@pytest.mark.parametrize(
    ("formula", "help"),
    [
        ("G (x[t] < 3)", "write `x`: a name stands for the value at each instant"),
        ("G (mode == idle)", 'if it is a text, write "idle"; the columns are: mode, x'),
        ("G (idle != mode)", 'if it is a text, write "idle"; the columns are: mode, x'),
        ("G (mode == modee)", "did you mean `mode`?"),
    ],
)
def test_help_for_names_that_are_no_columns(formula: str, help: str) -> None:
    with pytest.raises(InputError) as refusal:
        tachk.monitor(formula, {"time": [0, 1], "mode": ["idle", "busy"], "x": [1, 2]})
    assert refusal.value.diagnostics[0].help == help


@pytest.mark.parametrize(
    ("formula", "truth"), [("G (x < 5.)", "true"), ("G (x > .5)", "true"), ("F[0,1.] (x>2.)", "false")]
)
def test_numbers_need_a_digit_on_one_side_of_the_point(formula: str, truth: str) -> None:
    trace = {"time": [0, 1, 2], "x": [1, 1.5, 1.5]}
    assert tachk.monitor(formula, trace)[0].truth.word == truth
