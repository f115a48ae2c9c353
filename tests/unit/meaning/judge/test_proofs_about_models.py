"""What holds in the models has certificates, which both checkers accept and which are small."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.verify.certificates import is_provable, widened_proof
from tachk.verify.verify import verify
from tests.support.seeds import some
from tests.unit.meaning.judge.proofs import MODELS, judged, proved, written

pytestmark = pytest.mark.drawn(8)

SMALL: dict[str, dict[str, int | bool]] = {
    "classics/bridge.ta": {},
    "classics/brp.ta": {},
    "classics/critical_region.ta": {"N": 2},
    "classics/csma_cd.ta": {"N": 2},
    "classics/csma_cd_any_order.ta": {"N": 2},
    "classics/dining_philosophers.ta": {"N": 3},
    "classics/fddi.ta": {"N": 2},
    "classics/fischer.ta": {"N": 3},
    "classics/single_sign_on.ta": {},
    "classics/train_gate.ta": {"N": 3},
}


@pytest.mark.parametrize("model", SMALL)
def test_both_checkers_accept_what_is_proved_about_a_classic(model: str) -> None:
    loaded = tachk.load(MODELS / model, **SMALL[model])
    provable = [v for v in loaded.verify(trace=False) if is_provable(v)]
    assert provable or model.endswith(("critical_region.ta", "csma_cd.ta"))
    for verdict in provable:
        certificate = written(proved(loaded.network, verdict.query))
        assert judged(loaded.network, verdict.query, certificate) is None


ALONE = {"MESSAGES": 1, "LOSSES": 0, "QUOTA": 1}

XRCE: list[tuple[str, dict[str, int], int]] = [
    ("spec.ta", ALONE, 14),
    ("spec.ta", {"MESSAGES": 1, "LOSSES": 1, "QUOTA": 1, "SLEEPS": 0}, 14),
    ("paper.ta", ALONE, 16),
    ("client_2_0.ta", ALONE, 9),
    ("delayed.ta", ALONE, 4),
    ("client_3_0.ta", ALONE, 9),
    ("publication.ta", {"MESSAGES": 1, "LOSSES": 0}, 6),
    ("subscription.ta", {"MESSAGES": 1, "QUOTA": 1, "SLEEPS": 0}, 9),
    ("overtaking.ta", {"MESSAGES": 1}, 3),
    ("fleet.ta", {"EACH": 1, "LOSSES": 0}, 5),
    ("full_window.ta", {"MESSAGES": 1, "LOSSES": 0}, 4),
    ("read_again.ta", {"MESSAGES": 2, "SLEEPS": 0}, 3),
    ("fragments.ta", {"PIECES": 1, "MESSAGES": 1, "LOSSES": 0}, 5),
    ("reconnect.ta", {"RESETS_AGAIN": 1, "OLD": 1}, 4),
    ("run_returns.ta", {"CALL": 0, "MESSAGES": 1}, 2),
    ("unlimited_read.ta", {"COUNTED": 0, "LOSSES": 0}, 3),
    ("wrap.ta", {"LOSSES": 0}, 3),
]


@pytest.mark.parametrize(("model", "constants", "least"), XRCE)
def test_proofs_about_the_protocol_are_accepted(model: str, constants: dict[str, int], least: int) -> None:
    loaded = tachk.load(MODELS / "micro_xrce_dds" / model, **constants)
    provable = [v.query for v in loaded.verify(trace=False) if is_provable(v)]
    assert len(provable) >= least
    for query in some(provable, 2):
        assert judged(loaded.network, query, written(proved(loaded.network, query))) is None


def test_each_model_with_properties_has_its_proofs_checked() -> None:
    named = {*SMALL, *(f"micro_xrce_dds/{model}" for model, _, _ in XRCE)}
    for path in MODELS.glob("*/*.ta"):
        try:
            loaded = tachk.load(path)
        except InputError:  # a part of other models
            continue
        assert not loaded.properties or path.relative_to(MODELS).as_posix() in named


@pytest.mark.parametrize(
    ("model", "name", "constants"),
    [
        ("csma_cd.ta", "collision_noticed", {}),
        ("csma_cd.ta", "collision_noticed", {"N": 6}),
        ("brp.ta", "no_failure", {}),
        ("brp.ta", "no_overflow", {}),
        ("fddi.ta", "one_sender", {}),
        ("fddi.ta", "rotation_bound", {}),
        ("fddi.ta", "no_deadlock", {}),
    ],
)
def test_a_proof_needs_at_most_a_quarter_of_the_stored_zones(model: str, name: str, constants: dict[str, int]) -> None:
    """Constraints that it can do without are left out, and zones become one, until enough are equal."""
    loaded = tachk.load(MODELS / "classics" / model, **constants)
    (query,) = (query for query in loaded.properties if query.name == name)
    (verdict,) = verify(loaded.network, [query], trace=False)
    proof = proved(loaded.network, query)
    stored = verdict.statistics.states_stored
    wide = widened_proof(loaded.network, query, proof, stored)
    before, after = (sum(len(columns.constraints) for columns in one.columns()) for one in (proof, wide))
    assert 4 * before > stored >= 4 * after
    assert wide.zones <= proof.zones and wide.states == proof.states
    assert judged(loaded.network, query, written(wide)) is None


def test_one_zone_for_each_discrete_state_where_exact_bounds_allow_it() -> None:
    """With abstraction the hull of two zones of FDDI seems to have a deadlock."""
    loaded = tachk.load(MODELS / "classics/fddi.ta", N=10)
    (query,) = (query for query in loaded.properties if query.name == "no_deadlock")
    proof = proved(loaded.network, query)
    assert proof.zones == proof.states == 80
    assert judged(loaded.network, query, written(proof)) is None
