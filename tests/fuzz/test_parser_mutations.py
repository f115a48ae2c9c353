"""Mutated models: whatever the text, the parser answers with a tree or with diagnostics inside the text."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.diagnostics.render import render
from tachk.base.plain_data import PlainData
from tachk.base.resources import data_root
from tachk.base.span import Source
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.parsing.parser import has_errors, parse_document
from tachk.syntax.printing.printer import canonical, print_document
from tachk.syntax.query_files import parse_queries
from tachk.syntax.source_files import read_source

MUTANTS = 150

WORDS = """
process location to guard sync assign init urgent committed branchpoint { } ( ) [ ] ; , : = == ! ? -> -u-> A[] E<> -->
forall sum property signal import gantt "x" " /* */ // /// \\ ' é € 99999999999 1.5e3 const int struct typedef
state trans commit system < <= := =< chan priority default expect holds time_unit \0 \a
"""

OLD = """\
const N 5;
process P(int v; const c) {
    clock x;
    state A { x <= 5, v >= 1 }, B;
    init A;
    trans A -> B { guard x > 1, v => N; sync a!; assign x := 0; }, -> A { };
}
system P;
"""


def seeds() -> list[str]:
    folder = data_root() / "models" / "classics"
    return [path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.ta"))] + [OLD]


def mutate(text: str, random: Random) -> str:
    if random.random() < 0.7:
        begin = random.randrange(len(text))
        text = text[begin : begin + random.randrange(1, 800)]
    for _ in range(random.randrange(1, 6)):
        place = random.randrange(len(text) + 1)
        end = place + random.choice([0, 0, 1, 3, 20])
        piece = random.choice([f" {random.choice(WORDS.split())} ", "", text[random.randrange(len(text) + 1) :][:30]])
        text = text[:place] + piece + text[end:]
    return text


@pytest.mark.parametrize("seed", range(4))
def test_mutated_models(seed: int) -> None:
    random = Random(seed)
    originals = seeds()
    for _ in range(MUTANTS):
        text = mutate(random.choice(originals), random)
        document, diagnostics = parse_document(Source("m.ta", text))
        for diagnostic in diagnostics:
            assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(text)
            assert render(diagnostic)
            assert PlainData().of(diagnostic)
        assert document is not None or has_errors(diagnostics)
        if document is not None and not has_errors(diagnostics):
            printed = print_document(document)
            again, found = parse_document(Source("again.ta", printed))
            assert not has_errors(found), printed
            assert again == canonical(document)


def test_mutated_queries() -> None:
    random = Random(7)
    original = (
        "A[] forall (i : id_t) not P(i).bad imply x - y <= 3 \\\n and deadlock\n/* EXPECT:T */\nsup{p}: x, y\np --> q\n"
    )
    for _ in range(300):
        text = mutate(original, random)
        _, diagnostics = parse_queries(Source("m.q", text))
        assert all(0 <= d.span.start <= d.span.end <= len(text) for d in diagnostics)


FORMULAS = """\
G (p -> F[0, 180 s] q && x - y <= 3.5)
(p U[0, 5) q) W (r S(2, inf) `odd name`) || !rise(T(1).loc) && change(n + 1)
H[0, N + 1 ms] O(1, 2] abs(x) < 3 imply forall (i : id_t) not P(i).bad
whenever p becomes true, within 20 s, q must stay true for at least 5 s.
"""

FORMULA_WORDS = """
G F[0,5] U S W O H [0, (1, inf) 5 s] ) ( `G` `a b` -> && || ! rise( change( fall( , . : ; == = ++ A[] --> sum forall
true deadlock whenever must within ` é 99999999999 1.5e3 expect holds "x" // /* 's
"""


def mutate_formula(random: Random) -> str:
    text = random.choice(FORMULAS.splitlines())
    for _ in range(random.randrange(1, 5)):
        place = random.randrange(len(text) + 1)
        end = place + random.choice([0, 0, 1, 2, 10])
        text = text[:place] + f" {random.choice([*FORMULA_WORDS.split(), ''])} " + text[end:]
    return text


def test_mutated_formulas() -> None:
    random = Random(11)
    for _ in range(600):
        text = mutate_formula(random)
        formula, diagnostics = parse_formula(Source("f", text))
        assert (formula is None) == has_errors(diagnostics)
        for diagnostic in diagnostics:
            assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(text)
            assert render(diagnostic)
        if formula is not None:
            printed = print_formula(formula)
            again, found = parse_formula(Source("again", printed))
            assert again == formula, (text, printed, found)


def test_mutated_properties() -> None:
    random = Random(12)
    for _ in range(300):
        text = f"property a : {mutate_formula(random)};\nproperty b : A[] x;\n"
        document, diagnostics = parse_document(Source("m.ta", text))
        assert all(0 <= d.span.start <= d.span.end <= len(text) for d in diagnostics)
        if document is not None and not has_errors(diagnostics):
            printed = print_document(document)
            again, found = parse_document(Source("again.ta", printed))
            assert not has_errors(found), printed
            assert again == canonical(document)


@pytest.mark.parametrize("seed", range(20))
def test_random_bytes(seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    alphabet = random.choice([bytes(range(256)), b"{}()[];,=<>!? \n", b"process { } state ;\"/*\\'"])
    path = tmp_path / "m.ta"
    path.write_bytes(bytes(random.choices(alphabet, k=random.randrange(2000))))
    try:
        source = read_source(path)
    except (InputError, UsageError):
        return
    document, diagnostics = parse_document(source)
    assert document is not None or has_errors(diagnostics)
