"""The life of a session: set-up and reconnect, the return of run calls, READ_DATA without limit, numbers that go round.

Each system has the behaviour of a historic version of the real programs and that of a later one, as a constant says.
"""

from __future__ import annotations

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn

MODELS = data_root() / "models" / "micro_xrce_dds"

STUCK = {"returns", "ends"}
SWALLOWED = {"created", "counted"}
DISORDERED = {"ECFS", "RMIO"}

FAIL: list[tuple[str, dict[str, int | bool], set[str]]] = [
    ("unlimited_read", {}, {"ECRA", "goes_on"}),
    ("unlimited_read", {"COUNTED": False}, set()),
    ("unlimited_read", {"UNLIMITED": 4}, {"ECRA", "goes_on"}),
    ("unlimited_read", {"UNLIMITED": 5}, {"goes_on"}),
    ("run_returns", {}, STUCK),
    ("run_returns", {"CALL": 0}, set()),
    ("run_returns", {"CALL": 0, "LOSSES": 3}, set()),
    ("run_returns", {"LOSSES": 0}, set()),
    ("run_returns", {"TRAFFIC": 0, "LOSSES": 3}, set()),
    ("run_returns", {"TRAFFIC": 150}, set()),
    ("run_returns", {"HEARTBEAT_LAW": 0}, set()),
    ("run_returns", {"CALL": 2, "LOSSES": 0}, STUCK),
    ("run_returns", {"CALL": 2, "TRAFFIC": 1100}, {"returns"}),
    ("reconnect", {}, SWALLOWED),
    ("reconnect", {"RESETS_AGAIN": True}, set()),
    ("reconnect", {"RESETS_AGAIN": True, "YOUNG": 3}, set()),
    ("reconnect", {"OLD": 0}, set()),
    ("reconnect", {"OLD_NUMBER": 1, "OLD": 1}, SWALLOWED),
    ("reconnect", {"OLD_NUMBER": 3}, set()),
    ("reconnect", {"RESETS_AGAIN": True, "OLD": 0, "LATES": 1}, {"created", "NOHOLE"}),
    ("reconnect", {"OLD": 0, "LATES": 1}, {"created"}),
    ("wrap", {}, set()),
    ("wrap", {"LOSSES": 2}, set()),
    ("wrap", {"CYCLE": 9, "HISTORY": 3}, set()),
    ("wrap", {"HISTORY": 3, "LOSSES": 0}, DISORDERED),
    ("wrap", {"HISTORY": 3, "BURST": 1, "LOSSES": 0}, set()),
    ("wrap", {"HISTORY": 3, "BURST": 1}, DISORDERED | {"no_overflow"}),
    ("wrap", {"CIRCLE": False}, DISORDERED | {"no_overflow"}),
]


@pytest.mark.parametrize(("system", "settings", "fail"), FAIL)
def test_a_system_has_its_defect_and_loses_it_with_its_cause(
    system: str, settings: dict[str, int | bool], fail: set[str]
) -> None:
    report = tachk.load(MODELS / f"{system}.ta", **settings).verify(trace=False, limits=tachk.Limits(states=300_000))
    assert {verdict.query.name for verdict in report if verdict.answer.value == "fails"} == fail
    assert report.met is True
