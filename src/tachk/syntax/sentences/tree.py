"""The tree of a sentence: a requirement in English with a scope, a trigger, a delay and a response.

``After Q, whenever p becomes true, within 5 s, q must be true.`` is ``Sentence(After(Q), Becomes(p), Within(5 s),
MustBeTrue(q))``. What it means is the business of `tachk.logic.sentences`. Conditions are formulas about one state:
atoms, connectives, and the edges ``rise``, ``fall`` and ``change``. Different wordings of one thing have one tree:
``is false`` is a negated condition, ``with a delay of at most`` is `Within`.
"""

from __future__ import annotations

from enum import StrEnum

from tachk.base.records import dataclass
from tachk.syntax.ast import Expression, Node
from tachk.syntax.formula import Duration, Formula

Condition = Formula
"""A formula without temporal operators other than ``rise``, ``fall`` and ``change``."""


# ---- spans of time ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class AtLeast(Node):
    duration: Duration


@dataclass(frozen=True, slots=True)
class AtMost(Node):
    duration: Duration


@dataclass(frozen=True, slots=True)
class FromTo(Node):
    """``between lower and upper``, both included."""

    lower: Duration
    upper: Duration


Lasting = AtLeast | AtMost | FromTo
"""The time for which a condition stays true."""


# ---- scopes -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Globally(Node):
    """The whole run."""


@dataclass(frozen=True, slots=True)
class BeforeScope(Node):
    """From the start to the first ``end``; nothing is demanded of runs without one."""

    end: Condition


@dataclass(frozen=True, slots=True)
class After(Node):
    """From the first ``start`` on."""

    start: Condition


@dataclass(frozen=True, slots=True)
class BetweenScope(Node):
    """From each ``start`` to the next ``end``; nothing is demanded where there is none."""

    start: Condition
    end: Condition


@dataclass(frozen=True, slots=True)
class AfterUntil(Node):
    """From each ``start`` to the next ``end``, or for ever where there is none."""

    start: Condition
    end: Condition


@dataclass(frozen=True, slots=True)
class WhileScope(Node):
    """The instants at which ``condition`` is true."""

    condition: Condition


Scope = Globally | BeforeScope | After | BetweenScope | AfterUntil | WhileScope


# ---- triggers -----------------------------------------------------------------------------------------------------


class DelayReference(StrEnum):
    """The instant of a run of the trigger's condition from which the delay is counted."""

    RISE = "rise"
    FALL = "fall"
    MINIMUM = "minimum"
    MAXIMUM = "maximum"


@dataclass(frozen=True, slots=True)
class AtEveryInstant(Node):
    """Every instant of the scope."""


@dataclass(frozen=True, slots=True)
class Initially(Node):
    """The first instant."""


@dataclass(frozen=True, slots=True)
class Whenever(Node):
    """Every instant at which the condition is true."""

    condition: Condition


@dataclass(frozen=True, slots=True)
class Becomes(Node):
    """One instant of every run of the condition, or of every run that lasts as long as demanded."""

    condition: Condition
    lasting: Lasting | None = None
    reference: DelayReference = DelayReference.RISE


@dataclass(frozen=True, slots=True)
class ChangeInstants(Node):
    """Every instant at which the value of an expression becomes another."""

    expression: Expression


Trigger = AtEveryInstant | Initially | Whenever | Becomes | ChangeInstants


# ---- delays -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NoDelay(Node):
    pass


@dataclass(frozen=True, slots=True)
class Within(Node):
    """At some instant from now to a duration ahead."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class SentenceWindow(Node):
    """At some instant between two durations ahead."""

    lower: Duration
    upper: Duration


@dataclass(frozen=True, slots=True)
class Exactly(Node):
    """At the instant a duration ahead."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class AtSomeInstant(Node):
    """At some later instant, or now."""


Delay = NoDelay | Within | SentenceWindow | Exactly | AtSomeInstant


# ---- responses ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MustBeTrue(Node):
    condition: Condition


@dataclass(frozen=True, slots=True)
class MustStay(Node):
    condition: Condition
    lasting: Lasting


@dataclass(frozen=True, slots=True)
class MustStayUntil(Node):
    """Until ``end``, which comes at the latest after a duration, if one is given."""

    condition: Condition
    end: Condition
    within: Duration | None = None


@dataclass(frozen=True, slots=True)
class MustStayOn(Node):
    """From then on, to the end of the scope."""

    condition: Condition


@dataclass(frozen=True, slots=True)
class MustNotOccur(Node):
    """At that instant, or at no instant from then until a duration later."""

    condition: Condition
    duration: Duration | None = None


@dataclass(frozen=True, slots=True)
class MustOccur(Node):
    """Once in the scope, or within a duration from its start."""

    condition: Condition
    within: Duration | None = None


@dataclass(frozen=True, slots=True)
class MustRecur(Node):
    """Again and again, at most a period apart."""

    condition: Condition
    period: Duration


@dataclass(frozen=True, slots=True)
class MustHaveBeen(Node):
    """At some earlier instant, or now; within a duration back, if one is given."""

    condition: Condition
    within: Duration | None = None


Response = MustBeTrue | MustStay | MustStayUntil | MustStayOn | MustNotOccur | MustOccur | MustRecur | MustHaveBeen


@dataclass(frozen=True, slots=True)
class Sentence(Node):
    """Attributes:
    label: the name in front of the sentence, ``label: ...``, or nothing.
    """

    scope: Scope
    trigger: Trigger
    delay: Delay
    response: Response
    label: str = ""
