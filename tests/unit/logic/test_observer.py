"""Observers: how small they are, what they are called, and what is refused. Whether they are right is a question for
tests/differential/test_observers.py."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.span import Source
from tachk.logic.durations import resolve
from tachk.logic.observer.construction import BAD, NoObserver, build_observer
from tachk.syntax import ast
from tachk.syntax.formula import Formula
from tachk.syntax.parsing.parser import parse_query
from tachk.syntax.printing.expression_printer import print_expression


def formula(text: str) -> Formula:
    entry, diagnostics = parse_query(Source("formula", text))
    assert entry is not None and not diagnostics
    assert isinstance(entry.formula, ast.TemporalFormula) and entry.formula.formula is not None
    return resolve(entry.formula.formula, lambda _: Fraction(0), "1 s")


def observer(text: str) -> ast.Template:
    return build_observer(formula(text), "Observer").template


def locations(template: ast.Template) -> list[str]:
    return [location.name.name for location in template.locations]


def clocks(template: ast.Template) -> int:
    return sum(
        len(node.declarators)
        for node in template.declarations
        if isinstance(node, ast.VariableDeclaration)
        and node.type is not None
        and isinstance(node.type.base, ast.BuiltinType)
        and node.type.base.name == "clock"
    )


def edges(template: ast.Template, source: str) -> dict[str, ast.EdgeDeclaration]:
    found = next(location for location in template.locations if location.name.name == source)
    return {edge.target.name: edge for edge in found.edges}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("G !p", ["Idle", "Violated", "Bad"]),
        ("G (p -> q)", ["Idle", "Violated", "Bad"]),
        ("G (p -> F[0,5] q)", ["Idle", "Triggered", "Waiting", "Bad"]),
        ("G (p -> F[2,5] q)", ["Idle", "Triggered", "Waiting", "Ahead", "Bad"]),
        ("G F[0,5] q", ["Idle", "Waiting", "Bad"]),
        ("F[0,5] q", ["Waiting", "Passed", "Bad"]),
        ("p W q", ["Waiting", "Violated", "Passed", "Bad"]),
        ("G (p -> G[0,5] !q)", ["Idle", "Violated", "During", "Violated_1", "After", "Bad"]),
        ("G (p -> O[0,5] q)", ["Held", "Idle", "Violated", "Held_1", "Bad"]),
        ("G (p -> O q)", ["Held", "Violated", "Passed", "Bad"]),
        ("G (rise(p) -> F[0,5] q)", ["Before", "Idle", "Triggered", "Before_1", "Waiting", "Bad"]),
        ("G (rise(p) -> F(0,5] !p)", ["Before", "Idle", "Triggered", "Before_1", "Bad"]),
        ("G (rise(p) -> G[0,5) p)", ["Before", "Idle", "Triggered", "Before_1", "Violated", "Bad"]),
    ],
)
def test_frequent_requirements_have_small_observers_with_one_clock(text: str, expected: list[str]) -> None:
    template = observer(text)
    assert locations(template) == expected
    assert clocks(template) == 1


def test_a_response_that_must_last_takes_two_clocks() -> None:
    assert clocks(observer("G (p -> F[0,5] G[0,2) q)")) == 2


def test_a_violation_of_a_response_waits_longer_than_the_deadline() -> None:
    to_bad = edges(observer("G (p -> F[0,5] q)"), "Waiting")[BAD]
    assert to_bad.guard is not None and print_expression(to_bad.guard) == "x > 5"
    open_end = edges(observer("G (p -> F[0,5) q)"), "Waiting")[BAD]
    assert open_end.guard is not None and print_expression(open_end.guard) == "x >= 5"


def test_every_location_with_a_requirement_has_an_urgent_way_out_without_a_clock() -> None:
    template = observer("G (rise(p) && r -> q U[1,4] s)")
    for location in template.locations:
        for edge in location.edges:
            if edge.synchronisation is not None:
                assert edge.guard is None or "x" not in print_expression(edge.guard)
        assert not location.doc or any(edge.synchronisation is not None for edge in location.edges)


def test_every_location_is_reachable_and_leads_to_bad_or_gives_up() -> None:
    template = observer("G (change(n) -> F[0,5] G[0,2) q)")
    targets = {edge.target.name for location in template.locations for edge in location.edges}
    first = next(location.name.name for location in template.locations if location.initial)
    assert set(locations(template)) == targets | {first}


def test_names_of_the_formula_are_not_hidden() -> None:
    template = observer("G (Idle && x > 0 -> F[0,5] Waiting)")
    used = {
        name.name.name
        for d in template.declarations
        if isinstance(d, ast.VariableDeclaration)
        for name in d.declarators
    }
    assert not {"Idle", "Waiting", "x"} & {*locations(template), *used}


def test_a_formula_that_always_holds_has_an_observer_that_cannot_move() -> None:
    template = observer("G true")
    assert locations(template) == ["Passed", "Bad"]
    assert [location.edges for location in template.locations] == [(), ()]


def test_a_formula_that_never_holds_has_an_observer_that_starts_in_bad() -> None:
    assert [(node.name.name, node.initial) for node in observer("F[3,3) p").locations] == [("Bad", True)]


@pytest.mark.parametrize(
    "text",
    [
        "G (rise(p) -> F(0,8] rise(p))",
        "G (rise(p) -> F[4,6] rise(p))",
        "G (q -> F[1,5] rise(p))",
        "G (q -> F(1,5] fall(p))",
        "G (q -> F[5,5] rise(p))",
        "G (q -> G[2,5] !rise(p))",
    ],
)
def test_edges_are_followed_in_every_window(text: str) -> None:
    assert "Bad" in locations(observer(text))


@pytest.mark.parametrize(
    ("text", "blamed", "reason"),
    [
        ("F G (q || F[0,2] r)", "F G (q || F[0,2] r)", "again and again"),
        ("G[0,5] (p -> F q) -> F r", "G[0,5] (p -> F q)", "each instant of a window would need an answer"),
        ("G (p -> F[0,5] (q U[0,3] r))", "F[0,5] (q U[0,3] r)", "something temporal would have to hold at every"),
        ("G (p -> F[0,5] (q && F[1,2] r))", "F[0,5] (q && F[1,2] r)", "something temporal would have to hold at every"),
        ("G (p -> F[0,5] G[1,2] q)", "F[0,5] G[1,2] q", "another window begins"),
        ("G (p -> F[0,3] O[2,5] q)", "[2,5]", "does not reach up to the present"),
        ("G (rise(F[0,2] p) -> q)", "F[0,2] p", "a temporal formula cannot stand here"),
        ("G (p -> F[0,1 ms] q)", "1 ms", "whole numbers"),
    ],
)
def test_what_no_observer_follows_is_named_with_its_place(text: str, blamed: str, reason: str) -> None:
    with pytest.raises(NoObserver) as caught:
        observer(text)
    assert caught.value.span.text == blamed
    assert reason in caught.value.reason


@pytest.mark.parametrize(
    ("text", "endless"),
    [
        ("F q", True),
        ("G (p -> F q)", True),
        ("G F p", True),
        ("p U q", True),
        ("G p -> G q", True),
        ("F p -> F (p && F q)", True),
        ("G (p -> F[0,5] q)", False),
        ("G (p && F q -> F[0,5] q)", False),
        ("G (q && !r && F r -> !p U r)", False),  # r, which is awaited, ends it
    ],
)
def test_what_sets_no_deadline_is_violated_by_never_leaving_a_location(text: str, endless: bool) -> None:
    assert bool(build_observer(formula(text), "Observer").endings) is endless


def test_what_lasts_for_ever_from_later_on_does_not_exclude_what_comes_before() -> None:
    assert build_observer(formula("G[0,3] !p || F[5,inf) p"), "Observer").endings


@pytest.mark.parametrize(
    ("text", "most"),
    [
        ("G (rise(p) -> F[0,10] (rise(q) && F[0,10] rise(r)))", 3),
        ("F[0,20] (p && F[0,3] q)", 3),
        ("G (rise(p) -> F[0,8] (q && rise(r)))", 2),
        ("G (rise(p) -> !rise(p) U[4,6] rise(p))", 2),
        ("G (rise(p) && !rise(q) && F rise(q) -> !r U rise(q))", 2),
        ("G (p && !q && F q -> (r -> !q U[0,2] (s && !q)) U q)", 2),
        ("G (p -> F[0,5] G q)", 2),
        ("G (p -> F[0,5] (q && F(0,2] !q))", 3),
    ],
)
def test_what_is_temporal_inside_a_window_takes_few_clocks(text: str, most: int) -> None:
    assert clocks(observer(text)) <= most


def test_a_deadline_that_comes_later_in_the_formula_makes_an_unbounded_end_harmless() -> None:
    assert BAD in locations(observer("G (q && !r && F r -> !p U r)"))
