"""`tachk chart` of captures."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from click.testing import CliRunner

from tachk.cli.main import app
from tachk.model.quantity import ranges
from tachk.xrce.report.sequence_chart import chart_of_capture
from tachk.xrce.transmissions import read_transmissions
from tests.unit.xrce.captures import CREATE_CLIENT, RECORDED, needs_recorded, pcap, udp
from tests.unit.xrce.test_measure import acknack, heartbeat, write


def relayed(path: Path) -> Path:
    """A client, a relay that loses one message and copies another, and an Agent."""
    up, on = (40000, 9001), (9101, 8888)
    packets = [
        udp(CREATE_CLIENT, *up),
        udp(CREATE_CLIENT, *on),
        udp(write(0), *up),
        udp(write(0), *on),
        udp(write(1), *up),
        udp(heartbeat(1, 1), *up),
        udp(heartbeat(1, 1), *on),
        udp(heartbeat(1, 1), *on),
        udp(acknack(1, 1), 8888, 9101),
        udp(acknack(1, 1), 9001, 40000),
        udp(write(1), *up),
        udp(write(1), *on),
    ]
    path.write_bytes(pcap(packets))
    return path


def test_what_a_capture_shows(tmp_path: Path):
    chart = chart_of_capture(read_transmissions(relayed(tmp_path / "run.pcap")), "run")
    assert chart.lifelines == ("client CCCCDDDD", "Agent")
    assert [(m.label, m.tag, m.sender, len(m.arrivals), m.is_repeated) for m in chart.messages] == [
        ("CREATE_CLIENT", "1", 0, 1, False),
        ("WRITE_DATA 0", "3", 0, 1, False),
        ("WRITE_DATA 1", "5", 0, 0, False),
        ("HEARTBEAT 1..1", "6", 0, 2, False),
        ("ACKNACK 1 missing 1", "9", 1, 1, False),
        ("WRITE_DATA 1", "11", 0, 1, True),
    ]
    assert [float(m.sent.time) for m in chart.messages] == [0, 2, 4, 5, 8, 10]


def test_the_command(tmp_path: Path):
    capture, picture = relayed(tmp_path / "run.pcap"), tmp_path / "out.svg"
    result = CliRunner().invoke(app, ["chart", str(capture), "--from", "4 ms", "--to", "0.009", "-o", str(picture)])
    assert result.output == f"written: {picture}\n"
    found = ElementTree.parse(picture).getroot().iter("{http://www.w3.org/2000/svg}text")
    texts = [list(text.itertext())[-1] for text in found]
    assert [text for text in texts if "WRITE" in text] == ["WRITE_DATA 1 lost"]
    assert "HEARTBEAT 1..1 ×2" in texts
    png = tmp_path / "out.png"
    assert CliRunner().invoke(app, ["chart", str(capture), "--time", "scale", "-o", str(png)]).exit_code == 0
    assert png.read_bytes()[:4] == b"\x89PNG"


def test_what_cannot_be_drawn(tmp_path: Path):
    capture = relayed(tmp_path / "run.pcap")
    for options, words in (
        (["--from", "soon"], "'soon' is not a time"),
        (["--from", "3 s"], "there is nothing to draw"),
        (["-o", "out.gif"], "charts are written as .svg or .png"),
        (["--port", "2018"], "no message to or from the ports of an Agent"),
    ):
        result = CliRunner().invoke(app, ["chart", str(capture), "-o", str(tmp_path / "x.svg"), *options])
        assert (result.exit_code, words in result.stderr) == (2, True), result.stderr


def test_numbers_in_a_row_are_reported_together():
    assert ranges([4, 6, 7, 8, 9]) == "4, 6..9"


@needs_recorded
def test_losses_are_those_of_the_log_of_the_relay():
    lost = {"a1_": 0, "c8_": 3, "d2_": 61, "e5_": 16, "h5_": 34}
    for name, number in lost.items():
        recording = read_transmissions(next(RECORDED.glob(f"{name}*.pcap")))
        assert sum(message.is_lost for message in chart_of_capture(recording, name).messages) == number
