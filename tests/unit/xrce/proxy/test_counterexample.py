"""Runs of models as rules: the network of the rules shows both ends what they see in the run."""

from __future__ import annotations

import json
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.counterexample import rules_of
from tachk.xrce.proxy.decisions import Decisions, RelayArrival
from tachk.xrce.proxy.rules import PacketDirection
from tachk.xrce.proxy.run_of_model import Happening, ModelMessage, ModelRun, read_run
from tachk.xrce.wire import SubmessageKind
from tests.support.seeds import seeds
from tests.unit.xrce.proxy.packets import acknack, heartbeat, write_data

UP, DOWN = PacketDirection.TO_AGENT, PacketDirection.TO_CLIENT
CONSTANTS = {
    "LINKS": 4,
    "PUB": 0,
    "PUB_UP": 0,
    "PUB_DOWN": 1,
    "SUB_UP": 2,
    "SUB_DOWN": 3,
    "DATA": 0,
    "HEARTBEAT": 1,
    "ACKNACK": 2,
    "PING": 3,
}


def state(channel: str, *processes: str, **variables: int) -> dict[str, object]:
    participants = [
        {"process": process, "role": "receives" if place else "sends", "source": "a", "target": "b"}
        for place, process in enumerate(processes)
    ]
    transition = {"channel": channel, "participants": participants}
    return {"time": "0", "delay": "0", "transition": transition, "variables": variables}


def report(*steps: dict[str, object], prop: str = "p") -> dict[str, object]:
    """As tachk verify writes it."""
    first = {"time": "0", "locations": {}, "clocks": {}, "variables": {"losses": 0}}
    texts = dict.fromkeys(("title", "query", "reason", "assumption"), "")
    counts = dict.fromkeys(("states_explored", "states_stored", "transitions", "seconds", "peak_bytes"), 0)
    stats = {**counts, "interchangeable": 0, "exchanged": [], "less_known": []}
    result = {
        **texts,
        **dict.fromkeys(("expected", "met", "loop_start", "due", "fault", "observer")),
        **{key: [] for key in ("notes", "unexamined", "values")},
        "name": prop,
        "answer": "fails",
        "exact": True,
        "ending": "open",
        "stats": {**stats, "asked_of_all": False, "local_times": False},
        "trace": [first, *steps],
    }
    run = {"model": "m.ta", "constants": CONSTANTS, "time_unit": "1 ms", "templates": {}, "results": [result]}
    return {"runs": [{**run, "not_checked": [], "estimates": [], "errors": []}]}


STALE = report(
    state("send[PUB_UP][DATA]", "publisher", "Up(0)"),
    state("send[PUB_UP][DATA]", "publisher", "Up(1)"),
    state("send[PUB_UP][DATA]", "publisher", "Up(2)", losses=1),
    state("deliver[PUB_UP][DATA]", "Up(0)", "writer"),
    state("send[PUB_DOWN][ACKNACK]", "writer", "Down(0)"),
    state("deliver[PUB_UP][DATA]", "Up(1)", "writer"),
    state("dds", "writer"),
    state("send[PUB_DOWN][ACKNACK]", "writer", "Down(1)"),
    {"time": "1", "delay": "1", "transition": None},
    state("deliver[PUB_DOWN][ACKNACK]", "Down(1)", "publisher"),
    state("deliver[PUB_DOWN][ACKNACK]", "Down(0)", "publisher"),
)
"""An ACKNACK is overtaken by a later one while a message is lost."""


def words(document: object, *ports: int) -> list[str]:
    return [str(rule) for rule in rules_of(read_run(document, "t.json"), ports or (1,), "t.json")]


def test_a_stale_acknack_is_held_until_the_later_one_has_passed() -> None:
    assert words(STALE) == [
        "drop the 3rd WRITE_DATA client->agent since WRITE_DATA",
        "delay the 2nd WRITE_DATA client->agent since WRITE_DATA until the 1st ACKNACK agent->client since WRITE_DATA",
        "delay the 2nd ACKNACK agent->client since WRITE_DATA until the 3rd WRITE_DATA client->agent since WRITE_DATA",
        "delay the 1st ACKNACK agent->client since WRITE_DATA until the 2nd ACKNACK agent->client since WRITE_DATA",
    ]


def test_a_copy_of_create_client_reaches_the_clients_whose_proxy_forgets() -> None:
    document = report(
        state("send[PUB_UP][DATA]", "publisher", "InstantLink(0)"),
        state("deliver[PUB_UP][DATA]", "InstantLink(0)", "writer"),
        state("send[PUB_DOWN][ACKNACK]", "writer", "InstantLink(1)"),
        state("created_again[PUB]", "duplicate", "writer", "agent"),
    )
    assert words(document) == [
        "duplicate the 1st CREATE_CLIENT client->agent after the 1st ACKNACK agent->client since WRITE_DATA"
    ]


def test_links_may_be_hidden() -> None:
    """The composed systems tell their runs without their links."""
    steps = [json.loads(json.dumps(step)) for step in STALE["runs"][0]["results"][0]["trace"][1:]]  # type: ignore[index]
    for step in steps:
        parts = (step["transition"] or {}).get("participants", [])
        parts[:] = [part for part in parts if not part["process"].startswith(("Up", "Down"))]
    assert words(report(*steps)) == [
        "drop the 3rd WRITE_DATA client->agent since WRITE_DATA",
        "delay the 2nd WRITE_DATA client->agent since WRITE_DATA until the 1st ACKNACK agent->client since WRITE_DATA",
        "delay the 1st ACKNACK agent->client since WRITE_DATA until the 3rd WRITE_DATA client->agent since WRITE_DATA",
        "delay the 2nd ACKNACK agent->client since WRITE_DATA until the 1st ACKNACK agent->client since WRITE_DATA",
    ]


def test_what_follows_a_held_packet_is_held_as_well() -> None:
    """Sent 1, 2, 3; delivered 3, 1, 2."""
    up = [ModelMessage(0, UP, SubmessageKind.WRITE_DATA, count) for count in (1, 2, 3)]
    sent = [Happening(message, True) for message in up]
    run = ModelRun(1, (*sent, *(Happening(up[place], False) for place in (2, 0, 1))))
    assert [str(rule).split(" client->agent")[0] for rule in rules_of(run, [1], "t.json")] == [
        "delay the 1st WRITE_DATA",
        "delay the 2nd WRITE_DATA",
    ]


def test_channels_may_stand_there_by_numbers_and_copies_are_duplicates() -> None:
    document = report(
        state("send[3][0]", "reader", "Place(3)"),
        state("deliver[3][0]", "Place(3)", "subscriber", copies=1),
        state("send[2][2]", "subscriber", "Place(2)"),
        state("deliver[3][0]", "Place(3)", "subscriber", copies=1),
    )
    assert words(document, 7, 8) == [
        "duplicate the 1st DATA agent->client on 8 since DATA after the 1st ACKNACK client->agent since DATA"
    ]
    assert words(document, 8) == [
        "duplicate the 1st DATA agent->client since DATA after the 1st ACKNACK client->agent since DATA"
    ]


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ([], "not a report of tachk verify"),
        ({"runs": [{"results": 3}]}, "not a report of tachk verify"),
        ({"runs": []}, "has no run of a model"),
        (report(), "no message is sent"),
        (report(state("send[PUB_UP][GOSSIP]", "publisher", "l")), r"send\[PUB_UP\]\[GOSSIP\]: it is not known"),
        (report(state("send[SUB_DOWN][PING]", "reader", "l")), "it is not known"),
        (report(state("send[NO_LINK][DATA]", "reader", "l")), "NO_LINK is not a constant"),
        (report(state("deliver[PUB_UP][DATA]", "l", "writer")), "delivers WRITE_DATA that was not sent"),
    ],
)
def test_what_is_no_run_of_a_model_is_rejected(document: object, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        read_run(document, "t.json")


def test_one_of_several_runs_is_chosen_by_its_property() -> None:
    other = report(state("send[PUB_UP][DATA]", "publisher", "l"), prop="q")
    both = {"runs": [*STALE["runs"], *other["runs"]]}  # type: ignore[misc]
    assert len(read_run(both, "t.json", "q").happenings) == 1
    with pytest.raises(UsageError, match="several runs"):
        read_run(both, "t.json")
    with pytest.raises(UsageError, match="no run for r"):
        read_run(both, "t.json", "r")


def test_there_is_a_port_for_each_client_and_there_may_be_others() -> None:
    assert words(STALE, 1, 2, 3)[0] == "drop the 3rd WRITE_DATA client->agent on 1 since WRITE_DATA"
    run = read_run(
        report(state("send[SUB_DOWN][DATA]", "reader", "l"), state("send[0][0]", "publisher", "l")), "t.json"
    )
    with pytest.raises(UsageError, match=r"2 clients, and the relay listens for 1"):
        rules_of(run, [1], "t.json")


def test_messages_of_a_client_that_gets_samples_are_requests() -> None:
    document = report(
        state("send[SUB_DOWN][DATA]", "reader", "l"),
        state("send[SUB_UP][DATA]", "subscriber", "m", losses=1),
    )
    assert words(document, 9)[0] == "drop the 1st READ_DATA client->agent since DATA"


# ---- the network of the rules against the run -----------------------------------------------------------------------


def random_run(random: Random) -> ModelRun:
    """Any messages in any order, lost, overtaken, or under way at the end."""
    counts: dict[tuple[PacketDirection, SubmessageKind], int] = {}
    under_way: list[ModelMessage] = []
    happenings: list[Happening] = []
    for _ in range(random.randint(1, 14)):
        if under_way and random.random() < 0.5:
            message = under_way.pop(random.randrange(len(under_way)))
            happenings.append(Happening(message, False))
            if random.random() < 0.3:
                continue
        way = random.choice((UP, DOWN))
        kind = (
            random.choice((SubmessageKind.WRITE_DATA, SubmessageKind.HEARTBEAT))
            if way is UP
            else SubmessageKind.ACKNACK
        )
        if not happenings:
            way, kind = UP, SubmessageKind.WRITE_DATA  # the first sample begins the run
        counts[(way, kind)] = counts.get((way, kind), 0) + 1
        message = ModelMessage(0, way, kind, counts[(way, kind)])
        lost = random.random() < 0.2
        happenings.append(Happening(message, True, lost))
        if not lost:
            under_way.append(message)
    return ModelRun(1, tuple(happenings))


def octets_of(message: ModelMessage) -> bytes:
    match message.kind:
        case SubmessageKind.WRITE_DATA:
            return write_data(message.count)
        case SubmessageKind.HEARTBEAT:
            return heartbeat(message.count, message.count)
        case _:
            return acknack(message.count)


class End:
    """Client or Agent: does and expects what it does and gets in the run, in this order."""

    def __init__(self, run: ModelRun, sends: PacketDirection) -> None:
        self.sends = sends
        self.left = [one for one in run.happenings if (one.message.way is sends) == one.sent]

    @property
    def next_to_send(self) -> Happening | None:
        return self.left[0] if self.left and self.left[0].sent else None


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_the_network_of_the_rules_shows_what_the_run_shows(seed: int) -> None:
    random = Random(seed)
    run = random_run(random)
    decisions = Decisions(rules_of(run, [1], "t.json"))
    ends = {way: End(run, way) for way in PacketDirection}
    sent: list[ModelMessage] = []
    for time in range(1000):
        ready = [end for end in ends.values() if end.next_to_send is not None]
        if not ready:
            break
        end = random.choice(ready) if time else ends[UP]  # the first sample, from which packets are counted
        happening = end.left.pop(0)
        sent.append(happening.message)
        arrival = RelayArrival(1, Endpoint("127.0.0.1", 5), end.sends, octets_of(happening.message), time)
        for departure in decisions.arrived(arrival).departures:
            receiver = ends[UP if departure.way is DOWN else DOWN]
            if receiver.left:
                assert receiver.left.pop(0) == Happening(sent[departure.arrival], False)
    assert all(not end.left for end in ends.values())


@pytest.mark.parametrize(
    ("settings", "prop", "first"),
    [
        (
            "REORDER=true GUARDED=false PACE=1 SPIN=1 DELAY=2",
            "NOHOLE",
            "drop the 3rd WRITE_DATA client->agent since WRITE_DATA",
        ),
        (
            "DUPLICATES=1 RESETS=true GUARDED=false LOSSES=0 MESSAGES=2 DELIVERY_BOUND=12",
            "ECFS",
            "duplicate the 1st CREATE_CLIENT client->agent after the 1st ACKNACK agent->client since WRITE_DATA",
        ),
    ],
)
def test_the_report_of_verify_is_read(capsys: pytest.CaptureFixture[str], settings: str, prop: str, first: str) -> None:
    defined = [word for setting in settings.split() for word in ("-D", setting)]
    command = ["verify", "models/micro_xrce_dds/publication.ta", *defined, "--property", prop, "--format", "json"]
    with pytest.raises(SystemExit):
        app(command, prog_name="tachk")
    assert words(json.loads(capsys.readouterr().out))[0] == first
