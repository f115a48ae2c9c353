"""What applications noted beside a recording."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of, with_log
from tachk.recordings.conformance.events import Closing, EventLog, RecordedEvent
from tachk.xrce.conformance.packet_events import read_capture

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
CAPTURE = ROOT / "tests/data/captures/spin_pause.pcap"
MODEL = ROOT / "models/micro_xrce_dds/recorded.ta"
SECOND = Fraction(10**9)


def event(time: int, name: str, **cells: int | str) -> RecordedEvent:
    return RecordedEvent(Fraction(time), name, cells, f"at {time}")


def recording(*events: RecordedEvent, unit: Fraction | None = Fraction(1), epoch: int = 0) -> EventLog:
    closings = (Closing("client", 1, Fraction(50)),)
    return EventLog("run.pcap", events, unit, None, Fraction(100), closings, epoch)


RUN = recording(
    event(10, "written", client=0, detail=-4),
    event(20, "written", client=0, detail=0),
    event(30, "written", client=0, detail=1),
    epoch=5 * 10**9,
)


def log(*events: RecordedEvent, unit: Fraction | None = Fraction(1)) -> EventLog:
    return EventLog("app.csv", events, unit, Fraction(0), Fraction(0))


def test_events_of_a_log_are_put_where_their_time_is() -> None:
    found = with_log(RUN, log(event(5 * 10**9 + 25, "told", client=0, what="CALLED")))
    assert [(e.name, int(e.time)) for e in found.events] == [
        ("written", 10),
        ("written", 20),
        ("told", 25),
        ("written", 30),
    ]


def test_what_a_log_reports_behind_a_sample_happens_after_it() -> None:
    """The CREATE is not a sample."""
    start = 5 * 10**9
    rows = [event(start + 19, "written", client="0"), event(start + 29, "written", client=0)]
    found = with_log(RUN, log(*rows, event(start + 31, "told", client=0, what="BACK")))
    told = next(e for e in found.events if e.name == "told")
    assert told.after is not None
    assert found.events[told.after].cells["detail"] == 1


def test_another_unit() -> None:
    seconds = log(event(5, "told", client=0, what="CALLED"), unit=SECOND)
    assert [int(e.time) for e in with_log(RUN, seconds).events] == [0, 10, 20, 30]


def test_a_client_has_ended() -> None:
    rows = [event(5 * 10**9 + time, "told", client=1, what="CALLED") for time in (40, 60)]
    assert sum(e.name == "told" for e in with_log(RUN, log(*rows)).events) == 1


def test_a_log_of_another_time() -> None:
    with pytest.raises(UsageError, match=r"nothing of app\.csv happens while run\.pcap is recorded"):
        with_log(RUN, log(event(6 * 10**9, "told", client=0, what="CALLED")))


def test_a_log_without_a_unit() -> None:
    with pytest.raises(UsageError, match=r"the times of app\.csv have no unit"):
        with_log(RUN, log(event(0, "told"), unit=None))


@pytest.mark.parametrize(("calls", "expected"), [(True, True), (False, False)])
def test_calls_of_the_run_function_put_a_heartbeat_off(calls: bool, expected: bool) -> None:
    """A sample is lost, and the application calls its run function every 50 ms for five seconds."""
    capture = CAPTURE.with_name("starved_heartbeat.pcap")
    printed = json.loads(capture.with_suffix(".json").read_text(encoding="utf-8"))["publisher"]
    ready, begin = (next(line["time"] for line in printed if line["event"] == name) for name in ("ready", "written"))
    told = [(ready, "TOLD_ALL"), (ready, "CALLED"), (begin + 5_050_000_000, "TOLD_SOME")]
    told[2:2] = [(begin + n * 50_500_000, "CALLED") for n in range(100 if calls else 1)]
    rows = tuple(RecordedEvent(Fraction(time), "told", {"client": 0, "what": what}, "log") for time, what in told)
    noted = EventLog("app.csv", rows, Fraction(1), None, rows[-1].time)
    settings = {"HISTORY": 8, "CLIENT_JITTER": 60, "AGENT_JITTER": 60, "EXACT_BITMAPS": True}
    model = tachk.load(MODEL, **settings)
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        with_log(read_capture(capture), noted),
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(30), Fraction(60)),
        limits=tachk.Limits(states=20_000),
        run=False,
        explain=False,
    )
    assert found.accepted is expected


@pytest.mark.parametrize(("said", "status"), [("TOLD_SOME", 0), ("LEFT", 10)])
def test_on_the_command_line(tmp_path: Path, said: str, status: int) -> None:
    """An application that is outside of its run function from the start takes no ACKNACK: its history fills."""
    printed = json.loads(CAPTURE.with_suffix(".json").read_text(encoding="utf-8"))["publisher"]
    ready = next(line["time"] for line in printed if line["event"] == "ready")
    rows = ["time [ns],event,client,what", f"{ready},told,0,TOLD_ALL", f"{ready + 1},told,0,{said}"]
    file = tmp_path / "app.csv"
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    settings = ("HISTORY=8", "CLIENT_JITTER=60", "AGENT_JITTER=60", "EXACT_BITMAPS=true")
    question = ["conform", str(MODEL), str(CAPTURE), *(word for each in settings for word in ("-D", each))]
    question += ["--tolerance", "30ms", "--late", "60ms", "--application", str(file), "--max-states", "3000"]
    found = CliRunner().invoke(app, question)
    assert found.exit_code == status, found.output


def test_one_row_stands_for_one_sample_of_a_message_with_several() -> None:
    """A call between the rows of its first two samples is not a call behind the message."""
    several = recording(event(20, "written", client=0, detail=2 * 2**23), event(30, "written", client=0, detail=3))
    rows = [event(time, "written", client=0) for time in (11, 13, 15)]
    calls = [event(time, "told", client=0, what="CALLED") for time in (12, 16, 32)]
    last = event(31, "written", client=0)
    found = with_log(several, log(*sorted([*rows, *calls, last], key=lambda each: each.time)))
    told = [each for each in found.events if each.name == "told"]
    after = [None if each.after is None else found.events[each.after].cells["detail"] for each in told]
    assert after == [None, 2 * 2**23, 3]
