"""What recordings of the real client and Agent showed to be missing from the models of Micro XRCE-DDS."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn

MODELS = data_root() / "models" / "micro_xrce_dds"
LOOP = {"HEARTBEAT_LAW": 1, "CLIENT_HEARTBEAT": 2, "MESSAGES": 1, "PLACES": 3}
DRIVER = """
const int CLIENTS = 1;
const int MESSAGES = {samples};
const int AGENT_WINDOW = {window};
const int SUBSCRIPTION = {subscription};
const int QUOTA = {samples};
const int KEEP = {keep};
const int PLACES = 1;
const int LOSSES = 0;
import "{models}/protocol.ta";
import "{models}/../lib/messages.ta";
import "{models}/proxy_subscriber.ta";

int brought = 0;
int sent_numbers[40];
int sent_samples[40];
int sends = 0;

process Driver() {{
    clock gap;
    init location Start {{
        to Start {{
            guard brought < MESSAGES && gap >= 1;
            sync dds!;
            assign sample = brought, brought = brought + 1, gap = 0;
        }}
        to Answered {{ guard brought == MESSAGES && gap >= 1; {answer} }}
    }}
    location Answered;
}}

process Recorder() {{
    init location Listening {{
        to Listening {{
            sync send[SUB_DOWN][DATA]?;
            assign sent_numbers[sends] = number, sent_samples[sends] = detail, sends = sends + 1;
        }}
    }}
}}

reader = ProxySubscriber(SUB, deliver[SUB_UP], send[SUB_DOWN], FIRST_REQUEST, 0);
driver = Driver();
recorder = Recorder();
system driver, reader, recorder;
property over : E<> {goal};
"""


def answer(system: str, name: str, **constants: int | bool) -> str:
    model = tachk.load(MODELS / f"{system}.ta", **constants)
    return model.verify(property=name, trace=False, limits=tachk.Limits(states=300_000))[name].answer.value


@pytest.mark.parametrize(("slice_", "pause", "detected"), [(1, 3, 5), (2, 1, 4), (1, 0, None)])
def test_a_pause_between_run_calls_lets_the_heartbeat_out(slice_: int, pause: int, detected: int | None) -> None:
    """A heartbeat due outside the run function is sent by the next call; calls that begin too closely starve it."""
    settings = {**LOOP, "SPIN": slice_, "PAUSE": pause}
    if detected is None:
        assert answer("publication", "TMRK", REPAIR_BOUND=50, **settings) == "fails"
    else:
        assert answer("publication", "TMRK", REPAIR_BOUND=detected, **settings) == "holds"
        assert answer("publication", "TMRK", REPAIR_BOUND=detected - 1, **settings) == "fails"


def test_the_bitmap_of_an_acknack_has_sixteen_bits() -> None:
    """With 16 messages outstanding the sum of 15 powers of two was out of range."""
    constants = {"MESSAGES": 18, "KEEP": 18, "AGENT_WINDOW": 16, "PLACES": 20, "SLEEP": 165, "SUBSCRIPTION": 0}
    assert answer("read_again", "RMIO2", **constants) == "holds"


def test_a_heartbeat_may_be_late_by_the_jitter() -> None:
    """HBC + D = 3 without jitter, see test_publication.py."""
    settings = {"MESSAGES": 1, "PLACES": 3, "CLIENT_JITTER": 1}
    assert answer("publication", "TMRK", REPAIR_BOUND=4, **settings) == "holds"
    assert answer("publication", "TMRK", REPAIR_BOUND=3, **settings) == "fails"


def test_rounds_of_the_agent_may_be_late_by_the_jitter() -> None:
    """LINGER + SLEEP + HBA = 7 < DEAD = 8 without jitter, see test_subscription.py."""
    assert answer("subscription", "ECRA", AGENT_JITTER=1) == "fails"


@pytest.mark.parametrize(("missed", "latest"), [(0, 1), (1, 2)])
def test_a_round_may_leave_out_a_client_that_has_just_been_created(missed: int, latest: int) -> None:
    """Recordings have a first HEARTBEAT after one and a half periods."""
    model = tachk.load(MODELS / "subscription.ta", MISSED_ROUNDS=missed)
    query = "E<> agent.FirstRound && agent.round {} {} * AGENT_HEARTBEAT"
    found = model.verify(query.format(">=", latest), query.format(">", latest), trace=False)
    assert [verdict.answer.value for verdict in found] == ["holds", "fails"]


def test_a_client_that_sleeps_at_will_has_been_silent_for_longer() -> None:
    """q + SLEEP + HBA < DEAD with q = LINGER = 2; at will, q grows up to the time between two samples."""
    settings = {"PACE": 4, "MESSAGES": 2, "KEEP": 2, "PLACES": 4}
    assert answer("subscription", "ECRA", **settings) == "holds"
    assert answer("subscription", "ECRA", SLEEP_AT_WILL=True, **settings) == "fails"


def test_what_waits_in_the_socket_is_not_lost() -> None:
    """The Agent takes the client for dead in both cases; what waits in the socket makes the client speak."""
    settings = {"SLEEP": 4, "PACE": 4, "MESSAGES": 2, "KEEP": 2, "PLACES": 4}
    assert answer("subscription", "ECRA", **settings) == "fails"
    assert answer("subscription", "ECRA", RADIO_ON=True, **settings) == "holds"
    assert answer("subscription", "NIWS", RADIO_ON=True, **settings) == "holds"


def reachable(directory: Path, goal: str, answer: str, **sizes: int) -> bool:
    path = directory / "driver.ta"
    settings = {"samples": 12, "window": 16, "keep": 12, "subscription": 0} | sizes
    path.write_text(DRIVER.format(models=MODELS.as_posix(), goal=goal, answer=answer, **settings), encoding="utf-8")
    return tachk.load(path).verify(trace=False)["over"].answer.value == "holds"


NACK = "sync deliver[SUB_UP][ACKNACK]!; assign number = {first}, detail = {bitmap};"


def test_the_agent_repeats_in_the_order_of_its_two_bytes(tmp_path: Path) -> None:
    """Bits 0, 8, 1, 9, 2, 10, ...: as the captures h4 and h8 show it."""
    goal = "driver.Answered && reader.Idle && sends == 18"
    order = [1, 9, 2, 10, 3, 11]
    exactly = " && ".join(f"sent_numbers[{12 + i}] == {number}" for i, number in enumerate(order))
    nack = NACK.format(first=1, bitmap=0b111_0000_0111)
    assert reachable(tmp_path, f"{goal} && {exactly}", nack)
    assert not reachable(tmp_path, f"{goal} && !({exactly})", nack)


def test_the_reading_thread_holds_one_sample_more_than_window_and_history(tmp_path: Path) -> None:
    """Window 2, one held, one kept by the DataReader: of 6 samples 0, 1, 2 and the last survive."""
    confirm = NACK.format(first=2, bitmap=0)
    samples = "sent_samples[2] == 2 && sent_samples[3] == 5"
    sizes = {"samples": 6, "window": 2, "keep": 1}
    assert reachable(tmp_path, f"driver.Answered && sends == 4 && {samples}", confirm, **sizes)
    assert not reachable(tmp_path, f"driver.Answered && sends == 4 && !({samples})", confirm, **sizes)


STOPPING = """
const int CLIENTS = 2;
const int MESSAGES = 2;
const int AGENT_WINDOW = 4;
const int PLACES = 1;
const int LOSSES = 0;
const int QUEUE = 4;
const bool OVERTAKES = true;
const int READER_STOP = 7;
const bool GO_BACK = false;
const bool ANSWER_DATA = true;
import "{models}/protocol.ta";
import "{models}/../lib/messages.ta";
import "{models}/agent_queue.ta";
import "{models}/proxy_publisher.ta";
process Driver() {{
    clock since;
    init location Start {{
        invariant since <= 0;
        to Asked {{ sync deliver[SUB_UP][DATA]!; assign number = 0, detail = READ; }}
    }}
    location Asked {{
        invariant since <= 1;
        to Waiting {{ guard since == 1; sync deliver[PUB_UP][DATA]!; assign number = 0, detail = 1; }}
    }}
    location Waiting {{ to Answered {{ sync send[PUB_DOWN][ACKNACK]?; }} }}
    location Answered;
}}
writer = ProxyPublisher(PUB, taken[PUB], send[PUB_DOWN]);
asked = ProxyPublisher(SUB, taken[SUB], send[SUB_DOWN]);
driver = Driver();
queue = AgentQueue();
system driver, queue, writer, asked;
property latest : E<> driver.Waiting && driver.since == 7;
property later : E<> driver.Waiting && driver.since > 7;
property answered : A<> driver.Answered;
"""


def test_a_reading_thread_that_stops_keeps_the_packets_of_all_clients_waiting(tmp_path: Path) -> None:
    path = tmp_path / "stopping.ta"
    path.write_text(STOPPING.format(models=MODELS.as_posix()), encoding="utf-8")
    report = tachk.load(path).verify(trace=False)
    found = {verdict.query.name: verdict.answer.value for verdict in report}
    assert found == {"latest": "holds", "later": "fails", "answered": "holds"}


FREE = """
const int CLIENTS = 1;
const int MESSAGES = 2;
const int AGENT_WINDOW = 4;
const int HISTORY = 2;
const int HEARTBEAT_LAW = 1;
const int CLIENT_HEARTBEAT = 2;
const bool GO_BACK = true;
const bool GUARDED = true;
const int PLACES = 1;
const int LOSSES = 0;
const int WAITING = 2;
import "{models}/protocol.ta";
import "{models}/../lib/messages.ta";
import "{models}/../lib/free_application.ta";
import "{models}/client_publisher.ta";
process Driver() {{
    clock age;
    init location Start {{ to Written {{ sync write[PUB]!; assign offered = 1; }} }}
    location Written {{ to Answered {{ sync arrive[PUB_DOWN][ACKNACK]!; assign number = 1, detail = 0, age = 0; }} }}
    location Answered;
}}
process Watcher() {{
    init location Watching {{ to Seen {{ guard outside[PUB]; sync send[PUB_UP][HEARTBEAT]?; }} }}
    location Seen;
}}
publisher = ClientPublisher(PUB, send[PUB_UP], deliver[PUB_DOWN]);
application = FreeApplication(PUB);
driver = Driver();
watcher = Watcher();
system driver, application, Socket, publisher, watcher;
property late : E<> publisher.Overdue && publisher.timer > 5;
property overdue : E<> publisher.Unconfirmed && application.Inside && publisher.timer > 2;
property waits : E<> driver.Answered && driver.age > 3 && acked[PUB] == 0;
property arrives : E<> driver.Answered && acked[PUB] == 1 && driver.age > 3;
property beats_outside : E<> watcher.Seen;
property sixteen_bits : A[] bit(15) == 32768 && bit(16) == 0;
"""


def test_what_reaches_a_client_outside_its_run_function_waits_in_its_socket(tmp_path: Path) -> None:
    path = tmp_path / "free.ta"
    path.write_text(FREE.format(models=MODELS.as_posix()), encoding="utf-8")
    report = tachk.load(path, PAUSES=True).verify(trace=False)
    found = {verdict.query.name: verdict.answer.value for verdict in report}
    fine = dict.fromkeys(("late", "waits", "arrives", "sixteen_bits"), "holds")
    assert found == fine | {"overdue": "fails", "beats_outside": "fails"}


ANNOUNCED = """
int sends = 0;           // messages sent, in their order
int early = 0;           // the last HEARTBEAT announced so many that had not been sent
bool in_order = true;

process Heartbeats() {{ init location Asking {{ to Asking {{ sync early_round[SUB]?; }} }} }}

process Recorder() {{
    init location Listening {{
        to Listening {{
            sync send[SUB_DOWN][DATA]?;
            assign in_order = in_order && number == sends, sends = sends + 1, early = early > 0 ? early - 1 : 0;
        }}
        to Listening {{ sync send[SUB_DOWN][HEARTBEAT]?; assign early = detail - sends; }}
    }}
}}
"""

EARLY = (
    """
const int CLIENTS = 1;
const int MESSAGES = 2;
const int AGENT_WINDOW = 4;
const int SUBSCRIPTION = 0;
const int QUOTA = 2;
const int KEEP = 2;
const int PLACES = 1;
const int LOSSES = 0;
import "{models}/protocol.ta";
import "{models}/../lib/messages.ta";
import "{models}/proxy_subscriber.ta";

int brought = 0;

process Topic() {{
    clock gap;
    init location Bringing {{
        to Bringing {{
            guard brought < MESSAGES && gap >= 1;
            sync dds!;
            assign sample = brought, brought = brought + 1, gap = 0;
        }}
    }}
}}

"""
    + ANNOUNCED
    + """
reader = ProxySubscriber(SUB, deliver[SUB_UP], send[SUB_DOWN], FIRST_REQUEST, 0);
topic = Topic();
heartbeats = Heartbeats();
recorder = Recorder();
system topic, heartbeats, reader, recorder;
property all_pieces : E<> early == PIECES + 1;
property middle : E<> sends == 1 && early == PIECES;
property more : E<> early > PIECES + 1;
property ordered : A[] in_order && early >= 0;
property sent_before_rest : A[] reader.Idle imply early == 0;
"""
)


def test_a_heartbeat_may_announce_all_pieces_of_a_sample_before_they_are_sent() -> None:
    """ReliableOutputStream::push_submessage stores them all before get_next_message takes the first."""
    text = EARLY.format(models=MODELS.as_posix())
    model = tachk.loads(text, PIECES=2, EARLY_ANNOUNCEMENT=True)
    found = {verdict.query.name: verdict.answer.value for verdict in model.verify(trace=False)}
    assert found.pop("more") == "fails"
    assert set(found.values()) == {"holds"}, found
    without = tachk.loads(text, PIECES=2).verify(property="all_pieces", trace=False)
    assert without["all_pieces"].answer.value == "fails"


EARLY_STATUS = (
    """
const int CLIENTS = 1;
const int MESSAGES = 2;
const int AGENT_WINDOW = 4;
const bool ANSWER_DATA = true;
const bool GO_BACK = true;
const int SUBSCRIPTION = 0;
const int PLACES = 1;
const int LOSSES = 0;
import "{models}/protocol.ta";
import "{models}/../lib/messages.ta";
import "{models}/proxy_publisher.ta";

process Client() {{
    init location Creating {{
        to Done {{ sync deliver[SUB_UP][DATA]!; assign put(0, CREATE - 2); }}
    }}
    location Done {{ }}
}}
"""
    + ANNOUNCED
    + """
writer = ProxyPublisher(SUB, deliver[SUB_UP], send[SUB_DOWN]);
client = Client();
heartbeats = Heartbeats();
recorder = Recorder();
system client, heartbeats, writer, recorder;
property announced : E<> early == 1;
property both : E<> sends == 2;
property second : E<> sends == 1 && early == 1;
property more : E<> early > 1;
property ordered : A[] in_order && early >= 0;
property sent_before_rest : A[] writer.Waiting imply early == 0;
"""
)


def test_a_heartbeat_may_announce_a_status_before_it_is_sent() -> None:
    """Processor::process_create_submessage puts each STATUS into the history and hands it over before the next one."""
    text = EARLY_STATUS.format(models=MODELS.as_posix())
    found = {v.query.name: v.answer.value for v in tachk.loads(text, EARLY_ANNOUNCEMENT=True).verify(trace=False)}
    assert found.pop("more") == "fails"
    assert set(found.values()) == {"holds"}, found
    without = tachk.loads(text).verify(property="announced", trace=False)
    assert without["announced"].answer.value == "fails"
