"""By which numbers processes are told apart."""

import tachk
from tachk.engine.symmetry.process_numbers import most_alike, numbers_of_processes
from tachk.model.network import Network

EDGES = ("to L {{ guard turn == {0}; assign turn = 0; }}", "to M {{ assign taken[{0}] = true; }}")


def network(*edges: tuple[str, ...]) -> Network:
    processes = (
        f"process P{n}() {{ init location L {{ {' '.join(own).format(n)} }} location M; }}"
        for n, own in enumerate(edges, start=1)
    )
    names = ", ".join(f"P{n}" for n in range(1, len(edges) + 1))
    text = "\n".join(("int[0, 9] turn; bool taken[10];", *processes, f"system {names};"))
    return tachk.loads(text).network


def test_each_place_with_a_number_for_each() -> None:
    assert numbers_of_processes(network(EDGES, EDGES, EDGES)) == {frozenset({1, 2, 3})}


def test_edges_may_come_in_another_order() -> None:
    assert numbers_of_processes(network(EDGES, EDGES[::-1])) == {frozenset({1, 2})}


def test_processes_that_look_otherwise_do_not_count() -> None:
    assert numbers_of_processes(network(EDGES, EDGES, EDGES[:1])) == {frozenset({1, 2})}
    assert numbers_of_processes(network(EDGES, EDGES[:1])) == set()


def test_what_is_seen_at_once() -> None:
    three = network(EDGES, EDGES, EDGES[:1])
    assert most_alike(three) == 3
    assert numbers_of_processes(three, fewest=3) == set()
