"""Questions about the probabilities of runs, with their names resolved: what UPPAAL calls statistical queries."""

from __future__ import annotations

from enum import StrEnum
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.base.span import NOWHERE, Span
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.run_formulas import RunFormula


class Scale(StrEnum):
    """The unit of the bound of a run."""

    TIME = "time"
    STEPS = "steps"
    CLOCK = "clock"


@dataclass(frozen=True, slots=True)
class RunBound:
    """The bound of a run: the time, the number of transitions or the clock is at most ``limit``.

    Attributes:
        beyond: for a hybrid clock the condition that it is larger than the limit. Then there is no ``clock``.
    """

    scale: Scale
    limit: Fraction
    clock: Expression | None = None
    beyond: Expression | None = None


@dataclass(frozen=True, slots=True)
class Path:
    """The property that is evaluated on each run.

    Attributes:
        runs: how many are to be drawn, if the query says it.
        predicate: what becomes true, or with ``always`` stays true, within the bound.
        before: of ``p U q``: what is true until then.
        since: the predicate counts from this moment on, and with ``always`` need not be true earlier.
    """

    bound: RunBound
    runs: int | None
    always: bool
    predicate: Expression
    before: Expression | None = None
    since: int = 0


@dataclass(frozen=True, slots=True)
class FormulaPath:
    """A formula with several temporal operators, which is true or false on each run.

    Attributes:
        bound: a time, at which runs end. What a run leaves open then is unknown.
        runs: how many are to be drawn, if the query says it.
    """

    bound: RunBound
    runs: int | None
    formula: RunFormula

    @property
    def always(self) -> bool:
        """As of `Path`: violations are never counted here."""
        return False


PathProperty = Path | FormulaPath


@dataclass(frozen=True, slots=True)
class Probability:
    """``Pr[<=T](<> p)``: how probable is it?"""

    path: PathProperty


@dataclass(frozen=True, slots=True)
class Threshold:
    """``Pr[<=T](<> p) >= 0.9``: is it at least (or at most) so probable?"""

    path: PathProperty
    at_least: bool
    probability: float


@dataclass(frozen=True, slots=True)
class ProbabilityComparison:
    """``Pr[<=T](<> p) >= Pr[<=S](<> q)``: is the first at least as probable?"""

    first: PathProperty
    second: PathProperty


@dataclass(frozen=True, slots=True)
class ExpectedValue:
    """``E[<=T; N](max: e)``: the mean, over all runs, of the largest or least value on the run."""

    bound: RunBound
    runs: int | None
    largest: bool
    value: Expression


@dataclass(frozen=True, slots=True)
class Trajectories:
    """``simulate [<=T; N] {e, f} : k : p``: how values go on some runs.

    Attributes:
        runs: how many are drawn.
        condition: only runs on which it becomes true within the bound are shown; None: all.
        most: so many of these.
    """

    bound: RunBound
    runs: int
    values: tuple[Expression, ...]
    condition: Expression | None = None
    most: int | None = None


Question = Probability | Threshold | ProbabilityComparison | ExpectedValue | Trajectories


@dataclass(frozen=True, slots=True)
class StatisticalQuery:
    """A question with its name, as `tachk.model.query.Query` has them.

    Attributes:
        network: where it is another one than that of the model: clocks that the query computes with are hybrid there.
    """

    name: str
    question: Question
    text: str
    title: str = ""
    span: Span = NOWHERE
    network: Network | None = None

    def __repr__(self) -> str:
        return f"<StatisticalQuery {self.name}: {self.text}>"
