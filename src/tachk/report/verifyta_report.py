"""The lines that UPPAAL's verifyta prints, for scripts that look for them.

Every formula counts in the numbering, checked or not. What verifyta would not say stands behind ``tachk:``, and never
holds words that scripts take for a verdict.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, assert_never

from tachk.base.span import Span
from tachk.engine.options import SearchOrder
from tachk.model.run import Ending, TimedTrace
from tachk.report.extreme_text import verifyta_values
from tachk.report.record import NotChecked, RunRecord
from tachk.report.run.verifyta_trace import concrete_trace
from tachk.report.run_formats import ReportWriter
from tachk.report.verifyta_notes import harmless, memory_lines, note
from tachk.verify.verdict import Answer, Verdict

if TYPE_CHECKING:
    from tachk.simulation.statistics.answers import StatisticalAnswer

_ORDERS = {
    SearchOrder.AUTO: "breadth first",
    SearchOrder.BFS: "breadth first",
    SearchOrder.DFS: "depth first",
    SearchOrder.RANDOM_DFS: "random depth first",
}
OUT_OF_MEMORY = "memory limit"


class VerifytaReport(ReportWriter):
    """Writes about each model when it has been checked, and requested runs to standard error, where verifyta writes
    them."""

    def add(self, record: RunRecord) -> None:
        shown = self.presentation
        wanted = shown.every_trace and shown.evidence != "none"
        self.out.write(run_to_verifyta(record, shown.evidence if wanted else "no"))
        for verdict in record.verdicts:
            if wanted and verdict.trace is not None:
                sys.stderr.write(concrete_trace(record.network, verdict.trace) + "\n")


def run_to_verifyta(record: RunRecord, trace: str = "no") -> str:
    """The output of verifyta with ``-u`` about a whole run.

    Args:
        trace: as of `option_lines`; the traces themselves are printed elsewhere.
    """
    lines = list(option_lines(trace, record.options.order, record.options.seed))
    for number, report in numbered(record):
        if isinstance(report, NotChecked):
            lines += heading_lines(number, report.span)
            lines.append(note(f"not checked: {report.reason}"))
        elif isinstance(report, Verdict):
            lines += heading_lines(number, report.query.span)
            lines += verdict_lines(report)
            if trace != "no" and report.trace is not None:
                lines.append(f"Showing {evidence(report)}.")
                lines += ending_lines(report.trace)
            lines += summary_lines(report)
        else:
            lines += heading_lines(number, report.query.span)
            lines += _estimate_lines(report)
    return "\n".join(lines) + "\n"


def _estimate_lines(answer: StatisticalAnswer) -> Iterator[str]:
    from tachk.report.statistics.verifyta import statistical_lines, statistical_summary

    yield from statistical_lines(answer)
    yield from statistical_summary(answer)


def numbered(record: RunRecord) -> Iterator[tuple[int, Verdict | NotChecked | StatisticalAnswer]]:
    """The formulas with their numbers among all of the run: those of a verdict are the ones that are left."""
    taken: dict[int, NotChecked | StatisticalAnswer] = {skipped.number: skipped for skipped in record.not_checked}
    taken |= {answer.number: answer for answer in record.estimates}
    verdicts = iter(record.verdicts)
    for number in range(1, len(record.verdicts) + len(taken) + 1):
        yield number, taken[number] if number in taken else next(verdicts)


def option_lines(trace: str, order: SearchOrder, seed: int, notes: Sequence[str] = ()) -> Iterator[str]:
    """The summary of the options. ``trace``: ``no``, ``some``, ``shortest`` or ``fastest``."""
    yield "Options for the verification:"
    yield f"  Generating {trace} trace"
    yield f"  Search order is {_ORDERS.get(order, f'by {order.value}')}"
    yield f"  Seed is {seed}"
    yield from (f"  tachk: {harmless(text)}" for text in notes)


def heading_lines(number: int, span: Span) -> Iterator[str]:
    """The lines before the verdict about a formula."""
    yield ""
    yield f"Verifying formula {number} at {place_of(span)}"


def verdict_lines(verdict: Verdict) -> Iterator[str]:
    """The answer; only a reason where there is none. "May be" is the answer of an over-approximation alone."""
    match verdict.answer:
        case Answer.HOLDS:
            yield " -- Formula is satisfied."
            yield from (f" -- Result: {value}" for value in verifyta_values(verdict))
        case Answer.FAILS:
            yield " -- Formula is NOT satisfied."
        case Answer.UNKNOWN if verdict.unsupported is not None:
            yield note(f"not checked: {verdict.unsupported.message}")
        case Answer.UNKNOWN if not verdict.exact:
            yield " -- Formula MAY be satisfied."
            yield note(verdict.reason)
        case Answer.UNKNOWN if verdict.reason == OUT_OF_MEMORY:
            yield " -- Out of memory."
        case _:
            yield note(f"no answer: {verdict.reason}")
    if verdict.assumption:
        yield note(verdict.assumption)
    for text in verdict.notes:
        yield note(text)


def evidence(verdict: Verdict) -> str:
    """The name of the trace of a verdict."""
    return "example trace" if verdict.answer is Answer.HOLDS else "counter example"


def ending_lines(run: TimedTrace) -> Iterator[str]:
    """The lines after the last state of a trace, which the trace itself does not contain."""
    match run.ending:
        case Ending.OPEN:
            return
        case Ending.IDLE:
            yield note("from the last state on time passes for ever")
        case Ending.STUCK:
            yield note("from the last state on nothing can happen any more")
        case Ending.PERIODIC:
            yield note(f"the transitions from number {(run.loop_start or 0) + 1} on repeat for ever, with their delays")
        case Ending.RECURRENT:
            yield note(f"the transitions from number {(run.loop_start or 0) + 1} on repeat for ever, delays differ")
        case never:
            assert_never(never)


def summary_lines(verdict: Verdict) -> Iterator[str]:
    """The figures of ``-u``: states and time of the search, memory of the process."""
    if verdict.unsupported is not None:
        return
    statistics = verdict.statistics
    yield f" -- States stored : {statistics.states_stored} states"
    yield f" -- States explored : {statistics.states_explored} states"
    yield f" -- CPU user time used : {round(statistics.user_seconds * 1000)} ms"
    yield from memory_lines()


def place_of(span: Span) -> str:
    """``/nta/queries/query[1]/formula`` in XML, ``FILE:LINE`` elsewhere."""
    if span.passage is not None:
        return span.passage.path
    place = span.in_file
    return f"{place.source.name}:{place.source.line_column(place.start)[0]}"
