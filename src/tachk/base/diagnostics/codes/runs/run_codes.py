"""Codes of runs that are written down and executed: `tachk replay`, `tachk step`, `--policy script`."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

RUN_CODES: dict[str, Explanation] = {
    "E0921": Explanation(
        "step that the model does not take",
        "Each step of a run that is replayed must be one of the model: the time must be able to pass, the guards must "
        "hold then, and no invariant may be violated.",
        "5 P: A -> B",
        "12 P: A -> B",
    ),
    "E0922": Explanation(
        "line of a run that is not understood",
        "A line of a run has the time of the step, perhaps the channel, and each process that moves with its old and "
        "its new location, joined by &. A line with a time only lets time pass.",
        "P: A -> B",
        "2.5 c!  P: A -> B & Q: C -> D",
    ),
}
