"""Defects of the real client and Agent, each with a model that has it and a constant that takes its cause away."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn

MODELS = data_root() / "models" / "micro_xrce_dds"


SMALL = {
    "read_again": {"MESSAGES": 5, "KEEP": 5, "AGENT_WINDOW": 2, "SLEEP": 35},
    "overtaking": {},
    "full_window": {"HISTORY": 2, "LOSSES": 2, "MESSAGES": 3},
    "fragments": {"PIECES": 2},
    "fleet": {"EACH": 1, "OBJECTS": 1},
}
FAIL = {
    "read_again": {"ECRA", "RMIO2"},  # a second READ_DATA stops the thread that holds a sample
    "overtaking": {"needless"},  # a HEARTBEAT overtakes the message that it announces
    "full_window": {"opens", "ECFS", "FCRS", "never"},  # every run starts the timer again
    "fragments": {"returns", "ECRA", "FARS"},  # the client looks for the last piece among slots that have other ones
    "fleet": set(),
}


@pytest.mark.parametrize("system", SMALL)
def test_a_system_has_its_defect_and_no_other(system: str) -> None:
    """That each is gone without its cause is what the models tell one to try: test_settings.py."""
    model = tachk.load(MODELS / f"{system}.ta", **SMALL[system])
    report = model.verify(trace=False, limits=tachk.Limits(states=100_000))
    assert report.met is True
    assert {verdict.query.name for verdict in report if verdict.answer.value == "fails"} == FAIL[system]


@pytest.mark.parametrize("slots", [1, 2, 4])
@pytest.mark.parametrize("pieces", range(6))
def test_a_history_of_as_many_slots_as_a_sample_has_pieces_is_enough(slots: int, pieces: int) -> None:
    model = tachk.load(MODELS / "fragments.ta", INPUT_HISTORY=slots, PIECES=pieces, LOSSES=0, MESSAGES=1, KEEP=1)
    found = model.verify(property=["returns", "ECRA", "FARS"], trace=False)
    assert {verdict.answer.value for verdict in found} == {"holds" if pieces + 1 <= slots else "fails"}
