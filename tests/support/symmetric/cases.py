"""Random models of interchangeable processes, and of processes that are not quite: for tests of symmetry.

The models are text. Instances of one template know their numbers and use them as names: they are compared, stored in
variables, arrays and queues, chosen, sent along channels. A share of the models has something that tells instances
apart, which a search may not overlook: an order, a sum, an instance with another constant. Variables may begin with the
numbers of some instances.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

_GUARDS = (
    "owner == me",
    "owner == 0",
    "owner != me",
    "friend == me",
    "friend != 0",
    "mark[me] == 1",
    "friend != 0 && mark[friend] == 0",
    "count < 2",
    "forall (i : id_t) mark[i] == 0",
    "exists (i : id_t) i != me && mark[i] == 1",
    "sum (i : id_t) mark[i] < 2",
    "length > 0 && queue[0] == me",
    "is_free()",
)
_UPDATES = (
    "owner = me",
    "owner = 0",
    "friend = owner",
    "friend = me",
    "owner = friend",
    "mark[me] = 1",
    "mark[me] = 1 - mark[me]",
    "mark[me] = 0",
    "count = (count + 1) % 3",
    "push(me)",
    "pop()",
    "last[me] = owner",
    "owner = last[me]",
    "claim()",
)
_BREAKING_GUARDS = ("owner < me", "me > 1", "owner == 1", "count < me", "(owner + me) % 2 == 0", "friend >= owner")
_BREAKING_UPDATES = (
    "owner = 1",
    "count = me % 3",
    "owner = (owner + 1) % (N + 1)",
    "mark[1] = 1",
    "leave()",
)
_SYNCHRONISATIONS = ("call!", "call?", "to[me]?", "all!", "all?", "to[friend]!", "hurry!", "hurry?")
_QUERIES = (
    "E<> exists (i : id_t) P(i).L1 && owner == i",
    "A[] forall (i : id_t) forall (j : id_t) P(i).L1 && P(j).L1 imply i == j",
    "E<> count == 2",
    "A[] owner == 0 or mark[owner] == 0",
    "E<> forall (i : id_t) P(i).L1",
    "E<> exists (i : id_t) P(i).L1 && P(i).x > 2",
    "E<> P(1).L1 && owner == 2",
    "E<> P(2).L2",
    "A[] P(1).friend != 2",
    "A[] not deadlock",
    "E<> length == 2 && queue[0] != queue[1]",
    "E<> P(1).x > 3 && P(2).x < 1",
    "A[] not ((P(1).L1 || owner == 1) && (P(2).L1 xor owner == 2))",
)


@dataclass(frozen=True, slots=True)
class SymmetricCase:
    """A model and formulas about it.

    Attributes:
        broken: something in it was meant to tell instances apart.
    """

    text: str
    queries: tuple[str, ...]
    broken: bool


def random_symmetric_case(random: Random, breaking: float = 0.3) -> SymmetricCase:
    """A case; in the share ``breaking`` of the models something tells instances apart."""
    size = random.choice((2, 2, 3))
    broken = random.random() < breaking
    way = random.choice(("guard", "update", "priority", "constant", "initial")) if broken else ""
    edges: dict[int, list[str]] = {0: [], 1: [], 2: []}
    count = random.randint(4, 6)
    odd = random.randrange(count)
    for number in range(count):
        source = number % 3 if number < 3 else random.randrange(3)
        edges[source].append(_edge(random, way if number == odd else ""))
    kinds = [random.choice(("", "", "", "", "urgent ", "committed ")) for _ in range(3)]
    limits = [random.choice(("", "", "x <= 2", "x <= 3")) for _ in range(3)]
    if way == "constant":
        limits[1] = "x <= 2 + (me > 1 ? 1 : 0)"
    locations = "\n".join(
        f"    {'init ' if number == 0 else ''}{kinds[number]}location L{number} {{ "
        f"{f'invariant {limits[number]}; ' if limits[number] else ''}{' '.join(edges[number])} }}"
        for number in range(3)
    )
    first = 1 if way == "initial" else 0
    helper = _helper(random)
    last, queue = (", ".join(str(random.choice((0, 0, 0, 1, 2))) for _ in range(length)) for length in (size + 1, 3))
    system = "system P, Q;" if helper else "system P;"
    if way == "priority":
        system = "A = P(1); B = P(2);\nsystem A < B, Q;" if helper else "A = P(1); B = P(2);\nsystem A < B;"
    queries = tuple(random.sample(_QUERIES, 4))
    if way == "priority":
        queries = ("E<> count == 2", "A[] not deadlock", "E<> A.L1 && owner == 2", "E<> B.L2")
    text = _TEXT.format(
        size=size, first=first, last=last, queue=queue, locations=locations, helper=helper, system=system
    )
    return SymmetricCase(text, queries, broken)


def _edge(random: Random, way: str) -> str:
    guards = [random.choice(_GUARDS)] if random.random() < 0.5 else []
    if way == "guard":
        guards = [random.choice(_BREAKING_GUARDS)]
    synchronisation = random.choice(_SYNCHRONISATIONS) if random.random() < 0.45 else ""
    clock = random.choice(("x >= 1", "x < 2", "x > 2", "x == 2"))
    if random.random() < 0.4 and synchronisation not in ("hurry!", "hurry?", "all?"):
        guards.append(clock)
    if synchronisation == "to[friend]!":
        guards.append("friend != 0")
    updates = random.sample(_UPDATES, random.choice((0, 1, 1, 2)))
    if way == "update":
        updates.append(random.choice(_BREAKING_UPDATES))
    if random.random() < 0.5:
        updates.append("x = 0")
    parts = []
    if random.random() < 0.15:
        parts.append("select k : id_t;")
        guards.append("k != me")
        updates.append("owner = k")
    return edge_text(random.randrange(3), parts, guards, synchronisation, updates)


def edge_text(target: int, parts: list[str], guards: list[str], synchronisation: str, updates: list[str]) -> str:
    """An edge to the location with this number; `parts` come before its guard."""
    parts = list(parts)
    if guards:
        parts.append(f"guard {' && '.join(f'({guard})' for guard in guards)};")
    if synchronisation:
        parts.append(f"sync {synchronisation};")
    if updates:
        parts.append(f"assign {', '.join(updates)};")
    return f"to L{target} {{ {' '.join(parts)} }}"


def _helper(random: Random) -> str:
    """A process beside the instances, which talks to them."""
    if random.random() < 0.5:
        return ""
    edges = random.sample(
        (
            "to M { sync call?; assign y = 0; }",
            "to M { guard y > 1; sync all!; assign y = 0; }",
            "to M { select k : id_t; sync to[k]!; assign owner = k; }",
            "to M { guard length > 0; sync to[queue[0]]!; assign pop(); }",
            "to M { sync all?; assign count = 0; }",
            "to M { guard owner != 0 && mark[owner] == 1; assign owner = 0; }",
        ),
        2,
    )
    return f"process Q() {{\n    clock y;\n    init location M {{ {' '.join(edges)} }}\n}}\n"


_TEXT = """\
const int N = {size};
typedef int[1, N] id_t;
int[0, N] owner = {first};
int[0, 1] mark[N + 1];
int[0, N] last[N + 1] = {{{last}}};
int[0, N] queue[3] = {{{queue}}};
int[0, 3] length = 0;
int[0, 2] count = 0;
chan call;
chan to[N + 1];
broadcast chan all;
urgent chan hurry;

bool is_free() {{ return length == 0 && owner == 0; }}
void push(int[0, N] who) {{ if (length < 3) {{ queue[length] = who; length = length + 1; }} }}
void pop() {{
    int[0, 3] i = 0;
    if (length > 0) {{
        length = length - 1;
        while (i < length) {{ queue[i] = queue[i + 1]; i = i + 1; }}
        queue[length] = 0;
    }}
}}

process P(const id_t me) {{
    clock x;
    int[0, N] friend = 0;

    void claim() {{ if (owner == 0) owner = me; else friend = owner; }}
    void leave() {{ if (me == 1) owner = 0; }}

{locations}
}}

{helper}
{system}
"""
