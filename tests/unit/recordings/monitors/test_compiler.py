"""What formulas over columns are compiled to, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, InternalError
from tachk.base.span import Source
from tachk.recordings.monitors import compiler as monitoring
from tachk.recordings.traces.monitor_program import UNBOUNDED, AtomRelation, MonitorProgram, NodeKind, ValueOperator
from tachk.syntax.formulas.parser import parse_formula
from tests.support.tricky import read_formula

COLUMNS = ("p", "q", "speed", "x", "P.loc", "x[3]", "speed in km/h", "T(1).x")


def compiled(text: str, ticks: int = 1, **options: tuple[str, ...]) -> MonitorProgram:
    return monitoring.compile(read_formula(text), COLUMNS, ticks, **options)


def refused(text: str, ticks: int = 1) -> tuple[Diagnostic, ...]:
    with pytest.raises(InputError) as error:
        compiled(text, ticks)
    return error.value.diagnostics


def outline(program: MonitorProgram) -> list[tuple[NodeKind, tuple[int, ...]]]:
    return [(node.kind, node.operands) for node in program.nodes]


def test_intervals_become_ticks() -> None:
    program = compiled("G(p -> F(0.5,180] q)", ticks=2)
    assert outline(program) == [
        (NodeKind.ATOM, ()),
        (NodeKind.ATOM, ()),
        (NodeKind.EVENTUALLY, (1,)),
        (NodeKind.NOT, (0,)),
        (NodeKind.OR, (3, 2)),
        (NodeKind.ALWAYS, (4,)),
    ]
    window, always = program.nodes[2], program.nodes[5]
    assert (window.lower, window.upper, window.lower_closed, window.upper_closed) == (1, 360, False, True)
    assert (always.lower, always.upper, always.lower_closed, always.upper_closed) == (0, UNBOUNDED, True, True)
    assert program.columns == ("p", "q")
    assert window.text == "F(0.5, 180] q"


def test_what_occurs_twice_is_computed_once() -> None:
    program = compiled("F[0,3] (x < 2 && p) || F[0,3] (x < 2 && p)")
    assert outline(program) == [
        (NodeKind.ATOM, ()),
        (NodeKind.ATOM, ()),
        (NodeKind.AND, (0, 1)),
        (NodeKind.EVENTUALLY, (2,)),
        (NodeKind.OR, (3, 3)),
    ]


def test_weak_until_is_until_or_always() -> None:
    assert outline(compiled("p W q"))[2:] == [(NodeKind.UNTIL, (0, 1)), (NodeKind.ALWAYS, (0,)), (NodeKind.OR, (2, 3))]


def test_arithmetic_is_postfix() -> None:
    (atom,) = compiled("abs(x - 2) * 0.1 <= min(speed, x, 7)").atoms
    assert atom.relation is AtomRelation.LESS_EQUAL
    assert [(i.operator, i.operand) for i in atom.left] == [
        (ValueOperator.COLUMN, 0),
        (ValueOperator.CONSTANT, 2),
        (ValueOperator.SUBTRACT, 0),
        (ValueOperator.ABSOLUTE, 0),
        (ValueOperator.CONSTANT, 0.1),
        (ValueOperator.MULTIPLY, 0),
    ]
    assert [(i.operator, i.operand) for i in atom.right] == [
        (ValueOperator.COLUMN, 1),
        (ValueOperator.COLUMN, 0),
        (ValueOperator.MINIMUM, 0),
        (ValueOperator.CONSTANT, 7),
        (ValueOperator.MINIMUM, 0),
    ]


@pytest.mark.parametrize("name", ["P.loc", "x[3]", "`speed in km/h`", "T(1).x"])
def test_columns_may_be_called_like_parts_of_a_model(name: str) -> None:
    assert compiled(f"G {name} > 0").columns == (name.strip("`"),)
    assert monitoring.columns_read(read_formula(f"G {name} > 0 && abs(q) < 1")) == {name.strip("`"), "q"}


def test_truth_values_are_compared_as_conditions() -> None:
    equivalence = compiled("(p == q) && x < 1", booleans=("p", "q"))
    assert [node.kind for node in equivalence.nodes].count(NodeKind.NOT) == 2
    assert {atom.relation for atom in equivalence.atoms} == {AtomRelation.TRUTH, AtomRelation.LESS}
    assert compiled("p == q").atoms[0].relation is AtomRelation.EQUAL
    assert compiled("p == (x < 3)").nodes[-1].kind is NodeKind.OR
    assert compiled("p == true").nodes[-1].kind is NodeKind.OR
    assert compiled("p == 1", booleans=("p",)).atoms[0].relation is AtomRelation.EQUAL


def test_changes_of_values_and_of_conditions() -> None:
    assert [node.kind for node in compiled("change(x + speed)").nodes] == [NodeKind.CHANGE]
    program = compiled("change(x < 3)")
    assert [node.kind for node in program.nodes] == [
        NodeKind.ATOM,
        NodeKind.FALL,
        NodeKind.NOT,
        NodeKind.FALL,
        NodeKind.OR,
    ]


def test_unknown_columns_are_all_reported_at_their_places() -> None:
    first, second = refused("G (spede > 3 -> F[0,5] nothing_like_it)")
    assert first.code == "E0901"
    assert first.span.text == "spede"
    assert first.help == "did you mean `speed`?"
    assert second.span.text == "nothing_like_it"
    assert second.help is not None and "speed in km/h" in second.help


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("F f(x) > 3", "E0902", "f(x)"),
        ("F (p ? x : 3) > 1", "E0902", "p ? x : 3"),
        ("F (forall (i : int[0,1]) x > i)", "E0902", "forall (i : int[0,1]) x > i"),
        ("F (x & 3) == 1", "E0902", "x & 3"),
        ("F (x > 3) + 1 > 1", "E0902", "x > 3"),
        ("F 0 < x < 3", "E0904", "0 < x < 3"),
        ("F min() < 3", "E0902", "min()"),
        ("F[0,0.3] p", "E0903", "0.3"),
        ("F[0,2147483647] p && F[0,268435455000000000.0] p", "E0903", "F[0,"),
    ],
)
def test_rejected(text: str, code: str, place: str) -> None:
    (finding,) = refused(text, ticks=4)
    assert finding.code == code
    assert place in finding.span.text


def test_ticks_needed() -> None:
    assert monitoring.ticks_needed(read_formula("F[0.5,2] (p U[0,1.2] q)")) == 10
    assert monitoring.ticks_needed(read_formula("F p")) == 1


def test_durations_must_be_resolved_before() -> None:
    with pytest.raises(InternalError):
        compiled("F[0,5 s] p")
    formula, _ = parse_formula(read_formula("F[0,M] p").span)
    assert formula is not None
    with pytest.raises(InternalError):
        monitoring.ticks_needed(formula)


def test_a_third_of_a_unit_is_exact() -> None:
    assert compiled("F[0,0.25] p", ticks=12).nodes[-1].upper == Fraction(12, 4)


@pytest.mark.parametrize(("text", "advice"), [("G (p & q)", "&&"), ("G (p | q)", "||")])
def test_operators_on_bits_are_answered_with_those_on_conditions(text: str, advice: str) -> None:
    formula, _ = parse_formula(Source("<formula>", text))
    assert formula is not None
    with pytest.raises(InputError) as error:
        monitoring.compile(formula, ["p", "q"], 1)
    assert error.value.diagnostics[0].help == f"conditions are joined by {advice}"


def test_a_message_quotes_the_ends_of_a_long_expression() -> None:
    formula = read_formula(f"G ({' + '.join(f'c{number}' for number in range(1000))})")
    with pytest.raises(InputError) as error:
        monitoring.compile(formula, [f"c{number}" for number in range(1000)], 1)
    (found,) = error.value.diagnostics
    assert found.message == "`c0 + c1 + c2 + c3 + c4 + ... c998 + c999` is a number, not a condition"
    assert len(str(found.help)) < 80
