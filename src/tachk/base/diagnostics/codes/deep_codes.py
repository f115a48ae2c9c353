"""Explanations of what `tachk check --deep` warns of."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

DEEP_CODES: dict[str, Explanation] = {
    "W0601": Explanation(
        "location that no run reaches",
        "Edges lead to this location, but no run takes one of them, in any process of the template. Every property "
        "that speaks of the location alone is decided by that. Found by exploring all states (`tachk check --deep`).",
        "int n;\nprocess P() { init location a { to a; to b { guard n > 0; } } location b { to a; } }\nsystem P;",
        "int n = 1;\nprocess P() { init location a { to a; to b; } location b { to a; } }\nsystem P;",
    ),
    "W0602": Explanation(
        "edge that no run takes",
        "Runs reach the location that this edge leaves, but none takes it, in any process of the template: its guard "
        "is false there, nobody synchronises with it, or the invariants forbid it.",
        "chan c;\nprocess P() { init location a { to b { sync c!; } } location b { to a; } }\n"
        "process Q() { init location a { to a { guard false; sync c?; } to b; } location b { to a; } }\nsystem P, Q;",
        "chan c;\nprocess P() { init location a { to b { sync c!; } } location b { to a; } }\n"
        "process Q() { init location a { to a { sync c?; } to b; } location b { to a; } }\nsystem P, Q;",
    ),
    "W0603": Explanation(
        "guard that is never true",
        "Runs reach the location that this edge leaves, but what its guard says about variables is false in each of "
        "these states.",
        "int n;\nprocess P() { init location a { to a { guard n > 3; assign n = 0; } to a { assign n = 1; } } }\n"
        "system P;",
        "int n;\nprocess P() { init location a { to a { guard n > 0; assign n = 0; } to a { assign n = 1; } } }\n"
        "system P;",
    ),
    "W0604": Explanation(
        "guard that is always true",
        "The guard is true in every state in which its process is where the edge begins. So it excludes nothing; "
        "perhaps it says something else than it should.",
        "int n;\nprocess P() { init location a { to a { guard n < 2; assign n = 1 - n; } } }\nsystem P;",
        "int n;\nprocess P() { init location a { to a { assign n = 1; } } }\nsystem P;",
    ),
    "W0605": Explanation(
        "time-lock",
        "A run ends where no action is possible and an invariant, or an urgent or committed location, lets no more "
        "time pass. No real system does that, so the model is wrong, and what a property says about all runs says "
        "nothing about what comes after this state.",
        "process P() { clock x; init location a { invariant x <= 3; } }\nsystem P;",
        "process P() { clock x; init location a { invariant x <= 3; to b; } location b { to b; } }\nsystem P;",
    ),
    "W0606": Explanation(
        "deadlock in which time passes",
        "A run ends where no action is possible any more, while time goes on. Some systems are meant to end; for "
        "others it is a mistake. `property ends : E<> deadlock;` asks for both kinds of deadlock.",
        "process P() { init location a { to b; } location b; }\nsystem P;",
        "process P() { init location a { to b; } location b { to a; } }\nsystem P;",
    ),
    "W0607": Explanation(
        "a Zeno loop",
        "This cycle can be taken again and again in finite time: infinitely many actions before a certain moment. No "
        "real system does that. A run that does is a counterexample to `A<>` and `-->`; --non-zeno does not count it. "
        "There is certainly none where a clock is reset in the cycle and compared there with at least 1. Where the "
        "message says `may go round`, the search for such a run has not come to its end.",
        "process P() { clock x; init location a { to b { assign x = 0; } } location b { to a { guard x > 0; } } }\n"
        "system P;",
        "process P() { clock x; init location a { to b { assign x = 0; } } location b { to a { guard x >= 1; } } }\n"
        "system P;",
    ),
    "W0610": Explanation(
        "every run ends in a time-lock",
        "No run of the model lets time pass without end: each comes to a state in which time stops and nothing is "
        "possible. Then `A[]` speaks of the short time before only.",
        "process P() { clock x; init location a { invariant x <= 3; to b; } location b { invariant x <= 5; } }\n"
        "system P;",
        "process P() { clock x; init location a { invariant x <= 3; to b; } location b { to b; } }\nsystem P;",
    ),
    "W0608": Explanation(
        "name that is never used",
        "Nothing in the model or its properties uses what is declared here. A typing mistake may be the reason.",
        "chan go, stop;\nprocess P() { init location a { to a { sync go!; } to a; } }\n"
        "process Q() { init location a { to a { sync go?; } } }\nsystem P, Q;",
        "chan go;\nprocess P() { init location a { to a { sync go!; } to a; } }\n"
        "process Q() { init location a { to a { sync go?; } } }\nsystem P, Q;",
    ),
    "W0609": Explanation(
        "variable that is never read",
        "The variable gets values, or the clock is reset, but no guard, invariant, update or property looks at it. It "
        "only "
        "makes more states.",
        "int n;\nprocess P() { init location a { to a { assign n = 1; } } }\nsystem P;",
        "int n;\nprocess P() { init location a { to a { assign n = 1; } } }\nsystem P;\nproperty p : A[] n <= 1;",
    ),
}
