"""Random models in which a variable counts through the numbers of processes: for tests of what may be forgotten of it.

Most use it only in what edges require, offer and change. A share uses it where nothing may be forgotten: in invariants,
on both sides of a synchronisation, with urgent and broadcast channels, behind functions.
"""

from __future__ import annotations

from random import Random

from tests.support.symmetric.cases import SymmetricCase

_GUARDS = (
    "next <= N",
    "next <= N",
    "next == N + 1",
    "next < N",
    "next > 0",
    "next <= N && y >= 1",
    "count < 2",
    "y < 2",
)
_UPDATES = (
    "next = next + 1",
    "next++",
    "next += 1",
    "next = 1",
    "next = 1, next++",
    "y = 0",
    "count = (count + 1) % 3",
)
_SYNCHRONISATIONS = ("call[next]!", "call[next]!", "plain!", "all!", "")
_ODD_GUARDS = ("next <= N && y < next", "odd(next)", "next == 2", "next > 0 imply count < 1")
_ODD_UPDATES = (
    "bump(next)",
    "count = next++ % 3",
    "next = 2",
    "count = next % 3",
    "next = next",
    "reset()",
    "next = odd(next)",
)
_ODD_SYNCHRONISATIONS = ("hurry!", "all?", "call[next]?", "plain?")
_OF_PROCESS = ("call[me]?", "call[me]?", "plain?", "all?", "hurry?", "call[me]!", "")
_QUERIES = (
    "E<> exists (i : id_t) P(i).L2",
    "E<> forall (i : id_t) P(i).L1",
    "A[] forall (i : id_t) forall (j : id_t) P(i).L2 && P(j).L2 imply i == j",
    "E<> count == 2 && S.B",
    "E<> P(1).L2 && P(2).L0",
    "E<> exists (i : id_t) P(i).L1 && P(i).x > 2 && S.A",
    "E<> next == 2",
)


def random_counted_case(random: Random) -> SymmetricCase:
    """A case with two or three processes and one that goes through them."""
    odd = random.random() < 0.3
    low, high, last = random.choice(((1, "N + 1", "next <= N"), (1, "N + 1", "next <= N"), (0, "N", "next < N")))
    edges: dict[str, list[str]] = {"A": [], "B": []}
    count = random.randint(3, 5)
    for number in range(count):
        edges["A" if number == 0 else random.choice("AB")].append(_edge(random, odd and random.random() < 0.3, last))
    kinds = [random.choice(("", "", "committed ", "urgent ")) for _ in range(2)]
    limits = [random.choice(("", "invariant y <= 2;")) for _ in range(2)]
    if odd and random.random() < 0.2:
        limits[1] = "invariant y <= next;"
    places = "\n".join(
        f"{'init ' if place == 'A' else ''}{kind}location {place} {{ {limit} {' '.join(edges[place])} }}"
        for place, kind, limit in zip("AB", kinds, limits, strict=True)
    )
    stays = [_of_process(random, source, odd) for source in (0, 0, 1, 1, 2)]
    inside = "\n".join(
        f"{'init ' if number == 0 else ''}location L{number} {{ {' '.join(e for at, e in stays if at == number)} }}"
        for number in range(3)
    )
    text = _TEXT.format(
        size=random.choice((2, 3)), low=low, high=high, begin=random.choice((low, 1)), places=places, inside=inside
    )
    return SymmetricCase(text, tuple(random.sample(_QUERIES, 4)), odd)


def _edge(random: Random, odd: bool, last: str) -> str:
    guard = random.choice(_ODD_GUARDS if odd and random.random() < 0.4 else _GUARDS)
    synchronisation = random.choice(_ODD_SYNCHRONISATIONS if odd and random.random() < 0.4 else _SYNCHRONISATIONS)
    updates = [random.choice(_ODD_UPDATES if odd and random.random() < 0.5 else _UPDATES)]
    if "next + 1" in updates[0] or "++" in updates[0] or "+=" in updates[0]:
        guard = f"{last} && y < 2" if "y" in guard else last
    updates += random.sample(("y = 0", "count = (count + 1) % 3"), random.randint(0, 1))
    return _written(random.choice("AB"), guard, synchronisation, updates)


def _of_process(random: Random, source: int, odd: bool) -> tuple[int, str]:
    guard = random.choice(("next == me", "next != me", "x >= 1", "x < 2", "x == 2"))
    synchronisation = random.choice(_OF_PROCESS)
    if synchronisation and not odd:
        guard = "x <= 2"
    updates = [random.choice(("x = 0", "x = 0", "next = me" if odd else "x = 0"))]
    return source, _written(f"L{random.choice([n for n in range(3) if n != source])}", guard, synchronisation, updates)


def _written(target: str, guard: str, synchronisation: str, updates: list[str]) -> str:
    sync = f"sync {synchronisation}; " if synchronisation else ""
    clock_guard = synchronisation in ("hurry!", "hurry?", "all?") and any(c in guard for c in ("x", "y <", "y >"))
    condition = "" if clock_guard and "next" not in guard else f"guard {guard}; "
    return f"to {target} {{ {condition}{sync}assign {', '.join(updates)}; }}"


_TEXT = """
const int N = {size};
typedef int[1, N] id_t;
int[{low}, {high}] next = {begin};
int[0, 2] count = 0;
chan call[N + 2], plain;
urgent chan hurry;
broadcast chan all;
clock y;

void bump(int[0, 9] &k) {{ if (k <= N) k = k + 1; else k = 1; }}
void reset() {{ next = 1; }}
int odd(int k) {{ return k % 2; }}

process Server() {{
    {places}
}}

process P(const id_t me) {{
    clock x;
    {inside}
}}

S = Server();
system S, P;
"""
