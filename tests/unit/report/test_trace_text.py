"""How runs are told: hidden processes, news, rounds, long runs."""

from __future__ import annotations

from io import StringIO

from rich.console import Console

from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.meaning.run_view import TraceView, view_trace
from tachk.report.json_report import trace_to_json
from tachk.report.run.display import RunDisplay
from tachk.report.run.trace_text import print_trace
from tachk.report.text_report import news_line, print_fault
from tachk.verify.verify import verify

LINK = """
const int DATA = 0;
const int BEAT = 1;
time_unit = 1 ms;
broadcast chan send[2], deliver[2];
int[0, 30] n = 0;
process Sender() {
    clock x;
    init location Busy {
        invariant x <= 10;
        /// beats
        to Busy { guard x == 10 && n < 20; sync send[BEAT]!; assign x = 0, n = n + 1; }
        to Done { guard n == 20 && x >= 5; sync send[DATA]!; }
    }
    location Done;
}
process Link() {
    int length = 0;
    init location Empty {
        to Full { select k : int[0, 1]; sync send[k]?; assign length = 1; }
        /// ! is lost
        to Empty { select k : int[0, 1]; guard k == DATA; sync send[k]?; }
    }
    urgent location Full { to Empty { select k : int[0, 1]; guard k == BEAT; sync deliver[k]!; assign length = 0; } }
}
process Receiver() {
    init location Idle {
        /// hears
        to Idle { sync deliver[BEAT]?; }
    }
}
hide Link;
system Sender, Link, Receiver;
property lost : E<> Sender.Done && Link.Empty;
"""

COUNTING = """
int[0, 1000] n = 0;
process P() {
    init location A { to A { select k : int[0, 1000]; guard k == n && n < 1000; assign n = n + 1; } }
}
system P;
property p : E<> n == 1000;
"""

WHOLE = RunDisplay(every_step=True)


def run_of(text: str) -> TraceView:
    model = load_model(Source("model.ta", text))
    (verdict,) = verify(model.network, model.queries)
    assert verdict.trace is not None
    return view_trace(model.network, verdict.trace)


def told(view: TraceView, display: RunDisplay = RunDisplay()) -> str:
    out = StringIO()
    print_trace(view, Console(file=out, width=120), "1 ms", display)
    return out.getvalue()


def test_indices_of_channels_are_reported_by_the_names_that_edges_write() -> None:
    text = told(run_of(LINK), WHOLE)
    assert "deliver[BEAT]!  Link: Full → Empty" in text
    assert "deliver[BEAT]?  Receiver: Idle → Idle · hears" in text
    assert "[k = 1]" not in text


def test_a_hidden_process_is_reported_where_it_brings_news_or_acts_alone() -> None:
    text = told(run_of(LINK))
    assert "Link: Full → Empty" not in text
    assert "Link: Empty → Full" not in text
    assert "Link.length" not in text
    assert "Link: Empty → Empty · is lost" in text
    assert "Link.Empty" not in text.splitlines()[0]
    assert "Link.length: 0 → 1" in told(run_of(LINK), WHOLE)


def test_repeated_rounds_are_reported_once() -> None:
    text = told(run_of(LINK))
    assert "↻ steps 1 to 2 happen 20 times in a row, every 10 ms, to step 40 at 200 ms" in text
    assert "n: 1 → 20" in text
    assert len(text.splitlines()) < 12
    assert len(told(run_of(LINK), WHOLE).splitlines()) > 100


def test_news_come_first() -> None:
    assert news_line(run_of(LINK), "1 ms") == "send[DATA] is lost at 205 ms"


def test_news_that_happen_often_are_counted() -> None:
    view = run_of(LINK.replace("/// beats", "/// ! beats"))
    assert news_line(view, "1 ms") == "Sender beats 20 times from 10 ms to 200 ms; send[DATA] is lost at 205 ms"


def test_a_long_run_without_rounds_leaves_out_its_middle() -> None:
    view = run_of(COUNTING)
    text = told(view)
    assert "  ...  (700 steps)" in text
    assert "  200  " in text and "  901  " in text and "  500  " not in text
    assert "  500  " in told(view, WHOLE)


def test_of_a_long_run_to_an_error_both_ends_are_reported() -> None:
    model = load_model(Source("model.ta", COUNTING.replace("int[0, 1000] n", "int[0, 300] n")))
    (verdict,) = verify(model.network, model.queries)
    assert verdict.fault is not None
    out = StringIO()
    print_fault(model.network, verdict.fault, Console(file=out, width=120))
    assert "  ...  (260 steps)" in out.getvalue()
    numbers = [word for line in out.getvalue().splitlines() if (word := line[:7].strip()).isdigit()]
    assert numbers == [*map(str, range(11)), *map(str, range(271, 301))]


def test_json_names_what_is_different() -> None:
    start, first, second, *_ = trace_to_json(run_of(LINK).without_hidden())
    assert start["variables"] == {"n": 0}
    assert first["variables"] == {"n": 1}
    assert first["clocks"] == {"Sender.x": "0"}
    assert second["time"] == "10" and "variables" not in second and "clocks" not in second
