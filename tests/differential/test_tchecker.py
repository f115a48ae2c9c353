"""Random networks written for TChecker and read back reach the same combinations of locations."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.span import Source
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.formats.loading.load import load_model
from tachk.formats.tchecker.writer import to_tchecker
from tachk.model.expressions import BOOL, Binary, Expression, LocationTest
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.verify.verify import verify
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

SHAPE = Shape(urgent_channels=False, clocks_on_broadcast=False, locations=3)


def written(seed: int) -> tuple[Network, str] | None:
    """A random network and its text; None if TChecker has no words for it."""
    network = random_case(Random(seed), SHAPE).network
    try:
        return network, to_tchecker(network).text
    except UnsupportedError:
        return None


SEEDS = [seed for seed in seeds(range(40)) if written(seed) is not None]


def reached(network: Network, sizes: list[int]) -> set[tuple[int, ...]]:
    combinations = list(product(*map(range, sizes)))
    queries = []
    for places in combinations:
        test: Expression = LocationTest(0, places[0])
        for process, place in enumerate(places[1:], 1):
            test = Binary(BinaryOperator.AND, test, LocationTest(process, place), BOOL)
        queries.append(Query("q", QueryKind.POSSIBLY, test))
    verdicts = verify(network, tuple(queries), Options(), Limits(states=20_000), False)
    assert not any(verdict.reason for verdict in verdicts)
    return {places for places, verdict in zip(combinations, verdicts, strict=True) if verdict.answer == "holds"}


@pytest.mark.parametrize("seed", SEEDS)
def test_the_same_locations_are_reached(seed: int) -> None:
    pair = written(seed)
    assert pair is not None
    network, text = pair
    sizes = [len(process.locations) for process in network.processes]
    again = load_model(Source("random.tck", text)).network
    assert reached(again, sizes) == reached(network, sizes)
