"""Random models of processes in a ring, and of rings that are not quite: for tests of symmetry.

Instances know their number and that of their neighbour. A share of the models has something that breaks the ring: an
order, a number, an instance with another constant, an initial value.
"""

from __future__ import annotations

from random import Random

from tests.support.symmetric.cases import SymmetricCase, edge_text

_GUARDS = (
    "fork[me] == 0",
    "fork[RIGHT] == 0",
    "fork[me] == 1 && fork[RIGHT] == 0",
    "token == me",
    "token == RIGHT",
    "token == N",
    "token != RIGHT",
    "next == me",
    "next == (me + 1) % N",
    "fork[(next + 1) % N] == 0",
    "forall (i : id_t) fork[i] == fork[(i + 1) % N]",
    "exists (i : id_t) i != me && fork[i] == 1",
    "!knows[me][next]",
    "count < 2",
)
_UPDATES = (
    "fork[me] = 1",
    "fork[RIGHT] = 1",
    "fork[me] = 0",
    "fork[RIGHT] = 1 - fork[RIGHT]",
    "token = me",
    "token = RIGHT",
    "token = N",
    "next = (next + 1) % N",
    "next = (next - 1 + N) % N",
    "token = next",
    "knows[me][next] = true",
    "count = (count + 1) % 3",
    "hand_on()",
)
_BREAKING_GUARDS = (
    "token < me",
    "me > 0",
    "token == 1",
    "next > me",
    "(next + me) % 2 == 0",
    "(next + 1) % (N + 1) == me",
)
_BREAKING_UPDATES = (
    "token = 1",
    "count = me % 3",
    "fork[0] = 1",
    "token = (token + 1) % (N + 1)",
    "knows[0][me] = true",
)
_SYNCHRONISATIONS = (
    "to[me]?",
    "to[RIGHT]!",
    "to[next]!",
    "to[(next + 1) % N]!",
    "all!",
    "all?",
    "hurry[me]?",
    "hurry[RIGHT]!",
)
_CALM = 4
"""The first so many leave each process a time of its own."""
_QUERIES = (
    "E<> exists (i : id_t) P(i).L1 && P((i + 1) % N).L2",
    "A[] forall (i : id_t) P(i).L1 imply !P((i + 1) % N).L1",
    "E<> count == 2",
    "E<> forall (i : id_t) P(i).L1",
    "A[] token == N or fork[token] == 0",
    "E<> exists (i : id_t) P(i).L1 && P(i).x > 2 && P((i + 1) % N).x < 1",
    "E<> P(1).L1 && token == 0",
    "E<> P(0).L2",
    "A[] not deadlock",
    "E<> exists (i : id_t) token == i && P(i).next == i",
)


def random_ring_case(random: Random, breaking: float = 0.25) -> SymmetricCase:
    """A case; in the share ``breaking`` of the models something breaks the ring."""
    size = random.choice((2, 3, 3, 4))
    broken = random.random() < breaking
    way = random.choice(("guard", "update", "constant", "initial", "fork", "every second")) if broken else ""
    edges: dict[int, list[str]] = {0: [], 1: [], 2: []}
    count = random.randint(3, 5)
    odd = random.randrange(count)
    calm = random.random() < 0.6
    synchronisations = _SYNCHRONISATIONS[:_CALM] if calm else _SYNCHRONISATIONS
    for number in range(count):
        source = number if number < 3 else random.randrange(3)
        edges[source].append(_edge(random, way if number == odd else "", synchronisations))
    kinds = [random.choice(("", "", "", "", "", "urgent ", "" if calm else "committed ")) for _ in range(3)]
    limits = [random.choice(("", "", "x <= 2", "x <= 3")) for _ in range(3)]
    if way in ("constant", "every second"):
        limits[1] = "x <= 2 + (me > 0 ? 1 : 0)" if way == "constant" else "x <= 2 + me % 2"
    locations = "\n".join(
        f"    {'init ' if number == 0 else ''}{kinds[number]}location L{number} {{ "
        f"{f'invariant {limits[number]}; ' if limits[number] else ''}{' '.join(edges[number])} }}"
        for number in range(3)
    )
    helper = _HELPER if random.random() < 0.3 else ""
    text = _TEXT.format(
        size=size,
        token="0" if way == "initial" else "N",
        next=random.choice(("me", "(me + 1) % N")),
        forks="{" + ", ".join("1" if way == "fork" and not number else "0" for number in range(size)) + "}",
        locations=locations,
        channels="" if calm else "urgent chan hurry[N];\nbroadcast chan all;\n",
        helper=helper,
        system="P, Q" if helper else "P",
    )
    return SymmetricCase(text, tuple(random.sample(_QUERIES, 4)), broken)


def _edge(random: Random, way: str, synchronisations: tuple[str, ...]) -> str:
    guards = [random.choice(_GUARDS)] if random.random() < 0.5 else []
    if way == "guard":
        guards = [random.choice(_BREAKING_GUARDS)]
    synchronisation = random.choice(synchronisations) if random.random() < 0.4 else ""
    if random.random() < 0.4 and synchronisation not in ("hurry[me]?", "hurry[RIGHT]!", "all?"):
        guards.append(random.choice(("x >= 1", "x < 2", "x > 2", "x == 2")))
    updates = random.sample(_UPDATES, random.choice((0, 1, 1, 2)))
    if way == "update":
        updates.append(random.choice(_BREAKING_UPDATES))
    if random.random() < 0.5:
        updates.append("x = 0")
    parts = []
    if random.random() < 0.15:
        parts.append("select k : id_t;")
        guards.append("k != me")
        updates.append("token = (k + 1) % N")
    return edge_text(random.randrange(3), parts, guards, synchronisation, updates)


_HELPER = """
process Q() {
    clock y;
    init location M {
        to M { select k : id_t; guard fork[k] == 1; sync to[k]!; assign fork[k] = 0; }
        to M { guard y > 1 && token != N; assign token = N, y = 0; }
    }
}
"""

_TEXT = """\
const int N = {size};
typedef int[0, N - 1] id_t;
int[0, N] token = {token};
int[0, 1] fork[N] = {forks};
bool knows[N][N];
int[0, 2] count = 0;
chan to[N];
{channels}
process P(const id_t me) {{
    const int RIGHT = (me + 1) % N;
    clock x;
    id_t next = {next};

    void hand_on() {{ if (token == me) token = RIGHT; }}

{locations}
}}
{helper}
system {system};
"""
