"""A quick look tells apart only what a full one tells apart, too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.engine.symmetry import detection
from tachk.engine.symmetry.coarse_partition import CoarsePartition, coarse_partition
from tachk.engine.symmetry.detection import Symmetry, search_symmetry
from tachk.model.network import Network
from tests.support.seeds import enough, seeds
from tests.support.symmetric.cases import SymmetricCase, random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.cycles import random_ring_case
from tests.support.symmetric.registers import random_register_case

pytestmark = pytest.mark.drawn


def _members(symmetry: Symmetry) -> list[object]:
    return [*(group.members for group in symmetry.groups), *(cycle.members for cycle in symmetry.cycles)]


def _without_colours(network: Network) -> CoarsePartition:
    return replace(coarse_partition(network), colours=[0] * len(network.processes))


@pytest.mark.parametrize(
    "random_case", [random_symmetric_case, random_controller_case, random_register_case, random_ring_case]
)
def test_the_same_is_found_without_it(
    random_case: Callable[[Random], SymmetricCase], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = 0
    for seed in seeds(range(60)):
        network = tachk.loads(random_case(Random(seed)).text).network
        quick = _members(search_symmetry(network, []))
        with monkeypatch.context() as patched:
            patched.setattr(detection, "coarse_partition", _without_colours)
            assert quick == _members(search_symmetry(network, [])), f"seed {seed}"
        found += bool(quick)
        assert coarse_partition(network).repeats or not quick
    assert enough(found > 20)


def _repeats(first: str, second: str, declarations: str = "") -> bool:
    processes = f"process P() {{ {first} }}\nprocess Q() {{ {second} }}"
    return coarse_partition(tachk.loads(f"{declarations}\n{processes}\nsystem P, Q;").network).repeats


def _loop(words: str) -> str:
    return f"init location L {{ to L {{ {words} }} }}"


def test_what_is_used_in_the_same_way_is_not_distinguished() -> None:
    assert _repeats(_loop("assign a = 1;"), _loop("assign b = 1;"), "bool a, b;")
    assert _repeats(_loop("assign a[0] = 1;"), _loop("assign a[1] = 1;"), "bool a[2];")


def test_what_only_one_of_them_mentions_distinguishes_them() -> None:
    assert not _repeats(_loop("assign a = 1;"), _loop("assign b = 1;"), "bool a; int b;")
    assert not _repeats(
        _loop("guard a; assign a = 1;"), _loop("assign a = 1;") + " location M { to M { guard a; } }", "bool a;"
    )
    assert not _repeats(_loop("assign a[0] = 1;"), _loop("guard a[0]; assign a[1] = 1;"), "bool a[2];")


def test_functions_are_analysed() -> None:
    assert not _repeats(
        f"void set() {{ a = 1; }} {_loop('assign set();')}",
        f"void set() {{ b = 1; }} {_loop('assign set();')}",
        "bool a; int b;",
    )


def test_what_is_known_is_not_mentioned() -> None:
    text = (
        "const int K = 1;\nint x;\nprocess P(const int me) { init location L { to L { guard me == K || me == 2; } } }\n"
    )
    assert coarse_partition(tachk.loads(f"{text}A = P(1);\nB = P(2);\nsystem A, B;").network).repeats


def test_edges_that_are_never_taken_do_not_count() -> None:
    text = "bool x;\nprocess P(const int me) { init location L { to L { guard me > 1; assign x = 1; } to L { } } }\n"
    two, one = (coarse_partition(tachk.loads(f"{text}A = P({a});\nB = P(1);\nsystem A, B;").network) for a in (0, 2))
    assert two.repeats and not one.repeats


def _of_two(words: str) -> bool:
    text = f"int[0, 5] turn;\nprocess P(const int[0, 1] me) {{ {_loop(words)} }}\nsystem P;"
    return coarse_partition(tachk.loads(text).network).repeats


def test_numbers_that_are_more_than_names_distinguish_them() -> None:
    assert _of_two("guard turn == me; assign turn = 1 - me;")
    assert not _of_two("guard turn > me; assign turn = 1 - me;")


def test_what_a_function_does_with_a_number_counts() -> None:
    function = "bool before(int[0, 1] p) { return p < turn; }\n"
    words = "guard before(me); assign turn = 1 - me;"
    text = f"int[0, 5] turn;\n{function}process P(const int[0, 1] me) {{ {_loop(words)} }}\nsystem P;"
    assert not coarse_partition(tachk.loads(text).network).repeats


def test_updates_in_another_order_show_nothing() -> None:
    text = (
        "int[0, 9] a, c; bool b, d;\n"
        "process P() { init location L { to L { assign a = 2, b = 1; } } }\n"
        "process Q() { init location L { to L { assign d = 1, c = 2; } } }\nsystem P, Q;"
    )
    assert coarse_partition(tachk.loads(text).network).repeats
