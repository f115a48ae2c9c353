"""Sound files that are written here, for readers to be given in part, changed, or whole beside others."""

from __future__ import annotations

MODEL = """\
time_unit = 1 ms;
const int N = 3; int[0,5] n = 0; int t[4] = {1, 2, 3, 4}; bool flag; typedef struct { int a; bool b; } pair; pair r;
clock x; broadcast chan tick; chan c[2]; urgent chan now; meta int m;
int f(int a, int &b) { int i; for (i = 0; i < 3; i++) { b += t[i]; } while (b > 9) b = b / 2; return a * b % 7; }
process P(const int[0,1] id) {
    clock y;
    init location A { invariant x <= 5 && y <= 9; to B { select i : int[0,1]; guard x >= 2 && n < N; sync c[i]!;
        assign n = n + 1, x = 0, m = f(n, n); } to F; }
    urgent location B { to A { guard forall (j : int[0,3]) t[j] > 0; assign r.a = t[n % 4], y = 0; } }
    branchpoint F { to A { probability 2; } to B { probability 1; assign flag = !flag; } }
}
process Q() {
    init location L { to L { sync c[0]?; } to M { sync tick?; } to L { guard n > 0; sync tick!; assign n = 0; } }
    committed location M { to L; }
}
system P, Q;
property safe : A[] n <= N expect holds;
property dead : E<> deadlock;
property soon : G (rise(P(0).B) -> F[0, 20 ms] P(0).A);
property said : whenever P(0).B becomes true, within 20 ms, P(0).A must be true.;
"""

SMALL = """\
<?xml version="1.0" encoding="utf-8"?>
<nta><declaration>clock x; int[0,3] n; chan c;</declaration>
<template><name>P</name><declaration>clock y;</declaration>
<location id="id0"><name>A</name><label kind="invariant">x &lt;= 5</label></location>
<location id="id1"><name>B</name><urgent/></location><init ref="id0"/>
<transition><source ref="id0"/><target ref="id1"/><label kind="guard">x &gt;= 2 &amp;&amp; n &lt; 3</label>
<label kind="synchronisation">c!</label><label kind="assignment">n = n + 1, y = 0</label></transition>
<transition><source ref="id1"/><target ref="id0"/><label kind="assignment">x = 0</label></transition></template>
<template><name>Q</name><location id="id0"/><init ref="id0"/>
<transition><source ref="id0"/><target ref="id0"/><label kind="synchronisation">c?</label></transition></template>
<system>system P, Q;</system>
<queries><query><formula>E&lt;&gt; n == 3 and P.B</formula><comment>all</comment></query>
<query><formula>A[] n &lt;= 2</formula></query><query><formula>A[] not deadlock</formula></query></queries></nta>
"""

SMALL_QUERIES = (
    "E<> n == 3 and P.y > 1\n\nA[] not deadlock // always\n/* not */\nA[] n <= 2\nsup: n\nn == 1 --> n == 2\n"
)

QUERIES = """\
A[] forall (i : int[0,1]) not P(i).B imply P(i).y - x <= 3 \\
 and not deadlock
/* EXPECT:T */
E<> n == 2 && Q.M
sup{n > 1}: x, P(0).y
n == 1 --> n == 0
Pr[<=10](<> n == 3)
E<> t[n] > 2 and r.a == 1
"""

FORMULAS = """\
G (p -> F[0, 180 s] q && x - y <= 3.5)
(p U[0, 5) q) W (q S[2, 9] p) || !rise(p) && change(x + 1)
H[0, 12 s] O[1, 2] abs(x) < 3
whenever p becomes true, within 20 s, q must stay true for at least 5 s.
within_limits: G (x < 2 && y >= -1.5)
"""

CSV = """\
time [s],p,q,x [V],y
0,0,0,1.5,-2
0.25,1,0,2.5,3
1,true,false,-1e3,0
1,1,1,0.1,nan
7.125,0,1,4,1
20,0,0,0,0
"""

VCD = """\
$date today $end
$timescale 10 ns $end
$var wire 1 ! p $end
$var reg 4 " q [3:0] $end
$var integer 32 # x $end
$var real 64 $ y $end
$enddefinitions $end
#0
$dumpvars
0!
bx "
b11111111111111111111111111111110 #
r1.5 $
$end
#5
1!
b0011 "
#10
0!
r-2.25 $
#20
"""

LAMP = """\
time_unit = 1 ms;
const int LIMIT = 3;
clock x; int[0,9] n = 0; bool lit = false; chan press; broadcast chan light[2]; meta int level = 0;
process Lamp() {
    clock y;
    init location off { to on { sync press?; assign y = 0, n = n < LIMIT ? n + 1 : 0, lit = true, level = 7; } }
    location on { invariant y <= 5; to off { guard y >= 2; sync light[0]!; assign lit = false, x = 0; } }
}
process User(const int[0,1] id) {
    clock z;
    init location idle { invariant z <= 9; to idle { guard z >= 1; sync press!; assign z = 0; } }
}
system Lamp, User;
property few : A[] n <= LIMIT expect holds;
property live : Lamp.on --> Lamp.off;
property shown : E<> n == 2 and Lamp.y > 1 expect fails;
property soon : G (rise(lit) -> F[0, 5 ms] !lit);
property likely : Pr[<=20](<> n == 2);
"""

DIMMER = """\
time_unit = 1 ms;
chan press; broadcast chan light[2]; meta int level = 0;
process Lamp() {
    clock since;
    init location Off { to Waking { sync press?; assign since = 0; } }
    location Waking { invariant since <= 5; to On { guard since >= 3; sync light[1]!; assign level = 7, since = 0; } }
    location On { invariant since <= 100; to Off { guard since >= 50; sync light[0]!; assign level = 0; } }
}
process Finger() { init location Idle { to Idle { sync press!; } } }
system Lamp, Finger;
recording {
    replaces Finger;
    visible press as press();
    visible light[on] as light(on, level);
    tolerance 1 ms;
    late output 2 ms;
}
"""

PRESSED = """\
time [ms],event,on,level,id,after
2,press,,,a,
6.2,light,1,7,,a
60,light,0,0,,
61,press,,,,
65.5,light,1,7,,
"""

PRESSED_LINES = """\
{"time [ms]": 2, "event": "press", "id": "a"}
{"time [ms]": 6.2, "event": "light", "on": true, "level": 7, "after": "a"}
{"time [ms]": 60, "event": "light", "on": 0, "level": 0}
{"time [ms]": 61, "event": "press"}
"""

QUEUE = """\
time_unit = 1 min; broadcast chan arrive; int[0, 1000] waiting = 0; clock quiet; hybrid clock heat;
double load = 1.5;
process Door() {
    init location Open { invariant heat' == 2.5 - load / 2 && quiet' == 1; exponential_rate 1 : 2;
        to Open { sync arrive!; assign waiting = waiting + 1, quiet = 0, load = random(2.0); } to F; }
    branchpoint F { to Open { probability 3; } to Open { probability 1; assign waiting = 0; } }
}
process Counter() {
    init location Idle { to Serving { sync arrive?; } }
    location Serving { exponential_rate 1; to Next { guard waiting > 0; assign waiting = waiting - 1; } }
    committed location Next { to Idle { guard waiting == 0; } to Serving { guard waiting > 0; } }
}
system Door, Counter;
property crowded: Pr[<=20](<> waiting >= 5) >= 0.5;
property mean: E[<=20; 20](max: waiting + load);
"""

STATISTICAL = """\
Pr[<=10](<> waiting >= 3)
Pr[<=10; 30](<> waiting >= 3) >= Pr[<=12](<> quiet >= 2)
Pr[quiet<=3]([] waiting < 9) >= 0.25
E[<=10; 20](max: waiting)
simulate [<=3; 2] {waiting, quiet, heat}
simulate [<=3; 5] {waiting} : 1 : waiting > 2
Pr(<>[0,5] waiting >= 2)
"""

RULES = """\
# what is lost
drop the 2nd ACKNACK agent->client on 9001
drop 12.5 % of DATA between 1.5 s and 2 min
delay 3rd to 5th HEARTBEAT by 20 ms to 40 ms
delay every DATA since ACKNACK until the 2nd HEARTBEAT
duplicate WRITE_DATA 17 client->agent after 300 ms
"""

REQUIREMENTS = """\
light: whenever button becomes true, within 5 s, lamp must be true.
calm: whenever alarm becomes true, lamp must not occur for 10 s.
steady: whenever lamp becomes true, lamp must stay true for at least 2 s.
const int N = 3;
dark: whenever battery < 20, heater must not occur.
frost: whenever heater && battery < 10 * N, fan must be true.
timed: G (rise(fan) -> F[0, 3 s] !fan)
"""

LINES = (
    '{"t": 0, "x": 1, "s": "a", "v": [1, {"z": true}]}\n{"t": 0.30000000000000004, "x": -1.5e3}\n'
    '{"t": 1, "x": null, "s": "b", "v": [Infinity, {"z": false}]}\n'
)
RUNS = "run,time,P,n\n0,0,A,1\n0,1.25,B,2\n1,0,A,1\n1,2,B,3\n"
SHEET = 'sep=;\ntime;x;s\n0;1,5;a\n0,5;-2,25;"b c"\n0,75;;\n'
STRINGS = VCD.replace(
    "$enddefinitions", "$scope module model $end $var string 1 % P $end $upscope $end\n$enddefinitions"
)

TYPED = """\
help
list
1
delay 2
1 @ 2.5
2 after 1/3
undo
goto 1
random 3
history
show
save a.run
load a.run
redo
restart
quit
"""

RUN = """\
# run 0 of lamp.ta, which reached the time limit
3.466743475 press!  User(1): idle -> idle & Lamp: off -> on
8.092923671 light[0]!  Lamp: on -> off
+0.5 press!  User(0): idle -> idle & Lamp: off -> on
12
"""

SMALL_TEXT = """\
clock x; int[0, 3] n; chan c;
process P() {
    clock y;
    init location A { invariant x <= 5; to B { guard x >= 2 && n < 3; sync c!; assign n = n + 1, y = 0; } }
    urgent location B { to A { assign x = 0; } }
}
process Q() { init location _id0 { to _id0 { sync c?; } } }
system P, Q;
property all : E<> n == 3 && P.B;
"""
"""The beginning of `SMALL` in tachk's language."""
