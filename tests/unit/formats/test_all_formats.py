"""Every format takes every model: it is written, or refused by name."""

from __future__ import annotations

from contextlib import nullcontext, suppress
from pathlib import Path
from random import Random

import pytest

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.span import Source
from tachk.formats.catalogue import EXPORT_FORMATS, export_model
from tachk.formats.dot import to_dot
from tachk.formats.exported import Writing
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.network import network_from_json, network_to_json, same_network
from tachk.formats.tchecker.writer import to_tchecker
from tachk.formats.uppaal.intermediate import network_to_intermediate
from tachk.model.random_networks import random_case
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

MODELS = Path(__file__).parents[3] / "models"
SHIPPED = [*sorted(MODELS.glob("classics/*.ta")), MODELS / "micro_xrce_dds" / "publication.ta"]
POORER = ("tchecker", "munta")
FORMULAS = """\
process P() { clock x; init location a { to b { guard x >= 1; } } location b; }
system P;
property r : G (P.a -> F[0, 5] P.b);
property s : E<> P.b;
property t : A<> P.b;
property u : Pr[<=10] (<> P.b);
"""


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_models(path: Path) -> None:
    model = api.load(path).loaded
    for format_ in EXPORT_FORMATS:
        for observers in (True, False):
            with suppress(UnsupportedError) if format_ in POORER else nullcontext():
                assert export_model(model, format_, Writing(observers=observers)).text


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_random_networks(seed: int) -> None:
    network = random_case(Random(seed)).network
    assert same_network(network_from_json(network_to_json(network)), network)
    assert to_dot(network)
    assert network_to_intermediate(network).startswith("layout\n")
    with suppress(UnsupportedError):
        assert to_tchecker(network).text


@pytest.mark.parametrize("format_", list(EXPORT_FORMATS))
def test_formulas_of_every_kind(format_: str) -> None:
    model = load_model(Source("m.ta", FORMULAS))
    assert export_model(model, format_).text


def test_a_temporal_formula_is_a_comment_for_tchecker() -> None:
    text = export_model(load_model(Source("m.ta", FORMULAS)), "tchecker").text
    assert "process:P\n" in text
    assert "# r: G (P.a -> F[0, 5] P.b)\n#     labels cannot ask it: it is a temporal formula" in text
    assert "# s: E<> P.b\n#     holds if TChecker reaches -l q2_1\n" in text
