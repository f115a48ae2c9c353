"""Random networks in which much is lost: processes with clocks of their own, edges that are possible at single moments,
variables that mostly grow, and queries that name one to three processes."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

LARGEST = 4
"""The largest constant that clocks are compared with."""


@dataclass(frozen=True, slots=True)
class MissedMoments:
    """Attributes:
    text: of the network.
    queries: about single states.
    """

    text: str
    queries: tuple[str, ...]


def random_missed_moments(random: Random) -> MissedMoments:
    """Now and then a clock or a variable belongs to all, or a raised variable may leave its range."""
    processes = random.randint(2, 4)
    locations = [random.randint(2, 4) for _ in range(processes)]
    shared = random.random() < 0.3
    alike = random.random() < 0.25
    lines = ["clock g;" if shared else "", "int[0, 3] total;", "int[-1, 2] level = 0;", "int[0, 1] on[2];"]
    lines += ["chan a;", "urgent chan u;", "broadcast chan b;"]
    if alike:
        count = locations[0]
        lines += [_process(random, "T", count, shared, "const int[0, 1] me")]
        lines += ["P0 = T(0);", "P1 = T(1);"]
    first = 2 if alike else 0
    if alike:
        locations[1] = locations[0]
    lines += [_process(random, f"P{n}", locations[n], shared) for n in range(first, processes)]
    lines.append(f"system {', '.join(f'P{n}' for n in range(processes))};")
    queries = [_query(random, locations, shared) for _ in range(4)]
    return MissedMoments("\n".join(lines), tuple(queries))


def _process(random: Random, name: str, locations: int, shared: bool, parameter: str = "") -> str:
    clocks = ["x", "y"][: random.randint(1, 2)] + (["g"] if shared else [])
    own = clocks[:-1] if shared else clocks
    lines = [f"process {name}({parameter}) {{", f"clock {', '.join(own)};", f"int[0, 3] n = {random.randint(0, 1)};"]
    for place in range(locations):
        kind = random.choice(("", "", "", "", "", "urgent ", "committed ")) if place else "init "
        lines.append(f"{kind}location L{place} {{")
        if random.random() < 0.35:
            operator = random.choice(("<", "<=", "<="))
            lines.append(f"invariant {random.choice(clocks)} {operator} {random.randint(1, LARGEST)};")
        for _ in range(random.choice((0, 1, 1, 2, 2, 3)) if place else random.randint(1, 3)):
            target = random.randint(max(place - 1, 0), locations - 1)
            lines.append(f"to L{target} {{ {_edge(random, clocks, bool(parameter))} }}")
        lines.append("}")
    return "\n".join([*lines, "}"])


def _edge(random: Random, clocks: list[str], indexed: bool) -> str:
    guards, updates = [], []
    for _ in range(random.choice((0, 1, 1, 1, 2))):
        operator = random.choice(("==", "==", "==", "<=", "<", ">=", ">"))
        guards.append(f"{random.choice(clocks)} {operator} {random.randint(0 if operator != '<' else 1, LARGEST)}")
    if len(clocks) > 1 and random.random() < 0.05:
        guards.append(f"{clocks[0]} - {clocks[1]} <= {random.randint(-2, 2)}")
    kind = random.random()
    if kind < 0.12:
        guards.append("total < 3")
        updates.append("total = total + 1")
    elif kind < 0.14:
        updates.append("total = total + 1")
    elif kind < 0.20:
        guards.append("n < 3")
        updates.append("n = n + 1")
    elif kind < 0.24:
        updates.append(
            random.choice(("n = 0", "level = 2", "level = -1", "total = 2", "level = n - 1", "n = 1 - on[0]"))
        )
    elif kind < 0.28:
        guards.append(random.choice(("level == 2", "total >= 1", "n != 1", "on[1] == 0", "level < 2")))
    elif kind < 0.33:
        updates.append("on[me] = 1 - on[me]" if indexed else f"on[{random.randint(0, 1)}] = 1")
    elif kind < 0.36:
        guards.append("level > -1")
        updates.append("level = level - 1")
    updates += [f"{clock} = {random.choice((0, 0, 0, 1, 3, 'n'))}" for clock in clocks if random.random() < 0.3]
    random.shuffle(updates)
    synchronisation = random.choice(("a!", "a?", "b!", "b?", "u!", "u?")) if random.random() < 0.3 else ""
    if synchronisation.startswith(("u", "b?")):
        guards = [guard for guard in guards if guard[0] not in "xyg"]
    parts = [f"guard {' && '.join(guards)};"] if guards else []
    parts += [f"sync {synchronisation};"] if synchronisation else []
    parts += [f"assign {', '.join(updates)};"] if updates else []
    return " ".join(parts)


def _query(random: Random, locations: list[int], shared: bool) -> str:
    parts = [_conjunction(random, locations, shared) for _ in range(random.choice((1, 1, 1, 2, 2, 3)))]
    predicate = " || ".join(f"({part})" for part in parts)
    if random.random() < 0.1:
        predicate = f"!({predicate})"
    if random.random() < 0.3:
        return f"A[] !({predicate})"
    return f"E<> {predicate}"


def _conjunction(random: Random, locations: list[int], shared: bool) -> str:
    named = random.sample(range(len(locations)), random.randint(1, min(3, len(locations))))
    parts = []
    for number in named:
        place = f"P{number}.L{random.randrange(locations[number])}"
        parts.append(place if random.random() < 0.9 else f"!{place}")
        if random.random() < 0.35:
            operator = random.choice(("<", "<=", "==", ">=", ">"))
            low = 1 if operator == "<" else 0
            parts.append(f"P{number}.x {operator} {random.randint(low, LARGEST + 1)}")
    if shared and random.random() < 0.2:
        parts.append(f"g {random.choice(('<=', '>'))} {random.randint(0, LARGEST)}")
    if random.random() < 0.3:
        parts.append(
            random.choice(
                ("total == 1", "total <= 1", "total == 3", "level == 0", "level < 2", "P0.n == 1", "on[0] == 1")
            )
        )
    if random.random() < 0.1:
        parts.append("(total == 1 or P0.n == 0)")
    random.shuffle(parts)
    return " && ".join(parts)
