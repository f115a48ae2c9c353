"""Structs of which variables last lose their floating point fields, as a plain `double` is left out."""

from __future__ import annotations

import pytest

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
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
        ("o.e[0] = 2.0", "the floating point field `e` is not supported here"),
        ("total = u == v[0]", "comparing values of type s_t, which contain floating point numbers, is not supported"),
    ],
)
def test_what_reads_them_is_refused(update: str, message: str) -> None:
    assert message in [refusal.message for refusal in load(update).refusals]


def test_initial_values_name_what_there_is() -> None:
    text = "typedef struct { int n; double d; } s_t; s_t s = {1, nothing}; process P() { state A; init A; } system P;"
    with pytest.raises(InputError, match="unknown name `nothing`"):
        load_model(Source("model.ta", text))
