"""Explanations of what verification reports about a model that is well-formed."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

VERIFICATION_CODES: dict[str, Explanation] = {
    "E0409": Explanation(
        "no initial state",
        "In the initial state every variable has its initial value, and every clock, too, 0 where none is written; all "
        "invariants of the initial locations must hold there. Otherwise the system has no behaviour, and every A[] "
        "would hold trivially.",
        "int n = 3;\nprocess P() { init location A { invariant n < 3; } }\nsystem P;",
        "int n = 2;\nprocess P() { init location A { invariant n < 3; } }\nsystem P;",
    ),
}
