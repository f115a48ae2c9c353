"""Random networks written for UPPAAL: UPPAAL's rules take them, and what is read back reaches the same."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

import tachk
from tachk.analysis.fold import network_expressions
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.base.span import Source
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.formats.catalogue import export_model
from tachk.formats.exported import Writing
from tachk.formats.loading.load import load_model
from tachk.formats.network_document import network_model
from tachk.formats.uppaal.portability import portability
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.model.expressions import BOOL, Binary, Call, Expression, LocationTest
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.model.traversal import walk
from tachk.verify.verify import verify
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn


def reached(network: Network) -> list[str]:
    """The answer for each combination of locations."""
    queries = []
    for places in product(*(range(len(process.locations)) for process in network.processes)):
        test: Expression = LocationTest(0, places[0])
        for process, place in enumerate(places[1:], 1):
            test = Binary(BinaryOperator.AND, test, LocationTest(process, place), BOOL)
        queries.append(Query("q", QueryKind.POSSIBLY, test))
    verdicts = verify(network, tuple(queries[:40]), Options(), Limits(states=2_000), False)
    return [verdict.answer for verdict in verdicts]


@pytest.mark.parametrize("seed", seeds(range(16)))
def test_random_networks(seed: int) -> None:
    network = random_case(Random(seed)).network
    original = network_model(network, "random")
    answers = reached(original.network)
    for form, name in (("xml", "again.xml"), ("xta", "again.xta")):
        again = load_model(Source(name, export_model(original, form, Writing()).text))
        found = [d for d in portability(again, UppaalVersion.UPPAAL_5_0) if d.code.startswith("E")]
        assert found == []
        assert reached(again.network) == answers


def test_a_function_made_in_python_is_not_written_without_its_declaration() -> None:
    for seed in seeds(range(200)):
        network = random_case(Random(seed), Shape(clocks=3, copies=0.5)).network
        model = tachk.Model(network, "random")
        if any(isinstance(part, Call) for root in network_expressions(network) for part in walk(root)):
            with pytest.raises(UsageError, match="cannot be written as a model"):
                tachk.export(model, "xml")
            return
    raise AssertionError("no network calls a function")
