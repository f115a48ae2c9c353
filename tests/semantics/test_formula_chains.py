"""Chains of hundreds of parts in temporal formulas: verified, monitored and explained."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

import tachk
from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.logic.observer.construction import NoObserver, build_observer
from tachk.recordings.monitors import compiler
from tachk.recordings.traces.monitor_program import MonitorProgram, part_of
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.verdict_explanation import Explainer
from tachk.syntax.formula import Formula
from tachk.syntax.formulas.parser import parse_formula
from tests.support.seeds import some

pytestmark = pytest.mark.drawn

LONG = 1200
DEEP = 300

FORMULAS = [
    ("G (" + " && ".join(f"n < {5 + i}" for i in range(LONG)) + ")", True),
    ("G (" + " && ".join(f"n != {LONG - 2 - i}" for i in range(LONG)) + ")", False),
    ("G (" + " || ".join(f"n == {i}" for i in range(LONG)) + ")", True),
    ("G (" + " || ".join(f"n == {i + 1}" for i in range(LONG)) + ")", False),
    ("G (" + " -> ".join(f"n < {5 + i}" for i in range(LONG)) + ")", True),
    ("G (" + "n >= 0 -> " * LONG + "n < 4)", False),
    (" && ".join(f"G n < {5 + i}" for i in range(LONG)), True),
    (" && ".join(f"G n != {LONG - 2 - i}" for i in range(LONG)), False),
    ("G (" + " + ".join(["n"] * LONG) + f" <= {4 * LONG})", True),
    ("G " + "!" * (LONG + 1) + "(n == 9)", True),
    ("G (" + " xor ".join(["n >= 0"] * DEEP) + ")", False),
    ("G (" + " xor ".join(["n >= 0"] * (DEEP + 1)) + ")", True),
    ("G (" + " xor ".join(f"n < {5 + i}" for i in range(31)) + ")", True),
    ("G (" + " xor ".join(f"n < {4 + i}" for i in range(31)) + ")", False),
    ("G (" + "n == 9 imply " * DEEP + "n >= 0)", True),
    ("G (" + "n >= 0 imply " * DEEP + "n == 9)", False),
    ("G (" + "n == 9 || n == 7 imply " * DEEP + "n == 9)", False),
    ("G (" + " - ".join(["n"] * DEEP) + " <= 0)", True),
]


def model(formula: str) -> api.Model:
    text = f"""
        clock x; int n;
        process P() {{ state A {{ x <= 1 }}; init A;
            trans A -> A {{ guard x >= 1; assign x = 0, n = (n + 1) % 5; }}; }}
        system P;
        property Q : {formula};"""
    return api.Model(load_model(Source("model.ta", text)))


def parsed(text: str) -> Formula:
    formula, found = parse_formula(Source("f", text))
    assert formula is not None, found
    return formula


@pytest.mark.parametrize(("formula", "expected"), some(FORMULAS, 9), ids=lambda value: str(value)[:20])
def test_verified_and_monitored_alike(formula: str, expected: bool) -> None:
    (verdict,) = model(formula).verify()
    assert verdict.answer == ("holds" if expected else "fails")
    found = tachk.monitor(formula, {"time": list(range(10)), "n": [t % 5 for t in range(10)]})
    assert found.truth is (Truth.TRUE if expected else Truth.FALSE)


@pytest.mark.parametrize("links", [2, 5, 31, DEEP])
def test_the_robustness_of_a_chain_of_differences(links: int) -> None:
    """It is that of the nearest threshold; the truth is the parity of the thresholds above."""
    chain = " xor ".join(f"x > {2 * i}" for i in range(links))
    for value in (-1, 1, 2 * links - 3, 2 * links + 1):
        found = tachk.monitor(f"G ({chain})", {"time": [0, 1], "x": [value, value]}, end="weak")
        above = sum(value > 2 * i for i in range(links))
        assert found.truth is (Truth.TRUE if above % 2 else Truth.FALSE)
        nearest = min(abs(value - 2 * i) for i in range(links))
        assert found[0].robustness[1] == (nearest if above % 2 else -nearest)


def test_conditional_chains_are_verified() -> None:
    chain = "".join(f"n == {i} ? {i} : " for i in range(DEEP))
    assert [verdict.answer for verdict in model(f"G (({chain}7) == n)").verify()] == ["holds"]
    with pytest.raises(InputError):
        tachk.monitor(f"G (({chain}7) == n)", {"time": [0, 1], "n": [0, 1]})


@pytest.mark.parametrize(
    "formula",
    [
        "G (" + " || ".join(f"F[0,{i + 1}] n == {i}" for i in range(LONG)) + ")",
        " && ".join(f"F[0,{i + 1}] n == {i}" for i in range(LONG)),
        " || ".join(f"F[0,{i + 1}] n == {i} && F[0,{i + 1}] n == 7" for i in range(LONG)),
        " && ".join(f"G (n == {i} -> F[0,{i + 1}] n == 7)" for i in range(LONG)),
    ],
    ids=lambda text: text[:20],
)
def test_what_has_no_observer_is_said_before_it_is_built(formula: str) -> None:
    with pytest.raises(NoObserver, match="more than"):
        build_observer(parsed(formula), "Observer")


def test_observers_are_not_deep() -> None:
    """What thousands of conditions are joined to has few levels, also for those who recurse."""
    observer = build_observer(parsed("G (" + " && ".join(f"n < {5 + i}" for i in range(LONG)) + ")"), "Observer")
    assert hash(observer.template) == hash(observer.template)
    assert len(repr(observer.template)) > LONG


def responses(count: int) -> MonitorProgram:
    formula = parsed(" && ".join(f"G (x{i} -> F[0,5] y)" for i in range(count)))
    return compiler.compile(formula, ["y", *(f"x{i}" for i in range(count))], 1)


def test_the_part_of_a_program_that_some_nodes_need() -> None:
    program = responses(50)
    (last,) = program.nodes[-1].operands[-1:]
    part, (place,) = part_of(program, [last])
    assert set(part.columns) == {"x49", "y"} and len(part.atoms) == 2 and place == len(part.nodes) - 1
    assert part.nodes[place].text == program.nodes[last].text
    assert part_of(program, [len(program.nodes) - 1])[0] is program


def test_explanations_read_the_trace_few_times() -> None:
    program = responses(1000)
    asked: list[int] = []

    def compute(nodes: Sequence[int]) -> Sequence[NodeSignal]:
        asked.append(len(nodes))
        return [NodeSignal(np.array([0]), np.array([np.uint8(Truth.TRUE)]), 3) for _ in nodes]

    explainer = Explainer(program, compute, None, 3)
    parts = program.nodes[-1].operands
    assert list(explainer._having(parts, 0, Truth.FALSE)) == []
    assert len(asked) < 30
    assert next(Explainer(program, compute, None, 3)._having(parts, 0, Truth.TRUE)) == parts[0]
    assert asked[-1] == 2  # the first part and its operand
