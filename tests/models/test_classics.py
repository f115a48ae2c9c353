"""The classic models answer as they say, at their default size and at the settings that make a difference."""

from pathlib import Path

import pytest

import tachk
from tachk.base.resources import data_root

CLASSICS = data_root() / "models" / "classics"


def answers(model: Path, *properties: str, **constants: int | bool) -> dict[str, str]:
    """The answers by property name, without traces."""
    report = tachk.load(model, **constants).verify(
        property=properties, trace=False, limits=tachk.Limits(states=300_000)
    )
    return {verdict.query.name: verdict.answer.value for verdict in report}


@pytest.mark.parametrize("model", sorted(CLASSICS.glob("*.ta")), ids=lambda path: path.stem)
def test_a_classic_answers_as_it_expects(model: Path) -> None:
    assert tachk.load(model).verify(trace=False).met is True


@pytest.mark.parametrize(("waiting", "holds"), [(9, False), (10, True), (11, True)])
def test_fischer_needs_a_wait_as_long_as_the_write(waiting: int, holds: bool) -> None:
    found = answers(CLASSICS / "fischer.ta", "mutual_exclusion", N=3, WAIT=waiting)
    assert found == {"mutual_exclusion": "holds" if holds else "fails"}


@pytest.mark.parametrize(("processes", "stored"), [(4, 220), (6, 2378), (7, 7737)])
def test_fischer_has_the_published_number_of_zones(processes: int, stored: int) -> None:
    """TChecker stores the same numbers for its network of this name (covering reachability)."""
    model = tachk.load(CLASSICS / "fischer.ta", N=processes)
    report = model.verify(property="mutual_exclusion", trace=False, options=tachk.Options().off("symmetry"))
    assert report["mutual_exclusion"].statistics.states_stored == stored


@pytest.mark.parametrize(("time", "enough"), [(59, False), (60, True), (65, True)])
def test_four_people_need_sixty_minutes(time: int, enough: bool) -> None:
    assert answers(CLASSICS / "bridge.ta", "in_time", T=time) == {"in_time": "holds" if enough else "fails"}


def test_a_careful_counter_lets_one_cell_in_at_a_time() -> None:
    assert answers(CLASSICS / "critical_region.ta", "exclusive", CAREFUL=True) == {"exclusive": "holds"}


def test_csma_cd_without_the_late_notice_flaw_has_no_deadlock() -> None:
    assert answers(CLASSICS / "csma_cd.ta", "deadlock_free", N=3, NOTICE=52) == {"deadlock_free": "holds"}


BRP = [
    # TS, TR, SYNC, INSTANT: overflow, premature timeout, failure possible
    (3, 16, 14, True, False, False, False),
    (3, 16, 13, True, False, False, True),
    (3, 15, 15, True, False, False, True),
    (3, 15, 14, True, False, False, True),
    (3, 14, 14, True, False, False, True),
    (3, 15, 15, False, False, False, False),
    (3, 15, 13, False, False, False, False),
    (3, 15, 12, False, False, False, True),
    (2, 15, 15, True, True, True, True),
]


@pytest.mark.parametrize(("ts", "tr", "sync", "instant", "overflow", "premature", "failure"), BRP)
def test_brp_separates_strict_from_weak_bounds(
    ts: int, tr: int, sync: int, instant: bool, overflow: bool, premature: bool, failure: bool
) -> None:
    found = answers(CLASSICS / "brp.ta", TS=ts, TR=tr, SYNC=sync, INSTANT=instant)
    assert (found["no_overflow"] == "fails") == overflow
    assert (found["no_premature_timeout"] == "fails") == premature
    assert (found["no_failure"] == "fails") == failure
    assert "unknown" not in found.values()


@pytest.mark.parametrize(
    ("chunks", "repetitions", "delay", "patience"), [(2, 1, 1, 3), (3, 1, 1, 4), (2, 2, 1, 4), (2, 1, 2, 5)]
)
@pytest.mark.parametrize("instant", [True, False])
def test_brp_obeys_the_law_of_its_bounds(
    chunks: int, repetitions: int, delay: int, patience: int, instant: bool
) -> None:
    """No failure iff TR > 2 MAX TS + 3 TD (>= where a message takes time) and SYNC >= TR - TS + TD."""
    least_tr = 2 * repetitions * patience + 3 * delay + (1 if instant else 0)
    least_sync = least_tr - patience + delay
    for tr, sync, safe in (
        (least_tr, least_sync, True),
        (least_tr, least_sync - 1, False),
        (least_tr - 1, least_sync + 5, False),
    ):
        found = answers(
            CLASSICS / "brp.ta",
            "no_failure",
            N=chunks,
            MAX=repetitions,
            TD=delay,
            TS=patience,
            TR=tr,
            SYNC=sync,
            INSTANT=instant,
        )
        assert found == {"no_failure": "holds" if safe else "fails"}, (tr, sync)
