"""Sequence charts of runs of models: `tachk verify --chart`, and `tachk chart` of a report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.commands.chart import write_chart
from tachk.cli.main import app
from tachk.report.drawing.sequence.chart import Chart, EnteredLocation, Note
from tachk.report.drawing.sequence.layout import TimeAxis
from tachk.report.json_report import runs_to_json
from tachk.report.sequence.named_processes import named_members
from tachk.report.sequence.of_run import chart_of_run
from tachk.report.sequence.run_steps import steps_of_report

MODELS = Path(__file__).resolve().parents[3] / "models"

SLEEPER = """
time_unit = 10 ms;
const int LINKS = 1; const int KINDS = 2; const int PLACES = 2; const int LOSSES = 1;
const int DATA = 0; const int ACKNACK = 1;
import "lib/instant_link.ta";
chan wake;
process Sender() {
    clock x; int[0, 2] n = 0;
    init location Idle {
        invariant x <= 5;
        to Idle { guard x == 5 && n < 2; sync send[0][DATA]!; assign put(n, 0), n = n + 1, x = 0; }
        to Idle { guard x == 5 && n == 2; sync wake!; assign x = 0; }
    }
}
process Receiver() {
    int[0, 2] got = 0;
    init location Asleep { to Awake { sync wake?; } to Asleep { sync deliver[0][DATA]?; assign got = got + 1; } }
    /// wakes up
    location Awake { to Awake { sync wake?; } }
}
sender = Sender(); receiver = Receiver();
system sender, receiver, InstantLink;
"""


@pytest.fixture(scope="module")
def sleeper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sleeper")
    (folder / "lib").symlink_to(MODELS / "lib")
    path = folder / "sleeper.ta"
    path.write_text(SLEEPER, encoding="utf-8")
    return path


def chart_of(path: Path, query: str) -> Chart:
    """The chart of the run behind the answer."""
    report = tachk.load(str(path)).verify(query)
    document = json.loads(json.dumps(runs_to_json([report.record], False)))
    return chart_of_run(steps_of_report(document, "run.json", None))


def test_messages_through_links_sleep_and_repetitions(sleeper: Path):
    chart = chart_of(sleeper, "E<> receiver.got == 1 && losses == 1 && receiver.Awake && sender.x == 3")
    assert (chart.lifelines, chart.unit) == (("sender", "receiver"), "ms")
    sent = [(m.label, float(m.sent.time), m.is_lost, len(m.arrivals)) for m in chart.messages]
    assert sorted(sent[:2]) in (
        [("DATA 0", 50.0, True, 0), ("DATA 1", 100.0, False, 1)],
        [("DATA 0", 50.0, False, 1), ("DATA 1", 100.0, True, 0)],
    )
    assert sent[2][:2] == ("wake", 150.0)
    assert [(p.lifeline, float(p.begin.time), float(p.end.time)) for p in chart.phases] == [(1, 0.0, 150.0)]


def test_steps_that_repeat_are_drawn_once(tmp_path: Path):
    path = tmp_path / "ticks.ta"
    path.write_text(
        "chan tick; int n = 0; clock x;"
        "process P() { init location A { invariant x <= 10;"
        " to A { guard x == 10; sync tick!; assign x = 0, n = n + 1; } } }"
        "process Q() { init location B { to B { sync tick?; } } } system P, Q;",
        encoding="utf-8",
    )
    chart = chart_of(path, "E<> n == 50")
    assert [m.label for m in chart.messages] == ["tick"]
    assert "↻ 50 times, every 10, until 500" in [event.text for event in chart.events if isinstance(event, Note)]


def test_steps_without_anything_to_see_repeat_unsaid(tmp_path: Path):
    path = tmp_path / "ticks.ta"
    path.write_text(
        "broadcast chan tick; chan end; int n = 0; clock x;"
        "process P() { init location A { invariant x <= 10;"
        " to A { guard x == 10 && n < 9; sync tick!; assign x = 0, n = n + 1; }"
        " to A { guard x == 10 && n == 9; sync end!; assign x = 0, n = 10; } } }"
        "process Q() { init location B { to B { sync end?; } } } system P, Q;",
        encoding="utf-8",
    )
    chart = chart_of(path, "E<> n == 10")
    assert [m.label for m in chart.messages] == ["end"]
    assert [event.text for event in chart.events if isinstance(event, Note) and "times" in event.text] == []


def test_a_starved_publisher(tmp_path: Path):
    path, picture = MODELS / "micro_xrce_dds/publication.ta", tmp_path / "run.svg"
    options = ["-D", "HEARTBEAT_LAW=1", "-D", "SPIN=1", "--property", "ECFS", "--quiet", "--trace", "some"]
    result = CliRunner().invoke(app, ["verify", str(path), *options, "--chart", str(picture)])
    assert (result.exit_code, result.output) == (0, f"written: {picture}\n")
    text = picture.read_text(encoding="utf-8")
    assert "DATA 2 lost" in text and "ECFS fails" in text


def test_reports_without_a_run(tmp_path: Path, sleeper: Path):
    record = tachk.load(str(sleeper)).verify("A[] receiver.got <= 2").record
    for document, words in (
        ({}, "neither a capture nor a report"),
        ({"runs": [{}]}, "not a report of tachk verify"),
        (runs_to_json([record], False), "has no run of a model"),
    ):
        with pytest.raises(UsageError, match=words):
            steps_of_report(document, "x.json", None)
    path = tmp_path / "x.json"
    path.write_text("{", encoding="utf-8")
    assert CliRunner().invoke(app, ["chart", str(path), "-o", str(tmp_path / "x.svg")]).exit_code == 2
    result = CliRunner().invoke(app, ["verify", str(sleeper), "A[] true", "--chart", str(tmp_path / "x.svg")])
    assert (result.exit_code, "no answer has a run" in result.stderr) == (0, True)
    assert not (tmp_path / "x.svg").exists()


def locations(chart: Chart) -> list[tuple[str, str]]:
    """The locations in a chart, each with the process that enters it."""
    return [(chart.lifelines[one.lifeline], one.text) for one in chart.events if isinstance(one, EnteredLocation)]


@pytest.mark.parametrize(
    ("query", "places"),
    [
        ("A[] not Q.C", [("P", "A"), ("Q", "A"), ("P", "B"), ("Q", "B"), ("Q", "C")]),
        ("E<> P.A", [("P", "A")]),
        ("E<> P.B", [("P", "A"), ("P", "B")]),
    ],
)
def test_a_run_without_messages_shows_the_locations_that_processes_enter(
    query: str, places: list[tuple[str, str]], tmp_path: Path
) -> None:
    path = tmp_path / "quiet.ta"
    path.write_text(
        """int[0,1] n;
        process P() { init location A { to B { assign n = 1; } } location B; }
        process Q() { init location A { to B { guard n == 1; } } location B { to C; } location C; }
        system P, Q;""",
        encoding="utf-8",
    )
    chart = chart_of(path, query)
    assert locations(chart)[: len(places)] == places
    assert set(locations(chart)[len(places) :]) <= {("P", "B")}, "the last one, where another process goes on"
    for picture in ("quiet.svg", "quiet.png"):
        write_chart(chart.used(), tmp_path / picture, TimeAxis.COMPRESSED)


CONTROLLER = """
chan request, answer;
process Client() {
    init location Idle { to Waiting { sync request!; } }
    location Waiting { to Idle { sync answer?; } }
}
process Controller() {
    clock y;
    init location Ready { to Busy { sync request?; assign y = 0; } }
    location Busy { invariant y <= 8; to Ready { guard y >= 2; sync answer!; } to Failed { guard y >= 7; } }
    location Failed { }
}
system Client, Controller;
"""


@pytest.mark.parametrize(
    ("query", "places"),
    [
        ("A[] !Controller.Failed", [("Controller", "Ready"), ("Controller", "Failed"), ("Client", "Waiting")]),
        (
            "A[] !Controller.Busy",
            [("Controller", "Ready"), ("Controller", "Busy"), ("Client", "Waiting")],
        ),
        ("A[] !deadlock", [("Client", "Waiting"), ("Controller", "Failed")]),
    ],
)
def test_among_messages_locations_of_named_processes_and_the_last_ones_are_shown(
    query: str, places: list[tuple[str, str]], tmp_path: Path
) -> None:
    path = tmp_path / "controller.ta"
    path.write_text(CONTROLLER, encoding="utf-8")
    assert locations(chart_of(path, query)) == places


@pytest.mark.parametrize(
    ("query", "named"),
    [
        ("A[] !Gate.Open", {"Gate": {"Open"}}),
        ("E<> Train(1).Cross && Train( 1 ).x > 3", {"Train(1)": {"Cross", "x"}}),
        ("A[] forall (i : id_t) !Train(i).Cross", {"Train(1)": {"Cross"}, "Train(2)": {"Cross"}}),
        ("Whenever Gate.Open, within 20, Train(2).Stop must be true.", {"Gate": {"Open"}, "Train(2)": {"Stop"}}),
        ("A[] !deadlock", {}),
    ],
)
def test_processes_that_a_property_names(query: str, named: dict[str, set[str]]) -> None:
    assert named_members(query, ("Train(1)", "Train(2)", "Gate")) == named


def test_repeated_moves_are_drawn_once(tmp_path: Path) -> None:
    path = tmp_path / "round.ta"
    path.write_text(
        """clock x; int[0,40] n;
        process P() {
            init location A { invariant x <= 5; to B { guard x == 5; } }
            location B { to A { assign x = 0, n = n < 40 ? n + 1 : n; } }
        }
        system P;""",
        encoding="utf-8",
    )
    chart = chart_of(path, "E<> n == 40")
    assert locations(chart) == [("P", "A"), ("P", "B"), ("P", "A")]
    assert next(note.text for note in chart.events if isinstance(note, Note)).startswith("↻ 40 times")
