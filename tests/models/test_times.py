"""`tachk time` gives the closed forms of the Micro XRCE-DDS models by itself."""

from pathlib import Path

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.cli.main import app

pytestmark = pytest.mark.drawn(8)

MODELS = data_root() / "models" / "micro_xrce_dds"
PUBLICATION = MODELS / "publication.ta"
FIVE_AUTOMATA = MODELS / "delayed.ta"
REARMED, DOUBLING = 1, 2
ALONE = {"MESSAGES": 1, "SPIN": 1000, "PACE": 0}


def worst(start: str | None, end: str, system: Path = PUBLICATION, **constants: int) -> int | None:
    times = tachk.load(system, **constants).time(start, end, best=False, trace=False)
    assert times.worst is not None and times.waiting is not None
    assert not times.worst.strict
    assert times.waiting.value == times.worst.value  # it always comes in that time
    return times.worst.value


@pytest.mark.parametrize(("losses", "expected"), list(enumerate([8, 116, 224, 332, 440])))
def test_a_reliable_publish_blocks_that_long(losses: int, expected: int) -> None:
    """k (H + 2d) + 2d with H = 100 and d = 4."""
    constants = {**ALONE, "DELAY": 4, "CLIENT_HEARTBEAT": 100, "PLACES": 12, "LOSSES": losses}
    assert worst(None, "acked[PUB] == MESSAGES", **constants) == expected


@pytest.mark.parametrize(("losses", "expected"), list(enumerate([9, 13])))
def test_the_last_delivery(losses: int, expected: int) -> None:
    assert worst(None, "written[PUB] == MESSAGES", LOSSES=losses) == expected


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


@pytest.mark.parametrize(("losses", "expected"), list(enumerate([8, 116, 224, 332, 440])))
def test_a_reliable_publish_blocks_that_long_among_the_five_automata(losses: int, expected: int) -> None:
    constants = {**ALONE, "DELAY": 4, "CLIENT_HEARTBEAT": 100, "AGENT_HEARTBEAT": 200, "DEAD": 30_000, "LOSSES": losses}
    assert worst(None, "acked[PUB] == MESSAGES", FIVE_AUTOMATA, **constants) == expected


@pytest.mark.parametrize(("messages", "losses", "expected"), [(1, 0, 1), (1, 2, 9), (2, 0, 5), (2, 1, 9), (3, 0, 9)])
def test_the_last_delivery_among_the_five_automata(messages: int, losses: int, expected: int) -> None:
    """(N - 1) max(PACE, SPIN) + K (HBC + 2 D) + D with SPIN = 4, HBC = 2, D = 1."""
    constants = {"MESSAGES": messages, "LOSSES": losses}
    assert worst(None, "written[PUB] == MESSAGES", FIVE_AUTOMATA, **constants) == expected


@pytest.mark.parametrize(("losses", "expected"), [(1, 3), (2, 5)])
def test_a_loss_is_detected_among_the_five_automata(losses: int, expected: int) -> None:
    assert worst("loss.lost", "!loss.lost", FIVE_AUTOMATA, LOSSES=losses) == expected


@pytest.mark.parametrize(
    ("start", "end", "longest"), [(None, "written[PUB] == MESSAGES", 1000), ("loss.lost", "!loss.lost", 1000)]
)
def test_nothing_repairs_a_loss_with_slices_that_are_too_short(start: str | None, end: str, longest: int) -> None:
    """Whether the client waits for ever is proved beside clocks that count up to 50,000."""
    times = tachk.load(MODELS / "client_3_0.ta", MESSAGES=2).time(start, end, best=False, trace=False)
    assert times.reason == "" and times.worst is not None
    assert times.worst.value == longest and times.may_wait_for_ever
