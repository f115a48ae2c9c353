"""`tachk.mine` against brute force, and what it tells."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from random import Random

import jsonschema
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.monitors.monotone import Monotonicity, joint_effect, occurrences

SCHEMAS = Path(__file__).parents[4] / "docs/schema"

TRACE = {
    "t": [0, 1, 2, 4, 6.5, 9, 12, 15, 20, 40],
    "p": [0, 1, 1, 0, 0, 0, 1, 0, 0, 0],
    "q": [0, 0, 0, 0, 0, 1, 0, 0, 1, 0],
    "x": [1, 2, 3, 5, 2, 1, 0, 7, 1, 1],
}


@pytest.mark.parametrize(
    ("formula", "effect"),
    [
        ("G (p -> F[0, T] q)", Monotonicity.EASIER),
        ("G (p -> F[T, 9] q)", Monotonicity.HARDER),
        ("G (p -> G[0, 2 * T + 1] q)", Monotonicity.HARDER),
        ("G (F[0, T] p -> q)", Monotonicity.HARDER),
        ("!G (p -> !(q U[0, 9 - T] p))", Monotonicity.HARDER),
        ("G (p -> O[0, T] q && H[T, 50] q)", Monotonicity.EASIER),
        ("G (p -> F[T, T] q)", Monotonicity.UNKNOWN),
        ("G (x < T)", Monotonicity.EASIER),
        ("G (x - T > 3 * -T)", Monotonicity.EASIER),
        ("G (T * T > x)", Monotonicity.UNKNOWN),
        ("G !(x >= -T && x <= 3)", Monotonicity.HARDER),
        ("G (x == T)", Monotonicity.UNKNOWN),
        ("G (rise(x > T) -> q)", Monotonicity.UNKNOWN),
        ("G (x > T -> F[0, T] q)", Monotonicity.EASIER),
    ],
)
def test_the_effect_of_a_parameter(formula: str, effect: Monotonicity) -> None:
    (named,) = read_formulas(formula)
    assert joint_effect(occurrences(named.formula, "T")) is effect


@pytest.mark.parametrize(
    ("formula", "value", "attained"),
    [
        ("G (rise(p) -> F[0, T] q)", 8, True),
        ("G (rise(p) -> F[0, T) q)", 8, False),
        ("G (p -> G[0, T] !q)", 5, True),
        ("G (p -> G[0, T) !q)", 5, True),
        ("G (x <= T)", 7, True),
        ("G (T > x)", 7, False),
        ("G (q -> x <= 1.25 - T)", Fraction(1, 4), False),
        ("G[0, 10] F[0, T] F[0, T] q", Fraction(9, 2), True),
        ("G (x < 100 * T)", Fraction(1), True),
    ],
)
def test_the_tightest_value(formula: str, value: Fraction, attained: bool) -> None:
    found = tachk.mine(formula, [TRACE], {"T": (0, 100)})
    if found.exact:
        assert (found.value, found.attained) == (value, attained)
    else:
        assert found.value in (value, 0)


TEMPLATES = (
    "G (p -> F[0, T] q)",
    "G (p -> F[0, T) q)",
    "G (p -> G(0, T] !q)",
    "F[T, 8] (p && q)",
    "G F[0, T] F[0, T / 2] p",
    "G (p -> F[0, 2 * T] G[0, 1) q)",
    "G (p -> q U[0, T] !p)",
    "G (p -> O[0, T] q)",
    "G (H[0, T] p -> F[0, T] q)",
    "G (p -> G[T, 6] (q || O[0, 2 * T] p))",
)


@pytest.mark.parametrize("template", TEMPLATES)
def test_bisection_finds_what_brute_force_finds(template: str) -> None:
    for seed, end in enumerate(("undetermined", "strong")):
        random = Random(seed)
        traces = []
        for _ in range(2):
            times = sorted(random.sample(range(1, 12), 6))
            columns = {name: [random.randint(0, 1) for _ in range(7)] for name in "pq"}
            traces.append({"t": [0, *times], **columns})
        found = tachk.mine(template, traces, {"T": (0, 5)}, end=end)
        grid = [Fraction(n, 2) for n in range(11)]
        near = [] if found.value is None else [found.value + Fraction(n, 48) for n in (-1, 0, 1)]
        grid = sorted({*grid, *(value for value in near if 0 <= value <= 5)})
        good = [
            value
            for value in grid
            if all(
                tachk.monitor(template, trace, robustness=False, end=end, constants={"T": value}).truth
                is not tachk.Truth.FALSE
                for trace in traces
            )
        ]
        assert found.exact
        border = found.value
        if border is None:
            assert good == []
        elif found.tightest == "least":
            assert good == [value for value in grid if value > border or (value == border and found.attained)]
        else:
            assert good == [value for value in grid if value < border or (value == border and found.attained)]


def test_the_trace_that_makes_it_tight_is_reported_with_its_instant() -> None:
    slow = {**TRACE, "q": [0, 0, 0, 0, 0, 0, 1, 0, 0, 1]}
    found = tachk.mine("G (rise(p) -> F[0, T] q)", [TRACE, slow, TRACE], {"T": ("0", "99.5")})
    assert (found.value, found.trace) == (11, "the trace")
    assert [each.value for each in found.traces] == [8, 11, 8]
    assert found.record is not None
    assert found.violating is not None
    assert found.violating < 11
    assert found.record.verdicts[0].truth is tachk.Truth.FALSE
    document = json.loads(json.dumps(found.to_dict()))
    monitor = json.loads((SCHEMAS / "monitor.schema.json").read_text())
    schema = json.loads((SCHEMAS / "mine.schema.json").read_text().replace("monitor.schema.json#", "#"))
    jsonschema.validate(document, {**schema, "$defs": {**monitor["$defs"], **schema["$defs"]}})
    assert document["finding"]["from"] == "1"
    assert "T = 11 is the least that satisfies it" in found.to_text()


def test_what_is_not_known_to_be_monotone_is_tried_value_by_value() -> None:
    found = tachk.mine("G (rise(p) -> F[T, T] q)", [TRACE], {"T": (0, 20)})
    assert found.tightest is None
    assert found.ranges == ((8, 10), (19, 20))
    assert tachk.mine("G (x == T)", [TRACE], {"T": (0, 9)}).satisfiable is False
    with pytest.raises(UsageError, match="tried one by one"):
        tachk.mine("G (x == T)", [TRACE], {"T": (0, 10**9)})


def test_what_is_open_at_the_end_is_reported() -> None:
    trace = {"t": [0, 5], "p": [0, 1], "q": [0, 0]}
    found = tachk.mine("G (p -> F[0, T] q)", [trace], {"T": (0, 9)})
    assert (found.value, found.attained, found.undecided) == (0, False, ("the trace",))
    assert tachk.mine("G (p -> F[0, T] q)", [trace], {"T": (0, 9)}, end="strong").value is None


BOUNDS = ("[0, T]", "[0, T)", "[T, 4]", "[0, 4 - T]", "[0, 2]", "[1, 3)")
ATOMS = ("p", "q", "x < T", "x <= T", "T < x", "x >= T", "x - T > 0", "2 * T >= x", "x + T < 4", "!(x > T && p)")


def random_formula(random: Random, depth: int) -> str:
    """A formula with the parameter anywhere, or nowhere: larger values may make it easier, harder, or either."""
    if depth == 0:
        return f"({random.choice(ATOMS)})"
    parts = (random_formula(random, depth - 1), random_formula(random, random.randrange(depth)))
    bound = random.choice(BOUNDS)
    forms = (
        "G{2} {0}",
        "F{2} {0}",
        "{0} U{2} {1}",
        "O{2} {0}",
        "H{2} {0}",
        "!{0}",
        "{0} && {1}",
        "{0} || {1}",
        "{0} -> {1}",
    )
    return "(" + random.choice(forms).format(*parts, bound) + ")"


def good_values(formula: str, trace: dict[str, list[int]], grid: list[Fraction]) -> list[Fraction]:
    """Those with which a trace does not violate a formula."""
    judged = (tachk.monitor(formula, trace, robustness=False, constants={"T": value}).truth for value in grid)
    return [value for value, truth in zip(grid, judged, strict=True) if truth is not tachk.Truth.FALSE]


def test_random_formulas_with_a_parameter_anywhere() -> None:
    random, ways = Random(5), set()
    for _ in range(30):
        formula = f"G {random_formula(random, 2)}"
        if "T" not in formula:
            continue
        times = [0, *sorted(random.sample(range(1, 8), 4))]
        trace = {"t": times, **{name: [random.randint(0, 1) for _ in times] for name in "pq"}}
        trace["x"] = [random.randint(0, 4) for _ in times]
        found = tachk.mine(formula, [trace], {"T": (0, 4)})
        border = found.value
        near = [] if border is None or not found.exact else [border + Fraction(n, 48) for n in (-1, 0, 1)]
        whole = [Fraction(n, 2 if found.exact else 1) for n in range(9 if found.exact else 5)]
        grid = sorted({*whole, *(value for value in near if 0 <= value <= 4)})
        good = good_values(formula, trace, grid)
        ways.add((found.tightest, found.exact, border is None))
        if found.tightest is None:
            assert [v for v in grid if any(low <= v <= high for low, high in found.ranges)] == good, formula
        elif border is None:
            assert good == [], formula
        else:
            sign = 1 if found.tightest == "least" else -1
            assert good == [v for v in grid if sign * (v - border) > 0 or (v == border and found.attained)], formula
    assert {tightest for tightest, _, _ in ways} == {None, "least", "greatest"}
    assert len(ways) >= 4


def test_columns_of_texts(tmp_path: Path) -> None:
    """Columns that the formula does not read may hold anything."""
    log = tmp_path / "log.csv"
    log.write_text("time,mode,speed,note\n0,idle,0,begins\n100,run,1.5,\n300,stop,0.2,done\n", encoding="utf-8")
    found = tachk.mine('G (mode == "run" -> F[0, T] speed < 1)', [log], {"T": (0, 500)})
    assert (found.value, found.attained) == (200, True)


def test_one_parameter_is_mined_at_a_time(tmp_path: Path) -> None:
    trace = tmp_path / "a.csv"
    trace.write_text("time,p,x\n0,0,1\n1,1,6\n3,0,2\n", encoding="utf-8")
    formula = "G (rise(p) -> F[0, T] (x < C))"
    both = CliRunner().invoke(app, ["monitor", formula, str(trace), "--find", "T=0..20", "--find", "C=0..10"])
    assert (both.exit_code, both.stdout) == (2, "")
    assert "one parameter is mined at a time, not 2: T, C" in both.stderr
    twice = CliRunner().invoke(app, ["monitor", formula, str(trace), "--find", "T=0..20", "--find", "T=0..10"])
    assert (twice.exit_code, "--find T is given twice" in twice.stderr) == (2, True)
    assert CliRunner().invoke(app, ["monitor", formula, str(trace), "--find", "T=0..20", "-D", "C=5"]).exit_code == 0
