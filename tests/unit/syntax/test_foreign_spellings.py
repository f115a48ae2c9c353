"""The spellings of RTAMT, Breach, tools for LTL and C, wherever a formula can be written: what the help says."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.recordings.monitors.formulas import read_formulas

MODEL = """time_unit = 1 s;
bool p, q;
int x;
process P() {{ location A {{ to B; }} init location B {{ to A; }} }}
{}
system P;
"""

G, F = "the operator is written G", "the operator is written F"
O, H = "the operator is written O", "the operator is written H"
U, S = "the operator is written U", "the operator is written S"
RELEASE = "write `q W (p && q)`"
SAME = "write `p == q` for conditions"
NEXT, BEFORE = "no next instant", "no last instant"
INTERVAL = "F[0, 5]"
GROUP = "write ( and ) in place of { and }"
IMPLIES = "write -> for 'implies'"

EVERYWHERE = {
    # RTAMT
    "always (p -> q)": G,
    "always (p implies q)": G,
    "always (p implies eventually[0,5] q)": G,
    "always[0,5] p": G,
    "always p": G,
    "G (p -> eventually (q))": F,
    "eventually[0:5] p": F,
    "eventually p": F,
    "once[0,5] p": O,
    "historically[0,5] p": H,
    "p until[0,5] q": U,
    "p since[0,5] q": S,
    "p unless q": "the operator is written W",
    "p implies q": IMPLIES,
    "G (p implies q)": IMPLIES,
    "p iff q": SAME,
    "G (p iff q)": SAME,
    "G p iff F q": SAME,
    "prev p": BEFORE,
    "G (next p)": NEXT,
    "rise p": "rise(p)",
    "F[0:5] p": "[0, 5]",
    "F[0, 1 sec] p": "'s'",
    # Breach
    "alw_[0,5] (x < 3)": G,
    "alw (x < 3)": G,
    "ev_[0,5] p": F,
    "ev (p)": F,
    "p until_[0,5] q": U,
    # tools for LTL and MTL
    "[]_[0,5] p": G,
    "<>_[0,5] p": F,
    "G_[0,5] p": G,
    "F_[0,5] p": F,
    "p U_[0,5] q": U,
    "p <-> q": SAME,
    "G (p <-> q)": SAME,
    "p <=> q": SAME,
    "G (p <=> F q)": SAME,
    "p xnor q": SAME,
    "p R q": RELEASE,
    "G (p R q)": RELEASE,
    "p V q": RELEASE,
    "p release q": RELEASE,
    "X p": NEXT,
    "G (X p)": NEXT,
    "next p": NEXT,
    "Y p": BEFORE,
    "F[<=5] p": INTERVAL,
    "F{<=5} p": INTERVAL,
    "F<=5 p": INTERVAL,
    "F[>=5] p": "F[5, inf)",
    "p /\\ q": "write && in place of /\\",
    "G (p \\/ q)": "write || in place of \\/",
    "~p": "write ! for 'not'",
    "p => q": IMPLIES,
    "G (p => q)": IMPLIES,
    "p ==> q": IMPLIES,
    "{p} -> {q}": GROUP,
    "G {p}": GROUP,
    "p AND q": "write and",
    "G (p ∧ q)": "write &&",
    "G (x = 3)": "compare with ==",
}

ON_RECORDINGS = {
    "AG p": "write G in place of AG",
    "A[] p": "write G in place of A[]",
    "p --> q": "write `G (p -> F q)`",
    "never p": "write ! in front",
    "next(p)": NEXT,
    "always(p)": G,
    "p before q": "write `!q W p`",
    "p precedes q": "write `!q W p`",
    "G (p triggers q)": "write `G (p -> F[0, 5] q)`",
    "p after q": "write `G (p -> F[0, 5] q)`",
    "G (p if q)": "write `p -> q`",
    "p weak until q": "the operator is written W",
    "p leads to q": "write `G (p -> F[0, 5] q)`",
    "if p then q": "write `p -> q`",
    "if p, q": "write `p -> q`",
    "whenever p then q": "write `p -> q`",
    "G (if p then q)": "write `p -> q`",
    "G(p before q)": "write `!q W p`",
    "after p, q": "write `G (p -> F[0, 5] q)`",
    "while p, q": "write `G (p -> q)`",
}
"""Where a formula about one run is wanted."""

ON_MODELS = {
    "A[] (p implies q)": "write imply",
    "A[] p iff q": "write `p == q`",
    "A[] (p <-> q)": "write `p == q`",
    "A[] (p => q)": "write imply",
    "A[] (p ==> q)": "write imply",
    "A[] always (p)": G,
    "A[] {p}": GROUP,
    "A[] p -> q": "write imply",
    "never p": "write `A[] not ...`",
    "x < .5": "write 0.5",
    "x < 5.": "write 5.0",
}
"""Queries about all runs, and what formulas may have that models may not."""

NUMBERS = ("G (x < 5.)", "G x < 5.", "G (x < .5)", "F[0,1.] (x > 2.)", "G x > 5. && p")


Findings = list[tuple[str, str]]
"""Code and help of each."""

Place = Callable[[str, Path], Findings]


def as_property(text: str, folder: Path) -> Findings:
    return refused(lambda: load_model(Source("m.ta", MODEL.format(f"property a : {text};"))))


def in_query_file(text: str, folder: Path) -> Findings:
    (folder / "m.q").write_text(f"{text}\n", encoding="utf-8")
    report: Any = tachk.loads(MODEL.format("")).verify(query_files=[folder / "m.q"], trace=False).to_dict()
    errors = [error for query in report["not_checked"] for error in query.get("errors", ())]
    return [(error["code"], error["help"]) for error in errors]


def as_query(text: str, folder: Path) -> Findings:
    return refused(lambda: tachk.loads(MODEL.format("")).verify(text, trace=False))


def in_formula_file(text: str, folder: Path) -> Findings:
    (folder / "f.stl").write_text(f"{text}\n", encoding="utf-8")
    return refused(lambda: read_formulas(str(folder / "f.stl")))


def as_formula(text: str, folder: Path) -> Findings:
    return refused(lambda: read_formulas(text))


def refused(read: Callable[[], object]) -> Findings:
    try:
        read()
    except InputError as error:
        return [(found.code, found.help or "") for found in error.diagnostics]
    return []


MODELS = (as_property, in_query_file, as_query)
RECORDINGS = (in_formula_file, as_formula)


@pytest.mark.parametrize("read", [*MODELS, *RECORDINGS])
def test_help_names_the_spelling_that_is_meant(read: Place, tmp_path: Path) -> None:
    rows = EVERYWHERE | (ON_MODELS if read in MODELS else ON_RECORDINGS)
    told = {text: [help_ for _, help_ in read(text, tmp_path)] for text in rows}
    wrong = {text: helps for text, helps in told.items() if len(helps) != 1 or rows[text] not in helps[0]}
    assert not wrong


@pytest.mark.parametrize("read", [*MODELS, *RECORDINGS])
def test_numbers_of_c_are_numbers_in_formulas(read: Place, tmp_path: Path) -> None:
    for text in NUMBERS:
        assert not [code for code, _ in read(text, tmp_path) if code.startswith("E01")], text


def test_an_arrow_of_old_models_is_no_comparison_in_a_property() -> None:
    """``=>`` is ``>=`` in guards of UPPAAL 3.x; in a property it was read so, too, whatever it was meant to say."""
    text = "const N 5;\nclock c;\nprocess P() {{ state A; init A; trans A -> A {{ guard c => N; }}; }}\n{}\nsystem P;\n"
    assert not load_model(Source("m.ta", text.format(""))).refusals
    with pytest.raises(InputError, match="'=>' is not an operator"):
        load_model(Source("m.ta", text.format("property a : G (P.A => P.A);")))


EDGES = {
    "c!;": "write `sync c!;`",
    "assign t = 0; n = 1;": "write `assign t = 0, n = 1;`",
    "when t > 3;": "write `guard t > 3;`",
    "if (t > 3);": "write `guard t > 3;`",
    "if (t > 3) n = 1;": "write `guard t > 3; assign n = 1;`",
    "t > 3;": "write `guard t > 3;`",
    "n = 1;": "write `assign n = 1;`",
    "guard t > 3 -> t = 0;": "write `guard t > 3; assign t = 0;`",
    "reset t;": "write `assign t = 0;`",
    "send c;": "write `sync c!;`",
    "send c[1]!;": "write `sync c[1]!;`",
    "receive c;": "write `sync c?;`",
    "reset(t);": "write `assign t = 0;`",
    "reset {t};": "write `assign t = 0;`",
    "update t = 0;": "write `assign t = 0;`",
}
"""What stands in the braces of an edge."""


def test_help_for_clauses_of_other_languages() -> None:
    text = "clock t; int n; chan c;\nprocess P() {{ init location a {{ to b {{ {} }} }} location b; }}\nsystem P;\n"
    told = {edge: refused(partial(load_model, Source("m.ta", text.format(edge)))) for edge in EDGES}
    wrong = {edge: found for edge, found in told.items() if len(found) != 1 or EDGES[edge] not in found[0][1]}
    assert not wrong


ITEMS = {
    "float d = 2.5;\nprocess P() { init location a; }\nsystem P;": "write double",
    "process P() { init location a { to b; } location c; }\nsystem P;": "the locations are a, c",
    "process P() { init location a; }\nSystem P;": "write system",
    "process P() { init location a; }\nproperty q : E<> P.a expect true;\nsystem P;": "write `expect holds`",
    "process P() { init location a; }\nproperty q : always P.a;\nsystem P;": G,
    "process P() { init location a { to a { sync stop!; } } }\nsystem P;": "`chan stop;`",
}


@pytest.mark.parametrize("text", ITEMS)
def test_help_for_items_of_other_languages(text: str) -> None:
    assert ITEMS[text] in refused(lambda: load_model(Source("m.ta", text)))[0][1]
