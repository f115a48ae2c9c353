"""Explanations of run-time errors: the values involved, and the timed run that leads there."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.job import StoppedError, unhurried
from tachk.base.records import replace
from tachk.base.span import NOWHERE, Span
from tachk.engine.exact.concretise import concretise
from tachk.meaning.discrete import PreparedNetwork, execute_updates
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.network import Network
from tachk.model.run import RunTimeFault, TimedTrace
from tachk.verify.verdict import Verdict

_WHAT = {
    RuntimeErrorKind.RANGE: (
        "E0761",
        "a value is outside its declared range",
        "declare a wider range, or guard the edge so that this is not evaluated there",
    ),
    RuntimeErrorKind.INDEX: (
        "E0762",
        "an index is outside its array",
        "guard the edge so that this is not evaluated there, or make the array larger",
    ),
    RuntimeErrorKind.DIVISION: ("E0763", "division by zero", "guard the edge so that the divisor is not 0"),
    RuntimeErrorKind.NEGATIVE_CLOCK: ("E0764", "a clock is set to a negative value", "set it to 0 or more"),
    RuntimeErrorKind.SHIFT: ("E0765", "a shift distance is negative or above 31", "shift by 0 to 31"),
    RuntimeErrorKind.NEGATIVE_EXPONENT: ("E0766", "an exponent is negative", "raise to powers of 0 or more"),
    RuntimeErrorKind.ASSERT: ("E0767", "an assertion is false", "the run below leads to it"),
    RuntimeErrorKind.LOOP: ("E0768", "this takes more than 2^24 instructions", "perhaps a loop does not end"),
    RuntimeErrorKind.NOT_FINITE: (
        "E0770",
        "a floating point operation has no finite result, or none that fits an integer",
        "guard the edge so that this is not evaluated there",
    ),
    RuntimeErrorKind.BOUND: (
        "E0769",
        "a clock is compared with a value beyond the limits known before the run",
        "declare ranges for the variables of the bound",
    ),
}
"""Code, message and help of each kind."""

_IN_QUERIES = {
    RuntimeErrorKind.INDEX: "say in the query when it counts: `i < n && a[i] == 1`, after A[] `i < n imply ...`",
    RuntimeErrorKind.DIVISION: "say in the query when it counts: `d != 0 && n / d == 1`, after A[] `d != 0 imply ...`",
    RuntimeErrorKind.ASSERT: _WHAT[RuntimeErrorKind.ASSERT][2],
    RuntimeErrorKind.LOOP: _WHAT[RuntimeErrorKind.LOOP][2],
}
_IN_OTHER_QUERIES = "say in the query when it counts: `condition && ...`, after A[] `condition imply ...`"
"""The help where the query itself meets the run-time error, for which no edge is to blame."""


def diagnostic_of(fault: RunTimeFault) -> Diagnostic:
    """The diagnostic of a run-time error, in the form of every other finding."""
    code, message, help = _WHAT[fault.kind]
    if fault.of_query:
        help = _IN_QUERIES.get(fault.kind, _IN_OTHER_QUERIES)
    detail = f": {fault.detail}" if fault.detail else ""
    return Diagnostic(code, f"run-time error: {message}{detail}", fault.span, help)


_LEAST_SECONDS = 1.0


def explain(model: PreparedNetwork, fault: RunTimeFault) -> RunTimeFault:
    """The fault with its run and, where an update failed, the values as the reference evaluator finds them.

    What is not found in the time that is left, or in a second, is left out: the run is one of Python, in which a
    function that loops takes many seconds.
    """
    placed = replace(fault, span=_place(model.network, fault))
    try:
        with unhurried(_LEAST_SECONDS):
            run = concretise(model, fault.path)
            return replace(placed, detail=_detail(model, fault, run), run=run)
    except StoppedError:
        return placed


def with_blame(verdict: Verdict) -> Verdict:
    """The verdict, whose run-time error is one of the query if its place is in the text of the query."""
    fault, query_span = verdict.fault, verdict.query.span
    if fault is None or fault.transition is not None or query_span.source is NOWHERE.source:
        return verdict
    inside = (
        fault.span.source is query_span.source
        and query_span.start <= fault.span.start <= fault.span.end <= query_span.end
    )
    return replace(verdict, fault=replace(fault, of_query=fault.of_query or inside))


def _detail(model: PreparedNetwork, fault: RunTimeFault, run: TimedTrace | None) -> str:
    # No value says why a loop does not end, and the reference evaluator would run it for many seconds.
    if run is not None and fault.transition is not None and fault.kind is not RuntimeErrorKind.LOOP:
        try:
            execute_updates(model, run.states[-1].discrete, fault.transition)
        except EvaluationFault as error:
            return error.detail
    return ""


def _place(network: Network, fault: RunTimeFault) -> Span:
    """The place of a run-time error; the edge that was tried, where the instruction has no place: the place of a loop
    that does not end is arbitrary."""
    placed = fault.span.source is not NOWHERE.source and fault.kind is not RuntimeErrorKind.LOOP
    if placed or fault.transition is None:
        return fault.span
    first = fault.transition.participants[0]
    return network.processes[first.process].edges[first.edge].spans[0]
