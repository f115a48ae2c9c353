"""Mutants apply to the sources and name tests that are there."""

from __future__ import annotations

import pytest

from tests.mutation.mutants import Mutant, MutantError, applies, load_mutants
from tests.mutation.places import ROOT, Place, functions, spans
from tests.mutation.results import KILLED, SURVIVED, Result, summary

MUTANTS = load_mutants()


def test_there_are_enough_in_every_area() -> None:
    assert len(MUTANTS) >= 150
    assert {mutant.area for mutant in MUTANTS} >= {"zones", "observers", "judge", "limits", "compiler"}


def test_all_apply() -> None:
    assert [mutant.id for mutant in MUTANTS if not applies(mutant)] == []


def test_they_can_be_compiled() -> None:
    for mutant in filter(applies, MUTANTS):
        file = mutant.place().path
        if file.endswith(".py"):
            compile(mutant.apply((ROOT / file).read_text(encoding="utf-8")), file, "exec")


def test_their_tests_exist() -> None:
    programs = {path.stem for path in (ROOT / "tests" / "core").rglob("*.cpp")}
    assert {program for mutant in MUTANTS for program in mutant.programs} <= programs
    for name in {path for mutant in MUTANTS for path in mutant.paths}:
        file, _, test = name.partition("::")
        assert (ROOT / file).exists(), name
        assert not test or f"def {test.partition('[')[0]}(" in (ROOT / file).read_text(encoding="utf-8"), name


def test_tokens_are_found_wherever_lines_end() -> None:
    assert spans("a = f(b,\n  c)  # c)\nc = d", ".py", "c)") == [(11, 13)]
    assert spans("if (a /* b */ == 1)", ".cpp", "a == 1") == [(4, 18)]
    assert spans("ab == 1", ".cpp", "b == 1") == []


def test_a_place_that_is_not_unique_is_no_place(monkeypatch: pytest.MonkeyPatch) -> None:
    def mutant(function: str, old: str) -> Mutant:
        return Mutant("T1", "none", function, old, "c", "", (), "")

    here = "tests/mutation/places.py"
    text = (ROOT / here).read_text(encoding="utf-8")
    monkeypatch.setitem(functions(), "whole", [Place(here, 0, len(text))])
    assert mutant("whole", "def   spans(").apply(text) == text.replace("def spans(", "c", 1)
    for wrong in (mutant("whole", "yield"), mutant("whole", "never there"), mutant("nothing", "yield")):
        with pytest.raises(MutantError):
            wrong.apply(text)


def test_what_is_equivalent_does_not_count_as_surviving() -> None:
    mutants = [Mutant(f"T{n}", "none", "", "", "", "", (), "because" if n == 2 else "") for n in range(4)]
    results = {f"T{n}": Result(f"T{n}", "", fate, "", 0.0) for n, fate in enumerate([KILLED, SURVIVED, SURVIVED])}
    assert summary(mutants, results).splitlines()[-1] == "| all | 4 | 1 | 1 | 1 | 1 | 50 % |"
