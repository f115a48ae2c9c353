"""Explanations of the run-time errors of a model. The examples are processes with a property that meets the error."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation


def _process(declarations: str, update: str, guard: str = "") -> str:
    label = f"guard {guard}; " if guard else ""
    return (
        f"process P() {{\n    {declarations}\n    init location a {{ to a {{ {label}assign {update}; }} }}\n}}\n"
        "system P;\nproperty always : A[] P.a;"
    )


_HALF = "int half(int n) { double d = 1.0 / n; return fint(d * 10); }\n"

RUN_TIME_CODES: dict[str, Explanation] = {
    "E0761": Explanation(
        "value outside its range",
        "A run stores a value in a variable, parameter or result whose declared range does not contain it. The report "
        "shows the run. Declare a wider range, or guard the edge so that it is not taken there.",
        _process("int[0,3] n;", "n = n + 1"),
        _process("int[0,3] n;", "n = n + 1", "n < 3"),
    ),
    "E0762": Explanation(
        "index outside its array",
        "A run evaluates an element that the array does not have. Guard the edge, or make the array larger.",
        _process("int[0,4] n; int full[4];", "full[n] = 1, n = n + 1", "n < 5"),
        _process("int[0,4] n; int full[4];", "full[n] = 1, n = n + 1", "n < 4"),
    ),
    "E0763": Explanation(
        "division by zero",
        "A run divides by zero, or takes a remainder of a division by zero.",
        _process("int[0,3] n = 3; int m;", "m = 6 / n, n = n - 1", "n >= 0"),
        _process("int[0,3] n = 3; int m;", "m = 6 / n, n = n - 1", "n > 0"),
    ),
    "E0764": Explanation(
        "clock set to a negative value",
        "Clocks measure time that has passed, so a run cannot set one to less than 0.",
        _process("clock x; int[0,3] n = 0;", "x = n - 1"),
        _process("clock x; int[0,3] n = 0;", "x = n"),
    ),
    "E0765": Explanation(
        "shift distance out of range",
        "Integers have 32 bits: << and >> shift by 0 to 31.",
        _process("int[0,40] n; int m;", "m = 0 << n, n = n + 1", "n < 40"),
        _process("int[0,40] n; int m;", "m = 0 << n, n = n + 1", "n < 32"),
    ),
    "E0766": Explanation(
        "negative exponent",
        "`**` raises integers to powers, and a power with a negative exponent is not an integer.",
        _process("int[-2,3] n = 3; int m;", "m = 2 ** n, n = n - 1", "n >= -1"),
        _process("int[-2,3] n = 3; int m;", "m = 2 ** n, n = n - 1", "n >= 0"),
    ),
    "E0767": Explanation(
        "false assertion",
        "An `assert` of a function is false in a run. The report shows the run.",
        "int[0,5] n;\nvoid check() { assert n < 3; }\n" + _process("", "n = n + 1, check()", "n < 5"),
        "int[0,5] n;\nvoid check() { assert n < 3; }\n" + _process("", "n = n + 1, check()", "n < 2"),
    ),
    "E0768": Explanation(
        "too many steps",
        "One update, guard or function takes more than 2^24 instructions. Most often a loop does not end.",
        "int[0,1] n = 1;\nvoid wait() { while (n > 0) { } }\n" + _process("", "wait()"),
        "int[0,1] n = 1;\nvoid wait() { while (n > 0) { n = 0; } }\n" + _process("", "wait()"),
    ),
    "E0769": Explanation(
        "clock compared with too large a value",
        "A clock is compared with a value beyond the limit that was computed before the run; zones need such a limit. "
        "Declare ranges for the variables of the bound.",
    ),
    "E0770": Explanation(
        "floating point operation without a result",
        "A run divides a `double` by zero, takes the root of a negative number, computes a number too large for one, "
        "or makes one an integer of more than 32 bits. tachk knows no infinities: it reports where one would be.",
        _HALF + _process("int[0,3] n = 3; int m;", "m = half(n), n = n - 1", "n >= 0"),
        _HALF + _process("int[0,3] n = 3; int m;", "m = half(n), n = n - 1", "n > 0"),
    ),
}
