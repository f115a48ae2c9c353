"""Damaged inputs of every form that a command reads, made from sound ones."""

from __future__ import annotations

import io
import re
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from random import Random

from tachk.resources import data_root
from tests.fuzz.worker import Case, run

WORDS = """
process location to guard sync assign init urgent committed branchpoint { } ( ) [ ] ; , : = == ! ? -> -u-> A[] E<> -->
forall exists sum property signal import gantt "x" " /* */ // /// \\ ' é € 99999999999 -1 0 1.5e3 1e999 nan inf const
int struct typedef state trans commit system < <= := =< << >> ** % / ? : chan priority default expect holds if else for
while return void clock bool meta broadcast select i:int[0,3] int[0,1000000000] a[1000000] deadlock time_unit x' imply
G F[0,5] U S W O H (1,inf) 5 s rise( change( fall( whenever must within `a b` true false 2147483647 -2147483648 not and
#0 $end $var b1x r1e5 $timescale <label <!DOCTYPE &lt; &#0; </ <nta> kind="guard" id="id0" event: edge:P:A:B:e{ sync:
""".split()  # noqa: SIM905
WORDS += ["\0", "\a", "\r", "\t", "\n", "\r\n", "\ufeff", "\u2028"]

NUMBERS = """
0 1 2 3 5 7 9 40 255 1000 -1 -5 1.5 0.1 1e3 1e308 1e309 1e-12 32767 32768 65536 1000000 1073741823 1073741824
2147483647 2147483648 4294967296 9223372036854775808 99999999999999999999 0x10 1_000 007
""".split()  # noqa: SIM905
_OPERATORS = "+ - * / % < <= == != >= > && || ! = += ? : , ; . ( ) [ ] { } & | ^ << >> imply and not -> '".split()  # noqa: SIM905
_TOKEN = re.compile(r"\d+|[A-Za-z_]\w*|[^\s\w]+")
_NUMBER = re.compile(r"\d+(\.\d+)?")

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

LIMITS = ("--max-states", "2000", "--max-seconds", "2", "--max-memory", "200M")
TIME = ("--max-seconds", "5")
WITHOUT_TIME = frozenset({"verify", "verifyta", "sentences", "models", "completion"})
"""Commands that have `LIMITS`, or nothing that takes long."""


def within_time(arguments: tuple[str, ...]) -> tuple[str, ...]:
    """The command line with a limit on time, which makes a command without an end one that is out of time."""
    name, *others = arguments
    return arguments if name in WITHOUT_TIME else (name, *TIME, *others)


@cache
def sound() -> dict[str, tuple[bytes, ...]]:
    """Sound inputs by the endings of their names."""
    folder = data_root() / "models"
    models = [MODEL, *(path.read_text(encoding="utf-8") for path in sorted((folder / "classics").glob("*.ta")))]
    texts = {
        "ta": [model.encode() for model in models],
        "q": [QUERIES.encode(), SMALL_QUERIES.encode()],
        "stl": [FORMULAS.encode()],
        "csv": [CSV.encode()],
        "vcd": [VCD.encode()],
        "parquet": [_parquet()],
    }
    for ending in ("xta", "xml", "tck"):
        texts[ending] = [_converted(model, ending) for model in texts["ta"][:4]]
    return {ending: tuple(text for text in found if text) for ending, found in texts.items()}


def sound_cases() -> Iterator[Case]:
    """Every use of every sound form, once; but for Parquet, whose reader starts threads."""
    for ending, contents in sound().items():
        if ending != "parquet":
            name = f"m.{ending}"
            yield from (Case(within_time(use(name)), {**_beside(), name: contents[0]}) for use in _uses(ending))


def _beside() -> dict[str, bytes]:
    texts = {"sound.ta": MODEL, "sound.stl": FORMULAS, "sound.csv": CSV, "small.xml": SMALL}
    return {name: text.encode() for name, text in texts.items()}


def random_input(random: Random) -> Case:
    """A command over a damaged file of some form; its other files are sound."""
    ending = random.choice(list(sound()))
    name = f"m.{ending}"
    damaged = _damaged(random, ending)
    files = {**_beside(), name: damaged}
    arguments = random.choice(_uses(ending))(name)
    if ending == "csv" and random.random() < 0.2:
        return Case(within_time(("monitor", "G (p -> F[0,5] q)", "-")), files, damaged)
    return Case(within_time(arguments), files)


_Use = Callable[[str], tuple[str, ...]]


def _uses(ending: str) -> list[_Use]:
    if ending in ("ta", "xta", "xml", "tck"):
        uses: list[_Use] = [
            lambda name: ("check", name),
            lambda name: ("check", "--for", "uppaal-4.1", name),
            lambda name: ("verify", *LIMITS, name),
            lambda name: ("verify", *LIMITS, "--format", "json", name, "E<> deadlock"),
            lambda name: ("convert", name, "out.ta"),
            lambda name: ("convert", name, "out.xml"),
            lambda name: ("convert", "--fix", name, "out.xta"),
            lambda name: ("convert", name, "out.json"),
            lambda name: ("export", "-o", "out.tck", name),
            lambda name: ("export", "-o", "out.xml", "--explain", name),
            lambda name: ("draw", "-o", "out.svg", name),
            lambda name: ("diff", name, "sound.ta"),
            lambda name: ("monitor", name, "sound.csv"),
            lambda name: ("explain", name),
        ]
        return [*uses, lambda name: ("fmt", "--stdout", name)] if ending in ("ta", "xta") else uses
    if ending == "q":
        return [
            lambda name: ("verify", *LIMITS, "-q", name, "sound.ta"),
            lambda name: ("verifyta", "small.xml", name),
            lambda name: ("verifyta", "-t0", "-y", "-u", "small.xml", name),
            lambda name: ("convert", name, "out.q"),
            lambda name: ("convert", "-q", name, "sound.ta", "out.ta"),
            lambda name: ("fmt", "--stdout", name),
        ]
    if ending == "stl":
        return [
            lambda name: ("monitor", name, "sound.csv"),
            lambda name: ("monitor", "--interpolation", "linear", name, "sound.csv"),
            lambda name: ("monitor", "--online", name, "sound.csv"),
            lambda name: ("explain", name),
        ]
    formula = "G (p -> F[0, 5 s] q && x < 3)"
    return [
        lambda name: ("monitor", formula, name),
        lambda name: ("monitor", "sound.stl", name, "--format", "json"),
        lambda name: ("monitor", formula, name, "--interpolation", "linear", "--time-robustness"),
        lambda name: ("monitor", formula, name, "--online"),
        lambda name: ("plot", formula, name, "-o", "out.svg"),
    ]


def _damaged(random: Random, ending: str) -> bytes:
    content = random.choice(sound()[ending])
    if ending == "parquet" or random.random() < 0.03:
        return _with_other_bytes(random, content)
    text = content.decode()
    if random.random() < 0.08:
        begin = random.randrange(len(text))
        text = text[begin : begin + random.randrange(1, 1500)]
    for _ in range(random.choice((1, 1, 1, 1, 1, 1, 2, 4))):
        text = random.choices(_DAMAGES, (4, 10, 3, 2, 1, 1))[0](random, text)
    return text.encode(errors="replace")


def _other_word(random: Random, text: str) -> str:
    """A number becomes another one, a name another name of the text, an operator another operator."""
    tokens = list(_TOKEN.finditer(text))
    if not tokens:
        return text
    token = random.choice(tokens)
    if token[0].isdigit():
        new = random.choice(NUMBERS)
    elif token[0][0].isalpha():
        new = random.choice([other[0] for other in tokens if other[0][0].isalpha()])
    else:
        new = random.choice(_OPERATORS)
    return text[: token.start()] + new + text[token.end() :]


def _other_number(random: Random, text: str) -> str:
    numbers = list(_NUMBER.finditer(text))
    if not numbers:
        return text
    number = random.choice(numbers)
    return text[: number.start()] + random.choice(NUMBERS) + text[number.end() :]


def _other_lines(random: Random, text: str) -> str:
    lines = text.splitlines(keepends=True)
    first, second = random.randrange(len(lines)), random.randrange(len(lines))
    kind = random.randrange(3)
    if kind == 0:
        lines[first], lines[second] = lines[second], lines[first]
    elif kind == 1:
        lines.insert(first, lines[second])
    else:
        del lines[first]
    return "".join(lines) or text


def _more_words(random: Random, text: str) -> str:
    place = random.randrange(len(text) + 1)
    if random.random() < 0.7:  # at the edge of a word, so that more of it can be read
        place = next((n for n in range(place, len(text)) if not text[n].isalnum()), place)
    return f"{text[:place]} {random.choice(WORDS)} {text[place:]}"


def _less(random: Random, text: str) -> str:
    place = random.randrange(len(text))
    return text[:place] + text[place + random.choice((1, 1, 3, 20)) :] or text


def _again(random: Random, text: str) -> str:
    begin, place = random.randrange(len(text)), random.randrange(len(text) + 1)
    return text[:place] + text[begin : begin + random.choice((5, 30, 200))] + text[place:]


_DAMAGES = (_other_word, _other_number, _other_lines, _more_words, _less, _again)


def _with_other_bytes(random: Random, content: bytes) -> bytes:
    changed = bytearray(content)
    for _ in range(random.randint(1, 8)):
        if not changed:
            break
        place = random.randrange(len(changed))
        kind = random.random()
        if kind < 0.6:
            changed[place] = random.randrange(256)
        elif kind < 0.8:
            del changed[place : place + random.choice((1, 4, 50))]
        else:
            changed[place:place] = bytes(random.choices(range(256), k=random.choice((1, 4, 30))))
    return bytes(changed)


def _converted(text: bytes, ending: str) -> bytes:
    """What tachk writes; empty where the model cannot be written so."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / f"out.{ending}"
        run(Case(("convert", "m.ta", str(out)), {"m.ta": text}))
        return out.read_bytes() if out.exists() else b""


def _parquet() -> bytes:
    import pyarrow
    import pyarrow.parquet

    table = pyarrow.table(
        {"time": [0.0, 0.5, 1.0, 9.0], "p": [True, False, True, False], "q": [0, 1, 0, 1], "x": [1.5, -2.0, 0.0, 3.0]}
    )
    written = io.BytesIO()
    pyarrow.parquet.write_table(table, written)
    return written.getvalue()
