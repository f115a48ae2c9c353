"""Assignments as places, as UPPAAL has them: what stands inside is done first."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.base.span import Source
from tachk.engine.options import Engine, Options
from tachk.formats.loading.load import load_model
from tachk.verify.verify import verify

MODEL = """
    int[0, 99] i, j, seen; int a[3];
    typedef struct {{ int x; int y; }} r_t;
    r_t r, q;
    void k(int &n) {{ n += 10; }}
    bool even(int &n) {{ return n % 2 == 0; }}
    void f() {{ {statements} }}
    process P() {{ state A, B; init A; trans A -> B {{ assign f(); }}; }}
    system P;
    property Q : A[] P.B imply {claim};
"""


@pytest.mark.parametrize(
    ("statements", "claim"),
    [
        ("(++i)++; ++++i;", "i == 4"),
        ("(i = 3) += 2;", "i == 5"),
        ("k(++i);", "i == 11"),
        ("q.y = 7; (r = q).x = 2;", "r.x == 2 && r.y == 7 && q.x == 0"),
        ("(a[1] = 4) *= 2; ++(++a[0]);", "a[1] == 8 && a[0] == 2"),
        ("seen = (j = 3) += 1;", "j == 4 && seen == 4"),
        ("seen = even(++i) ? 1 : 2; j = (i += 1)++;", "seen == 2 && i == 3 && j == 2"),
        ("((i = 9) -= 2) -= 3; --(j = 5);", "i == 4 && j == 4"),
    ],
)
def test_what_stands_inside_is_done_first(statements: str, claim: str) -> None:
    loaded = load_model(Source("model.ta", MODEL.format(statements=statements, claim=claim)))
    for engine in (Engine.ZONE, Engine.SMT):
        (found,) = verify(loaded.network, loaded.queries, Options(engine=engine))
        assert found.answer.value == "holds"


@pytest.mark.parametrize("statements", ["(a[i] = i = 2) += 1;", "(a[i++] = 3) += 2;"])
def test_order_that_would_matter_is_rejected(statements: str) -> None:
    text = MODEL.format(statements=statements, claim="true")
    with pytest.raises(UnsupportedError, match=r"where its order matters|function `f`"):
        assert load_model(Source("model.ta", text)).network


@pytest.mark.parametrize(
    ("statements", "help"),
    [
        ("i++++;", "write `++` in front of the variable"),
        ("--(j++);", "write `++` in front of the variable"),
        ("(i + 1)++;", None),
        ("5 = i;", "write `==` to compare"),
    ],
)
def test_what_is_no_place(statements: str, help: str | None) -> None:
    with pytest.raises(InputError) as error:
        load_model(Source("model.ta", MODEL.format(statements=statements, claim="true")))
    assert [(d.code, d.help) for d in error.value.diagnostics] == [("E0303", help)]
