"""Results about networks that are worked out once."""

from dataclasses import replace

from tachk.model.network import Network
from tachk.model.remembered import MOST_RESULTS, by_network, by_network_where


def test_a_network_is_asked_once_and_others_for_themselves() -> None:
    asked: list[tuple[Network, int]] = []

    @by_network
    def count(network: Network, number: int) -> int:
        asked.append((network, number))
        return len(asked)

    network = Network(())
    assert [count(network, 1), count(network, 1), count(network, 2), count(network, 1)] == [1, 1, 2, 1]
    assert count(replace(network), 1) == 3


def test_the_oldest_results_are_forgotten() -> None:
    asked = []

    @by_network
    def count(network: Network, number: int) -> int:
        asked.append(number)
        return number

    network = Network(())
    for number in range(MOST_RESULTS + 1):
        assert count(network, number) == number
    assert count(network, 1) == 1 and len(asked) == MOST_RESULTS + 1
    assert count(network, 0) == 0 and len(asked) == MOST_RESULTS + 2


def test_a_result_that_is_not_worth_it_is_worked_out_again() -> None:
    asked = []

    @by_network_where(lambda result: result < 5)
    def count(network: Network, number: int) -> int:
        asked.append(number)
        return number

    network = Network(())
    assert [count(network, number) for number in (1, 9, 1, 9)] == [1, 9, 1, 9]
    assert asked == [1, 9, 9]
