"""What sentences mean: the tables of formulas, and, on random traces, what they say in plain words."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from random import Random

import pytest

from tachk.base.span import Source
from tachk.logic.patterns import patterns
from tachk.logic.sentences import meaning
from tachk.syntax.formula import Formula
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.sentences.parser import parse_sentence
from tachk.syntax.sentences.printer import print_sentence
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import ExactTrace, pulses

Runs = list[tuple[int, int]]

END = 26
"""The random traces end here; nothing happens after `QUIET`, so that every window is decided."""

QUIET = 14


def meant(text: str) -> Formula:
    sentence, found = parse_sentence(Source("s", text))
    assert sentence is not None, [diagnostic.message for diagnostic in found]
    return meaning(sentence)


PREPRINT = {
    "ECFS": ("true", "of at most 180 seconds", "allToAgent", "G F[0, 180 s] allToAgent"),
    "ECRA": ("true", "of at most 180 seconds", "allToClient", "G F[0, 180 s] allToClient"),
    "NIWS": ("sleep", "between 0 seconds and 50 seconds", "not arrive", "G (sleep -> F[0, 50 s] !arrive)"),
    "RMIO": ("tenthAtAgent", "", "TDDSisSent", "G (tenthAtAgent -> TDDSisSent)"),
    "RMIO2": ("tenthAtClient", "", "FDDSisSent", "G (tenthAtClient -> FDDSisSent)"),
    "TMRK": ("lost", "between 0 seconds and 20 seconds", "marked", "G (lost -> F[0, 20 s] marked)"),
    "FARS": ("behind", "between 0 seconds and 20 seconds", "caughtUp", "G (behind -> F[0, 20 s] caughtUp)"),
}
"""The seven sentences of the preprint with its words; only the signals, which it leaves out, are named here."""


@pytest.mark.parametrize("name", PREPRINT)
def test_the_sentences_of_the_preprint_are_read_word_for_word(name: str) -> None:
    trigger, delay, response, formula = PREPRINT[name]
    with_delay = f"with a delay {delay}" if delay else "with no delay"
    text = f"At any point of time, whenever {trigger} is true, {with_delay}, {response} must be true."
    expected, _ = parse_formula(Source("f", formula))
    assert meant(text) == expected
    assert print_formula(meant(text)) == formula


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("At any point of time, x must always be less than 5.", "G (x < 5)"),
        ("x must always be less than or equal to 5.", "G (x <= 5)"),
        ("x + 1 must be greater than y.", "G (x + 1 > y)"),
        ("x must always be greater than or equal to 5.", "G (x >= 5)"),
        ("whenever p, within d, x must be at most 5.", "G (p -> F[0, d] (x <= 5))"),
        ("x must be at least 5.", "G (x >= 5)"),
        ("x must always be inside 2 and 5.", "G (2 <= x && x <= 5)"),
        ("x must always be outside 2 and 5.", "G (x < 2 || x > 5)"),
    ],
)
def test_bounds_checks(text: str, formula: str) -> None:
    expected, _ = parse_formula(Source("f", formula))
    assert meant(text) == expected


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("c must be true.", "G c"),
        ("whenever p, q must be true.", "G (p -> q)"),
        ("whenever p, within d, q must be true.", "G (p -> F[0, d] q)"),
        ("whenever p becomes true, within d, q must be true.", "G (rise(p) -> F[0, d] q)"),
        ("whenever p, between a and b later, q must be true.", "G (p -> F[a, b] q)"),
        ("whenever p, after a, q must be true.", "G (p -> F[a, a] q)"),
        ("whenever p, q must stay true for at least m.", "G (p -> G[0, m) q)"),
        ("whenever p, within d, q must stay true for at least m.", "G (p -> F[0, d] G[0, m) q)"),
        ("whenever p, within d, q must stay true for at most m.", "G (p -> F[0, d] (q && F(0, m] !q))"),
        (
            "whenever p, within d, q must stay true for between m and M.",
            "G (p -> F[0, d] (G[0, m) q && F[m, M] !q))",
        ),
        ("whenever p, within d, q must stay true until u within M.", "G (p -> F[0, d] (q U[0, M] u))"),
        ("whenever p, q must not occur for d.", "G (p -> G[0, d] !q)"),
        ("whenever p, q must stay true until u within M.", "G (p -> q U[0, M] u)"),
        ("q must occur at least every d.", "G F[0, d] q"),
        ("initially, within d, q must be true.", "F[0, d] q"),
        ("whenever p becomes true, p must stay true for at least m.", "G (rise(p) -> G[0, m) p)"),
        ("whenever p becomes true, p must stay true for at most M.", "G (rise(p) -> F(0, M] !p)"),
        ("whenever p, q must have been true.", "G (p -> O q)"),
        ("whenever p, q must have been true within the last d.", "G (p -> O[0, d] q)"),
        ("after Q, p must not occur.", "G (O Q -> !p)"),
        ("between Q and R, p must not occur.", "G (Q && !R && F R -> !p U R)"),
        ("after Q until R, p must not occur.", "G (Q && !R -> !p W R)"),
        ("before R, p must not occur.", "F R -> !p U R"),
        ("whenever x changes, within d, q must be true.", "G (change(x) -> F[0, d] q)"),
        ("whenever p and q or not r becomes true, p must be false.", "G (rise(p && q || !r) -> !p)"),
        # the readings of NIWS
        ("whenever sleep, arrive must not occur.", "G (sleep -> !arrive)"),
        ("whenever sleep, within 50, not arrive must be true.", "G (sleep -> F[0, 50] !arrive)"),
        ("whenever sleep becomes true, arrive must not occur for 50.", "G (rise(sleep) -> G[0, 50] !arrive)"),
        # the paper's wording
        (
            "At any point of time, whenever true is true, with a delay of at most 180 seconds, done must be true.",
            "G F[0, 180 s] done",
        ),
        (
            "At any point of time, whenever s is true, with a delay of between 0 and 50 seconds, not a must be true.",
            "G (s -> F[0, 50 s] !a)",
        ),
        ("whenever n == 10 is true then, with no delay, sent == toDDS must be true.", "G (n == 10 -> sent == toDDS)"),
    ],
)
def test_table_of_formulas(text: str, formula: str) -> None:
    expected, found = parse_formula(Source("f", formula))
    assert found == ()
    assert print_formula(meant(text)) == formula
    assert meant(text) == expected


@pytest.mark.parametrize("pattern", patterns(), ids=lambda pattern: pattern.name)
def test_catalogue(pattern) -> None:  # type: ignore[no-untyped-def]
    assert print_formula(pattern.tree) == pattern.formula
    assert print_sentence(pattern.sentence) == pattern.example


# ---- in plain words ------------------------------------------------------------------------------------------------


def random_runs(random: Random, most: int = 3) -> Runs:
    """Disjoint intervals [begin, end) that do not touch."""
    edges = sorted(random.sample(range(QUIET), 2 * random.randrange(most + 1)))
    return list(zip(edges[::2], edges[1::2], strict=True))


def trace_of(**signals: Runs) -> ExactTrace:
    return pulses(END, **{name: [(a, b) for a, b in runs] for name, runs in signals.items()})


def answer(text: str, trace: ExactTrace) -> bool | None:
    return verdict(meant(text), trace).truth


def some_in(runs: Runs, first: int, last: int) -> bool:
    """Whether some instant of the closed window is in a run."""
    return any(begin <= last and first < end for begin, end in runs)


AT_LEAST, AT_MOST, BETWEEN = "at least 3", "at most 5", "between 3 and 5"
LASTS: dict[str, Callable[[int], bool]] = {
    AT_LEAST: lambda length: length >= 3,
    AT_MOST: lambda length: length <= 5,
    BETWEEN: lambda length: 3 <= length <= 5,
}
INSTANTS: dict[str, Callable[[int, int], int]] = {
    "the rise": lambda begin, end: begin,
    "the fall": lambda begin, end: end,
    "the end of min time": lambda begin, end: begin + 3,
    "the end of max time": lambda begin, end: begin + 5,
}
REFERENCES = [
    *((AT_LEAST, "the rise"), (AT_LEAST, "the end of min time")),
    *((AT_MOST, "the rise"), (AT_MOST, "the fall"), (AT_MOST, "the end of max time")),
    *((BETWEEN, "the rise"), (BETWEEN, "the fall"), (BETWEEN, "the end of min time"), (BETWEEN, "the end of max time")),
]


@pytest.mark.parametrize(("lasting", "instant"), REFERENCES)
def test_triggers_that_last(lasting: str, instant: str) -> None:
    text = (
        f"whenever p becomes true and stays true for {lasting}, counting from {instant}, between 1 and 2 later, "
        "q must be true."
    )
    random = Random(7)
    answers = set()
    for _ in range(12):
        p, q = random_runs(random), random_runs(random, 5)
        instants = [INSTANTS[instant](*run) for run in p if LASTS[lasting](run[1] - run[0])]
        expected = all(some_in(q, at + 1, at + 2) for at in instants)
        assert answer(text, trace_of(p=p, q=q)) is expected, (p, q)
        answers.add(expected)
    assert answers == {True, False}


@pytest.mark.parametrize("lasting", LASTS)
def test_durations_of_segments(lasting: str) -> None:
    text = f"whenever p becomes true, p must stay true for {lasting}."
    random = Random(8)
    answers = set()
    for _ in range(12):
        p = random_runs(random, 3)
        expected = all(LASTS[lasting](end - begin) for begin, end in p)
        assert answer(text, trace_of(p=p)) is expected, p
        answers.add(expected)
    assert answers == {True, False}


Cells = list[bool]


def cells(runs: Runs) -> Cells:
    """The value at every instant 0, 1, ... and in the open intervals between them."""
    return [any(2 * a <= cell < 2 * b for a, b in runs) for cell in range(2 * END + 1)]


def segments(start: Cells, end: Cells, open_ended: bool) -> list[range]:
    """From each cell with the start and not the end up to before the next end."""
    found = []
    for first in range(len(start)):
        if start[first] and not end[first]:
            last = next((cell for cell in range(first, len(end)) if end[cell]), None)
            if last is not None:
                found.append(range(first, last))
            elif open_ended:
                found.append(range(first, len(end)))
    return found


def stretches(value: Cells) -> list[range]:
    begins = [c for c in range(len(value)) if value[c] and (c == 0 or not value[c - 1])]
    return [range(b, next((c for c in range(b, len(value)) if not value[c]), len(value))) for b in begins]


def in_scope(scope: str, start: Cells, end: Cells) -> list[range]:
    """The parts of the trace that a scope speaks about."""
    whole = range(len(start))
    first = next((c for c in whole if start[c]), None)
    stop = next((c for c in whole if end[c]), None)
    match scope:
        case "globally":
            return [whole]
        case "before R":
            return [] if stop is None else [range(stop)]
        case "after Q":
            return [] if first is None else [range(first, len(start))]
        case "between Q and R":
            return segments(start, end, False)
        case "after Q until R":
            return segments(start, end, True)
        case _:
            return stretches(start)


SCOPES = ("globally", "before R", "after Q", "between Q and R", "after Q until R", "while Q")


@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize(
    "pattern",
    [
        *("absence", "universality", "existence", "bounded existence", "precedence", "response", "recurrence"),
        *("invariance", "maximum duration"),
    ],
)
def test_patterns_in_scopes(pattern: str, scope: str) -> None:
    text = {
        "absence": "p must not occur.",
        "universality": "p must be true.",
        "existence": "p must occur.",
        "precedence": "whenever p, q must have been true.",
        "response": "whenever p, within 3, q must be true.",
        "recurrence": "p must occur at least every 4.",
        "bounded existence": "p must occur within 3.",
        "invariance": "whenever p is true, q must stay true for at least 3.",
        "maximum duration": "whenever p becomes true, p must stay true for at most 3.",
    }[pattern]
    random = Random(9)
    answers = set()
    for number in range(200):
        if number >= 12 and answers == {True, False}:
            break
        runs = {"p": random_runs(random), "q": random_runs(random), "R": random_runs(random, 2)}
        runs["Q"] = random_runs(random, 2)
        if random.random() < 0.4:
            # Else what must be true all the time, or come first, hardly ever is.
            runs["p"], runs["q"] = [(0, END + 9)], runs["p"]
        if random.random() < 0.2:
            runs["p"] = []
        p, q, start, end = (cells(runs[name]) for name in ("p", "q", "Q", "R"))
        parts = in_scope(scope, start, end)
        if pattern == "existence" and scope == "before R" and not any(end):
            parts = []

        def holds(part: range, p: Cells = p, q: Cells = q) -> bool:
            match pattern:
                case "absence":
                    return not any(p[c] for c in part)
                case "universality":
                    return all(p[c] for c in part)
                case "existence":
                    return any(p[c] for c in part)
                case "precedence":
                    begin = 0 if scope == "while Q" else part.start
                    return all(any(q[begin : c + 1]) for c in part if p[c])
                case "response":
                    stop = len(q) if scope in ("globally", "after Q", "while Q") else part.stop
                    return all(any(q[c : min(c + 7, stop)]) for c in part if p[c])
                case "bounded existence":
                    return any(p[part.start : min(part.start + 7, part.stop)])
                case "invariance":
                    stop = len(q) if scope in ("globally", "after Q", "while Q") else part.stop
                    return all(all(q[c : min(c + 6 + c % 2, stop)]) for c in part if p[c])
                case "maximum duration":
                    rises = [c for c in part if p[c] and (c == 0 or not p[c - 1])]
                    over = part.stop if scope not in ("globally", "after Q", "while Q") else len(p)
                    return all(over <= c + 6 or not all(p[c + 1 : c + 7]) for c in rises)
                case _:
                    return all(c + 9 > part.stop + (part.stop == len(p)) * 99 or any(p[c : c + 9]) for c in part)

        if pattern == "recurrence" and any(part.stop == len(p) for part in parts):
            continue
        if pattern in ("response", "invariance", "maximum duration") and any(p[-8:]):
            continue
        expected = all(holds(part) for part in parts)
        assert answer(f"{scope}, {text}", trace_of(**runs)) is expected, runs
        answers.add(expected)
    assert answers == {True, False} or (pattern, scope) in {("recurrence", "globally"), ("recurrence", "after Q")}


def test_the_readings_of_a_silent_sleep_differ() -> None:
    """A message one second after the beginning of a sleep, and one after waking up."""
    trace = pulses(200, sleep=[(10, 60)], arrive=[(11, 12), (Fraction(121, 2), 61)])
    assert answer("whenever sleep, within 50, not arrive must be true.", trace) is True
    assert answer("whenever sleep, arrive must not occur.", trace) is False
    late = pulses(200, sleep=[(10, 40)], arrive=[(50, 51)])
    assert answer("whenever sleep, arrive must not occur.", late) is True
    assert answer("whenever sleep becomes true, arrive must not occur for 50.", late) is False
