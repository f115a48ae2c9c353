"""Explanations of what is reported about files of recorded signals."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

TRACE_CODES: dict[str, Explanation] = {
    "E0911": Explanation(
        "cell that is not a value",
        "A cell of a trace holds a number such as -1.5, 2e3 or inf, or true or false. A column holds either numbers "
        "or truth values, which may also be written 1 and 0. Columns that no formula reads may hold anything.",
        "time,speed\n0,fast",
        "time,speed\n0,17.5",
    ),
    "E0912": Explanation(
        "missing value",
        "Every row has a time. An empty cell of another column, or nan, NA or null, means that the value of the row "
        "above stays; the trace begins with the first row in which every column that a formula reads has a value.",
        "time,speed\n,17.5",
        "time,speed\n0,17.5\n1,",
    ),
    "E0913": Explanation(
        "time goes backwards",
        "The rows of a trace are sorted by time. Several rows may have the same time; the last of them counts.",
        "time,p\n2,1\n1,0",
        "time,p\n1,0\n2,1",
    ),
    "E0914": Explanation(
        "row of another length",
        "Every row of a table has as many cells as its header. A value with a separator in it stands in quotes.",
        "time,p\n0,1,1",
        "time,p\n0,1",
    ),
    "E0915": Explanation(
        "time that cannot be counted",
        "Times are exact decimal numbers, counted in 64 bits in units of the finest decimal of the trace. Binary "
        "numbers such as 0.30000000000000004 are rounded to nine decimals, or to more where neighbours would be the "
        "same. --decimals rounds all times. Where rows are judged as they come, the number of decimals is fixed "
        "beforehand.",
        "time,p\n123456789012345678901,1",
        "time,p\n12345678901,1",
    ),
    "E0916": Explanation(
        "table without names",
        "The first line of a table names its columns; the formula speaks about them by these names.",
        "0,1\n1,0",
        "time,p\n0,1\n1,0",
    ),
    "E0917": Explanation(
        "value change dump that cannot be read",
        "A value change dump declares its variables under $scope and $var and ends the declarations with "
        "$enddefinitions $end; then come times (#10) and values (1!, b0110 #, r1.5 %). The trace begins when all "
        "variables that a formula reads have a known value, and then they keep one: x and z are not values.",
    ),
}
