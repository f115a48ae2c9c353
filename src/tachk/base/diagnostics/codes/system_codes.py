"""Explanations of what is reported about templates, channels, the system line and queries; warnings about them."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

_P = "process P() { state s; init s; }\n"


def _edge(label: str) -> str:
    return f"process P() {{ int n; state s; init s; trans s -> s {{ {label} }}; }}"


def _branches(branch: str) -> str:
    return f"process P() {{ state s; branchpoint b; init s; trans s -> b {{ }}, b -> s {{ {branch} }}; }}"


SYSTEM_CODES: dict[str, Explanation] = {
    "E0401": Explanation(
        "synchronisation",
        "A synchronisation is a channel followed by ! (send) or ? (receive).",
        "int a;\n" + _edge("sync a!;"),
        "broadcast chan a;\n" + _edge("sync a!;"),
    ),
    "E0402": Explanation(
        "value over a channel",
        "`c!e` stores e in a hidden variable that `c?x` copies to x. So every sender of a channel must give a value if "
        "a receiver expects one, all values must have one type, and the channel must be named directly.",
        "broadcast chan c;\nprocess P() { int n; state s; init s; trans s -> s { sync c!; }, s -> s { sync c?n; }; }",
        "broadcast chan c;\nprocess P() { int n; state s; init s; trans s -> s { sync c!1; }, s -> s { sync c?n; }; }",
    ),
    "E0403": Explanation(
        "initial location",
        "Every template has exactly one initial location.",
        "process P() { location a { to b; } location b; }",
        "process P() { init location a { to b; } location b; }",
    ),
    "E0404": Explanation(
        "branchpoint",
        "An edge to a branchpoint carries select, guard and synchronisation; the branches that leave it have selects, "
        "updates and weights only, and lead to locations.",
        _branches("guard true;"),
        _branches("probability 3;"),
    ),
    "E0405": Explanation(
        "channel priority",
        "A model has at most one line of channel priorities. It names global channels, each once, and says with "
        "`default` where all other actions belong.",
        "chan a, b;\nchan priority a < default < b < a;",
        "chan a, b;\nchan priority a < default < b;",
    ),
    "E0410": Explanation(
        "no system line",
        "`system P, Q;` says which processes run, and in which order broadcast updates are executed. A file that is "
        "only imported has none, and cannot be loaded by itself.",
        _P + "// system P;",
        _P + "system P;",
    ),
    "E0411": Explanation(
        "second system line",
        "A model has one system line, and it stands in the file that is loaded, not in one that is imported.",
        _P + "system P;\nsystem P;",
        _P + "system P;",
    ),
    "E0412": Explanation(
        "wrong number of arguments",
        "An instantiation gives every parameter of the template an argument. Parameters that stay free become "
        "parameters of the instantiation: `Q(const int[0,3] i) = P(i, 5);`",
        "process P(int a) { state s; init s; }\nQ = P();\nsystem Q;",
        "process P(int a) { state s; init s; }\nQ = P(1);\nsystem Q;",
    ),
    "E0413": Explanation(
        "parameter that cannot stay free",
        "A template named in the system line without arguments gets one instance for each combination of values of its "
        "parameters; so these have a bounded integer or scalar type and are passed by value.",
        "process P(int a) { state s; init s; }\nsystem P;",
        "process P(int[0,3] a) { state s; init s; }\nsystem P;",
    ),
    "E0414": Explanation(
        "process named twice",
        "The system line names every process once. A second process of a template needs a name of its own.",
        _P + "system P, P;",
        _P + "Q = P();\nsystem P, Q;",
    ),
    "E0415": Explanation(
        "import that cannot be read",
        "The path of an import is relative to the file that contains the import.",
        'import "no_such_file.ta";',
    ),
    "E0416": Explanation(
        "imports in a circle",
        "Declarations stand above their use, so two files cannot import each other. Put what both need into a third "
        "file, which both import; tachk reads it once.",
    ),
    "E0417": Explanation(
        "two time units",
        "All files of a model measure time in the same unit.",
        "time_unit = 1 ms;\ntime_unit = 1 s;",
        "time_unit = 1 ms;",
    ),
    "E0418": Explanation(
        "too many processes",
        "More than 65536 instances of templates are taken for a mistake.",
        "process P(int[0,99999] a) { state s; init s; }\nsystem P;",
        "process P(int[0,9] a) { state s; init s; }\nsystem P;",
    ),
    "E0419": Explanation(
        "expectation that fits no property",
        "A line such as `expect A, B fails;` says what a system expects of properties, most often imported ones. Each "
        "name is that of a property, and each property is named once.",
        _P + "system P;\nproperty safe : A[] P.s;\nexpect save fails;",
        _P + "system P;\nproperty safe : A[] P.s;\nexpect safe holds;",
    ),
    "E0426": Explanation(
        "nothing to hide",
        "`hide A, B;` names templates, or processes of the system line, that told runs leave out.",
        _P + "system P;\nhide Q;",
        _P + "system P;\nhide P;",
    ),
    "E0501": Explanation(
        "deadlock outside a query",
        "`deadlock` speaks about all that can happen later, so it cannot be part of the behaviour itself, nor of a "
        "signal.",
        _edge("guard !deadlock;"),
        _P + "system P;\nproperty stuck : E<> deadlock;",
    ),
    "E0502": Explanation(
        "signal",
        "A signal is a global name for an integer, boolean, scalar or clock expression over the state of the "
        "processes.",
        "int a[2];\nsignal both = a;\n" + _P + "system P;",
        "int a[2];\nsignal first = a[0];\n" + _P + "system P;",
    ),
    "E0503": Explanation(
        "cannot be measured",
        "sup, inf and bounds ask for the extreme values of clocks, differences of two clocks and integers; what the "
        "states must satisfy goes between the braces.",
        "clock x;\n" + _P + "system P;\nproperty most : sup: x < 3;",
        "clock x;\n" + _P + "system P;\nproperty most : sup{P.s}: x;",
    ),
    "E0750": Explanation(
        "construct that is not supported",
        "tachk checks all of UPPAAL's language for symbolic checking. Floating point variables that last, functions "
        "such as `sin` that libraries compute differently, hybrid clocks, rates other than 0 and 1, arithmetic with "
        "clocks, strings, foreign functions, processes that appear and vanish while the system runs (dynamic, spawn, "
        "exit, numOf, foreach) and before_update/after_update belong to "
        "simulation and statistical checking, IO declarations to refinement checking; synchronisations without a "
        "direction or behind a branchpoint have no meaning here. A model with such "
        "a construct can be converted, formatted and drawn, but none of its queries is checked: the exit status is 3.",
        "const int level = fint(sin(0.5));",
        "const int level = fint(sqrt(0.25));",
    ),
    "W0401": Explanation(
        "nothing sends",
        "An edge receives on a channel that no process of the system sends on, so it can never be taken. Edges that a "
        "constant of the model switches off are not meant.",
        "chan go;\n" + _edge("sync go?;"),
        "chan go;\nprocess P() { state s; init s; trans s -> s { sync go?; }, s -> s { sync go!; }; }",
    ),
    "W0402": Explanation(
        "nothing receives",
        "An edge sends on a channel that no process of the system receives on. Unless the channel is broadcast, the "
        "edge can never be taken. Edges that a constant of the model switches off are not meant.",
        "chan go;\n" + _edge("sync go!;"),
        "broadcast chan go;\n" + _edge("sync go!;"),
    ),
    "W0403": Explanation(
        "clock guard on an urgent channel",
        "Time must not pass once an urgent synchronisation is possible. With a clock in the guard that moment may lie "
        "inside a delay; UPPAAL's manual forbids it.",
        "urgent broadcast chan now;\nprocess P() { clock x; state s; init s; trans s -> s { guard x > 1; sync "
        "now!; }; }",
        "urgent broadcast chan now;\nprocess P() { int n; state s; init s; trans s -> s { guard n > 1; sync now!; }; }",
    ),
    "W0404": Explanation(
        "unreachable location",
        "No path of edges leads from the initial location of the template to this one.",
        "process P() { state s, t; init s; trans t -> s { }; }",
        "process P() { state s, t; init s; trans s -> t { }; }",
    ),
    "W0405": Explanation(
        "not supported and not used",
        "A template that no process is an instance of uses a construct that tachk does not check. It is kept in the "
        "text and has no influence on any answer.",
        _P + "process Q() { const int n = fint(sin(0.5)); state s; init s; }\nsystem P;",
        _P + "process Q() { const int n = fint(0.5); state s; init s; }\nsystem P;",
    ),
    "W0406": Explanation(
        "variable that is not checked",
        "Floating point variables and hybrid clocks belong to statistical checking. As long as only assignments to "
        "such variables, and rates of such clocks, use them, they are left out of what is checked, and all answers are "
        "right without them. Any other use is refused (E0750).",
        "double level;",
        "int level;",
    ),
    "W0407": Explanation(
        "function that is not checked",
        "The function uses something that tachk does not check, or it belongs to a library of another program. It is "
        "left out of what is checked; anything that calls it is refused (E0750).",
        "int wave(int n) { return fint(sin(n / 2.0)); }",
        "int half(int n) { return fint(n / 2.0); }",
    ),
    "W0408": Explanation(
        "meta variable that lasts",
        "A meta variable is for values within one transition, and states do not tell its values apart. Where a "
        "transition may read what an earlier one has left in it, they must: the variable is an ordinary one then.",
        "meta int m;\nprocess P() { state s; init s; trans s -> s { guard m < 3; assign m = m + 1; }; }\nsystem P;",
        "int m;\nprocess P() { state s; init s; trans s -> s { guard m < 3; assign m = m + 1; }; }\nsystem P;",
    ),
    "W0409": Explanation(
        "channel priorities without `default`",
        "Internal edges and channels that are not listed have the priority `default`. UPPAAL's manual does not say "
        "where that is if the declaration does not. tachk checks queries with every place. If all answers agree, that "
        "is the answer; otherwise tachk gives the answer for `default` below all others, with a remark.",
        "chan a, b;\nchan priority a < b;\nprocess P() { state s; init s; }\nsystem P;",
        "chan a, b;\nchan priority default < a < b;\nprocess P() { state s; init s; }\nsystem P;",
    ),
    "W0410": Explanation(
        "template without locations",
        "A process of this template does nothing: it neither acts nor stops time. It can hold variables and functions "
        "that others use.",
        "process P() { int n; }\nsystem P;",
        "process P() { int n; init location idle; }\nsystem P;",
    ),
    "W0411": Explanation(
        "edge that is never taken",
        "A guard and the invariant of the location that the edge leaves exclude each other, in every process of the "
        "template: no value of the clock meets both.",
        "process P() { clock x; init location a { invariant x <= 5; to a { guard x >= 6; } } }\nsystem P;",
        "process P() { clock x; init location a { invariant x <= 5; to a { guard x >= 5; } } }\nsystem P;",
    ),
    "W0412": Explanation(
        "branchpoint without branches",
        "An edge through a branchpoint is one edge for each branch. Where no edge leaves the branchpoint there is "
        "none: the edges to it are never taken.",
        "process P() { state s; branchpoint b; init s; trans s -> b { }; }\nsystem P;",
        "process P() { state s; branchpoint b; init s; trans s -> b { }, b -> s { }; }\nsystem P;",
    ),
}
