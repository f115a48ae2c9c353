"""Explanations of what is reported about temporal formulas."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

FORMULA_CODES: dict[str, Explanation] = {
    "E0130": Explanation(
        "malformed interval",
        "The interval of a temporal operator has two bounds, separated by a comma: F[0, 5], G[0, 5), F[2, inf). The "
        "brackets say whether the bounds belong to it. An operator without an interval looks as far as the run goes; W "
        "has none.",
        "property p : F[5] P.a;",
        "property p : F[0, 5] P.a;",
    ),
    "E0131": Explanation(
        "temporal operator inside an expression",
        "The operands of temporal operators and of not, and, or, imply are conditions; the operands of comparisons, "
        "of arithmetic, of calls and of quantifiers are values of one instant, which no temporal operator has.",
        "property p : F P.a == 1 + G P.b;",
        "property p : F P.a && G P.b;",
    ),
    "E0132": Explanation(
        "not part of a formula",
        "A formula observes a run and changes nothing; so assignments, ++ and -- have no place in it. Nor does "
        "deadlock, which is not a property of one run: A[] not deadlock asks for it.",
        "property p : G (n = 3);",
        "property p : G (n == 3);",
    ),
    "E0133": Explanation(
        "sentence without its full stop",
        "A property that is written as a sentence ends with a full stop, so that tachk can tell it from a formula.",
        "property p : whenever P.a, P.b must be true;",
        "property p : whenever P.a, P.b must be true.;",
    ),
    "E0134": Explanation(
        "bound without a unit",
        "One bound of an interval has a unit; the other one is not zero and has none. A reader would take the unit for "
        "both, but a bound without a unit is in the unit of the model.",
        "property p : F[10, 20 s] P.a;",
        "property p : F[10 s, 20 s] P.a;",
    ),
    "E0135": Explanation(
        "unknown unit of time",
        "The units are ns, us, ms, s, min, h and d. A bound without a unit is in the unit of the model or the trace.",
        "property p : F[0, 20 sec] P.a;",
        "property p : F[0, 20 s] P.a;",
    ),
}

DURATION_CODES: dict[str, Explanation] = {
    "E0504": Explanation(
        "negative bound",
        "The bounds of an interval are distances in time. F, G and U look ahead, O, H and S look back.",
        "property p : F[-5, 0] P.a;",
        "property p : O[0, 5] P.a;",
    ),
    "E0505": Explanation(
        "interval that ends before it begins",
        "The lower bound of an interval is not above the upper one, in the unit of the model or the trace.",
        "property p : F[5, 2] P.a;",
        "property p : F[2, 5] P.a;",
    ),
    "E0506": Explanation(
        "bound in a unit that cannot be converted",
        "Models count time in units that mean nothing until the line `time_unit = 1 ms;` says how long one is; traces "
        "likewise. Only then can a bound be given in seconds or minutes. A bound without a unit is in the unit of the "
        "model or the trace.",
        "property p : F[0, 5 s] P.a;",
        "time_unit = 1 ms;\nproperty p : F[0, 5 s] P.a;",
    ),
}
