"""The lines that UPPAAL's verifyta prints, for scripts that look for them."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.engines.protocol import SearchOrder
from tachk.properties.verdict import Answer, Verdict
from tachk.report.record import RunRecord

_ANSWERS = {
    Answer.HOLDS: "Formula is satisfied.",
    Answer.FAILS: "Formula is NOT satisfied.",
    Answer.UNKNOWN: "Formula is MAYBE satisfied.",
}


def run_to_verifyta(record: RunRecord) -> str:
    """What verifyta would print with ``-u``. What it would not say stands in lines that begin with ``--  tachk:``."""
    lines = ["Options for the verification:", "  Generating no trace", f"  Search order is {_order(record)}", ""]
    for number, verdict in enumerate(record.verdicts, 1):
        lines += _verdict(number, verdict)
    for skipped in record.not_checked:
        lines += [f"-- tachk: {skipped.name} is not checked: {skipped.reason}"]
    return "\n".join(lines).rstrip() + "\n"


def _order(record: RunRecord) -> str:
    match record.options.order:
        case SearchOrder.BFS:
            return "breadth first"
        case SearchOrder.DFS:
            return "depth first"
        case SearchOrder.RANDOM_DFS:
            return "random depth first"


def _verdict(number: int, verdict: Verdict) -> Iterator[str]:
    yield f"Verifying formula {number} at {_place(verdict)}"
    yield f" -- {_ANSWERS[verdict.answer]}"
    reason = verdict.reason or ("" if verdict.unsupported is None else verdict.unsupported.message)
    if reason:
        yield f" -- tachk: {reason}"
    statistics = verdict.statistics
    yield f" -- States stored : {statistics.states_stored} states"
    yield f" -- States explored : {statistics.states_explored} states"
    yield f" -- CPU user time used : {round(statistics.seconds * 1000)} ms"
    yield f" -- Virtual memory used : {_kibibytes(statistics.peak_bytes)} KiB"
    yield f" -- Resident memory used : {_kibibytes(statistics.peak_bytes)} KiB"
    yield ""


def _place(verdict: Verdict) -> str:
    span = verdict.query.span
    return f"line {span.source.line_column(span.start)[0]}"


def _kibibytes(size: int) -> int:
    return -(-size // 1024)
