"""Where it makes no difference, or has no meaning yet, that only those infinite runs count in which time diverges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.words import QueryKind
from tachk.model.query import Query
from tachk.verify.plan import Analysis, analysis_of
from tachk.verify.verdict import Verdict

_NO_DIFFERENCE = "--non-zeno makes no difference here: every state counts that some run reaches"


def check_combination(query: Query) -> None:
    """Raises UnsupportedError for a deadline since the left side of ``-->``: nobody may act once it is kept."""
    if query.non_zeno and query.deadline is not None and query.kind is QueryKind.LEADS_TO:
        raise UnsupportedError(
            Diagnostic(
                "E0720",
                "queries with `-->[<= t]` are not checked with --non-zeno",
                query.span,
                "the formula G (p -> F[0, t] q) asks nearly the same of runs of any kind",
            )
        )


def noted(verdicts: Sequence[Verdict]) -> tuple[Verdict, ...]:
    """The verdicts, those with a note whose answer the runs do not decide."""
    return tuple(map(_noted, verdicts))


def _noted(verdict: Verdict) -> Verdict:
    query = verdict.query
    if not query.non_zeno or verdict.unsupported is not None or analysis_of(query) is Analysis.LIVENESS:
        return verdict
    return replace(verdict, notes=(*verdict.notes, _NO_DIFFERENCE))
