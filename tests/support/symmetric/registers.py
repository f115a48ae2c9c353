"""Random models of processes that each have a register, another process whose edges stand in an order of their own.

This is how models look whose authors have no variables for what several processes write: a process asks its register on
a channel for each value, and writes all registers by one broadcast. Updates that may come in any order come in any. A
share of the models has something that tells the processes apart.
"""

from __future__ import annotations

from random import Random

from tests.support.symmetric.cases import SymmetricCase, edge_text

_SIZE = 3
_OWN = (
    ("is{i}_0!", ()),
    ("is{i}_{i}!", ()),
    ("set{i}!", ("r1 = {i}", "r2 = {i}", "r3 = {i}", "last{i} = 1")),
    ("clear{i}!", ("r1 = 0", "r2 = 0", "r3 = 0")),
    ("clear{i}!", ("last1 = 0", "last2 = 0", "last3 = 0", "y = 0")),
    ("", ("last{i} = 2", "y = 0")),
    ("", ("r{i} = {i}", "last{i} = 1", "last{i} = 0")),
)
_ASKED = (
    "guard r{i} == {k}; sync is{i}_{k}?;",
    "guard r{i} == {k} && y > 1; assign r{i} = 0;",
    "guard r{i} != {k}; sync is{i}_{k}?; assign last{i} = 0;",
)
_QUERIES = (
    "E<> P1.L1 && r1 == 2",
    "A[] not (P1.L2 && P2.L2)",
    "E<> r1 == 3 && r2 == 0",
    "A[] last1 == 0 or last2 == 0",
    "E<> r1 == 1 && r2 == 2",
    "E<> P1.L1 && P2.L1 && P3.L1",
    "A[] not deadlock",
    "E<> last1 == 2 && r1 == 1",
    "E<> P2.L2 && x2 > 3",
)


def random_register_case(random: Random, breaking: float = 0.3) -> SymmetricCase:
    """A case; in the share ``breaking`` of the models something tells processes apart."""
    broken = random.random() < breaking
    edges = [(number % 3, *_edge(random)) for number in range(random.randint(4, 6))]
    limits = [random.choice(("", "", "x{i} <= 2", "x{i} <= 3")) for _ in range(3)]
    asked = [each for each in _ASKED if random.random() < 0.6] or [_ASKED[0]]
    odd = random.randint(1, _SIZE) if broken else 0
    wrong = random.choice(("process", "register"))
    processes, registers = [], []
    for number in range(1, _SIZE + 1):
        other = random.choice([each for each in range(1, _SIZE + 1) if each != number])
        processes.append(_process(random, number, edges, limits, other if (number, wrong) == (odd, "process") else 0))
        registers.append(_register(random, number, asked, other if (number, wrong) == (odd, "register") else 0))
    text = _TEXT.format(
        channels="\n".join(_channels(number) for number in range(1, _SIZE + 1)),
        processes="\n".join(processes), registers="\n".join(registers),
    )  # fmt: skip
    return SymmetricCase(text, tuple(random.sample(_QUERIES, 4)), broken)


def _edge(random: Random) -> tuple[int, str, list[str], list[str]]:
    """The target, what is done on a channel, guards, and updates."""
    channel, updates = random.choice(_OWN)
    guards = [random.choice(("x{i} >= 1", "x{i} < 2", "x{i} > 2"))] if random.random() < 0.5 else []
    return random.randrange(3), channel, guards, [*updates, "x{i} = 0"]


def _process(
    random: Random, number: int, edges: list[tuple[int, int, str, list[str], list[str]]], limits: list[str], wrong: int
) -> str:
    """With ``wrong``, if it is not 0, as the value that it writes."""

    def text(part: str) -> str:
        return part.replace("= {i}", f"= {wrong or number}").format(i=number)

    locations = []
    for place, limit in enumerate(limits):
        own = [
            edge_text(target, [], list(map(text, guards)), text(channel), list(map(text, _any_order(random, updates))))
            for source, target, channel, guards, updates in edges
            if source == place
        ]
        random.shuffle(own)
        invariant = f"invariant {text(limit)}; " if limit else ""
        first = "init " if place == 0 else ""
        locations.append(f"    {first}location L{place} {{ {invariant}{' '.join(own)} }}")
    body = "\n".join(locations)
    return f"process P{number}() {{\n{body}\n}}"


def _any_order(random: Random, updates: list[str]) -> list[str]:
    """Shuffled, unless one of them comes twice."""
    targets = [update.split()[0] for update in updates]
    return random.sample(updates, len(updates)) if len(set(targets)) == len(targets) else updates


def _register(random: Random, number: int, asked: list[str], wrong: int) -> str:
    """With ``wrong``, if it is not 0, in place of its number in the guard of one edge."""
    edges = [each.format(i=number, k=value) for each in asked for value in range(_SIZE + 1)]
    edges += [f"sync {name}{sender}?;" for name in ("set", "clear") for sender in range(1, _SIZE + 1)]
    if wrong:
        edges[number] = edges[number].replace(f"== {number}", f"== {wrong}").replace(f"!= {number}", f"!= {wrong}")
    random.shuffle(edges)
    return f"process R{number}() {{ init location M {{ {' '.join(f'to M {{ {edge} }}' for edge in edges)} }} }}"


def _channels(number: int) -> str:
    asked = ", ".join(f"is{number}_{value}" for value in range(_SIZE + 1))
    return f"chan {asked};\nbroadcast chan set{number}, clear{number};\nclock x{number};"


_TEXT = """\
clock y;
int[0, 3] r1 = 0, r2 = 0, r3 = 0;
int[0, 2] last1 = 0, last2 = 0, last3 = 0;
{channels}

{processes}

{registers}

system P1, P2, P3, R1, R2, R3;
"""
