"""Sentences as text: reading what was printed gives the same tree, for every tree that means something."""

from __future__ import annotations

from fractions import Fraction
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE, Source
from tachk.logic.sentences import meaning
from tachk.syntax import ast
from tachk.syntax import formula as f
from tachk.syntax.formulas.build import missing_unit
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.sentences import tree as s
from tachk.syntax.sentences.order import assemble
from tachk.syntax.sentences.parser import parse_sentence
from tachk.syntax.sentences.printer import print_sentence

NAMES = st.sampled_from(["p", "q", "s", "ms", "after", "until", "must", "true_", "then", "G", "between", "later", "is"])
UNITS = st.sampled_from(["", "ns", "us", "ms", "s", "min", "h", "d"])


def named(name: str) -> ast.Expression:
    return ast.NameExpression(NOWHERE, name)


def comparison(name: str, operator: str, number: int) -> ast.Expression:
    return ast.BinaryExpression(NOWHERE, BinaryOperator(operator), named(name), ast.IntegerLiteral(NOWHERE, number))


VALUES = st.one_of(
    st.builds(named, NAMES),
    st.builds(comparison, NAMES, st.sampled_from(["<", "==", ">="]), st.integers(0, 9)),
    st.builds(lambda name: ast.MemberExpression(NOWHERE, named("P"), ast.Identifier(NOWHERE, name)), NAMES),
    st.builds(lambda n, i: ast.IndexExpression(NOWHERE, named(n), ast.IntegerLiteral(NOWHERE, i)), NAMES, st.just(3)),
)


def flat(kind: type[f.And] | type[f.Or], parts: list[f.Formula]) -> f.Formula:
    inner = tuple(x for part in parts for x in (part.operands if isinstance(part, kind) else (part,)))
    return kind(NOWHERE, inner)


CONDITIONS: st.SearchStrategy[f.Formula] = st.recursive(
    st.one_of(
        st.builds(lambda e: f.Atom(NOWHERE, e), VALUES),
        st.builds(lambda v: f.TruthConstant(NOWHERE, v), st.booleans()),
        st.builds(lambda e: f.Change(NOWHERE, e), VALUES),
    ),
    lambda inner: st.one_of(
        st.builds(lambda o: f.Not(NOWHERE, o), inner),
        st.builds(lambda o: f.Rise(NOWHERE, o), inner),
        st.builds(lambda o: f.Fall(NOWHERE, o), inner),
        st.builds(lambda o: flat(f.And, o), st.lists(inner, min_size=2, max_size=3)),
        st.builds(lambda o: flat(f.Or, o), st.lists(inner, min_size=2, max_size=3)),
        st.builds(lambda a, b: f.Implies(NOWHERE, a, b), inner, inner),
    ),
    max_leaves=4,
)

TWO = ast.IntegerLiteral(NOWHERE, 2)
AMOUNTS = st.one_of(
    st.integers(0, 200).map(Fraction),
    st.integers(1, 999).map(lambda n: Fraction(n, 100)),
    st.builds(named, NAMES),
    st.builds(
        lambda n: ast.BinaryExpression(NOWHERE, BinaryOperator.MULTIPLY, ast.IntegerLiteral(NOWHERE, 2), named(n)),
        NAMES,
    ),
)
DURATIONS = st.builds(lambda value, unit: f.Duration(NOWHERE, value, unit), AMOUNTS, UNITS)
PAIRS = st.builds(
    lambda a, b, u, v: (f.Duration(NOWHERE, a, u or v), f.Duration(NOWHERE, b, v)), AMOUNTS, AMOUNTS, UNITS, UNITS
).filter(lambda pair: missing_unit(pair[1], pair[0]) is None)
LASTINGS = st.one_of(
    st.builds(lambda d: s.AtLeast(NOWHERE, d), DURATIONS),
    st.builds(lambda d: s.AtMost(NOWHERE, d), DURATIONS),
    st.builds(lambda pair: s.FromTo(NOWHERE, *pair), PAIRS),
)
SCOPES = st.one_of(
    st.just(s.Globally(NOWHERE)),
    st.builds(lambda c: s.BeforeScope(NOWHERE, c), CONDITIONS),
    st.builds(lambda c: s.After(NOWHERE, c), CONDITIONS),
    st.builds(lambda a, b: s.BetweenScope(NOWHERE, a, b), CONDITIONS, CONDITIONS),
    st.builds(lambda a, b: s.AfterUntil(NOWHERE, a, b), CONDITIONS, CONDITIONS),
    st.builds(lambda c: s.WhileScope(NOWHERE, c), CONDITIONS),
)
TRIGGERS = st.one_of(
    st.just(s.AtEveryInstant(NOWHERE)),
    st.just(s.Initially(NOWHERE)),
    st.builds(lambda c: s.Whenever(NOWHERE, c), CONDITIONS),
    st.builds(lambda c: s.Becomes(NOWHERE, c), CONDITIONS),
    st.builds(lambda c, l, r: s.Becomes(NOWHERE, c, l, r), CONDITIONS, LASTINGS, st.sampled_from(s.DelayReference)),
    st.builds(lambda e: s.ChangeInstants(NOWHERE, e), VALUES),
)
DELAYS = st.one_of(
    st.just(s.NoDelay(NOWHERE)),
    st.builds(lambda d: s.Within(NOWHERE, d), DURATIONS),
    st.builds(lambda pair: s.SentenceWindow(NOWHERE, *pair), PAIRS),
    st.builds(lambda d: s.Exactly(NOWHERE, d), DURATIONS),
    st.just(s.AtSomeInstant(NOWHERE)),
)
RESPONSES = st.one_of(
    st.builds(lambda c: s.MustBeTrue(NOWHERE, c), CONDITIONS),
    st.builds(lambda c, l: s.MustStay(NOWHERE, c, l), CONDITIONS, LASTINGS),
    st.builds(lambda c, u, d: s.MustStayUntil(NOWHERE, c, u, d), CONDITIONS, CONDITIONS, st.none() | DURATIONS),
    st.builds(lambda c: s.MustStayOn(NOWHERE, c), CONDITIONS),
    st.builds(lambda c, d: s.MustNotOccur(NOWHERE, c, d), CONDITIONS, st.none() | DURATIONS),
    st.builds(lambda c, d: s.MustOccur(NOWHERE, c, d), CONDITIONS, st.none() | DURATIONS),
    st.builds(lambda c, d: s.MustRecur(NOWHERE, c, d), CONDITIONS, DURATIONS),
    st.builds(lambda c, d: s.MustHaveBeen(NOWHERE, c, d), CONDITIONS, st.none() | DURATIONS),
)
SENTENCES = st.builds(
    lambda *parts: s.Sentence(NOWHERE, *parts),
    SCOPES,
    TRIGGERS,
    DELAYS,
    RESPONSES,
    st.sampled_from(["", "R1", "after"]),
)


def reference_is_known(sentence: s.Sentence) -> bool:
    trigger = sentence.trigger
    if not isinstance(trigger, s.Becomes) or trigger.lasting is None:
        return True
    return not (
        (
            isinstance(trigger.lasting, s.AtLeast)
            and trigger.reference in (s.DelayReference.FALL, s.DelayReference.MAXIMUM)
        )
        or (isinstance(trigger.lasting, s.AtMost) and trigger.reference is s.DelayReference.MINIMUM)
    )


def canonical(sentence: s.Sentence) -> s.Sentence | None:
    """The sentence as the parser would hold it; None if its parts do not go together."""
    parts = [sentence.scope, sentence.trigger, sentence.delay, sentence.response]
    assembled, found = assemble(NOWHERE, parts)
    if assembled is None or found or not reference_is_known(sentence):
        return None
    return s.Sentence(NOWHERE, assembled.scope, assembled.trigger, assembled.delay, assembled.response, sentence.label)


@settings(max_examples=150)
@given(SENTENCES)
def test_what_was_printed_reads_as_the_same_sentence(sentence: s.Sentence) -> None:
    expected = canonical(sentence)
    if expected is None:
        return
    text = print_sentence(expected)
    again, found = parse_sentence(Source("s", text))
    assert found == (), text
    assert again == expected, text
    assert print_sentence(again) == text


@settings(max_examples=100)
@given(SENTENCES)
def test_every_sentence_has_a_meaning_that_can_be_read(sentence: s.Sentence) -> None:
    expected = canonical(sentence)
    if expected is None:
        return
    formula = meaning(expected)
    again, found = parse_formula(Source("f", print_formula(formula)))
    assert found == ()
    assert again is not None
    assert print_formula(again) == print_formula(formula)


WORDS = """
whenever p q is true must be within 5 s after before and between until while then , . ( ) “ ” becomes stays for at least
most eventually initially with a delay of occur every not have been last counting from the rise end shall when ever [ 3
] " ' é
"""
ORIGINAL = """
After Q until R, whenever p becomes true and stays true for at least 5 s, within 3 ms, q must be true.
"""


def test_any_words_are_answered() -> None:
    random = Random(1)
    vocabulary = WORDS.split()
    for _ in range(100):
        words = random.choice([ORIGINAL.split(), random.choices(vocabulary, k=12)])
        for _ in range(random.randrange(4)):
            place = random.randrange(len(words))
            words[place : place + random.randrange(3)] = random.choices(vocabulary, k=random.randrange(3))
            words = words or ["p"]
        text = " ".join(words)
        sentence, found = parse_sentence(Source("s", text))
        assert (sentence is None) == bool(found)
        for diagnostic in found:
            assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(text)
