"""Random models of many pairs of processes, a few of which have an edge more, with queries that name some of them.

A process and its partner share channels, so that they can only be exchanged with another pair together; a share of the
models has partners that can be exchanged alone, as they belong to nobody.
"""

from __future__ import annotations

from random import Random

from tests.support.symmetric.cases import SymmetricCase

_ODD = (
    "to A {{ guard me == {odd}; assign owner = 0; }}",
    "to A {{ guard me == {odd} || me == {another}; assign count = 1; }}",
    "to A {{ guard owner == me && me != {odd}; }}",
    "to A {{ assign owner = {odd}; }}",
)
_PARTNERS = ("to M {{ guard me == {odd}; assign kept = 2; }}", "to M {{ guard owner == {odd}; assign kept = 1; }}")
_ATOMS = (
    "P({i}).B",
    "P({j}).B",
    "Q({i}).kept == 1",
    "Q({j}).kept == 1",
    "owner == {i}",
    "owner == {k}",
    "cell[{i}] == 1",
)


def random_pairs_case(random: Random) -> SymmetricCase:
    """A case of four to seven pairs."""
    size = random.randint(4, 7)
    odd, another = random.sample(range(1, size + 1), 2)
    of_first = random.sample(_ODD, random.choice((0, 0, 0, 1, 1, 2)))
    of_second = random.sample(_PARTNERS, random.choice((0, 0, 0, 1)))
    alone = random.random() < 0.2
    text = _TEXT.format(
        size=size,
        first=" ".join(each.format(odd=odd, another=another) for each in of_first),
        second=" ".join(each.format(odd=odd) for each in of_second),
        ask="pause?" if alone else "ask[me]?",
        free="pause?" if alone else "free[me]?",
        send="ask[me]!",
    )
    queries = []
    for _ in range(4):
        i, j, k = (random.randint(1, size) for _ in range(3))
        atoms = [each.format(i=i, j=j, k=k) for each in random.sample(_ATOMS, random.randint(1, 3))]
        queries.append("E<> " + random.choice((" && ", " || ")).join(atoms))
    queries.append("E<> exists (i : id_t) P(i).B && Q(i).kept == 1")
    return SymmetricCase(text, tuple(queries), bool(of_first or of_second))


_TEXT = """\
const int N = {size};
typedef int[1, N] id_t;
int[0, N] owner = 0;
int[0, 1] count = 0;
int[0, 1] cell[N + 1];
chan ask[N + 1], free[N + 1], pause;

process P(const id_t me) {{
    clock x;
    init location A {{ invariant x <= 5; to B {{ guard cell[me] == 0; sync {send}; assign x = 0; }} {first} }}
    location B {{ to A {{ guard x > 1; sync free[me]!; assign owner = me, cell[me] = 1, x = 0; }} }}
}}
process Q(const id_t me) {{
    int[0, 2] kept = 0;
    init location M {{ to M {{ sync {ask}; assign kept = 1; }} to M {{ sync {free}; assign kept = 0; }} {second} }}
}}
process R() {{ init location L {{ to L {{ sync pause!; }} }} }}
system P, Q, R;
"""
