"""Random models in which a controller has an edge of its own for each process, as models without templates have.

The processes know no numbers: each has a clock and channels of its own. What the controller keeps of them, in a
variable, a queue and an array, are numbers that only its own edges tell. A share of the models has something that tells
the processes apart.
"""

from __future__ import annotations

from random import Random

from tests.support.symmetric.cases import SymmetricCase, edge_text

_ANSWERS = (
    "guard owner == 0; sync ask{i}?; assign owner = {i};",
    "guard owner == {i}; sync drop{i}?; assign owner = 0;",
    "guard owner == {i}; sync give{i}!;",
    "guard owner != {i}; sync give{i}!; assign y = 0;",
    "guard length < 2; sync ask{i}?; assign queue[length] = {i}, length = length + 1;",
    "guard length > 0 && queue[0] == {i}; sync give{i}!; assign queue[0] = queue[1], length = length - 1;",
    "guard length > 0 && queue[length - 1] == {i}; sync drop{i}?; assign length = length - 1;",
    "guard mark[{i}] == 0 && y > 1; sync ask{i}?; assign mark[{i}] = 1;",
    "sync drop{i}?; assign mark[{i}] = 1 - mark[{i}], y = 0;",
    "guard mark[owner] == 0; sync give{i}!; assign owner = {i};",
)
_QUERIES = (
    "E<> P1.L1 && P2.L1",
    "A[] not (P1.L2 && P2.L2)",
    "E<> owner == 2 && P1.L2",
    "A[] owner == 0 or mark[owner] == 0",
    "E<> length == 2 && queue[0] != queue[1]",
    "E<> P1.L1 && P2.L1 && P3.L1",
    "A[] not deadlock",
    "E<> length == 2",
    "E<> P1.L2 && x2 > 3",
)


def random_controller_case(random: Random, breaking: float = 0.3) -> SymmetricCase:
    """A case; in the share ``breaking`` of the models something tells processes apart."""
    size = 3
    broken = random.random() < breaking
    edges = [(number % 3, _edge(random)) for number in range(random.randint(4, 6))]
    limits = [random.choice(("", "", "{x} <= 2", "{x} <= 3")) for _ in range(3)]
    answers = random.sample(_ANSWERS, random.randint(3, 5))
    odd = random.randrange(size) + 1 if broken else 0
    controller = [
        "to M { " + answer.format(i=number if number != odd or place else _other(random, number)) + " }"
        for place, answer in enumerate(answers)
        for number in range(1, size + 1)
    ]
    random.shuffle(controller)
    processes = "\n".join(_process(number, edges, limits) for number in range(1, size + 1))
    first = random.choice((0, 0, 1, 2))
    queue = ", ".join(str(random.choice((0, 0, 1, 3))) for _ in range(2))
    names = ", ".join(f"P{number}" for number in range(1, size + 1))
    clocks = ", ".join(f"x{number}" for number in range(1, size + 1))
    channels = "\n".join(f"chan ask{number}, give{number}, drop{number};" for number in range(1, size + 1))
    text = _TEXT.format(
        size=size, first=first, queue=queue, clocks=clocks, channels=channels, processes=processes,
        controller="\n        ".join(controller), names=names,
    )  # fmt: skip
    return SymmetricCase(text, tuple(random.sample(_QUERIES, 4)), broken)


def _other(random: Random, number: int) -> int:
    return random.choice([other for other in (1, 2, 3) if other != number])


def _edge(random: Random) -> str:
    """With ``{x}`` for the clock of the process and ``{i}`` for the end of the names of its channels."""
    synchronisation = random.choice(("ask{i}!", "drop{i}!", "give{i}?", ""))
    guards = [random.choice(("{x} >= 1", "{x} < 2", "{x} > 2"))] if random.random() < 0.5 else []
    updates = ["{x} = 0"] if random.random() < 0.6 else []
    return (
        edge_text(random.randrange(3), [], guards, synchronisation, updates).replace("{ ", "{{ ").replace(" }", " }}")
    )


def _process(number: int, edges: list[tuple[int, str]], limits: list[str]) -> str:
    clock = f"x{number}"
    locations = "\n".join(
        f"    {'init ' if place == 0 else ''}location L{place} {{ "
        + (f"invariant {limits[place].format(x=clock)}; " if limits[place] else "")
        + " ".join(edge.format(x=clock, i=number) for source, edge in edges if source == place)
        + " }"
        for place in range(3)
    )
    return f"process P{number}() {{\n{locations}\n}}"


_TEXT = """\
clock {clocks};
clock y;
int[0, {size}] owner = {first};
int[0, {size}] queue[2] = {{{queue}}};
int[0, 2] length = 0;
int[0, 1] mark[{size} + 1];
{channels}

{processes}

process C() {{
    init location M {{
        {controller}
    }}
}}

system {names}, C;
"""
