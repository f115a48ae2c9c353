"""Reading sentences: the wording of the paper, every part, names that look like phrases, near misses."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.diagnostics.explanation import explanations
from tachk.base.span import NOWHERE, Source, Span
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Duration, Formula, Not, Rise
from tachk.syntax.sentences import tree as s
from tachk.syntax.sentences.parser import parse_sentence, with_full_stop
from tachk.syntax.sentences.printer import print_sentence

SENTENCE_CODES = explanations("sentences")


def read(text: str) -> s.Sentence:
    sentence, found = parse_sentence(Source("s", text))
    assert sentence is not None, [diagnostic.message for diagnostic in found]
    assert found == ()
    return sentence


def refused(text: str) -> tuple[Diagnostic, ...]:
    sentence, found = parse_sentence(Source("s", text))
    assert sentence is None
    assert found
    return found


def name(text: str) -> Formula:
    return Atom(NOWHERE, ast.NameExpression(NOWHERE, text))


def time(amount: int | str, unit: str = "s") -> Duration:
    return Duration(NOWHERE, Fraction(amount), unit)


P, Q, R = name("p"), name("q"), name("r")
GLOBALLY, ALWAYS, NO_DELAY = s.Globally(NOWHERE), s.AtEveryInstant(NOWHERE), s.NoDelay(NOWHERE)
MUST = s.MustBeTrue(NOWHERE, Q)


def sentence(
    scope: s.Scope = GLOBALLY,
    trigger: s.Trigger = ALWAYS,
    delay: s.Delay = NO_DELAY,
    response: s.Response = MUST,
) -> s.Sentence:
    return s.Sentence(NOWHERE, scope, trigger, delay, response)


RESPONSE_180 = sentence(
    trigger=s.Whenever(NOWHERE, name("X")),
    delay=s.Within(NOWHERE, time(180)),
    response=s.MustBeTrue(NOWHERE, name("Y")),
)


@pytest.mark.parametrize(
    "text",
    [
        "At any point of time, whenever X is true then, with a delay of at most 180 seconds, Y must be true.",
        "At any point of time, whenever X is true then with a delay of at most 180 seconds, Y must be true.",
        "At any point of time whenever X is true, with a delay of at most 180 seconds, Y must be true.",
        "At any point of time, whenever X is true, then with a delay of at most 180 seconds Y must be true.",
        "at any point of time, Whenever X IS TRUE, With a Delay of at Most 180 Seconds, Y must be true .",
        "whenever X, within 180 s, Y must be true.",
        "Always whenever X within 180s Y must be true.",
        "Globally, always, whenever X,\n    within 180 sec, // as the paper has it\n    Y must be true.",
        "whenever “X” is true, within (180) seconds, (Y) must be true.",
        "whenever X, Y must occur within 180 s.",
    ],
)
def test_wordings_of_one_sentence(text: str) -> None:
    assert read(text) == RESPONSE_180


def test_the_properties_of_the_paper() -> None:
    everywhere = read(
        "At any point of time, whenever true is true, with a delay of at most 180 seconds, allToAgent must be true."
    )
    assert print_sentence(everywhere) == "Whenever true is true, within 180 s, allToAgent must be true."
    asleep = read(
        "At any point of time, whenever asleep is true, with a delay of between 0 and 50 seconds, not arrived must be "
        "true."
    )
    assert asleep.delay == s.SentenceWindow(NOWHERE, time(0), time(50))
    assert asleep.response == s.MustBeTrue(NOWHERE, Not(NOWHERE, name("arrived")))
    tenth = read("At any point of time, whenever count == 10 is true then, with no delay, sent == toDDS must be true.")
    assert tenth.delay == NO_DELAY


@pytest.mark.parametrize(
    ("text", "trigger"),
    [
        ("", ALWAYS),
        ("initially, ", s.Initially(NOWHERE)),
        ("whenever p, ", s.Whenever(NOWHERE, P)),
        ("whenever p is false, ", s.Whenever(NOWHERE, Not(NOWHERE, P))),
        ("whenever p changes, ", s.ChangeInstants(NOWHERE, ast.NameExpression(NOWHERE, "p"))),
        ("whenever p becomes true, ", s.Becomes(NOWHERE, P)),
        ("whenever p becomes false, ", s.Becomes(NOWHERE, Not(NOWHERE, P))),
        (
            "whenever p becomes true and stays true for at least 5 s, ",
            s.Becomes(NOWHERE, P, s.AtLeast(NOWHERE, time(5))),
        ),
        (
            "whenever p becomes true and stays true for at most 5 s, counting from the falling edge, ",
            s.Becomes(NOWHERE, P, s.AtMost(NOWHERE, time(5)), s.DelayReference.FALL),
        ),
        (
            "whenever p becomes true and stays true for between 1 and 5 s counting from the end of max-time, ",
            s.Becomes(NOWHERE, P, s.FromTo(NOWHERE, time(1), time(5)), s.DelayReference.MAXIMUM),
        ),
        (
            "whenever p becomes true and stays true for at least 1 h, counting from the end of the minimum time, ",
            s.Becomes(NOWHERE, P, s.AtLeast(NOWHERE, time(1, "h")), s.DelayReference.MINIMUM),
        ),
        (
            "whenever p becomes false and stays false for at most 2 ms, counting from the rise, ",
            s.Becomes(NOWHERE, Not(NOWHERE, P), s.AtMost(NOWHERE, time(2, "ms"))),
        ),
    ],
)
def test_triggers(text: str, trigger: s.Trigger) -> None:
    assert read(f"{text}q must be true.") == sentence(trigger=trigger)


@pytest.mark.parametrize(
    ("text", "delay"),
    [
        ("immediately, ", NO_DELAY),
        ("with no delay, ", NO_DELAY),
        ("within 1.5 ms, ", s.Within(NOWHERE, time("1.5", "ms"))),
        ("within 5 time units, ", s.Within(NOWHERE, time(5, ""))),
        ("between 1 and 5 minutes later, ", s.SentenceWindow(NOWHERE, time(1, "min"), time(5, "min"))),
        ("with a delay of between 1 s and 5 minutes, ", s.SentenceWindow(NOWHERE, time(1), time(5, "min"))),
        ("after 5 s, ", s.Exactly(NOWHERE, time(5))),
        ("eventually, ", s.AtSomeInstant(NOWHERE)),
    ],
)
def test_delays(text: str, delay: s.Delay) -> None:
    assert read(f"whenever p, {text}q must be true.") == sentence(trigger=s.Whenever(NOWHERE, P), delay=delay)


@pytest.mark.parametrize(
    ("text", "response"),
    [
        ("q must be false", s.MustBeTrue(NOWHERE, Not(NOWHERE, Q))),
        ("q must stay true for at least 5 s", s.MustStay(NOWHERE, Q, s.AtLeast(NOWHERE, time(5)))),
        ("q must stay true for at most 5 s", s.MustStay(NOWHERE, Q, s.AtMost(NOWHERE, time(5)))),
        ("q must stay true for between 1 and 5 s", s.MustStay(NOWHERE, Q, s.FromTo(NOWHERE, time(1), time(5)))),
        ("q must stay true until r within 5 s", s.MustStayUntil(NOWHERE, Q, R, time(5))),
        ("q must stay true until r is true, within a maximum of 5 s", s.MustStayUntil(NOWHERE, Q, R, time(5))),
        ("q must stay true until r is true", s.MustStayUntil(NOWHERE, Q, R)),
        ("q must stay true until r becomes true", s.MustStayUntil(NOWHERE, Q, Rise(NOWHERE, R))),
        ("q must stay true from then on", s.MustStayOn(NOWHERE, Q)),
        ("q must not occur", s.MustNotOccur(NOWHERE, Q)),
        ("q must not occur for 5 s", s.MustNotOccur(NOWHERE, Q, time(5))),
        ("q must have been true", s.MustHaveBeen(NOWHERE, Q)),
        ("q must have been true within the last 5 s", s.MustHaveBeen(NOWHERE, Q, time(5))),
    ],
)
def test_responses(text: str, response: s.Response) -> None:
    assert read(f"whenever p, {text}.") == sentence(trigger=s.Whenever(NOWHERE, P), response=response)


@pytest.mark.parametrize(
    ("text", "scope"),
    [
        ("globally, ", GLOBALLY),
        ("before r, ", s.BeforeScope(NOWHERE, R)),
        ("after p, ", s.After(NOWHERE, P)),
        ("after p becomes true, ", s.After(NOWHERE, Rise(NOWHERE, P))),
        ("between p and r, ", s.BetweenScope(NOWHERE, P, R)),
        ("after p until r, ", s.AfterUntil(NOWHERE, P, R)),
        ("while p, ", s.WhileScope(NOWHERE, P)),
    ],
)
def test_scopes(text: str, scope: s.Scope) -> None:
    assert read(f"{text}q must occur.") == sentence(scope=scope, response=s.MustOccur(NOWHERE, Q))
    recurring = s.MustRecur(NOWHERE, Q, time(5))
    assert read(f"{text}q must occur at least every 5 s.") == sentence(scope=scope, response=recurring)


def test_names_that_are_words_of_sentences() -> None:
    after, within = name("after"), name("within")
    expected = sentence(
        trigger=s.Whenever(NOWHERE, after),
        delay=s.Within(NOWHERE, time(5)),
        response=s.MustBeTrue(NOWHERE, within),
    )
    assert read("whenever after is true, within 5 s, within must be true.") == expected
    assert read("whenever (after) is true, within 5 s, (within) must be true.") == expected
    ranged = read("whenever within_range, P.after && must[1] > 3 must be true.")
    assert ranged.trigger == s.Whenever(NOWHERE, name("within_range"))
    seconds = read("whenever s, within s s, min must be true.")
    assert seconds.delay == s.Within(NOWHERE, Duration(NOWHERE, ast.NameExpression(NOWHERE, "s"), "s"))


@pytest.mark.parametrize(
    ("text", "completed"),
    [
        ("whenever p, q must be true", "whenever p, q must be true."),
        ("whenever p, q must be true.", "whenever p, q must be true."),
        ("whenever p, q must be true. expect holds", "whenever p, q must be true. expect holds"),
        ("A[] not deadlock", "A[] not deadlock"),
        ("G (p -> F[0, 5] q)", "G (p -> F[0, 5] q)"),
        ("P.after --> P.until", "P.after --> P.until"),
    ],
)
def test_an_argument_may_lack_its_full_stop(text: str, completed: str) -> None:
    assert with_full_stop(text) == completed


def test_quantifiers_calls_and_members() -> None:
    read("whenever forall (i : int[0, 3]) T(i).then or f(a, b) < 3, exists (i : id_t) after[i] must be true.")
    read("between P.a and Q.b, n == 1 ? x : y must be true.")


def test_a_name_in_front() -> None:
    assert read("NIWS: whenever p, q must be true.").label == "NIWS"


def test_durations_may_be_constants_and_expressions() -> None:
    delay = read("whenever p, within (2 * N) ms, q must be true.").delay
    assert isinstance(delay, s.Within)
    assert isinstance(delay.duration.value, ast.BinaryExpression)
    assert delay.duration.unit == "ms"


def test_spans_are_those_of_the_text() -> None:
    text = "xx whenever p and r, within 5 s, q must be true. yy"
    source = Source("s", text)
    found, _ = parse_sentence(Span(source, 3, text.index(" yy")))
    assert found is not None
    assert isinstance(found.trigger, s.Whenever)
    assert found.trigger.condition.span.text == "p and r"
    assert found.trigger.span.text == "whenever p and r"
    assert found.delay.span.text == "within 5 s"
    assert found.response.span.text == "q must be true"
    assert found.span.text == text[3:-3]


@pytest.mark.parametrize(
    ("text", "code", "place", "meant"),
    [
        ("when ever p, q must be true.", "E0141", "when ever", "Whenever p is true, q must be true."),
        ("whenever p, withn 5 s, q must be true.", "E0141", "withn", "Whenever p is true, within 5 s, q must be true."),
        ("whenever p, q must hold.", "E0141", "must hold", "Whenever p is true, q must be true."),
        ("whenever p, q shall be true.", "E0141", "shall be true", "Whenever p is true, q must be true."),
        ("if p then q must be true.", "E0141", "if", "Whenever p is true, q must be true."),
        ("whenever p becoms true, q must be true.", "E0141", "becoms true", "Whenever p becomes true, q must be true."),
        (
            "whenever p, with delay of at most 5 s, q must be true.",
            "E0141",
            "with delay of at most",
            "Whenever p is true, within 5 s, q must be true.",
        ),
        ("whenever p, q must be true", "E0133", "", "Whenever p is true, q must be true."),
        ("q must be true whenever p.", "E0142", "whenever p", "Whenever p is true, q must be true."),
        (
            "within 5 s, whenever p, q must be true.",
            "E0142",
            "whenever p",
            "Whenever p is true, within 5 s, q must be true.",
        ),
    ],
)
def test_near_misses_are_reported_what_was_meant(text: str, code: str, place: str, meant: str) -> None:
    found = refused(text)[0]
    assert found.code == code
    assert found.span.text == place
    assert found.help == f"did you mean: {meant}"


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("within 5 s, q must be true.", "E0143", "within 5 s"),
        ("eventually, q must be true.", "E0143", "eventually"),
        ("whenever p, within 5 s, q must not occur.", "E0144", "within 5 s"),
        ("whenever p, q must occur.", "E0144", "q must occur"),
        ("whenever p, q must occur at least every 5 s.", "E0144", "whenever p"),
        ("whenever p becomes true, counting from the fall, q must be true.", "E0144", "counting from the fall"),
        ("before r, initially, q must be true.", "E0144", "before r"),
        ("whenever p, q must be true and r must be true.", "E0144", "must"),
        ("whenever p, q must be true. whenever r, q must be true.", "E0144", "whenever"),
        ("whenever p is true and r is true, q must be true.", "E0140", "is"),
        ("whenever p, q must stay true for 5 s.", "E0140", "5"),
        ("whenever p, within 5 parsecs, q must be true.", "E0135", "parsecs"),
        ("whenever p, with a delay between 3 s and 5, q must be true.", "E0134", "5"),
        ("p must stay true for between 10 s and 20.", "E0134", "20"),
        ("whenever p, q.", "E0140", "q"),
        ("whenever p < , q must be true.", "E0101", ""),
        ("whenever F[0, 5] p, q must be true.", "E0146", "F[0, 5] p"),
        ("between p and q and r, p must be true.", "E0145", "between p and q and r, p must be true."),
        ("whenever (p, q must be true.", "E0113", "("),
        ("whenever “p, q must be true.", "E0004", "“"),
        ("", "E0006", ""),
        (".", "E0140", "."),
    ],
)
def test_what_has_no_meaning_is_rejected_at_its_place(text: str, code: str, place: str) -> None:
    found = refused(text)[0]
    assert (found.code, found.span.text) == (code, place)


def test_both_readings_of_an_ambiguous_sentence_are_shown() -> None:
    help = refused("between p and q and r, p must be true.")[0].help
    assert help is not None
    assert "Between p && q and r, p must be true." in help
    assert "Between p and q && r, p must be true." in help


@pytest.mark.parametrize("code", sorted(SENTENCE_CODES))
def test_examples_of_explanations(code: str) -> None:
    explanation = SENTENCE_CODES[code]
    assert code in {found.code for found in refused(explanation.bad)}
    read(explanation.good)


def test_a_long_text_is_rejected_in_time() -> None:
    refused("whenever " + "p and " * 60 + "q must be true and between a and b and must be true")
    assert refused("between and after until " * 100 + ".")[0].code == "E0111"
    refused("between and after until within whenever then " * 25 + ".")
