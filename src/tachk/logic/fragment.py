"""STL_{lb=0}: the formulas that one automaton with one clock for each operator can watch.

    f ::= true | c | !f | f && f | f || f | f -> f | F[0,b] f | G[0,b] f | f U[0,b] f

where c is a condition on one instant (the edges ``rise``, ``fall`` and ``change`` of conditions are ones too), and the
whole formula may be ``G f``, or a conjunction of such formulas. Every interval begins now: of all awaited responses the
oldest is then the most urgent. With a lower bound above 0 several are open at different ages. Observers
(`tachk.logic.observer.construction`) exist for formulas beyond this fragment as well.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from tachk.base.span import Span
from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Change,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Once,
    Or,
    Rise,
    Since,
    TruthConstant,
    Until,
    WeakUntil,
    operands,
)
from tachk.syntax.formulas.printer import print_formula, print_interval
from tachk.syntax.walk import nodes_of_kind

_TEMPORAL = (Eventually, Always, Until, WeakUntil, Once, Historically, Since)


@dataclass(frozen=True, slots=True)
class Offence:
    """The first part of a formula that is not in the fragment.

    Attributes:
        formula: the smallest subformula that shows it.
        reason: why, as a clause that makes sense after "it is not in STL_{lb=0}:".
    """

    formula: Formula
    reason: str

    @property
    def span(self) -> Span:
        return self.formula.span


def outside_fragment(formula: Formula) -> Offence | None:
    """The first subformula that is not in STL_{lb=0}, in the order of the text; None if there is none.

    Bounds that are not numbers yet count as what they are: not known to be 0.
    """
    return next(_offences(formula, top=True), None)


def _offences(formula: Formula, top: bool = False) -> Iterator[Offence]:
    match formula:
        case TruthConstant() | Atom() | Change():
            return
        case And(operands=parts) if top:
            for part in parts:
                yield from _offences(part, top=True)
            return
        case Always(interval=interval, operand=operand) if top and interval.upper is None and _from_now(interval):
            yield from _offences(operand)
            return
        case Rise(operand=operand) | Fall(operand=operand):
            inner = next(iter(nodes_of_kind(operand, *_TEMPORAL)), None)
            if inner is not None:
                word = "rise" if isinstance(formula, Rise) else "fall"
                yield Offence(
                    formula, f"'{word}' is about the temporal formula {print_formula(inner)}, not a condition"
                )
                return
        case WeakUntil():
            yield Offence(formula, "'W' has no end")
        case Once() | Historically() | Since():
            yield Offence(formula, "it looks back")
        case Eventually(interval=interval) | Always(interval=interval) | Until(interval=interval):
            reason = _why_not(interval)
            if reason is not None:
                yield Offence(formula, reason)
        case Not() | And() | Or() | Implies():
            pass
    for part in operands(formula):
        yield from _offences(part)


def _why_not(interval: Interval) -> str | None:
    if not _from_now(interval):
        shown = print_interval(interval)
        left_out = interval.lower.value == 0
        return (
            f"its interval {shown} leaves out the present" if left_out else f"its interval {shown} does not begin at 0"
        )
    if interval.upper is None:
        return "its interval has no upper bound, which only an outermost G may lack"
    return None


def _from_now(interval: Interval) -> bool:
    value = interval.lower.value
    return isinstance(value, Fraction) and value == 0 and interval.lower_closed
