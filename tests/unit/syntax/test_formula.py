"""Reading and printing temporal formulas."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk.base.operators import COMPARISONS, BinaryOperator, OperandGroup, PrefixOperator
from tachk.base.span import NOWHERE, Source, Span
from tachk.syntax import ast
from tachk.syntax import formula as f
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.printer import print_formula, print_number
from tachk.syntax.formulas.tokens import ORDINARY
from tachk.syntax.walk import nodes_of_kind


def parsed(text: str) -> f.Formula:
    formula, diagnostics = parse_formula(Source("f", text))
    assert formula is not None, diagnostics
    return formula


def canonical(text: str) -> str:
    return print_formula(parsed(text))


def name(text: str) -> ast.NameExpression:
    return ast.NameExpression(NOWHERE, text)


def atom(text: str) -> f.Atom:
    return f.Atom(NOWHERE, name(text))


P, Q, R = atom("p"), atom("q"), atom("r")


def within(lower: Any, upper: Any, unit: str = "", lower_closed: bool = True, upper_closed: bool = True) -> f.Interval:
    bound = None if upper is None else f.Duration(NOWHERE, Fraction(upper), unit)
    first = f.Duration(NOWHERE, Fraction(lower), unit if lower else "")
    return f.Interval(NOWHERE, first, bound, lower_closed, upper_closed)


def test_response() -> None:
    expected = f.Always(NOWHERE, within(0, None), f.Implies(NOWHERE, P, f.Eventually(NOWHERE, within(0, 180, "s"), Q)))
    assert parsed("G(p -> F[0,180 s] q)") == expected
    assert parsed("G (p imply F[0,180s] q)") == expected


@pytest.mark.parametrize(
    ("text", "interval"),
    [
        ("F[0,5] p", within(0, 5)),
        ("F[0, 5) p", within(0, 5, upper_closed=False)),
        ("F(0,5] p", within(0, 5, lower_closed=False)),
        ("F(0,5)p", within(0, 5, lower_closed=False, upper_closed=False)),
        ("F(0,5)(p)", within(0, 5, lower_closed=False, upper_closed=False)),
        ("F[2,inf) p", within(2, None)),
        ("F(2, inf) p", within(2, None, lower_closed=False)),
        ("F[1.5 ms, 2.25 ms] p", within("1.5", "2.25", "ms")),
        ("F (p)", within(0, None)),
        ("F p", within(0, None)),
        ("F[0,inf) p", within(0, None)),
    ],
)
def test_intervals(text: str, interval: f.Interval) -> None:
    assert parsed(text) == f.Eventually(NOWHERE, interval, P)


def test_bounds_may_be_expressions_with_a_unit() -> None:
    formula = parsed("F(0, 2 * N + M[1] ms] p")
    assert isinstance(formula, f.Eventually)
    upper = formula.interval.upper
    assert upper is not None
    assert isinstance(upper.value, ast.BinaryExpression)
    assert upper.unit == "ms"
    assert print_formula(formula) == "F(0, 2 * N + M[1] ms] p"


def test_a_unit_can_be_a_constant() -> None:
    formula = parsed("F[0, s] p")
    assert isinstance(formula, f.Eventually)
    assert formula.interval.upper == f.Duration(NOWHERE, name("s"), "")


@pytest.mark.parametrize(
    ("text", "grouped"),
    [
        ("!p U q", "!p U q"),
        ("p U q && r", "(p U q) && r"),
        ("p U q U r", "p U (q U r)"),
        ("p S q W r", "p S (q W r)"),
        ("G p U q", "(G p) U q"),
        ("G p && q", "(G p) && q"),
        ("! F p || q", "(!F p) || q"),
        ("p || q && r", "p || (q && r)"),
        ("p || q -> r || p", "(p || q) -> (r || p)"),
        ("p -> q -> r", "p -> (q -> r)"),
        ("G x < 3 && p", "(G (x < 3)) && p"),
        ("G x + 1 < y U p", "(G (x + 1 < y)) U p"),
        ("x < 3 U y < 4", "(x < 3) U (y < 4)"),
        ("not p and q or r", "(!p && q) || r"),
        ("F G p", "F (G p)"),
    ],
)
def test_grouping(text: str, grouped: str) -> None:
    assert parsed(text) == parsed(grouped)


def test_parentheses_within_a_chain_mean_nothing() -> None:
    assert parsed("p && (q && r)") == parsed("(p && q) && r") == f.And(NOWHERE, (P, Q, R))


@pytest.mark.parametrize(
    "text", ["S == 3", "P.F", "P(1).G && U", "F > 3", "x + W < O", "G.loc", "H'  == 1", "rise > 3", "inf > 3", "s == 1"]
)
def test_letters_name_things_where_no_operator_can_be_meant(text: str) -> None:
    names = {node.name for node in nodes_of_kind(parsed(text), ast.NameExpression, ast.Identifier)}
    assert names & {"S", "F", "G", "U", "W", "H", "O", "rise", "inf", "s"}
    assert not list(nodes_of_kind(parsed(text), f.Eventually, f.Always, f.Until, f.Since, f.WeakUntil, f.Rise))


def test_backticks_name_things_literally() -> None:
    assert parsed("G `G`") == f.Always(NOWHERE, within(0, None), atom("G"))
    assert parsed("`speed (km/h)` U `forall`") == f.Until(
        NOWHERE, within(0, None), atom("speed (km/h)"), atom("forall")
    )
    assert canonical("G`my column`  > 3") == "G (`my column` > 3)"
    assert canonical("F P.`odd one`") == "F P.`odd one`"


def test_edges() -> None:
    assert parsed("rise(p && q)") == f.Rise(NOWHERE, f.And(NOWHERE, (P, Q)))
    assert parsed("fall(F p)") == f.Fall(NOWHERE, f.Eventually(NOWHERE, within(0, None), P))
    assert canonical("change(x+1)") == "change(x + 1)"


def test_exclusive_or_is_written_out() -> None:
    assert canonical("p xor F q") == "p && !F q || !p && F q"


def test_every_node_has_its_place() -> None:
    text = "  G( p -> F[0, 5 s] (x < 3) ) "
    formula = parsed(text)
    assert isinstance(formula, f.Always)
    assert formula.span.text == "G( p -> F[0, 5 s] (x < 3) )"
    implication = formula.operand
    assert isinstance(implication, f.Implies)
    assert implication.left.span.text == "p"
    response = implication.right
    assert isinstance(response, f.Eventually)
    assert response.span.text == "F[0, 5 s] (x < 3)"
    assert response.interval.span.text == "[0, 5 s]"
    assert response.interval.upper is not None
    assert response.interval.upper.span.text == "5 s"
    assert response.operand.span.text == "(x < 3)"


def test_a_part_of_a_text() -> None:
    source = Source("f", "title: G p; rest")
    formula, diagnostics = parse_formula(Span(source, 7, 10))
    assert diagnostics == ()
    assert formula is not None
    assert formula.span == Span(source, 7, 10)


def test_hopeless_nesting_is_rejected() -> None:
    for text in ("(" * 300 + "p" + ")" * 300, "F " * 300 + "p", "F !" * 150 + "p", " U ".join(["p"] * 300)):
        formula, diagnostics = parse_formula(Source("f", text))
        assert formula is None
        assert [d.code for d in diagnostics] == ["E0111"]


LINKS = 2000


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        (" && ".join(["p"] * LINKS), " && ".join(["p"] * LINKS)),
        (" || ".join(["F[0, 1] p"] * LINKS), " || ".join(["F[0, 1] p"] * LINKS)),
        (" && ".join(["F[0, 1] p"] * LINKS), " && ".join(["F[0, 1] p"] * LINKS)),
        ("q -> " * LINKS + "F p", "q && " * (LINKS - 1) + "q -> F p"),
        ("q && r -> " * LINKS + "p", "q && r && " * (LINKS - 1) + "q && r -> p"),
        ("F " + "!" * LINKS + "p", "F !!p"),
        ("F " + "!" * (LINKS + 1) + "p", "F !p"),
        ("F (" + " xor ".join(["p"] * LINKS) + ")", "F (" + " xor ".join(["p"] * LINKS) + ")"),
        ("F (" + " + ".join(["x"] * LINKS) + " > 1)", "F (" + " + ".join(["x"] * LINKS) + " > 1)"),
        ("p imply " * 300 + "q", "p imply " * 300 + "q"),
        ("p imply q || " * 150 + "r && s", "p imply q || " * 150 + "r && s"),
        ("F (" + " - ".join(["x"] * 300) + " > 1)", "F (" + " - ".join(["x"] * 300) + " > 1)"),
        ("F ((" + "p ? 1 : " * 300 + "2) > 1)", "F ((" + "p ? 1 : " * 300 + "2) > 1)"),
    ],
    ids=lambda text: text[:18],
)
def test_chains_are_no_nesting(text: str, printed: str) -> None:
    again = print_formula(parsed(text))
    assert again == printed
    assert print_formula(parsed(again)) == again


@pytest.mark.parametrize("text", ["p imply q imply r", "p -> q -> r", "!!!p", "p || q imply r", "(p imply q) || r"])
def test_short_chains_stay_as_they_are(text: str) -> None:
    assert not isinstance(parsed(text), f.Atom)
    assert print_formula(parsed(print_formula(parsed(text)))) == print_formula(parsed(text))


def test_long_chains_that_are_nested_are_rejected() -> None:
    for text in ("F p imply " * 300 + "q", " xor ".join(["F p"] * 3)):
        assert parse_formula(Source("f", text))[0] is None


@pytest.mark.parametrize(
    ("number", "text"),
    [("0", "0"), ("2.5", "2.5"), ("-0.125", "-0.125"), ("1e-3", "0.001"), ("1/3", "1/3"), ("100", "100")],
)
def test_numbers(number: str, text: str) -> None:
    assert print_number(Fraction(number)) == text


def test_large_numbers_are_within_the_language() -> None:
    assert canonical("F[0, 5000000000.0] p") == "F[0, 5000000000.0] p"


# ---- random trees -------------------------------------------------------------------------------------------------

ARITHMETIC = [each for each in BinaryOperator if each.group is OperandGroup.ARITHMETIC]
NAMES = st.sampled_from(["p", "q", "x", "G", "F", "U", "rise", "inf", "forall", "deadlock", "a b"])
NUMBERS = st.builds(lambda n, d: Fraction(n, d), st.integers(0, 10**10), st.sampled_from([1, 2, 4, 5, 10, 1000]))


def values() -> st.SearchStrategy[Any]:
    leaves = st.one_of(
        NAMES.map(name),
        st.integers(0, 9).map(lambda n: ast.IntegerLiteral(NOWHERE, n)),
        st.sampled_from(["0.5", "1e3"]).map(lambda text: ast.FloatLiteral(NOWHERE, text)),
    )
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.builds(ast.BinaryExpression, st.just(NOWHERE), st.sampled_from(ARITHMETIC), inner, inner),
            st.builds(ast.UnaryExpression, st.just(NOWHERE), st.just(PrefixOperator.MINUS), inner),
            st.builds(
                ast.CallExpression, st.just(NOWHERE), st.sampled_from(["min", "abs"]).map(name), st.tuples(inner, inner)
            ),
            st.builds(
                ast.MemberExpression,
                st.just(NOWHERE),
                st.just(name("P")),
                NAMES.map(lambda text: ast.Identifier(NOWHERE, text)),
            ),
        ),
        max_leaves=5,
    )


def atoms() -> st.SearchStrategy[Any]:
    compared = st.builds(
        ast.BinaryExpression, st.just(NOWHERE), st.sampled_from(sorted(COMPARISONS)), values(), values()
    )
    return st.one_of(
        NAMES.map(atom),
        compared.map(lambda expression: f.Atom(NOWHERE, expression)),
        st.booleans().map(lambda value: f.TruthConstant(NOWHERE, value)),
        values().map(lambda value: f.Change(NOWHERE, value)),
    )


def bounds() -> st.SearchStrategy[Any]:
    return st.one_of(
        NUMBERS.map(lambda number: f.Duration(NOWHERE, number, "")),
        st.builds(lambda n, unit: f.Duration(NOWHERE, n, unit), NUMBERS, st.sampled_from(["ms", "s", "min"])),
        st.sampled_from(["N", "s", "G"]).map(lambda text: f.Duration(NOWHERE, name(text), "")),
    )


def intervals() -> st.SearchStrategy[Any]:
    def make(lower: Any, upper: Any, lower_closed: bool, upper_closed: bool) -> f.Interval:
        if upper is not None and upper.unit and not lower.unit:
            upper = f.Duration(NOWHERE, upper.value, "")
        if upper is not None and lower.unit and not upper.unit:
            lower = f.Duration(NOWHERE, lower.value, "")
        return f.Interval(NOWHERE, lower, upper, lower_closed, upper is None or upper_closed)

    return st.builds(make, bounds(), st.one_of(st.none(), bounds()), st.booleans(), st.booleans())


def flat(kind: Any, parts: list[Any]) -> Any:
    operands: list[Any] = []
    for part in parts:
        operands += part.operands if isinstance(part, kind) else [part]
    return kind(NOWHERE, tuple(operands))


def formulas() -> st.SearchStrategy[Any]:
    def larger(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
        nowhere = st.just(NOWHERE)
        two = st.lists(inner, min_size=2, max_size=3)
        prefix = [
            st.builds(kind, nowhere, intervals(), inner) for kind in (f.Eventually, f.Always, f.Once, f.Historically)
        ]
        return st.one_of(
            *(st.builds(kind, nowhere, inner) for kind in (f.Not, f.Rise, f.Fall)),
            *prefix,
            st.builds(f.Until, nowhere, intervals(), inner, inner),
            st.builds(f.Since, nowhere, intervals(), inner, inner),
            st.builds(f.WeakUntil, nowhere, inner, inner),
            st.builds(f.Implies, nowhere, inner, inner),
            two.map(lambda parts: flat(f.And, parts)),
            two.map(lambda parts: flat(f.Or, parts)),
        )

    return st.recursive(atoms(), larger, max_leaves=8)


@given(formulas())
def test_reading_what_was_printed_gives_the_same_formula(formula: f.Formula) -> None:
    text = print_formula(formula)
    again, diagnostics = parse_formula(Source("f", text))
    assert diagnostics == (), text
    assert again == formula, text
    assert print_formula(again) == text


@pytest.mark.parametrize(
    ("text", "message", "advice"),
    [
        ("A[] p", "'A[]' begins a query about all runs of a model", "write G in place of A[]"),
        ("E<> p", "'E<>' begins a query about all runs of a model", "write F in place of E<>"),
        ("G (p => q)", "'=>' is not an operator", "write -> for 'implies'"),
        ("G p; G q", "';' does not fit here", "&&"),
    ],
)
def test_what_is_spelt_as_elsewhere_gets_advice(text: str, message: str, advice: str) -> None:
    formula, (diagnostic,) = parse_formula(Source("<formula>", text))
    assert formula is None
    assert message in diagnostic.message
    assert advice in (diagnostic.help or "")


@pytest.mark.parametrize("word", sorted(ORDINARY))
def test_keywords_of_models_name_columns_in_formulas(word: str) -> None:
    text = "G (WORD == 1 && F[0, 1] WORD) && (x U !WORD) && a.WORD > WORD[1] && forall (i : int[0, 1]) WORD == i"
    plain, wrong = parse_formula(Source("f", text.replace("WORD", word)))
    quoted, _ = parse_formula(Source("f", text.replace("WORD", f"`{word}`")))
    assert wrong == ()
    assert plain == quoted


def test_keyword_behind_an_operand_is_no_name() -> None:
    """A semicolon may be missing."""
    formula, diagnostics = parse_formula(Source("f", "G (x == 0) process"))
    assert formula is None
    assert diagnostics


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("[] p", "G p"),
        ("<>[0, 5] p", "F[0, 5] p"),
        ("[](p -> <>[0,5] q)", "G (p -> F[0, 5] q)"),
        ("p -> []<>q", "p -> G F q"),
        ("a[1] -> [](b[0] < 3)", "a[1] -> G b[0] < 3"),
    ],
)
def test_boxes_and_diamonds_are_letters(text: str, meant: str) -> None:
    formula, found = parse_formula(Source("<formula>", text))
    assert found == ()
    assert formula is not None
    assert print_formula(formula) == print_formula(parse_formula(Source("<formula>", meant))[0])
