"""Sets of requirements whose findings are known, and small random ones against all runs on a grid of half units."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from random import Random

import pytest

from tachk.logic.durations import resolve
from tachk.recordings.monitors.formulas import read_formulas
from tachk.verify.requirements.analysis import FindingKind, RequirementAnalysis, analyse
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn


def analysed(*texts: str) -> RequirementAnalysis:
    """The requirements are called ``a``, ``b``, ... in order."""
    formulas = [resolve(read_formulas(text)[0].formula, lambda _: None, "s") for text in texts]
    return analyse(list(zip("abcdefgh", formulas, strict=False)))


def findings(*texts: str) -> list[tuple[str, str, str]]:
    analysis = analysed(*texts)
    assert not analysis.undecided
    return [(each.kind.value, "".join(each.names), "".join(each.by)) for each in analysis.findings]


@pytest.mark.parametrize(
    ("texts", "expected"),
    [
        (["G (rise(p) -> F[0,5] q)"], []),
        (["G p", "G !p"], [("inconsistent", "ab", "")]),
        (["p must occur within 5 s.", "G (x < 3)", "p must not occur."], [("inconsistent", "ac", "")]),
        (["G (rise(p) -> F[0,5] q)", "G (rise(r) -> G[0,10] !q)"], [("colliding", "ab", "")]),
        (["G (rise(p) -> F[0,5] q)", "G (rise(r) -> G[0,5] !q)"], [("colliding", "ab", "")]),
        (["F[0,5] p", "G[0,5) !p"], []),
        (["F[0,5] p", "G[0,5] !p"], [("inconsistent", "ab", "")]),
        (["F[0,5] p", "G (rise(q) -> G[0,2] !p)", "G (p -> q)"], [("colliding", "ab", "")]),
        (["G (p -> F[0,5] q)", "G (p -> F[0,8] q)"], [("redundant", "b", "a")]),
        (["G (p -> q)", "G (q -> r)", "G (p -> r)"], [("redundant", "c", "ab")]),
        (["G (x >= 7 -> !p)", "G (p && x > 8 -> q)"], [("vacuous", "b", "a")]),
        (["G (x > 2.5 -> p)", "G (x > 2 -> !p)"], [("vacuous", "a", "ab")]),
        # What two demand together forbids what they speak of.
        (["G (p -> q)", "G (p -> !q)"], [("vacuous", "ab", "ab")]),
        (["whenever p is true, q must be true.", "whenever p is true, q must not occur."], [("vacuous", "ab", "ab")]),
        (["G (x > 5 -> y < 3)", "G (x > 7 -> y > 4)"], [("vacuous", "b", "ab")]),
        (["G (p -> q)", "G (p -> !q)", "G (p -> F[0,2] r)"], [("vacuous", "c", "ab"), ("vacuous", "ab", "ab")]),
        (["G (p -> q)", "G !q"], [("vacuous", "a", "ab")]),
        (["G (p -> !p)"], [("vacuous", "a", "a")]),
        (["G (rise(p) -> q)", "G (q -> G[0,2] r)", "G (p -> !r)"], [("vacuous", "ac", "abc")]),
        (["G (p -> F[0,2] q)", "G (p -> !q)"], []),
        # That something never happens is what these say.
        (["G (p -> false)", "G (p && q -> 3 < 2)"], [("redundant", "b", "a")]),
        (["G !p", "G (q -> G[0,2] false)"], []),
        # About the beginning alone.
        (["p && q", "G p"], []),
        (["p || !q", "G p"], [("redundant", "a", "b")]),
        (["x < 3", "x < 2", "G (x > 1)"], [("redundant", "a", "b")]),
        (["p", "!p"], [("inconsistent", "ab", "")]),
        # Without any signal.
        (["G false"], [("inconsistent", "a", "")]),
        (["G true"], [("redundant", "a", "")]),
        (["F[0,2] (1 < 2)"], [("redundant", "a", "")]),
        (["G F[0,2] false"], [("inconsistent", "a", "")]),
        (["G (2 > 1 -> p)", "G (1 > 2 -> p)", "G (p -> q)"], [("redundant", "b", "")]),
        (["G (3 - 1 == 2 && 2 > 3)", "G (p -> q)"], [("inconsistent", "a", "")]),
        (["whenever true is true, within 2 s, false must be true.", "G p"], [("inconsistent", "a", "")]),
        (["G (p -> F[0,2] p)"], [("redundant", "a", "")]),
        (["G (O p -> !q)", "G (rise(r) -> F[0,2] q)"], [("colliding", "ab", "")]),
        (["G F[0,2] p", "G (fall(p) -> G[0,2] !p)"], [("colliding", "ab", "")]),
        # The end of p counts, however long it was there.
        (
            [
                "G (p -> G[0,2] q)",
                "G (fall(p) -> F[0,1] !q)",
                "G (rise(p) -> G[0,5] p)",
                "G (fall(p) -> G[0,5] !p)",
            ],
            [("colliding", "ab", "")],
        ),
        (["G F[0,2] p", "G (fall(p) -> G[0,1] !p)"], []),
        (["G (a -> F[0,2] b)", "G (c -> G[0,2] d)"], []),
    ],
)
def test_findings(texts: list[str], expected: list[tuple[str, str, str]]) -> None:
    assert findings(*texts) == expected


def test_a_collision_is_reported_by_a_run() -> None:
    (finding,) = analysed("G (rise(p) -> F[0,5] q)", "G (rise(r) -> G[0,10] !q)").findings
    assert [moment.time for moment in finding.run] == [0, 5]
    assert finding.run[0].values == {"p": "true", "q": "false", "r": "true"}


def test_a_signal_is_a_truth_value_or_a_number() -> None:
    analysis = analysed("G (rise(p) -> F[0,5] q)", "G (p < 3 -> q)", "G (q -> r)", "G (r > 1 -> !q)")
    assert [each.split(" is not")[0] for each in analysis.undecided] == ["b", "d"]
    assert "`p` is used as a truth value and as a number" in analysis.undecided[0]


@pytest.mark.parametrize(
    "text", ["G (p -> F q)", "G (p -> F[2,5] q)", "G (x + 1 > 3 -> q)", "G (x > y)", "G (change(x) -> q)", "p U q"]
)
def test_what_is_not_followed_is_reported(text: str) -> None:
    analysis = analysed(text, "G (r -> F[0,2] s)")
    assert not analysis.findings
    (reason,) = analysis.undecided
    assert reason.startswith("a is not followed: `")


# ---- all runs on a grid ---------------------------------------------------------------------------------------------

Cells = tuple[tuple[bool, bool], ...]
"""The values of p and q in half units of time."""


@dataclass(frozen=True)
class Small:
    """A requirement, and which cells it asks for from a cell of its trigger on."""

    text: str
    broken: Callable[[Cells], bool]


def _random_small(random: Random, comes: bool) -> Small:
    trigger, goal = random.choice((("p", "q"), ("p", "q"), ("p", "q"), ("q", "p"), ("q", "q"), ("true", "q")))
    length, edge, wanted = (
        random.choice((2, 2, 3)),
        random.random() < 0.7 and trigger != "true",
        random.random() < (0.8 if comes else 0.2),
    )
    if trigger == "true" and not comes:
        trigger, edge = "p", True
    closed = comes or random.random() < 0.5

    def value(cells: Cells, name: str, at: int) -> bool:
        return name == "true" or cells[at]["pq".index(name)]

    def broken(cells: Cells) -> bool:
        for at in range(len(cells)):
            if not value(cells, trigger, at) or (edge and at > 0 and value(cells, trigger, at - 1)):
                continue
            last = at + 2 * length - (1 if edge and not closed else 0)
            seen = [value(cells, goal, each) == wanted for each in range(at, min(last, len(cells) - 1) + 1)]
            if (comes and last < len(cells) and not any(seen)) or (not comes and not all(seen)):
                return True
        return False

    bounds = f"[0,{length}{']' if closed else ')'}"
    shown = f"rise({trigger})" if edge else trigger
    return Small(f"G ({shown} -> {'F' if comes else 'G'}{bounds} {'' if wanted else '!'}{goal})", broken)


def _extended(cells: Cells, by: int, rules: list[Small]) -> Iterator[Cells]:
    """The runs so much longer that break nothing."""
    if not by:
        yield cells
        return
    for values in product((False, True), repeat=2):
        longer = (*cells, values)
        if not any(rule.broken(longer) for rule in rules):
            yield from _extended(longer, by - 1, rules)


def _can_be_stuck(rules: list[Small]) -> bool:
    """Whether some run of at most six half units has broken nothing, and has no continuation of ten that does not."""
    return any(
        next(_extended(cells, 10, rules), None) is None for length in range(7) for cells in _extended((), length, rules)
    )


@pytest.mark.parametrize("block", range(2))
def test_what_can_collide_is_what_gets_stuck_on_a_grid(block: int) -> None:
    stuck = []
    for seed in seeds(range(10 * block, 10 * block + 10)):
        random = Random(seed)
        rules = [_random_small(random, comes=True), _random_small(random, comes=random.random() < 0.2)]
        analysis = analysed(*(rule.text for rule in rules))
        assert not analysis.undecided, seed
        found = any(each.kind in (FindingKind.COLLIDING, FindingKind.INCONSISTENT) for each in analysis.findings)
        assert found == _can_be_stuck(rules), f"seed {seed}: {[rule.text for rule in rules]}"
        stuck.append(found)
        for each in analysis.findings:
            if each.kind is FindingKind.REDUNDANT:
                one, other = (rules[0], rules[1]) if each.names == ("a",) else (rules[1], rules[0])
                assert not any(one.broken(cells) for cells in _extended((), 7, [other])), f"seed {seed}"
    assert enough(2 <= stuck.count(True) <= 8)
