"""`tachk time` gives the closed forms of the Micro XRCE-DDS models by itself."""

import pytest

import tachk
from tachk.cli.main import app
from tachk.resources import data_root

PUBLICATION = data_root() / "models" / "micro_xrce_dds" / "publication.ta"
REARMED, DOUBLING = 1, 2
ALONE = {"MESSAGES": 1, "SPIN": 1000, "PACE": 0}


def worst(start: str | None, end: str, **constants: int) -> int | None:
    times = tachk.load(PUBLICATION, **constants).time(start, end, best=False, trace=False)
    assert times.worst is not None and times.waiting is not None
    assert not times.worst.strict
    assert times.waiting.value == times.worst.value  # it always comes in that time
    return times.worst.value


@pytest.mark.parametrize(("losses", "expected"), list(enumerate([8, 116, 224, 332, 440])))
def test_a_reliable_publish_blocks_that_long(losses: int, expected: int) -> None:
    """k (H + 2d) + 2d with H = 100 and d = 4."""
    constants = {**ALONE, "DELAY": 4, "CLIENT_HEARTBEAT": 100, "PLACES": 12, "LOSSES": losses}
    assert worst(None, "acked == MESSAGES", **constants) == expected


@pytest.mark.parametrize(("losses", "expected"), list(enumerate([9, 13])))
def test_the_last_delivery(losses: int, expected: int) -> None:
    assert worst(None, "written == MESSAGES", LOSSES=losses) == expected


@pytest.mark.parametrize(("losses", "expected"), [(1, 3), (2, 5)])
def test_a_loss_is_detected(losses: int, expected: int) -> None:
    assert worst("loss.lost", "!loss.lost", LOSSES=losses, MESSAGES=1) == expected


@pytest.mark.parametrize("losses", [1, 2, 3])
def test_a_loss_is_detected_with_doubling_waits(losses: int) -> None:
    constants = {**ALONE, "HEARTBEAT_LAW": DOUBLING, "CLIENT_HEARTBEAT": 1, "LOSSES": losses}
    assert worst("loss.lost", "!loss.lost", **constants) == 2**losses


def test_run_slices_shorter_than_the_heartbeat_let_the_agent_wait_for_ever(capsys: pytest.CaptureFixture[str]) -> None:
    """SPIN < HBC starves the heartbeat, SPIN = HBC = 2 does not: K HBC + D."""
    line = f"time {PUBLICATION} --worst --format csv -D HEARTBEAT_LAW={REARMED} -D MESSAGES=1 --from loss.lost --to"
    arguments = [*line.split(), "!loss.lost", "--over", "LOSSES=1..2,SPIN=1..2,CLIENT_HEARTBEAT=2"]
    assert app.main(arguments, prog_name="tachk", standalone_mode=False) == 0
    rows = [line.split(",")[:6] for line in capsys.readouterr().out.splitlines()]
    assert rows == [
        ["LOSSES", "SPIN", "CLIENT_HEARTBEAT", "best", "worst", "waits"],
        ["1", "1", "2", "-", "-", "for ever"],
        ["1", "2", "2", "-", "3", "3"],
        ["2", "1", "2", "-", "-", "for ever"],
        ["2", "2", "2", "-", "5", "5"],
    ]
