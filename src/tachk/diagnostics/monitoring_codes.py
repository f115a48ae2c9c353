"""Explanations of what is reported about formulas over recorded traces."""

from __future__ import annotations

from tachk.diagnostics.explanation import Explanation

MONITORING_CODES: dict[str, Explanation] = {
    "E0901": Explanation(
        "unknown column",
        "A formula over a trace speaks about the columns of the trace, by their exact names. A column may be called "
        "like a part of a model, such as P.loc or x[3]; names that are no identifiers stand between backticks.",
    ),
    "E0902": Explanation(
        "no meaning on traces",
        "Atoms over a trace are arithmetic (+ - * / %, abs, min, max), comparisons and connectives over columns and "
        "numbers. Functions, quantifiers, deadlock, rates, assignments and ?: need a model. A condition is no number.",
    ),
    "E0903": Explanation(
        "duration that is no whole number of ticks",
        "Monitors count time in ticks, so that it is exact. A duration must be a whole number of them, and all of "
        "a formula together fewer than 2**58. Choose finer or coarser ticks.",
    ),
    "E0904": Explanation(
        "chained comparison",
        "0 < x < 5 would compare the truth of 0 < x with 5. Write 0 < x && x < 5.",
    ),
}
