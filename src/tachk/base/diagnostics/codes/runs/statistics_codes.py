"""Codes of statistical queries."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

STATISTICS_CODES = {
    "E0147": Explanation(
        "malformed statistical query",
        "The forms are Pr[<=100](<> p), with [] or with p U q, alone or compared by >= or <= with a probability or "
        "with another such query; Pr(<>[2,5] p); E[<=100; 1000](max: e) or min:; simulate [<=100; 5] {e, f}. "
        "The bound is a time, a number of transitions (# <= 50) or the value of a clock (x <= 20).",
        "Pr[100](<> P.a)",
        "Pr[<=100](<> P.a)",
    ),
    "E0728": Explanation(
        "statistical query of a form that is not estimated",
        "`tachk estimate` knows <>, [] and U under one bound or with an interval, formulas of several of these without "
        "clocks, in which each operator has an interval, expectations and trajectories. "
        "It does not look for `deadlock`, since a run that is drawn does not tell whether anything else was possible.",
        "Pr[<=100](<> deadlock)",
        "E<> deadlock",
    ),
}
