"""Structs of which variables last lose their floating point fields, as a plain `double` is left out."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.cli.main import app
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel

MODEL = """
    typedef struct {{ int n; double d; bool b; }} s_t;
    typedef struct {{ s_t s; double e[2]; int m; }} o_t;
    s_t u = {{3, 2.5, true}}; s_t v[2] = {{{{1, 0.5, false}}, {{d: 1.0, n: 4, b: true}}}}; o_t o; int total;
    const s_t C = {{7, 1.5, true}};
    void set(s_t &s, int k) {{ s.n = k; s.d = 1.5 * k; s.b = !s.b; }}
    int get(s_t s) {{ return s.n; }}
    process P(s_t &r) {{
        state A, B; init A;
        trans A -> B {{
            assign set(v[0], 5), r.n = get(v[0]) + C.n, r.d = v[1].d + 2.0, o.s = v[1], o.s.d = 3.25, {update};
        }};
    }}
    Q = P(u);
    system Q;
"""


def load(update: str) -> LoadedModel:
    return load_model(Source("model.ta", MODEL.format(update=update)))


def test_what_is_assigned_to_them_is_left_out() -> None:
    loaded = load("total = o.s.n")
    assert [d.code for d in loaded.warnings] == ["W0406", "W0406"]
    claim = "u.n == 12 && v[0].n == 5 && v[0].b && v[1].b && o.s.n == 4 && total == 4"
    report = api.Model(loaded).verify(f"A[] Q.B imply {claim}", "E<> Q.B")
    assert [verdict.answer for verdict in report] == ["holds", "holds"]


@pytest.mark.parametrize(
    ("update", "message"),
    [
        ("total = v[0].d > 1.0 ? 1 : 2", "the floating point field `d` is not supported here"),
        ("v[total].d = 2.0", "the floating point field `d` is not supported here"),
        ("o.e[total] = 2.0", "the floating point field `e` is not supported here"),
        ("o.e[2] = 2.0", "the floating point field `e` is not supported here"),
        ("total = u == v[0]", "comparing values of type s_t, which contain floating point numbers, is not supported"),
    ],
)
def test_what_reads_them_is_rejected(update: str, message: str) -> None:
    assert message in [refusal.message for refusal in load(update).refusals]


PARTS = """
    typedef struct {{ double a; double b; }} pair_t;
    typedef struct {{ pair_t i; pair_t k[2]; int m; }} s_t;
    s_t v; pair_t p, q[3]; double d[2]; double g; hybrid clock y[2]; int n; int zero;
    double next() {{ n++; return 2.5; }}
    void set(double &x) {{ x = 2.5; }}
    process P() {{ state A, B; init A; trans A -> B {{ select j: int[0, 1]; assign {update}, v.m = 4; }}; }}
    system P;
"""


@pytest.mark.parametrize(
    ("update", "calls"),
    [
        ("v.i.a = 2.5", 0),
        ("v.k[j].b = 1.0", 0),
        ("p.a = 3.0", 0),
        ("p = q[1]", 0),
        ("q[2] = v.i", 0),
        ("d[j] = d[1] * 2.0", 0),
        ("y[0] = 0", 0),
        ("g = next()", 1),
        ("d[1] = next() + next()", 2),
    ],
)
def test_parts_and_structs_of_floating_point_numbers_are_left_out(update: str, calls: int, tmp_path: Path) -> None:
    path, run = tmp_path / "model.ta", tmp_path / "one.run"
    path.write_text(PARTS.format(update=update))
    model = tachk.load(path)
    answers = model.verify(f"A[] P.B imply n == {calls} && v.m == 4", "E<> P.B")
    assert [verdict.answer for verdict in answers] == ["holds", "holds"]
    # The simulator keeps the numbers, and the semantics that judges runs does not: both take the same step.
    assert app.main(["simulate", str(path), "--until", "5", "-o", str(run)], standalone_mode=False) == 0
    assert tachk.replay(model, run).refusal is None


def test_what_is_assigned_to_them_may_be_a_run_time_error() -> None:
    model = api.Model(load_model(Source("model.ta", PARTS.format(update="g = 1 / zero"))))
    (verdict,) = model.verify("E<> P.B")
    assert (verdict.answer, verdict.reason) == ("unknown", "run-time error")


@pytest.mark.parametrize(
    ("update", "message"),
    [
        ("set(g)", "tachk leaves `g` out, and `set` could read it"),
        ("set(v.k[1].a)", "tachk leaves `v.k[1].a` out, and `set` could read it"),
        ("d[2] = 1.0", "the floating point variable `d` is not supported here"),
        ("g = d[0] + next()", "the floating point variable `d` is not supported here"),
    ],
)
def test_other_uses_of_parts_are_rejected(update: str, message: str) -> None:
    loaded = load_model(Source("model.ta", PARTS.format(update=update)))
    assert message in [refusal.message for refusal in loaded.refusals]


def test_initial_values_name_what_there_is() -> None:
    text = "typedef struct { int n; double d; } s_t; s_t s = {1, nothing}; process P() { state A; init A; } system P;"
    with pytest.raises(InputError, match="unknown name `nothing`"):
        load_model(Source("model.ta", text))
