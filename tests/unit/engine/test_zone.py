"""The zone engine: which zones it chooses, and what they can hold."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import BoundScope, Extrapolation, Limits, Options
from tachk.formats.loading.load import load_model
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify


def kernel(declarations: str, guard: str, update: str, options: Options = Options()) -> str:
    """The type of the entries and the length of a row of the zones in which a model is explored."""
    text = f"""
{declarations}
process P() {{
    clock x;
    init location a {{ to b {{ guard {guard}; assign {update}; }} }}
    location b {{ to a {{ guard x <= 300; }} }}
}}
system P;
"""
    program, goals = lower(load_model(Source("model.ta", text)).network)
    return zone._explorer(program, goals, options, Limits()).kernel().split()[1]


SET = "bool flag; void set(clock& c) {{ if (flag) c = {value}; else c = 0; }}"


@pytest.mark.parametrize(
    ("declarations", "guard", "update", "expected"),
    [
        ("", "x >= 500", "x = 0", "int16x8"),
        ("", "x >= 800", "x = 0", "int16x8"),
        ("", "x >= 801", "x = 0", "int32x8"),
        ("", "x >= 67108863", "x = 0", "int32x8"),
        ("", "x >= 67108864", "x = 0", "int64x8"),
        ("", "x >= 2147483647", "x = 2147483647", "int64x8"),
        (SET.format(value=7), "x >= 500", "set(x)", "int16x8"),
        (SET.format(value=900), "x >= 500", "set(x)", "int32x8"),
        ("int[0,70] n;", "x >= n", "x = n, n = 70 - n", "int16x8"),
        ("int[0,1] n;", "x >= 900 * n", "x = 600 * n, n = 1 - n", "int32x8"),
        ("clock more[8];", "x >= 5 && forall (i : int[0,7]) more[i] >= i", "more[1] = 0", "int16x16"),
        ("clock more[18];", "x >= 5 && forall (i : int[0,17]) more[i] >= i + 1", "more[1] = 0", "int16x24"),
    ],
)
def test_zones_are_as_narrow_as_the_constants_allow(declarations: str, guard: str, update: str, expected: str) -> None:
    assert kernel(declarations, guard, update, Options(scale=False)) == expected


@pytest.mark.parametrize(
    ("declarations", "guard", "update", "expected"),
    [
        ("", "x >= 60000", "x = 0", "int16x8"),
        ("", "x >= 60001", "x = 0", "int32x8"),
        ("", "x >= 60000", "x = 50", "int32x8"),
        (SET.format(value=6000), "x >= 9000", "set(x)", "int16x8"),
        (SET.format(value=6001), "x >= 9000", "set(x)", "int32x8"),
        ("const int T[2] = {9000, 60000}; int[0,1] n;", "x >= T[n]", "x = T[n], n = 1 - n", "int16x8"),
        ("int[0,1] n;", "x >= n * 9000 + (n == 0 ? 300 : 0)", "x = -600 * -n, n = 1 - n", "int16x8"),
        ("int[0,70] n;", "x >= 9000 && x >= n", "n = 70 - n", "int32x8"),
    ],
)
def test_time_is_counted_in_the_largest_unit(declarations: str, guard: str, update: str, expected: str) -> None:
    assert kernel(declarations, guard, update) == expected


@pytest.mark.parametrize("scale", [True, False])
@pytest.mark.parametrize("factor", [1, 20, 2_000_000, 2**31 // 11 - 1])
def test_runs_have_the_times_of_the_model_whatever_the_unit(factor: int, scale: bool) -> None:
    text = """
const int T[2] = {4 * F, 5 * F};
int[0,1] n;
void set(clock& c) { c = T[n]; }
process P() {
    clock x, y;
    init location a { invariant x <= 7 * F; to b { guard x > 6 * F; assign set(y); } }
    location b { invariant y <= 10 * F; to c { guard x >= T[n] + 6 * F; assign n = 1; } }
    location c;
}
p = P();
system p;
property reached : E<> p.c;
property too_early : E<> p.c && p.x < 10 * F;
property too_late : E<> p.c && n == 1 && p.y < 4 * F + 1;
"""
    loaded = load_model(Source("model.ta", text.replace("F", str(factor))))
    reached, too_early, too_late = verify(loaded.network, loaded.queries, options=Options(scale=scale))
    assert (too_early.answer, too_late.answer) == (Answer.FAILS, Answer.FAILS)
    assert reached.trace is not None
    first, second = [step.delay for step in reached.trace.steps if step.transition is not None]
    assert 6 * factor < first <= 7 * factor
    assert first + second == 10 * factor


@pytest.mark.parametrize(("subsumption", "stored"), [(True, 2), (False, 3)])
def test_without_subsumption_a_state_inside_another_is_stored(subsumption: bool, stored: int) -> None:
    text = """
    process P() { clock x; init location a { to b; to b { guard x >= 5; } } location b; }
    system P;
    """
    program, goals = lower(load_model(Source("model.ta", text)).network)
    options = Options(subsumption=subsumption, extrapolation=Extrapolation.NONE, bounds=BoundScope.GLOBAL)
    assert zone.explore(program, goals, options).statistics.states_stored == stored


def test_clocks_are_set_in_the_unit_in_which_they_are_compared() -> None:
    text = """
    process P() {
        clock x, y;
        init location a { to b { assign x = 600, y = 0; } }
        location b { to c { guard x <= 900 && y >= 300; } }
        location c;
    }
    system P;
    property reached : E<> P.c;
    property early : E<> P.c && P.x < 900;
    """
    loaded = load_model(Source("model.ta", text))
    answers = [verdict.answer for verdict in verify(loaded.network, loaded.queries)]
    assert answers == [Answer.HOLDS, Answer.FAILS]
