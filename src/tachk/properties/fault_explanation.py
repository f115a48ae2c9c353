"""What a run-time error of the model was about: the values involved, and the timed run that leads there."""

from __future__ import annotations

from dataclasses import replace

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.diagnostics.span import NOWHERE, Span
from tachk.engines.exact.concretise import concretise
from tachk.engines.outcome import RunTimeFault
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.network import Network
from tachk.semantics.discrete import PreparedNetwork, execute_updates
from tachk.semantics.timed_trace import TimedTrace
from tachk.time_limit import OutOfTimeError, time_limit

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


def diagnostic_of(fault: RunTimeFault) -> Diagnostic:
    """What is said about a run-time error, in the form of every other finding."""
    code, message, help = _WHAT[fault.kind]
    detail = f": {fault.detail}" if fault.detail else ""
    return Diagnostic(code, f"run-time error: {message}{detail}", fault.span, help)


def explain(model: PreparedNetwork, fault: RunTimeFault, seconds: float | None = None) -> RunTimeFault:
    """The fault with its run and, where an update failed, the values as the reference evaluator finds them.

    Args:
        seconds: how long that may take; what is not found by then is left out. The run is one of Python, in which a
            function that loops takes many seconds.
    """
    placed = replace(fault, span=_place(model.network, fault))
    try:
        with time_limit(seconds):
            run = concretise(model, fault.path)
            return replace(placed, detail=_detail(model, fault, run), run=run)
    except OutOfTimeError:
        return placed


def _detail(model: PreparedNetwork, fault: RunTimeFault, run: TimedTrace | None) -> str:
    # No value tells why a loop does not end, and the reference evaluator would run it for many seconds.
    if run is not None and fault.transition is not None and fault.kind is not RuntimeErrorKind.LOOP:
        try:
            execute_updates(model, run.states[-1].discrete, fault.transition)
        except EvaluationFault as error:
            return error.detail
    return ""


def _place(network: Network, fault: RunTimeFault) -> Span:
    """Where it happened; the edge that was tried, where the instruction has no place of its own: of a loop that does
    not end it is any."""
    placed = fault.span.source is not NOWHERE.source and fault.kind is not RuntimeErrorKind.LOOP
    if placed or fault.transition is None:
        return fault.span
    first = fault.transition.participants[0]
    return network.processes[first.process].edges[first.edge].spans[0]
