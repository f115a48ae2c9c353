"""Explanations of what is reported about formulas over recorded traces."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

MONITORING_CODES: dict[str, Explanation] = {
    "E0901": Explanation(
        "unknown column",
        "A formula over a trace speaks about the columns of the trace, by their exact names. A column may be called "
        "like a part of a model, such as P.loc or x[3]; names that are not identifiers stand between backticks.",
    ),
    "E0902": Explanation(
        "no meaning on traces",
        "Atoms over a trace are arithmetic (+ - * / %, abs, min, max), comparisons and connectives over columns and "
        "numbers. Functions, quantifiers, deadlock, rates, assignments and ?: need a model. A condition is not a "
        "number.",
    ),
    "E0903": Explanation(
        "duration that is not a whole number of ticks",
        "Monitors count time in ticks, so that it is exact. A duration must be a whole number of them, and all of "
        "a formula together fewer than 2**58, with --interpolation linear fewer than 2**47. Choose finer or coarser "
        "ticks.",
    ),
    "E0904": Explanation(
        "chained comparison",
        "0 < x < 5 would compare the truth of 0 < x with 5. Write 0 < x && x < 5.",
    ),
    "E0905": Explanation(
        "not linear between rows",
        "With --interpolation linear numbers move in straight lines from row to row. Sums, multiples by constants, "
        "abs, min and max of lines consist of lines; products and quotients of columns and % do not, so where they "
        "cross a value cannot be told exactly. Hold the values (--interpolation constant), or record the product as "
        "a column.",
    ),
    "E0906": Explanation(
        "change of what moves",
        "With --interpolation linear a number moves all the time, so there are no instants at which its value becomes "
        "another one. change() is for truth values then; rise(x >= 5) and fall(x > 5) tell when x crosses 5.",
    ),
    "E0907": Explanation(
        "no first instant",
        "With --interpolation linear, x > 5 is still false at the instant at which x crosses 5 upwards, and true at "
        "all instants after it: there is no first one, so rise(x > 5) would never happen. rise(x >= 5) happens at the "
        "crossing. In the same way fall needs x > 5 rather than x >= 5.",
    ),
}
