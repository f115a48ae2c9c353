"""Runs that go on for ever, without the parts of a network that have nothing to do with the question."""

from __future__ import annotations

from collections import Counter
from random import Random

import pytest

import tachk
from tachk import Limits, Options
from tachk.model.query import Query
from tachk.transform.independent_parts import independent_parts, takes_its_time
from tachk.verify import independent_parts as strategy
from tachk.verify.liveness import conditions_of
from tachk.verify.verdict import Answer
from tests.support.seeds import enough, seeds

ASKED = """
clock w;
process Q() {
    clock x;
    init location good { to bad { assign x = 0; } }
    location bad { invariant x <= 5; to good { guard x >= 2; } }
}
"""
PAIR = """
chan go;
process Left() {
    clock y;
    init location a { invariant y <= 3; to b { guard y >= 1; sync go!; } }
    location b { invariant y <= 6; to a { guard y >= 4; assign y = 0; } }
}
process Right() {
    init location a { to a { sync go?; } }
}
system Q, Left, Right;
"""
QUERY = "Q.bad --> Q.good"


def only_query(text: str) -> tuple[tachk.Model, Query]:
    model = tachk.loads(text + f"property asked : {QUERY};")
    (query,) = model.loaded.queries
    return model, query


def test_processes_that_share_something_belong_together() -> None:
    model, query = only_query(ASKED + PAIR)
    assert independent_parts(model.network, conditions_of(query)) == (frozenset({1, 2}),)
    assert takes_its_time(model.network, {1, 2})
    model, query = only_query(
        ASKED + PAIR.replace("guard y >= 4;", "guard y >= 4 && w >= 0;").replace("clock y", "clock y")
    )
    assert independent_parts(model.network, conditions_of(query)) == (frozenset({1, 2}),)
    asked = ASKED.replace("guard x >= 2;", "guard x >= 2 && w >= 0;")
    model, query = only_query(asked + PAIR.replace("guard y >= 4;", "guard y >= 4 && w >= 0;"))
    assert independent_parts(model.network, conditions_of(query)) == ()


@pytest.mark.parametrize(
    ("change", "to", "answer", "row"),
    [
        ("", "", "holds", "decomposed"),
        ("guard y >= 4; assign y = 0;", "guard y >= 7; assign y = 0;", "fails", "any-run"),  # nothing goes on after 6
        ("to a { sync go?; }", "to a { sync go?; } to a { }", "fails", "any-run"),  # it may go round in no time
    ],
)
def test_what_may_stop_time_is_not_left_out(
    change: str, to: str, answer: str, row: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(strategy, "_FEW", 0)
    model, _ = only_query(ASKED + PAIR.replace(change, to))
    for options in (Options(), Options().off("symmetry")):
        (found,) = model.verify(options=options)
        assert (found.answer.value, found.strategy) == (answer, row)
    (found,) = model.verify(options=Options().off("decomposed"))
    assert found.answer.value == answer


def random_network(random: Random) -> str:
    """One process that is asked about, and two that synchronise with each other at most: often so that they can go on,
    and take their time for it."""
    tame = random.random() < 0.7

    def edge(process: str) -> str:
        calm = tame and process != "P"
        guard = f"guard x {random.choice(['>=', '>=', '==', '<='])} {random.randint(0, 4)};"
        sync = {"P": "", "L": "sync go!;", "R": "sync go?;"}[process] if random.random() < 0.4 else ""
        if calm:
            guard = "" if process == "R" else f"guard x >= {random.choice([0, 1, 1, 2])};"
        elif random.random() < 0.3:
            guard = ""
        reset = "assign x = 0;" if calm or random.random() < 0.7 else ""
        return f"to l{random.randrange(3)} {{ {guard} {sync} {reset} }}"

    def process(name: str) -> str:
        lines = [f"process {name}() {{", "clock x;"]
        for number in range(3):
            flag = "" if tame and name != "P" else random.choice(["", "", "", "", "urgent ", "committed "])
            bound = f"invariant x <= {random.randint(2, 5)};" if random.random() < (0.3 if tame else 0.6) else ""
            edges = " ".join(edge(name) for _ in range(random.randint(1, 2)))
            lines.append(f"{'init ' if number == 0 else ''}{flag}location l{number} {{ {bound} {edges} }}")
        return "\n".join([*lines, "}"])

    return "chan go;\n" + "\n".join(map(process, "PLR")) + "\nsystem P, L, R;\n"


@pytest.mark.parametrize("block", range(3))
def test_no_answer_changes(block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strategy, "_FEW", 0)
    decided: Counter[str] = Counter()
    for seed in seeds(range(20 * block, 20 * block + 20)):
        random = Random(seed)
        text = random_network(random)
        one, other = random.sample(range(3), 2)
        model = tachk.loads(text)
        for query in (f"P.l{one} --> P.l{other}", f"A<> P.l{other}"):
            answers = set()
            for options in (Options(), Options().off("decomposed", "sliced")):
                (found,) = model.verify(query, options=options, limits=Limits(states=20_000))
                answers.add(found.answer)
                decided[found.strategy] += 1
            assert len(answers - {Answer.UNKNOWN}) <= 1, f"seed {seed}: {query}"
    assert enough(decided["decomposed"] > 0)
