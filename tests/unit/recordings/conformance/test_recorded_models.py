"""A model names another one against which recordings are held; `client_3_0.ta` and `spec.ta` do."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.formats.loading.recorded_models import recorded_model
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.report.conformance.text import conformance_to_text
from tachk.xrce.conformance.packet_events import read_capture

ROOT = Path(__file__).parents[4]
MODELS = ROOT / "models/micro_xrce_dds"
SHARED = ROOT.parent / "shared/captures"

RECORDED = """
const int WAIT = 5;
const int SPAN = 1;
broadcast chan beep;
process P {
    clock x;
    init location L { invariant x <= WAIT + SPAN; to L { guard x >= WAIT; sync beep!; assign x = 0; } }
}
system P;
recording { visible beep as beep(); }
"""
ASKING = """
const int WAIT = 7;
const int SPAN = 3;
process Q { init location L; }
system Q;
recording { import "recorded.ta" (WAIT = WAIT + 1); }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "recorded.ta").write_text(RECORDED, encoding="utf-8")
    (tmp_path / "asking.ta").write_text(ASKING, encoding="utf-8")
    (tmp_path / "beeps.csv").write_text("time,event\n8,beep\n17,beep\n", encoding="utf-8")
    return tmp_path


def test_the_other_model_takes_the_recording(folder: Path) -> None:
    assert tachk.conform(folder / "asking.ta", folder / "beeps.csv").accepted
    assert tachk.conform(folder / "recorded.ta", folder / "beeps.csv").accepted is False


def test_given_constants_have_their_value_in_both(folder: Path) -> None:
    model = tachk.load(folder / "asking.ta", SPAN=0)
    assert tachk.conform(model, folder / "beeps.csv").accepted is False


@pytest.mark.parametrize(
    ("clauses", "message"),
    [
        ('import "recorded.ta" (WAIT); tolerance 3;', "says nothing else"),
        ('import "recorded.ta" (WAIT = n);', "not a constant"),
    ],
)
def test_mistakes(clauses: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        tachk.loads(f"const int WAIT = 1; int n; process P {{ init location L; }} system P; recording {{ {clauses} }}")


CAPTURES = [("f3a_stale_acknack_tail_loss", "packet 126"), ("f6a_late_dup_create_client_pub_tail", "packet 132")]


@pytest.mark.parametrize(("capture", "place"), CAPTURES)
@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared captures are not here")
def test_a_stale_acknack_is_a_run_of_the_client_and_rejected_by_the_standard(capture: str, place: str) -> None:
    recording = read_capture(SHARED / f"{capture}.pcap")

    def conforms_within(name: str) -> Conformance:
        loaded = recorded_model(tachk.load(MODELS / name).loaded, str(MODELS / name), ())
        assert loaded.recording is not None
        return conform(loaded.network, loaded.recording, recording, constants_of(loaded), run=False)

    assert conforms_within("client_3_0.ta").accepted
    found = conforms_within("spec.ta")
    assert found.accepted is False
    assert found.refusal is not None and found.refusal.event is not None
    assert recording.events[found.refusal.event].place == place
    assert f"it leaves the model at {place}, at " in conformance_to_text(found, "spec.ta")
    assert " ms: sent(" in conformance_to_text(found, "spec.ta")


SOCKET = """
const int CLIENTS = 1, MESSAGES = 4, AGENT_WINDOW = 4, LOSSES = 0, PLACES = 1, WAITING = 1;
import "{models}/micro_xrce_dds/protocol.ta";
import "{models}/lib/messages.ta";
import "{models}/lib/free_application.ta";
process Relay {{
    clock since;
    init location Begun {{ to Half {{ sync arrive[1][DATA]!; }} }}
    location Half {{ to Done {{ sync arrive[1][DATA]!; assign since = 0; }} }}
    location Done;
}}
Application = FreeApplication(0);
ClientSocket = Socket(1);
system Application, ClientSocket, Relay;
"""


def test_time_ends_where_a_socket_overflows() -> None:
    model = tachk.loads(SOCKET.format(models=ROOT / "models"), PAUSES=True)
    overflows, goes_on = model.verify("E<> ClientSocket.overflow", "E<> ClientSocket.overflow && Relay.since >= 1")
    assert (overflows.answer.value, goes_on.answer.value) == ("holds", "fails")


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared captures are not here")
def test_a_burst_that_overflows_a_socket_is_not_forgotten() -> None:
    """The publisher of f3c ends without a DELETE; nobody tells, and it may not lose what comes then in its socket."""
    model = tachk.load(
        MODELS / "recorded.ta", HISTORY=8, INPUT_HISTORY=8, CLIENT_JITTER=5, AGENT_JITTER=5, EXACT_BITMAPS=True
    )
    assert model.loaded.recording is not None
    recording = read_capture(SHARED / "f3c_stale_acknack_three_later_msgs.pcap")
    limits = tachk.Limits(states=60_000)
    names = constants_of(model.loaded)
    found = conform(model.network, model.loaded.recording, recording, names, limits=limits, run=False, explain=False)
    assert found.accepted is False
