"""Small cases on which monitors are known to differ, with the answers that the definitions give."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from tachk.base.span import Source
from tachk.syntax import formula as syntax
from tachk.syntax.formulas.parser import parse_formula
from tests.support.exact_trace import ExactTrace, pulses


@dataclass(frozen=True, slots=True)
class TrickyCase:
    """Attributes:
    about: what it is that goes wrong.
    instant: at which the formula is judged.
    truth: None where the trace does not decide.
    """

    name: str
    about: str
    formula: str
    trace: ExactTrace
    instant: Fraction
    truth: bool | None

    @property
    def at_start(self) -> str:
        """The formula that says at time 0 what `formula` says at the instant."""
        return self.formula if self.instant == 0 else f"G[{self.instant},{self.instant}] ({self.formula})"


def read_formula(text: str) -> syntax.Formula:
    """Raises ValueError if the text is not a formula."""
    formula, diagnostics = parse_formula(Source("formula", text))
    if formula is None:
        raise ValueError("; ".join(diagnostic.message for diagnostic in diagnostics))
    return formula


def _case(name: str, about: str, formula: str, trace: ExactTrace, truth: bool | None, instant: int = 0) -> TrickyCase:
    return TrickyCase(name, about, formula, trace, Fraction(instant), truth)


def _rows(end: int, *rows: tuple[int, bool, bool]) -> ExactTrace:
    return ExactTrace(
        tuple(Fraction(time) for time, _, _ in rows),
        {"p": tuple(p for _, p, _ in rows), "q": tuple(q for _, _, q in rows)},
        Fraction(end),
    )


_END_CUTS_WINDOW = pulses(400, p=[(390, 391)], q=[])

TRICKY_CASES = (
    _case(
        "C01",
        "the upper bound belongs to the window",
        "p -> F[0,180] q",
        pulses(400, p=[(0, 1)], q=[(180, 181)]),
        True,
    ),
    _case(
        "C02",
        "one beyond the upper bound is too late",
        "p -> F[0,180] q",
        pulses(400, p=[(0, 1)], q=[(181, 182)]),
        False,
    ),
    _case("C03", "a pulse does not hold at its end", "F[2,5] q", pulses(400, q=[(10, 12)]), False, 10),
    _case("C04", "now belongs to the window", "p -> F[0,20] q", pulses(400, p=[(5, 6)], q=[(5, 6)]), True, 5),
    _case("C05", "the trace ends before the deadline", "p -> F[0,180] q", _END_CUTS_WINDOW, None, 390),
    _case("C06", "the trace ends before absence is certain", "p -> G[0,50] !q", _END_CUTS_WINDOW, None, 390),
    _case(
        "C07",
        "the first of two triggers is missed",
        "G[0,200] (p -> F[0,180] q)",
        pulses(400, p=[(0, 1), (100, 101)], q=[(270, 271)]),
        False,
    ),
    _case(
        "C08",
        "the second of two windows is hit",
        "G[0,100] (p -> G[0,50] !q)",
        pulses(400, p=[(0, 1), (30, 31)], q=[(70, 71)]),
        False,
    ),
    _case("C09", "recurrence is not existence", "G[0,400] F[0,180] q", pulses(600, q=[(300, 600)]), False),
    _case(
        "C10",
        "a pulse between two seconds",
        "F[0,20] q",
        pulses(400, q=[(Fraction(41, 4), Fraction(21, 2))]),
        True,
    ),
    _case("C11", "a window of one instant", "F[5,5] q", pulses(400, q=[(5, 6)]), True),
    _case("C12", "absence up to the bound, included", "G[0,5] !q", pulses(400, q=[(5, 6)]), False),
    _case("C13", "until is half-open", "p U[0,10] q", pulses(400, p=[(0, 5)], q=[(5, 6)]), True),
    _case("C14", "until begins now, not at its lower bound", "p U[3,10] q", pulses(400, p=[(2, 9)], q=[(5, 6)]), False),
    _case("C15", "nested windows reach beyond the end", "G[0,10] F[0,5] q", pulses(12, q=[(3, 4), (8, 9)]), None),
    _case("C16", "once over nothing", "O[2,5] q", pulses(400, q=[(0, 400)]), False, 1),
    _case("C17", "historically over nothing", "H[2,5] q", pulses(400, q=[]), True, 1),
    _case(
        "C18",
        "the last of two rows for one instant counts",
        "G[0,10] (p -> q)",
        _rows(10, (0, False, False), (5, True, False), (5, True, True)),
        True,
    ),
    _case(
        "C19",
        "values are held, not interpolated",
        "F[0,6] x > 5",
        ExactTrace((Fraction(0), Fraction(10)), {"x": (Fraction(0), Fraction(10))}, Fraction(10)),
        False,
    ),
    _case(
        "C20", "what is true at the beginning has risen", "G[0,10] (rise(p) -> q)", pulses(10, p=[(0, 11)], q=[]), False
    ),
)
"""The names are those of docs/logic.md."""
