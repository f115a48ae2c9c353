"""Networks of TARZAN's benchmark whose locations depend on the size, as text of tachk: generators of our own.

The others are in bench/models/tarzan, with a constant for the size. Processes and edges stand in the order in which
TARZAN reads its own files, because a search depth first depends on it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise, product


def gates(size: int) -> str:
    """Keys that turn at single moments, key i turns i times, and a lock with a hand of its own."""
    text = [f"int[0, {size}] turned;"]
    for key in range(1, size + 1):
        steps = [f"L{i} -> L{i + 1} {{ guard x == {key}; assign x = 0; }}" for i in range(key - 1)]
        last = f"L{key - 1} -> L{key} {{ guard x == {key}; assign turned = turned + 1; }}"
        text.append(_process(f"Key{key}", "x", [f"L{i}" for i in range(key + 1)], [*steps, last]))
    waits = [f"G{i} -> G{i + 1} {{ guard x == {size}; assign x = 0; }}" for i in range(size)]
    opens = f"G{size} -> open {{ guard x == {size} && turned == {size}; assign x = 0; }}"
    text.append(_process("Lock", "x", [*(f"G{i}" for i in range(size + 1)), "open"], [*waits, opens]))
    system = ", ".join([*(f"Key{key}" for key in range(1, size + 1)), "Lock"])
    return "\n".join([*text, f"system {system};", "property opens : E<> Lock.open expect holds;", ""])


def csma_cd(size: int) -> str:
    """Stations on a bus that tells them of a collision one after the other."""
    told = [f"collision{i}" for i in range(1, size + 1)]
    bus = [
        "idle -> active { sync begin?; assign x = 0; }",
        "active -> idle { sync end?; assign x = 0; }",
        "active -> active { guard x >= 26; sync busy!; }",
        "active -> collision1 { guard x < 26; sync begin?; assign x = 0; }",
        *(
            f"collision{i} -> {told[i] if i < size else 'idle'} "
            f"{{ guard {'x < 26' if i == 1 else 'x <= 0'}; sync cd[{i}]!; assign x = 0; }}"
            for i in range(1, size + 1)
        ),
    ]
    within = ["collision1 { x < 26 }", *(f"{name} {{ x <= 0 }}" for name in told[1:])]
    station = [
        "quiet -> sending { sync begin!; assign x = 0; }",
        "quiet -> quiet { sync cd[me]?; assign x = 0; }",
        "quiet -> retry { sync cd[me]?; assign x = 0; }",
        "quiet -> retry { sync busy?; assign x = 0; }",
        "sending -> quiet { guard x == 808; sync end!; assign x = 0; }",
        "sending -> retry { guard x < 52; sync cd[me]?; assign x = 0; }",
        "retry -> sending { guard x < 52; sync begin!; assign x = 0; }",
        "retry -> retry { guard x < 52; sync cd[me]?; assign x = 0; }",
    ]
    goal = " && ".join(f"Station({i}).{'sending' if i == 3 else 'retry'}" for i in range(1, 8))
    return "\n".join(
        [
            f"typedef int[1, {size}] id_t;",
            f"chan begin, end, busy, cd[{size + 1}];",
            _process("Bus", "x", ["idle", "active", *within], bus),
            _process("Station", "x", ["quiet", "sending { x <= 808 }", "retry { x < 52 }"], station, "const id_t me"),
            "system Bus, Station;",
            f"property one_of_seven : E<> {goal} expect holds;",
            "",
        ]
    )


def mpeg2(size: int) -> str:
    """The decoding of an I and a P frame and of `size` B frames between them, in microseconds."""
    starts = ["L1", *(f"extra{i}" for i in range(1, size)), "L0"]
    readies = ["L7", *(f"extra{i}" for i in range(size, 2 * size - 1)), "L6"]
    frames = [
        *(f"{a} -> {b} {{ guard x <= 0; sync start[{i}]!; }}" for i, (a, b) in enumerate(pairwise(starts), 1)),
        "L2 -> L1 { guard x == 515; assign x = 0; }",
        "L3 -> L2 { guard x == 521; sync dctq!; assign x = 0; }",
        "L4 -> L3 { guard x <= 0 && p_error == 1; assign x = 0, p_error = 0; }",
        "L5 -> L4 { guard x == 32; assign x = 0; }",
        "L6 -> L5 { guard x >= 1180 && x <= 1181 && p == 1; assign mvp = 1, p = 0, x = 0; }",
        *(
            f"{a} -> {b} {{ guard x <= 0; sync ready[{i}]!; assign p_error = 1, p = 1, x = 0; }}"
            for i, (a, b) in enumerate(pairwise(readies), 1)
        ),
        "L8 -> L7 { guard x == 673; assign x = 0; }",
        "I -> L8 { guard x == 595; sync dctq1!; assign x = 0; }",
    ]
    extra = [f"extra{i}" for i in range(1, 2 * size - 1)]
    places = ["I", "L0", *extra, *(f"L{i}" for i in range(1, 9))]
    ready = "ib[me] == 1 && b[me] == 1"
    b_frame = [
        "L6 -> L6 { sync ready[me]?; assign ib[me] = 1; }",
        "L0 -> out { guard x <= 0; }",
        "L1 -> L0 { guard x >= 189 && x <= 454 && mvb[me] == 1; assign x = 0, mvb[me] = 0; }",
        "L2 -> L1 { guard x == 521; assign x = 0; }",
        "L3 -> L2 { guard x <= 0 && b_error[me] == 1; assign x = 0, b_error[me] = 0; }",
        "L4 -> L3 { guard x == 48; assign x = 0; }",
        f"L5 -> L4 {{ guard x >= 2399 && x <= 2422 && {ready}; assign mvb[me] = 1, ib[me] = 0, b[me] = 0, x = 0; }}",
        "L6 -> L5 { sync start[me]?; assign x = 0, b[me] = 1, b_error[me] = 1; }",
    ]
    i_finish = [
        "L0 -> out { guard x <= 0; }",
        "L1 -> L0 { guard x >= 298 && x <= 358; assign x = 0; }",
        "L2 -> L1 { sync dctq1?; assign x = 0; }",
    ]
    p_finish = [
        "L0 -> out { guard x <= 0; }",
        "L1 -> L0 { guard x >= 378 && x <= 389 && mvp == 1; assign x = 0, mvp = 0; }",
        "L2 -> L1 { sync dctq?; assign x = 0; }",
    ]
    return "\n".join(
        [
            f"typedef int[1, {size}] id_t;",
            f"chan dctq, dctq1, ready[{size + 1}], start[{size + 1}];",
            f"int[0, 1] mvp, p, p_error, ib[{size + 1}], mvb[{size + 1}], b[{size + 1}], b_error[{size + 1}];",
            _process("BFrame", "x", ["L6", "out", *(f"L{i}" for i in range(6))], b_frame, "const id_t me"),
            _process("Frames", "x", places, frames, urgent=extra),
            _process("IFinish", "x", ["L2", "out", "L0", "L1"], i_finish),
            _process("PFinish", "x", ["L2", "out", "L0", "L1"], p_finish),
            _process("Time", "x", ["L0 { x <= 6673 }"], ["L0 -> L0 { }"]),
            "system BFrame, Frames, IFinish, PFinish, Time;",
            "property all_out : E<> forall (i : id_t) BFrame(i).out expect holds;",
            "",
        ]
    )


STAGES = (
    # name, time of a batch in tenths of a second, exact time in milliseconds, the stages that it waits for
    (0, 101, 10162, ()),
    (1, 13, 1305, (0,)),
    (2, 28, 2824, (0,)),
    (3, 28, 2882, (1, 2)),
    (4, 8, 875, (1, 2)),
    (5, 33, 3323, (3, 4)),
    (6, 18, 1872, (1, 2, 5)),
    (7, 13, 1333, (3, 4, 6)),
    (13, 3, 318, (1, 2, 5)),
)
TASKS, PROCESSORS = 128, 28


def pagerank(size: int) -> str:
    """A job of nine stages, 128 tasks each, on 28 processors; size 100 has times a hundred times as fine."""
    exact = size == 100
    text = [
        f"int[0, {PROCESSORS}] free;",
        "bool " + ", ".join(f"done{name}" for name, *_ in STAGES) + ";",
        "int " + ", ".join(f"tasks{name}" for name, *_ in STAGES) + ";",
    ]
    for name, coarse, fine, needs in STAGES:
        lasts = fine if exact else coarse
        begins = " && ".join(f"done{need} == 1" for need in needs)
        sizes = range(1, PROCESSORS + 1)
        edges = [
            "init_ -> waiting { "
            + (f"guard {begins}; " if needs else "")
            + (f"assign free = {PROCESSORS}; " if not needs else "")
            + "}",
            *(
                f"waiting -> run{k} {{ guard free > {k - 1} && tasks{name} <= {TASKS - k}; "
                f"assign x = 0, free = free - {k}; }}"
                for k in sizes
            ),
            *(
                f"run{k} -> waiting {{ guard x == {lasts}; "
                f"assign tasks{name} = tasks{name} + {k}, free = free + {k}; }}"
                for k in sizes
            ),
            f"waiting -> completed {{ guard tasks{name} == {TASKS}; assign done{name} = 1; }}",
        ]
        places = ["init_", "completed", *(f"run{k} {{ x <= {lasts} }}" for k in sizes), "waiting"]
        text.append(_process(f"Stage{name}", "x", places, edges))
    system = ", ".join(f"Stage{name}" for name, *_ in STAGES)
    return "\n".join([*text, f"system {system};", "property last : E<> Stage7.completed expect holds;", ""])


def sr_latch(_size: int) -> str:
    """Two NOR gates that hold each other; the one input falls, and the other a unit later."""

    def nor(a: bool, b: bool) -> bool:
        return not (a or b)

    environment = [
        "both -> one { sync s_down!; assign x = 0; }",
        "one -> none { guard x == 1; sync r_down!; }",
    ]
    return "\n".join(
        [
            "chan s_down, r_down, q_up, q_down, other_up, other_down;",
            _process("Environment", "x", ["both", "one { x <= 1 }", "none"], environment),
            _gate("Nor1", nor, ({False: "r_down"}, {True: "other_up", False: "other_down"}), "q", (1, 2), "100"),
            _gate("Nor2", nor, ({True: "q_up", False: "q_down"}, {False: "s_down"}), "other", (1, 2), "010"),
            "system Environment, Nor1, Nor2;",
            "property falls : E<> Environment.none expect holds;",
            "",
        ]
    )


def and_or(_size: int) -> str:
    """An AND and an OR gate in a loop, with two inputs that go up and down for ever."""

    def conjunction(a: bool, b: bool) -> bool:
        return a and b

    def disjunction(a: bool, b: bool) -> bool:
        return a or b

    edges = [
        "first -> second { guard b >= 7; sync b_down!; assign b = 0; }",
        "second -> third { guard a >= 13; sync a_down!; assign a = 0; }",
        "third -> fourth { guard b >= 19; sync b_up!; assign b = 0; }",
        "fourth -> first { guard a >= 16; sync a_up!; assign a = 0, b = 0; }",
    ]
    places = ["first { b <= 8 }", "second { a <= 14 }", "third { b <= 20 }", "fourth { a <= 18 }"]
    lines = [{value: f"{name}_{'up' if value else 'down'}" for value in (True, False)} for name in "abxt"]
    return "\n".join(
        [
            "chan a_up, a_down, b_up, b_down, x_up, x_down, t_up, t_down;",
            _gate("And", conjunction, (lines[3], lines[1]), "x", (3, 4), "111"),
            _process("Input", "a, b", places, edges),
            _gate("Or", disjunction, (lines[2], lines[0]), "t", (3, 4), "111"),
            "system And, Input, Or;",
            'property nothing "goes through all states" : E<> false expect fails;',
            "",
        ]
    )


def _gate(
    name: str,
    function: Callable[[bool, bool], bool],
    inputs: Sequence[dict[bool, str]],
    output: str,
    delay: tuple[int, int],
    start: str,
) -> str:
    """A gate in a location for its two inputs and its output: where these do not fit, its output changes after a delay.

    Args:
        inputs: of each the channels by which it changes, by its new value.
        start: the first location, without its letter.
    """
    places, edges = [], []
    for first, second, out in product((False, True), repeat=3):
        place = f"l{first:d}{second:d}{out:d}"
        waits = function(first, second) != out
        places.append(f"{place} {{ x <= {delay[1]} }}" if waits else place)
        if waits:
            change = f"{output}_{'down' if out else 'up'}"
            edges.append(f"{place} -> l{first:d}{second:d}{not out:d} {{ guard x >= {delay[0]}; sync {change}!; }}")
        for index, channels in enumerate(inputs):
            values = [first, second]
            values[index] = not values[index]
            if (channel := channels.get(values[index])) is None:
                continue
            again = "assign x = 0; " if function(*values) != out else ""
            edges.append(f"{place} -> l{values[0]:d}{values[1]:d}{out:d} {{ sync {channel}?; {again}}}")
    places.sort(key=lambda place: not place.startswith(f"l{start}"))
    return _process(name, "x", places, edges)


def _process(
    name: str,
    clocks: str,
    places: Sequence[str],
    edges: Sequence[str],
    parameters: str = "",
    urgent: Sequence[str] = (),
) -> str:
    """A process in the classic form; the first place is the initial one."""
    return "\n".join(
        [
            f"process {name}({parameters}) {{",
            f"    clock {clocks};",
            f"    state {', '.join(places)};",
            *([f"    urgent {', '.join(urgent)};"] if urgent else []),
            f"    init {places[0].split()[0]};",
            "    trans",
            ",\n".join(f"        {edge}" for edge in edges) + ";",
            "}",
        ]
    )
