"""Explanations of what lowering and the question for supported features report."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

LOWERING_CODES: dict[str, Explanation] = {
    "E0701": Explanation(
        "initial value outside its range",
        "A variable starts with a value that its declared range does not contain. Change one of them.",
        "int[0,3] tries = 7;",
        "int[0,7] tries = 7;",
    ),
    "E0702": Explanation(
        "copy of a value that contains clocks",
        "Clocks are not numbers that can be copied: an array or record with a clock in it cannot be assigned, passed "
        "by value or returned. Assign its integers one by one, or pass it by reference.",
    ),
    "E0703": Explanation(
        "clock compared inside a number",
        "Clocks may be compared in guards, invariants and queries, joined by &&, ||, imply, not and forall. The body "
        "of a function, an array index or an arithmetic expression has one value for a whole zone of clock values, so "
        "it cannot compare clocks.",
        "guard n == (x > 3 ? 1 : 0);",
        "guard x > 3 && n == 1;",
    ),
    "E0704": Explanation(
        "clock bound too large",
        "Clocks are compared with, and set to, values up to 2,147,483,647. The interval of the expression is derived "
        "from the declared ranges of its variables; declare smaller ones, or choose a coarser time unit.",
        "int[0,100000] n;  ...  guard x <= n * n;",
        "int[0,1000] n;    ...  guard x <= n * n;",
    ),
    "E0705": Explanation(
        "disjunction of clock comparisons",
        "A guard or an invariant must describe a convex set of clock values: at most one side of a disjunction may "
        "compare clocks. Use two edges. Queries have no such limit.",
        "to B { guard x >= 1 || y >= 1; }",
        "to B { guard x >= 1; }\nto B { guard y >= 1; }",
    ),
    "E0706": Explanation(
        "clock comparison of another form",
        "Only a clock, or the difference of two clocks, can be compared with an integer expression.",
        "guard x + y <= 5;",
        "guard x - y <= 5;",
    ),
    "E0707": Explanation(
        "predicate with too many cases",
        "A predicate in which clock comparisons or deadlock stand under nested disjunctions is split into cases; there "
        "were more than 4,096 of them. Split the property, or keep clocks out of the disjunctions.",
    ),
    "E0708": Explanation(
        "too many edges after select",
        "An edge with select labels stands for one edge for each combination of values, and the engine keeps them all. "
        "More than 1,000,000 edges are refused, and more than 10,000,000 combinations to try. Select from smaller "
        "ranges, or set a variable step by step.",
    ),
    "E0709": Explanation(
        "clock difference with a wide bound",
        "A difference of two clocks is compared with a variable that may have more than 1,024 values. The abstraction "
        "must tell all of them apart. Declare a smaller range.",
    ),
    "E0710": Explanation(
        "clock rate other than 0 and 1",
        "In symbolic checking a clock either runs (rate 1) or stands still (rate 0). Other rates need a statistical "
        "tool, and the rate of a clock must name the clock directly.",
        "invariant x' == 2;",
        "invariant x' == 0;",
    ),
    "E0711": Explanation(
        "clock set to a clock where clocks stop",
        "A clock can be set to the value of a clock, and a clock can be stopped, but a model cannot have both: when a "
        "run could happen is told by when each clock was set, and a copy of a clock that stood still was never set. "
        "Simulations read both.",
        "location A { invariant x' == 0; to B { do y = x; } }",
        "location A { to B { do y = x; } }",
    ),
    "E0712": Explanation(
        "copies of clocks that are compared with each other",
        "Where clocks are compared with each other, `x = y + 1` makes of a comparison with x one of y and another "
        "number, and in a loop so on without end. What can be reached is undecidable then (Bouyer, Dufourd, Fleury and "
        "Petit 2004). Copy clocks without adding to them, or compare clocks with numbers only.",
        "guard x - z <= 3; do x = x + 1;",
        "guard x <= 3; do x = x + 1;",
    ),
    "E0720": Explanation(
        "deadlock in a query about runs, with stopwatches",
        "Where a clock may stand still, zones say of too many states that they may be stuck. For E<> and A[] the "
        "answer is right or unknown nevertheless; in A<>, E[] and --> both answers could be wrong. Let all clocks "
        "run, or ask E<> deadlock.",
        "A<> deadlock",
        "E<> deadlock",
    ),
    "E0745": Explanation(
        "not encoded for the engine smt",
        "The engine smt answers E<> and A[], and has no formula for floating point arithmetic, for powers whose "
        "exponent varies, for loops without a small bound, and for priorities or `deadlock` where a step can be made "
        "in more than 2,000 ways. It refuses what it cannot encode; the zone engine checks these.",
        "double half(double d) { return d / 2; }    // called, with --engine smt",
        "int half(int n) { return n / 2; }",
    ),
    "E0721": Explanation(
        "clock guard on an urgent channel",
        "Time must stop at the very moment an urgent synchronisation becomes possible. With a clock in its guard that "
        "moment may lie inside a delay, which zones cannot express exactly; UPPAAL warns of it. Simulations take "
        "the edge as soon as its guard holds. Wait for the clock in a location of its own.",
        "to B { guard x >= 3; sync now!; }",
        "location Waiting { invariant x <= 3; to Ready { guard x >= 3; } }\nlocation Ready { to B { sync now!; } }",
    ),
    "E0722": Explanation(
        "rate or weight that is not computed",
        "A simulation needs the rate of each location and the weight of each branch as a number. A search does not "
        "look at them, so that it accepts any. They may use numbers, also floating point ones, and weights clocks.",
        "location A { exponential_rate speed; to B; }",
        "location A { exponential_rate 1 : 20; to B; }",
    ),
    "W0722": Explanation(
        "rate or weight that no simulation computes",
        "A search does not look at rates and weights, so that the model can be verified as it is. `tachk simulate` "
        "refuses it with E0722. They may use numbers, also floating point ones, and weights clocks.",
        "location A { exponential_rate speed; to B; }",
        "location A { exponential_rate 1 : 20; to B; }",
    ),
    "W0724": Explanation(
        "an invariant that ends while nobody has to act",
        "In a simulation a process draws when it acts. Where the invariant of a process that can only receive ends "
        "before anybody has drawn a moment, UPPAAL's documentation leaves open what happens. tachk lets one of the "
        "processes act that can, also one whose delay is exponential. That changes probabilities, and no search.",
        "process P() { clock x; init location A { invariant x <= 5; to B { sync go?; } } location B; }\n"
        "process Q() { init location C { exponential_rate 1 : 10; to D { sync go!; } } location D; }",
        "process P() { clock x; init location A { invariant x <= 5; to B { sync go?; } to Late { guard x >= 5; } } "
        "location B; location Late; }\n"
        "process Q() { init location C { exponential_rate 1 : 10; to D { sync go!; } } location D; }",
    ),
    "E0729": Explanation(
        "hybrid clocks or random initial values where they are not known",
        "Hybrid clocks, with rates other than 0 and 1, and initial values that are drawn for each run are simulated "
        "(`tachk simulate`, `tachk estimate`). Units of "
        "co-simulation, splitting, and whatever executes a run step by step do not have them.",
    ),
    "E0723": Explanation(
        "priorities in a unit of co-simulation",
        "A unit does what its surroundings ask for at once, without looking for something of higher priority. Searches "
        "and simulations obey priorities.",
    ),
}
