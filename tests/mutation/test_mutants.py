"""Every mutant still applies to the sources and names tests that are there."""

from __future__ import annotations

import pytest

from tests.mutation.mutants import ROOT, Mutant, MutantError, load_mutants
from tests.mutation.results import KILLED, SURVIVED, Result, summary

MUTANTS = load_mutants()


def test_there_are_enough_in_every_area() -> None:
    assert len(MUTANTS) >= 150
    assert {mutant.area for mutant in MUTANTS} >= {"zones", "observers", "judge", "limits", "exit_status"}


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.id)
def test_a_mutant_applies(mutant: Mutant) -> None:
    changed = mutant.apply((ROOT / mutant.file).read_text(encoding="utf-8"))
    if mutant.file.endswith(".py"):
        compile(changed, mutant.file, "exec")
    assert mutant.tests
    for name in mutant.programs:
        assert len(list((ROOT / "tests" / "core").rglob(f"{name}.cpp"))) == 1, name
    for name in mutant.paths:
        file, _, test = name.partition("::")
        assert (ROOT / file).exists(), name
        assert not test or f"def {test.partition('[')[0]}(" in (ROOT / file).read_text(encoding="utf-8"), name


def test_a_place_that_is_not_unique_is_no_place() -> None:
    def mutant(old: str, after: str = "") -> Mutant:
        return Mutant("T1", "none", "m.py", after, old, "c", "", (), "")

    assert mutant("b").apply("a b a") == "a c a"
    assert mutant("a", "b").apply("a b a") == "a b c"
    for wrong in (mutant("a"), mutant("d"), mutant("b", "b"), mutant("a", "a"), mutant("c", "c")):
        with pytest.raises(MutantError):
            wrong.apply("a b a c")


def test_what_is_equivalent_does_not_count_as_surviving() -> None:
    mutants = [Mutant(f"T{n}", "none", "", "", "", "", "", (), "because" if n == 2 else "") for n in range(4)]
    results = {f"T{n}": Result(f"T{n}", "", fate, "", 0.0) for n, fate in enumerate([KILLED, SURVIVED, SURVIVED])}
    assert summary(mutants, results).splitlines()[-1] == "| all | 4 | 1 | 1 | 1 | 1 | 50 % |"
