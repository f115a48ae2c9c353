"""Explanations of why properties are refused that are not mistakes."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

OBSERVER_CODES: dict[str, Explanation] = {
    "E0730": Explanation(
        "no observer for this formula",
        "A temporal property is checked by an automaton beside the model that reaches a bad location exactly if the "
        "formula can be violated, or stays in certain locations for ever exactly if a run without end violates it. "
        "tachk has none for some nestings of operators. docs/logic.md lists the formulas that have one.",
        "property p : G(rise(H[0,3] P.a) -> P.b);",
        "property p : G(H[0,3] P.a -> P.b);",
    ),
    "E0731": Explanation(
        "clock in a temporal formula",
        "Temporal operators speak of values that change at single instants, and a comparison of a clock changes while "
        "time passes. Say the same with the window of an operator and with locations, or with a variable that an edge "
        "sets.",
        "property p : G(P.x > 5 -> P.done);",
        "property p : G(rise(P.started) -> F[0,5] P.done);",
    ),
    "E0732": Explanation(
        "temporal property of a model with priorities",
        "An observer takes steps of its own. Where channels or processes have priorities, a step of a higher priority "
        "keeps all others from happening, so the observer would change what the model does.",
    ),
    "E0733": Explanation(
        "query about a process that does not run",
        "A property names a process that the model describes, but the system line does not run it. Models are often "
        "switched between several system lines, with queries about each; the query waits for its own.",
        "process P() { state s; init s; }\nprocess Q() { state t; init t; }\nsystem P;\nproperty p : A[] Q.t;",
        "process P() { state s; init s; }\nprocess Q() { state t; init t; }\nsystem P, Q;\nproperty p : A[] Q.t;",
    ),
}
