"""Parts that share nothing are searched one by one, with the verdicts of the search of the whole."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.components import are_independent, components_of, separated
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.event_streams import make_streams
from tachk.recordings.conformance.event_tables import read_events
from tachk.recordings.conformance.events import EventLog
from tachk.xrce.conformance.packet_events import read_capture
from tests.support.seeds import seeds

ROOT = Path(__file__).parents[4]
RECORDED = ROOT / "models/micro_xrce_dds/recorded.ta"

BALL = """
broadcast chan serve, take, back, home;
int thrown[2];
int[0, 1] which = 1;
process Server {{
    clock x;
    init location Ready {{
        invariant x <= {ready};
        to Waiting {{ guard x >= {early}; sync serve!; assign x = 0, thrown[0] = 1; }}
    }}
    location Waiting {{ invariant x <= {wait}; to Ready {{ sync home?; assign x = 0; }} }}
}}
process Player {{
    clock y;
    init location Free {{ to Holding {{ sync take?; assign y = 0; }} }}
    {committed} location Holding {{
        {invariant}
        to Free {{ guard y >= {hold}; sync back!; assign thrown[{shared}] = 0; }}
        {again}
    }}
}}
system Server, Player;
recording {{
    visible serve as serve(); visible take as take(); visible back as back(); visible home as home();
}}
"""


def _whole_and_parts(model: tachk.Model, recording: EventLog, tolerance: int, *late: int) -> list[Conformance]:
    mapping = model.loaded.recording
    assert mapping is not None
    names = constants_of(model.loaded)
    exact = TimestampUncertainty(Fraction(tolerance), Fraction(late[0]), Fraction(late[-1]))
    return [
        conform(model.network, mapping, recording, names, exact, run=divide, divide=divide) for divide in (False, True)
    ]


def _ball(random: Random, shared: int | str = 1) -> tachk.Model:
    quick = random.random() < 0.3
    held = 0 if quick else random.randint(0, 2)
    return tachk.loads(
        BALL.format(
            ready=random.randint(3, 5),
            early=random.randint(0, 3),
            wait=random.randint(3, 6),
            hold=held,
            committed="committed" if quick else "",
            invariant="" if quick else f"invariant y <= {held + random.randint(0, 1)};",
            again="to Holding { sync take?; }" if random.random() < 0.3 else "",
            shared=shared,
        )
    )


def _rally(random: Random) -> str:
    time, lines = random.randint(0, 4), ["time,event,id,after"]
    rows = []
    for number in range(random.randint(1, 4)):
        for event, needed in (("serve", ""), ("take", f"s{number}"), ("back", ""), ("home", f"b{number}")):
            name = {"serve": f"s{number}", "back": f"b{number}"}.get(event, "")
            rows.append((time, event, name, needed))
            time += random.choice((0, 0, 1, 1, 2))
        time += random.randint(0, 4)
    lines += [",".join(map(str, row)) for row in rows]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("seed", seeds(range(3)))
def test_verdicts_are_those_of_the_whole(seed: int, tmp_path: Path) -> None:
    random, file = Random(seed), tmp_path / "rally.csv"
    answers = []
    for _ in range(12):
        model = _ball(random)
        file.write_text(_rally(random), encoding="utf-8")
        exact = [random.randrange(3) for _ in range(3)]
        whole, components = _whole_and_parts(model, read_events(file, None), *exact)
        assert whole.accepted is components.accepted, file.read_text(encoding="utf-8")
        answers.append(whole.accepted)
    assert set(answers) == {True, False}


def test_what_is_shared_joins_parts(tmp_path: Path) -> None:
    file = tmp_path / "rally.csv"
    file.write_text(_rally(Random(1)), encoding="utf-8")

    def components(model: tachk.Model) -> int:
        mapping, recording = model.loaded.recording, read_events(file, None)
        assert mapping is not None
        names = constants_of(model.loaded)
        streams = make_streams(
            model.network, mapping, recording, names, TimestampUncertainty.of(Fraction(1), Fraction(1))
        )
        return len(components_of(model.network, mapping, streams))

    assert components(_ball(Random(1), shared=1)) == 2
    assert components(_ball(Random(1), shared=0)) == 1
    assert components(_ball(Random(1), shared="which")) == 1


def test_clients_and_agent_are_apart() -> None:
    model = tachk.load(RECORDED, CLIENT_JITTER=5, AGENT_JITTER=5, EXACT_BITMAPS=True, MISSED_ROUNDS=1)
    capture = sorted((ROOT / "tests/data/captures").glob("*.pcap"))[0]
    mapping, recording = model.loaded.recording, read_capture(capture)
    assert mapping is not None
    streams = make_streams(
        model.network,
        mapping,
        recording,
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(20)),
    )
    components = components_of(model.network, mapping, streams)
    assert sorted(len(component.processes) for component in components) == [5, 5, 16]
    cut = separated(streams, components)
    assert cut is not None
    part_of = {number: component for component in components for number in component.streams}
    across = [
        (cut.streams[other].latest[count - 1], stream.earliest[place])
        for number, stream in enumerate(cut.streams)
        for place, needs in enumerate(stream.needed)
        for other, count in needs
        if part_of[other] is not part_of[number]
    ]
    assert across and all(sent <= arrived for sent, arrived in across)
    assert are_independent(model.network, range(len(model.network.processes)), streams)


def test_parts_that_have_runs_only_apart_are_no_run_of_the_whole(tmp_path: Path) -> None:
    """The server serves from 3 on, and the player has to take that until 2."""
    file = tmp_path / "rally.csv"
    file.write_text("time,event\n0,take\n2,back\n3,serve\n6,home\n", encoding="utf-8")
    given = {"ready": 5, "early": 3, "wait": 6, "hold": 0, "committed": "", "again": "", "shared": 1}
    model = tachk.loads(BALL.format(invariant="invariant y <= 2;", **given))
    free = read_events(file, None)
    assert [each.accepted for each in _whole_and_parts(model, free, 2, 2)] == [True, True]
    bound = replace(free, events=(replace(free.events[0], after=2), *free.events[1:]))
    assert [each.accepted for each in _whole_and_parts(model, bound, 2, 2)] == [False, False]
