"""Load, print, load: the canonical text describes the same network and asks the same questions."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.base.resources import data_root
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.network import same_network
from tachk.frontend.loaded import LoadedModel
from tachk.syntax.printing.printer import print_document

pytestmark = pytest.mark.drawn

SYSTEMS = [
    path for path in sorted((data_root() / "models").rglob("*.ta")) if "\nsystem " in path.read_text(encoding="utf-8")
]


def check(loaded: LoadedModel, name: str) -> None:
    again = load_model(Source(name, print_document(loaded.document)))
    assert same_network(loaded.network, again.network)
    assert [(q.name, q.kind, q.title, q.expectation) for q in loaded.queries] == [
        (q.name, q.kind, q.title, q.expectation) for q in again.queries
    ]


@pytest.mark.parametrize("path", SYSTEMS, ids=lambda path: path.stem)
def test_the_models_of_the_project(path: Path) -> None:
    check(load_model(path), str(path))


BINARY = ["+", "-", "*", "&", "|", "^", "<?", ">?"]
COMPARISONS = ["<", "<=", "==", "!=", ">=", ">"]
CONNECTIVES = ["&&", "||", "and", "or", "imply", "xor"]


def _connected(parts: st.SearchStrategy[str], words: list[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.tuples(parts, st.sampled_from(words), parts).map(lambda t: f"{t[0]} {t[1]} {t[2]}"),
        st.tuples(parts, st.sampled_from(words), parts).map(lambda t: f"({t[0]}) {t[1]} ({t[2]})"),
        st.tuples(st.lists(parts, min_size=2, max_size=40), st.sampled_from(words)).map(
            lambda t: f" {t[1]} ".join(t[0])
        ),
    )


INTEGERS = st.recursive(
    st.sampled_from(["0", "7", "n", "k", "v[1]", "v[k]", "r.a", "N", "id", "f(n)", "-n", "!b"]),
    lambda inner: st.one_of(
        _connected(inner.map(lambda text: f"({text})"), BINARY),
        st.tuples(inner, inner, inner).map(lambda t: f"({t[0]} ? {t[1]} : {t[2]})"),
        inner.map(lambda text: f"sum (i : small) (i + {text})"),
        inner.map(lambda text: f"v[({text}) & 1]"),
    ),
    max_leaves=6,
)
CONDITIONS = st.recursive(
    st.one_of(
        st.tuples(INTEGERS, st.sampled_from(COMPARISONS), INTEGERS).map(lambda t: f"({t[0]}) {t[1]} ({t[2]})"),
        st.sampled_from(["true", "b", "not b"]),
    ),
    lambda inner: st.one_of(
        _connected(inner.map(lambda text: f"({text})"), CONNECTIVES),
        inner.map(lambda text: f"forall (j : small) v[j & 1] == 0 && ({text})"),
        inner.map(lambda text: f"!({text})"),
    ),
    max_leaves=5,
)
CLOCKS = st.sampled_from(["x <= 5", "x - y < n", "x >= 1 && y > 2", "b || x < N", "!(x < 3)", "x == k"])
GUARDS = st.one_of(CONDITIONS, CLOCKS, st.tuples(CLOCKS, CONDITIONS).map(lambda t: f"({t[0]}) && ({t[1]})"))
UPDATES = st.one_of(
    st.sampled_from(["n = 0", "x = 0", "n++", "b := !b", "v[0] += 1", "r.a = n, y = 2", "reset(x)", "r = zero"]),
    INTEGERS.map(lambda text: f"k = {text}"),
)
LABELS = st.tuples(
    st.sampled_from(["", "select i : small, j : int[0, N];"]),
    st.one_of(st.just(""), GUARDS.map(lambda text: f"guard {text};")),
    st.sampled_from(["", "sync c[id]!;", "sync d?;", "sync e!n;", "sync e?k;"]),
    st.one_of(st.just(""), UPDATES.map(lambda text: f"assign {text};")),
).map("".join)


@st.composite
def models(draw: st.DrawFn) -> str:
    """A model with one template of two processes, in either form of its body."""
    classic = draw(st.booleans())
    count = draw(st.integers(1, 4))
    invariants = [draw(st.one_of(st.just(""), CLOCKS)) for _ in range(count)]
    flags = [draw(st.sampled_from(["", "urgent", "committed"])) for _ in range(count)]
    edges = [draw(st.lists(st.tuples(st.integers(0, count - 1), LABELS), max_size=3)) for _ in range(count)]
    if classic:
        states = ", ".join(f"s{n} {{ {text} }}" if text else f"s{n}" for n, text in enumerate(invariants))
        lines = [f"s{source} -> s{target} {{ {labels} }}" for source, out in enumerate(edges) for target, labels in out]
        body = f"state {states};\n"
        body += "".join(f"commit s{n};\n" for n, flag in enumerate(flags) if flag == "committed")
        body += "".join(f"urgent s{n};\n" for n, flag in enumerate(flags) if flag == "urgent")
        body += "init s0;\n" + (f"trans {', '.join(lines)};\n" if lines else "")
    else:
        body = ""
        for n, out in enumerate(edges):
            clauses = f"invariant {invariants[n]};\n" if invariants[n] else ""
            clauses += "".join(f"to s{target} {{ {labels} }}\n" for target, labels in out)
            body += f"{'init' if n == 0 else ''} {flags[n]} location s{n} {{ {clauses} }}\n"
    signal = draw(INTEGERS).replace("id", "1")
    return f"""
const int N = 3; typedef int[0, 2] small; typedef struct {{ int a; bool c; }} pair;
const pair zero = {{ 0, false }}; pair r; int n, v[2]; bool b; int k; chan c[3], e; broadcast chan d;
int f(int a) {{ int t = a; for (i : small) t += i; if (t > 3) return 1; else return t; }}
void reset(clock &z) {{ z = 0; }}
process P(const small id) {{ clock x, y;
{body} }}
A = P(0); B = P(1);
system A < B;
signal s = {signal};
property p "title" : A[] {draw(CONDITIONS).replace("id", "2")} expect holds;
property q : E<> A.s0 && B.x < 3 && s == 2;
"""


@given(models())
@settings(max_examples=60, deadline=None)
def test_generated_models(text: str) -> None:
    check(load_model(Source("model.ta", text)), "model.ta")
