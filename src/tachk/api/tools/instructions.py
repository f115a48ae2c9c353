"""What the server tells an agent about tachk before the first call."""

from __future__ import annotations

EXAMPLE = """\
const int LIMIT = 20;
chan press;

process Lamp() {
    clock x;
    init location off { to on { sync press?; assign x = 0; } }
    location on { invariant x <= LIMIT; to off { guard x >= 5; sync press?; } to off { guard x == LIMIT; } }
}

process User() {
    clock y;
    init location idle { to idle { guard y >= 3; sync press!; assign y = 0; } }
}

system Lamp, User;

property goes_out "the lamp is never on for long" : A[] Lamp.on imply Lamp.x <= LIMIT;
property can_be_on : E<> Lamp.on;
property answered : Lamp.on --> Lamp.off;
"""
"""A model that shows the language; the tests verify it."""

INSTRUCTIONS = f"""\
tachk checks networks of timed automata: protocols and controllers whose correctness depends on time.

Write a model, call `check` until it has no errors, then `verify`. An answer that fails comes with a run; `step`
replays it and shows what else could happen. `simulate` estimates, `verify` proves. `monitor` judges recorded traces by
formulas, `conform` compares recorded events with a model. `explain` explains codes of messages. Every answer lists its
evidence: what was judged, and by what. "unknown" means that a limit was hit; it is never "holds".

A model can be given as text or as the path of a file. The language, by example:

{EXAMPLE}
An edge has, in this order and each at most once: select, guard, sync, assign. Locations have invariants; `committed`
and `urgent` locations let no time pass. Queries: A[] p (always), E<> p (possible), A<> p (inevitable), p --> q (leads
to), E[] p, sup: e, inf: e, deadlock; formulas such as G (p -> F[0, 5] q); English sentences such as
"Whenever Lamp.on, within 20, Lamp.off must be true."
"""
