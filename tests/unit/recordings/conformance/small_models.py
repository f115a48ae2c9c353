"""Small random models with a recording, as text, and a second definition of when one is a run of the other.

A model has one or two machines with a clock each. A machine waits for inputs, does outputs with a number, and moves on
its own. All bounds are closed and all times whole, so that runs at whole times show all that runs show [Henzinger,
Manna, Pnueli 1992: digitization]. The judge goes through these, one time unit after the other, and knows nothing of
networks, followers or zones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from random import Random

KEYS = 2
LONGEST = 7


@dataclass(frozen=True)
class Edge:
    source: int
    target: int
    label: str  # "in", "out" or ""
    key: int
    number: int
    low: int
    high: int
    resets: bool


@dataclass(frozen=True)
class Machine:
    invariants: tuple[int, ...]
    edges: tuple[Edge, ...]


@dataclass(frozen=True)
class Event:
    time: int
    machine: int
    label: str
    key: int
    number: int
    needed: int = 0  # of an input: so many outputs of its machine happen before


@dataclass(frozen=True)
class Place:
    """Where a machine is."""

    location: int = 0
    clock: int = 0


def random_machine(random: Random) -> Machine:
    count = random.randint(2, 3)
    invariants = tuple(random.choice((LONGEST, LONGEST, random.randint(2, 5))) for _ in range(count))
    edges = []
    for source in range(count):
        for _ in range(random.randint(1, 3)):
            low = random.randint(0, 4)
            edges.append(
                Edge(
                    source,
                    random.randrange(count),
                    random.choice(("in", "out", "out", "")),
                    random.randrange(KEYS),
                    random.randrange(3),
                    low,
                    random.choice((LONGEST, random.randint(low, 6))),
                    random.random() < 0.7,
                )
            )
    return Machine(invariants, tuple(edges))


def answering_machine(random: Random) -> Machine:
    """A machine that answers inputs, and may also speak on its own."""
    number, low = random.randrange(3), random.randint(0, 2)
    edges = [
        Edge(0, 1, "in", 0, 0, 0, LONGEST, True),
        Edge(1, 0, "out", 0, number, low, random.choice((LONGEST, low + 1)), random.random() < 0.5),
    ]
    if random.random() < 0.3:
        edges.append(Edge(0, 0, "out", random.randrange(KEYS), number, random.randint(0, 3), LONGEST, True))
    return Machine((LONGEST, LONGEST), tuple(edges))


def text_of(machines: tuple[Machine, ...], hidden: bool) -> str:
    """The model. With ``hidden`` inputs are not recorded."""
    lines = ["meta int number = 0;", f"broadcast chan say[{len(machines)}][{KEYS}];"]
    lines.append(f"broadcast chan hear[{len(machines)}][{KEYS}];")
    for n, machine in enumerate(machines):
        lines += [f"process M{n}() {{", "    clock x;"]
        for location, bound in enumerate(machine.invariants):
            lines.append(f"    {'init ' if location == 0 else ''}location L{location} {{")
            if bound < LONGEST:
                lines.append(f"        invariant x <= {bound};")
            for edge in (e for e in machine.edges if e.source == location):
                sync = {"in": f"sync hear[{n}][{edge.key}]?;", "out": f"sync say[{n}][{edge.key}]!;", "": ""}[
                    edge.label
                ]
                high = f" && x <= {edge.high}" if edge.high < LONGEST else ""
                number = [f"number = {edge.number}"] if edge.label == "out" else []
                updates = ", ".join([*number, *(["x = 0"] if edge.resets else [])])
                assign = f"assign {updates};" if updates else ""
                lines.append(f"        to L{edge.target} {{ guard x >= {edge.low}{high}; {sync} {assign} }}")
            lines.append("    }")
        lines.append("}")
    names = ", ".join(f"M{n}" for n in range(len(machines)))
    lines += [f"system {names};", "recording {", "    visible say[m][k] as out(m, k, number) per m;"]
    lines.append("    hidden hear;" if hidden else "    visible hear[m][k] as in(m, k) per m;")
    return "\n".join([*lines, "}"]) + "\n"


def csv_of(events: list[Event], end: int) -> str:
    rows = [f"{e.time},{e.label},{e.machine},{e.key},{e.number if e.label == 'out' else ''}" for e in events]
    return "\n".join(["time,event,m,k,number", *rows, f"{end},end,,,"]) + "\n"


# ---- runs -----------------------------------------------------------------------------------------------------------


def moves(machine: Machine, place: Place, label: str, key: int | None = None) -> Iterator[tuple[Edge, Place]]:
    for edge in machine.edges:
        if edge.source != place.location or edge.label != label or (key is not None and edge.key != key):
            continue
        clock = 0 if edge.resets else place.clock
        if edge.low <= place.clock and (edge.high >= LONGEST or place.clock <= edge.high):
            if _may_be(machine, Place(edge.target, clock)):
                yield edge, Place(edge.target, clock)


def _may_be(machine: Machine, place: Place) -> bool:
    bound = machine.invariants[place.location]
    return bound >= LONGEST or place.clock <= bound


def hears(machine: Machine, place: Place, key: int) -> list[Place]:
    """Where an input takes a machine: it stays if no guard holds; it cannot come if all that hear it cannot go on."""
    enabled = [
        e
        for e in machine.edges
        if e.source == place.location
        and e.label == "in"
        and e.key == key
        and e.low <= place.clock
        and (e.high >= LONGEST or place.clock <= e.high)
    ]
    return [after for _, after in moves(machine, place, "in", key)] if enabled else [place]


def after_a_unit(machines: tuple[Machine, ...], places: tuple[Place, ...]) -> tuple[Place, ...] | None:
    after = tuple(replace(p, clock=min(p.clock + 1, LONGEST)) for p in places)
    return after if all(_may_be(m, p) for m, p in zip(machines, after, strict=True)) else None


def random_run(random: Random, machines: tuple[Machine, ...], until: int, hidden: bool) -> tuple[list[Event], int]:
    """The events of a run at whole times, and when it ends: a run that gets stuck ends before."""
    places: tuple[Place, ...] = tuple(Place() for _ in machines)
    events: list[Event] = []
    now = 0
    while True:
        for _ in range(random.randint(0, 3)):
            n = random.randrange(len(machines))
            if random.random() < 0.3:
                key = random.randrange(KEYS)
                choices = hears(machines[n], places[n], key)
                if choices:
                    places = _with(places, n, random.choice(choices))
                    if not hidden:
                        events.append(Event(now, n, "in", key, 0))
                continue
            enabled = [*moves(machines[n], places[n], "out"), *moves(machines[n], places[n], "")]
            if enabled:
                edge, after = random.choice(enabled)
                places = _with(places, n, after)
                if edge.label == "out":
                    events.append(Event(now, n, "out", edge.key, edge.number))
        later = after_a_unit(machines, places)
        if later is None or now == until:
            return events, now
        places, now = later, now + 1


def _with(places: tuple[Place, ...], n: int, place: Place) -> tuple[Place, ...]:
    return (*places[:n], place, *places[n + 1 :])


# ---- the judge ------------------------------------------------------------------------------------------------------


def is_run(
    machines: tuple[Machine, ...],
    events: list[Event],
    end: int,
    tolerance: int,
    late: int | tuple[int, int],
    hidden: bool,
    ordered: bool = False,
) -> bool:
    """Whether some run at whole times has these events.

    The lateness is that of inputs and outputs, or a pair of both.

    With ``ordered`` outputs of a machine that were recorded before an input of it happen before that. A model none of
    whose edges sends what is recorded as output has these events from outside, and hears none of them.
    """
    streams: dict[tuple[str, int], list[Event]] = {}
    for event in events:
        if ordered and event.label == "in":
            event = replace(event, needed=len(streams.get(("out", event.machine), ())))
        streams.setdefault((event.label, event.machine), []).append(event)
    names = sorted(streams)
    input_late, output_late = (late, late) if isinstance(late, int) else late
    quiet = max(end - output_late, 0)
    sent = any(edge.label == "out" for machine in machines for edge in machine.edges)

    def window(event: Event) -> tuple[int, int]:
        if event.label == "out" and sent:
            return event.time - output_late, event.time + tolerance
        return event.time - tolerance, event.time + input_late

    start = (tuple(Place() for _ in machines), (0,) * len(names))
    present = {start}
    now = 0
    while True:
        pending = list(present)
        while pending:
            places, counts = pending.pop()
            for after in _steps(machines, places, counts, now, names, streams, window, quiet, hidden, sent):
                if after not in present:
                    present.add(after)
                    pending.append(after)
        whole = tuple(len(streams[name]) for name in names)
        if now >= quiet and any(counts == whole for _, counts in present):
            return True
        product = set()
        for places, counts in present:
            later = after_a_unit(machines, places)
            overdue = any(
                counts[n] < len(streams[name]) and window(streams[name][counts[n]])[1] <= now
                for n, name in enumerate(names)
            )
            if later is not None and not overdue:
                product.add((later, counts))
        present, now = product, now + 1
        if not present:
            return False


def _steps(machines, places, counts, now, names, streams, window, quiet, hidden, sent):  # type: ignore[no-untyped-def]
    for n, machine in enumerate(machines):
        for _, after in moves(machine, places[n], ""):
            yield _with(places, n, after), counts
        for key in range(KEYS) if hidden else ():
            for after in hears(machine, places[n], key):
                yield _with(places, n, after), counts
        for edge, after in moves(machine, places[n], "out"):
            found = _next(("out", n), names, streams, counts)
            if found is None:
                if now >= quiet:
                    yield _with(places, n, after), counts
                continue
            number, event = found
            low, high = window(event)
            if low <= now <= high and (event.key, event.number) == (edge.key, edge.number):
                yield _with(places, n, after), _counted(counts, number)
        found = None if sent else _next(("out", n), names, streams, counts)
        if found is not None and window(found[1])[0] <= now <= window(found[1])[1]:
            yield places, _counted(counts, found[0])
        found = None if hidden else _next(("in", n), names, streams, counts)
        if found is not None:
            number, event = found
            low, high = window(event)
            before = counts[names.index(("out", n))] if ("out", n) in names else 0
            if low <= now <= high and before >= event.needed:
                for after in hears(machine, places[n], event.key):
                    yield _with(places, n, after), _counted(counts, number)


def _next(name, names, streams, counts):  # type: ignore[no-untyped-def]
    if name not in names:
        return None
    number = names.index(name)
    return (number, streams[name][counts[number]]) if counts[number] < len(streams[name]) else None


def _counted(counts: tuple[int, ...], number: int) -> tuple[int, ...]:
    return (*counts[:number], counts[number] + 1, *counts[number + 1 :])


# ---- mutations ------------------------------------------------------------------------------------------------------


def mutated(random: Random, events: list[Event], end: int) -> list[Event]:
    """The events with one of them lost, doubled, moved or saying something else."""
    if not events:
        return [Event(random.randint(0, end), 0, "out", 0, 0)]
    place = random.randrange(len(events))
    event = events[place]
    match random.randrange(4):
        case 0:
            changed = [*events[:place], *events[place + 1 :]]
        case 1:
            changed = [*events[:place], event, event, *events[place + 1 :]]
        case 2:
            moved = replace(event, time=min(max(event.time + random.choice((-3, -2, 2, 3)), 0), end))
            changed = [*events[:place], moved, *events[place + 1 :]]
        case _:
            changed = [*events[:place], replace(event, number=(event.number + 1) % 3), *events[place + 1 :]]
    return sorted(changed, key=lambda e: e.time)
