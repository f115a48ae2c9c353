"""Random small models with two constants in all kinds of places, also where they must not be taken for bounds."""

from __future__ import annotations

from random import Random

LOW, HIGH = 0, 3
"""The values of both constants that are asked about."""

_TERMS = ["P", "Q", "P", "Q", "D", "E", "P + 1", "2 * Q", "4 - P", "P + Q", "Q - P", "P * Q", "n + P", "1", "2", "3"]
_UPPER_TERMS = ["P", "P", "P + 1", "2 * P", "P + n", "F", "1", "2", "3"]
_LOWER_TERMS = ["Q", "Q", "Q + 1", "2 * Q - 1", "G", "0", "1", "2"]
_COMPARISONS = ["<", "<=", "<=", ">", ">=", ">=", "=="]
_QUERIES = [
    "A[] not (one.c && two.c)",
    "A[] not (one.b && two.c)",
    "E<> one.c && two.c",
    "A[] not two.c",
    "E<> one.c && two.x <= P",
    "A[] one.c imply two.x > P",
    "A[] one.c imply two.x > Q - 1",
    "A[] not (one.x - two.x > P)",
    "A[] not (deadlock && two.b)",
    "F[0, 4] two.c",
    "G (one.b -> F[0, 2] not one.b)",
    "A[] n <= P",
]


def random_model(random: Random) -> str:
    """A model with the constants P and Q and a property ``p``."""
    priority = "chan priority h < k;" if random.random() < 0.08 else ""
    derived = random.choice(["P + 2 * Q - 1", "5 - P", "2 * P", "Q + 1"])
    plain = random.random() < 0.5
    return f"""
const int P = 1;
const int Q = 1;
const int D = {derived};
const int F = P + 2;
int[0, 2] n = 0;
chan h;
broadcast chan k;
urgent chan u;
{priority}
{_template(random, "One", "!", plain)}
{_template(random, "Two", "?", plain)}
one = One(Q + 1);
two = Two(P);
system one, two;
property p : {random.choice(_QUERIES)};
"""


def _template(random: Random, name: str, direction: str, plain: bool) -> str:
    locations = []
    for number, location in enumerate("abc"):
        kind = ("init " if number == 0 else "") + random.choice(["", "", "", "", "", "committed ", "urgent "])
        invariant = ""
        if random.random() < 0.5:
            invariant = f"invariant x {random.choice(['<', '<='])} {random.choice(_UPPER_TERMS if plain else _TERMS)};"
            if number == 0 and plain:
                invariant = "invariant x <= P;"
        targets = ["abc"[min(number + 1, 2)], *random.sample("abc", random.randint(0, 1))]
        edges = "".join(_edge(random, target, direction, plain) for target in targets)
        locations.append(f"    {kind}location {location} {{ {invariant} {edges} }}")
    head = f"process {name}(const int E) {{\n    const int G = Q - 1;\n    clock x;\n"
    return head + "\n".join(locations) + "\n}"


def _edge(random: Random, target: str, direction: str, plain: bool) -> str:
    """``plain``: P is an upper bound and Q a lower one, mostly."""
    channel = random.choice(["", "", "h", "k", "u"] if not plain else ["", "", "", "h"])
    atoms = []
    for _ in range(random.randint(0, 2)):
        if channel == "u":
            continue
        if plain and random.random() < 0.97:
            upper = random.random() < 0.4
            terms = _UPPER_TERMS if upper else _LOWER_TERMS
            atoms.append(f"x {random.choice(['<', '<='] if upper else ['>', '>='])} {random.choice(terms)}")
        else:
            atoms.append(f"x {random.choice(_COMPARISONS)} {random.choice(_TERMS)}")
    if random.random() < 0.15:
        atoms.append("n == 1" if plain else random.choice(["n < P", "n == 1", "n != Q"]))
    updates = ["x = 0"] if random.random() < 0.5 else []
    if random.random() < 0.3:
        updates.append("n = (n + 1) % 3")
    if not plain and random.random() < 0.1:
        updates.append("x = P")
    guard = f"guard {' && '.join(atoms)}; " if atoms else ""
    sync = f"sync {channel}{direction}; " if channel else ""
    assign = f"assign {', '.join(updates)}; " if updates else ""
    return f"to {target} {{ {guard}{sync}{assign}}} "
