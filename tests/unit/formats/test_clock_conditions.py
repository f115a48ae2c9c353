"""Conditions about clocks as UPPAAL reads them: what is written, that UPPAAL takes it, and that it means the same."""

from __future__ import annotations

import pytest

from tachk.api import model as api
from tachk.base.span import Source
from tachk.formats.catalogue import export_model
from tachk.formats.exported import Writing
from tachk.formats.loading.load import load_model
from tachk.formats.plain.expansion import expand
from tachk.formats.uppaal.portability import portability
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.syntax.printing.expression_printer import print_expression

pytestmark = pytest.mark.drawn

DECLARATIONS = """\
clock x, y, c[3];
typedef struct { clock t; int n; } r_t;
typedef int[0, 0] one_t;
typedef clock k_t[2];
int[0, 3] n; bool b; r_t r; k_t k;
"""


def model(guard: str = "true", invariant: str = "true", query: str = "P.A") -> str:
    return f"""{DECLARATIONS}
process P() {{
    clock w;
    state A {{ {invariant} }}, B;
    init A;
    trans A -> A {{ select i : int[0, 1]; guard y > 1; assign n = 2 * i + 1, b = !b, y = 0; }},
          A -> B {{ select i : int[0, 1]; guard {guard}; }};
}}
system P;
property q : E<> {query};"""


def refused(text: str, name: str = "model.xml") -> list[str]:
    found = portability(load_model(Source(name, text)), UppaalVersion.UPPAAL_5_0)
    return [d.code for d in found if d.code.startswith("E") and d.code != "E0810"]


GUARDS = [
    ("!(x <= 5)", "x > 5"),
    ("n == 1 ? x > 3 : x > 4", "(n != 1 || x > 3) && (n == 1 || x > 4)"),
    ("!(x <= 5 || r.n == 1 || r.t > 3)", "x > 5 && r.n != 1 && r.t <= 3"),
    ("x <= 5 imply b", "x > 5 || b"),
    ("exists (j : one_t) c[j] > 5", "forall (j : one_t) c[j] > 5"),
    ("!(b imply !(x > 5))", "b && x > 5"),
    ("!(k[i] - x < 3 || x < w)", "k[i] - x >= 3 && x >= w"),
    ("!forall (j : one_t) c[j] + n > 5", "forall (j : one_t) c[j] + n <= 5"),
    ("!(b ? n == 1 ? x > 3 : x > 4 : !(x > 7))", "(!b || (n != 1 || x <= 3) && (n == 1 || x <= 4)) && (b || x > 7)"),
]
KEPT = ["b imply x > 5", "b || x > 5", "x > 5 || !b", "forall (j : one_t) c[j] > 5", "(b ? x : y) > 5", "!(n > 2 && b)"]
INVARIANTS = [
    ("x == 5", "x <= 5 && x >= 5"),
    ("!(y >= 3) && w' == 0", "y < 3 && w' == 0"),
    ("x <= b", "x <= b + 0"),
]
QUERIES = [
    ("n == 1 ? x > 3 : P.w > 4", "(n != 1 || x > 3) && (n == 1 || P.w > 4)"),
    ("(x > 3) == (n > 1)", "x > 3 && n > 1 || x <= 3 && !(n > 1)"),
    ("(x > 3) xor b", "x > 3 && !b || x <= 3 && b"),
    ("!(x > 3 || P.B) && x != 3", "!(x > 3 || P.B) && x != 3"),
]


@pytest.mark.parametrize(("written", "meant"), [*GUARDS, *((text, text) for text in KEPT)])
def test_guards(written: str, meant: str) -> None:
    plain = expand(load_model(Source("model.ta", model(guard=written))))
    guard = plain.templates[0].edges[1].guard
    assert guard is not None and print_expression(guard) == meant
    assert "E0823" in refused(model(guard=written), "model.ta") or written == meant


@pytest.mark.parametrize(("written", "meant"), INVARIANTS)
def test_invariants(written: str, meant: str) -> None:
    plain = expand(load_model(Source("model.ta", model(invariant=written))))
    invariant = plain.templates[0].locations[0].invariant
    assert invariant is not None and print_expression(invariant) == meant
    assert {"E0818", "E0823"} & set(refused(model(invariant=written), "model.ta"))


@pytest.mark.parametrize(("written", "meant"), QUERIES)
def test_queries(written: str, meant: str) -> None:
    plain = expand(load_model(Source("model.ta", model(query=written))))
    predicate = plain.queries[0].formula.predicate  # type: ignore[union-attr]
    assert predicate is not None and print_expression(predicate) == meant
    assert "E0823" in refused(model(query=written), "model.ta") or written == meant


MODELS = [
    *(model(guard=text, query="P.B") for text in [*(g for g, _ in GUARDS), *KEPT]),
    *(model(invariant=text, query="x > 2 && n == 3") for text in ("y == 0", "!(y >= 3) && w' == 0", "x <= b")),
    *(model(query=text) for text, _ in QUERIES),
]


@pytest.mark.parametrize("text", MODELS)
def test_exports_are_taken_and_mean_the_same(text: str) -> None:
    original = load_model(Source("model.ta", text))
    for form, name in (("xml", "again.xml"), ("xta", "again.xta")):
        exported = export_model(original, form, Writing())
        assert refused(exported.text, name) == []
        goal = text[text.index("E<>") :].rstrip(";")
        again = api.Model(load_model(Source(name, exported.text)))
        assert answers(again, goal) == answers(api.Model(original), goal)


def answers(model: api.Model, goal: str) -> list[object]:
    """Of the goal, and the values of clocks in each location, which tell where a bound was moved."""
    report = model.verify(goal, "sup{P.A}: x", "inf{P.B}: x", "inf{P.B}: y", trace=False)
    return [(verdict.answer, verdict.extremes) for verdict in report]
