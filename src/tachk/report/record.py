"""The record of one verification run: the input of every report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.records import dataclass, field
from tachk.base.span import NOWHERE, Span
from tachk.engine.options import Limits, Options
from tachk.model.network import Network
from tachk.verify.verdict import Verdict

if TYPE_CHECKING:
    from tachk.simulation.statistics.answers import StatisticalAnswer


@dataclass(frozen=True, slots=True)
class NotChecked:
    """A formula of the model or the query file that tachk does not check, and why.

    Attributes:
        reason: ``"game query"``, or the first of the diagnostics.
        diagnostics: what is wrong with it; empty if it belongs to another kind of analysis.
        span: where it stands.
        number: its place among all formulas of the run, checked or not, from 1.
    """

    name: str
    text: str
    reason: str
    diagnostics: tuple[Diagnostic, ...] = ()
    title: str = ""
    span: Span = NOWHERE
    number: int = 0

    @property
    def is_wrong(self) -> bool:
        """True if it has a mistake, other than needing what is not supported."""
        return any(not diagnostic.is_unsupported for diagnostic in self.diagnostics)


@dataclass(frozen=True, slots=True)
class NotRead:
    """A model about which nothing can be said, for it, a query or an option is wrong: reports list it.

    Attributes:
        model: the path as the user gave it; empty where the command names no model.
        message: what is wrong, in one line.
        help: how to mend it, where ``diagnostics`` do not say it.
        diagnostics: every finding that has a place in a text.
    """

    model: str
    message: str
    help: str | None = None
    diagnostics: tuple[Diagnostic, ...] = ()


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Attributes:
    model: the path of the model as the user gave it.
    verdicts: one for each query, in order.
    definitions: the names of the constants that were set from outside.
    network: of a model with refusals only its constants and time unit.
    refusals: the constructs of the model that tachk does not check.
    runs: whether the runs behind the answers were requested.
    not_checked: the game and scenario queries met, which have no influence on success, and wrong queries of other
        programs' files.
    estimates: one for each statistical query, in order.
    """

    model: str
    network: Network
    verdicts: tuple[Verdict, ...]
    not_checked: tuple[NotChecked, ...] = ()
    options: Options = field(default_factory=Options)
    limits: Limits = field(default_factory=Limits)
    definitions: tuple[str, ...] = ()
    refusals: tuple[Diagnostic, ...] = ()
    runs: bool = True
    estimates: tuple[StatisticalAnswer, ...] = ()

    def leaves_the_model(self, verdict: Verdict) -> bool:
        """True if an answer is another than the model expects while the model does not speak of these constants:
        values came from outside, and the expectation does not depend on them."""
        said = verdict.query.expectation is not None and not verdict.query.conditional
        return verdict.met is False and said and bool(self.definitions)

    @property
    def blocking(self) -> tuple[Diagnostic, ...]:
        """The refusals, where some query needs what is refused: statistical ones may be answered all the same."""
        answered = self.estimates and all(answer.found is not None for answer in self.estimates)
        return () if answered and not self.verdicts else self.refusals

    @property
    def nothing_checked(self) -> bool:
        """There are queries, and none of them is of a kind that is checked."""
        return bool(self.not_checked) and not self.verdicts and not self.estimates

    @property
    def met(self) -> bool | None:
        """True if every expectation is met; False if one is not; else None, as an answer is unknown, something in the
        model is refused, or nothing was checked."""
        met = [*(verdict.met for verdict in self.verdicts), *(answer.met for answer in self.estimates)]
        if False in met:
            return False
        wrong_queries = any(query.diagnostics for query in self.not_checked)
        open_ = self.blocking or wrong_queries or self.nothing_checked
        return None if open_ or None in met else True
