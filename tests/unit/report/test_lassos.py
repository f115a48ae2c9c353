"""Runs that go on for ever, told: as text, JSON, a page, and as verifyta prints them."""

from __future__ import annotations

import re
from dataclasses import replace
from html import escape

import pytest

from tachk.base.span import Source
from tachk.engine.lasso import lasso
from tachk.engine.outcome import Obligation, Statistics
from tachk.formats.loading.load import load_model
from tachk.meaning.discrete import prepare
from tachk.model.run import Ending
from tachk.report.html_report import run_to_html
from tachk.report.json_report import Json, run_to_json
from tachk.report.record import RunRecord
from tachk.report.run.display import Ends, RunDisplay
from tachk.report.text_report import evidence_text
from tachk.report.verifyta_report import run_to_verifyta
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify
from tests.support.oracles.liveness_reference import check_by_zones

MODEL = """
clock x;
process Machine() {{
    int[0, 2] wear = 0;
    /// is off
    init location Off {{ invariant x <= 9; to Idle {{ guard x >= 4; assign x = 0; }} }}
    location Idle {{ invariant x <= 5; to Busy {{ guard x >= 5; assign x = 0; }} }}
    /// works
    location Busy {{ {busy} }}
    location Repaired;
}}
system Machine;
property repaired : A<> Machine.Repaired;
"""
WORKS = "invariant x <= 2; to Idle { guard x >= 2; assign x = 0, wear = wear < 2 ? wear + 1 : 2; }"


def checked(busy: str) -> RunRecord:
    """What is said of the model, its run made with the help of the oracle."""
    loaded = load_model(Source("machine.ta", MODEL.format(busy=busy)))
    (query,) = loaded.queries
    assert query.predicate is not None
    obligation = Obligation(query.predicate)
    run = check_by_zones(loaded.network, obligation).run
    assert run is not None
    trace = lasso(prepare(loaded.network), run, obligation)
    verdict = Verdict(query, Answer.FAILS, True, "", Statistics(), trace)
    return RunRecord("machine.ta", loaded.network, (verdict,))


def told(record: RunRecord, display: RunDisplay = RunDisplay()) -> str:
    return evidence_text(record.network, record.verdicts[0], display)


def test_a_loop_is_reported_after_what_leads_to_it() -> None:
    lines = told(checked(WORKS)).splitlines()
    assert re.fullmatch(
        r"repaired is violated by this run of \d+ steps, the last 2 of which repeat for ever:", lines[0]
    )
    (loop,) = (number for number, line in enumerate(lines) if "↻ from here on" in line)
    assert lines[loop].strip() == "↻ from here on this repeats for ever, every 7:"
    assert "Idle → Busy" in lines[loop + 1] and "Busy → Idle" in lines[-1]
    assert any("Off → Idle" in line for line in lines[:loop])


def test_a_loop_in_which_no_time_passes_says_so() -> None:
    assert "repeats for ever, and no time passes:" in told(checked("invariant x <= 3; to Busy;"))


def test_rounds_that_differ_are_reported_once() -> None:
    record = checked(WORKS)
    (verdict,) = record.verdicts
    assert verdict.trace is not None
    recurrent = replace(verdict, trace=replace(verdict.trace, ending=Ending.RECURRENT))
    assert "with delays that differ from round to round" in evidence_text(record.network, recurrent)


@pytest.mark.parametrize(
    ("busy", "title", "last"),
    [
        ("", "after which time passes for ever:", "∞ from here on time passes for ever, and nothing else need happen"),
        ("invariant x <= 3;", "after which nothing can happen:", "⊣ from here on nothing can happen any more"),
    ],
)
def test_runs_that_end_say_how(busy: str, title: str, last: str) -> None:
    lines = told(checked(busy)).splitlines()
    assert lines[0].endswith(title)
    assert lines[-1].strip() == last


def test_of_a_long_run_the_loop_is_reported() -> None:
    text = told(checked(WORKS), RunDisplay(ends=Ends(0, 1)))
    assert "↻ from here on" in text and "Idle → Busy" in text


def test_every_step_reports_the_loop_too() -> None:
    text = told(checked(WORKS), RunDisplay(every_step=True, clocks=True))
    assert "↻ from here on" in text and "start in Machine.Off" in text


def first_result(record: RunRecord) -> dict[str, Json]:
    results = run_to_json(record)["results"]
    assert isinstance(results, list)
    result: dict[str, Json] = results[0]
    return result


def test_json_has_the_state_to_which_the_loop_returns() -> None:
    record = checked(WORKS)
    found = first_result(record)
    assert found["ending"] == "periodic"
    start, trace = found["loop_start"], found["trace"]
    assert isinstance(start, int) and isinstance(trace, list) and start == len(trace) - 3
    ends = first_result(checked(""))
    assert (ends["ending"], ends["loop_start"]) == ("idle", None)
    without = first_result(replace(record, verdicts=(replace(record.verdicts[0], trace=None),)))
    assert (without["ending"], without["loop_start"]) == (None, None)


def test_the_page_reports_the_loop() -> None:
    assert "repeats for ever, every 7:" in run_to_html(checked(WORKS))


@pytest.mark.parametrize(
    ("busy", "words"),
    [
        (WORKS, "repeat for ever, with their delays"),
        ("", "from the last state on time passes for ever"),
        ("invariant x <= 3;", "from the last state on nothing can happen any more"),
    ],
)
def test_verifyta_says_what_comes_after_its_trace(busy: str, words: str) -> None:
    assert f"{words}\n" in run_to_verifyta(checked(busy), "some")


@pytest.mark.parametrize(
    ("formula", "line"),
    [
        ("F Machine.Repaired", "F Machine.Repaired: Waiting at 0"),  # the observer made no move
        (
            "G (Machine.Idle -> F Machine.Repaired)",
            "G (Machine.Idle -> F Machine.Repaired): Triggered at 4, Waiting at 9",
        ),
    ],
)
def test_a_formula_without_deadline_says_since_when_it_waits(formula: str, line: str) -> None:
    source = MODEL.format(busy=WORKS).replace("A<> Machine.Repaired", formula)
    loaded = load_model(Source("machine.ta", source))
    (verdict,) = verify(loaded.network, loaded.queries)
    assert evidence_text(loaded.network, verdict).splitlines()[1] == f"  {line}"


def against(query: str) -> RunRecord:
    """What `tachk verify` says of a query that fails, with its run."""
    text = MODEL.format(busy=WORKS).replace("A<> Machine.Repaired", query)
    loaded = load_model(Source("machine.ta", text))
    return RunRecord("machine.ta", loaded.network, tuple(verify(loaded.network, loaded.queries)))


@pytest.mark.parametrize(
    ("query", "state", "time"),
    [
        ("Machine.Off --> Machine.Repaired", 0, "0"),
        ("Machine.Idle --> Machine.Repaired", 1, "4"),
        ("Machine.Idle --> Machine.Busy && x > 2", 1, "4"),
        ("Machine.Idle -->[<= 4] Machine.Busy", 1, "4"),
        ("Machine.Off && x >= 3 --> Machine.Repaired", 0, "3"),
    ],
)
def test_where_the_obligation_begins_that_is_not_met(query: str, state: int, time: str) -> None:
    record = against(query)
    said = first_result(record)
    assert said["due"] == {"state": state, "time": time}
    place = f"after step {state}" if state else "before the first step"
    line = told(record).splitlines()[1]
    assert line.startswith(f"  From {time} on, {place}: `{query.split(' --')[0]}` was true, and `")
    assert line.endswith("` never follows in time" if "<=" in query else "` never follows")
    assert escape(line.strip()) in run_to_html(record)


def test_only_runs_against_leads_to_have_an_obligation_that_begins() -> None:
    record = checked(WORKS)
    assert first_result(record)["due"] is None
    assert "never follows" not in told(record)


@pytest.mark.parametrize(
    "formula", ["F Machine.Repaired", "G (Machine.Idle -> F Machine.Repaired)", "G F Machine.Repaired"]
)
def test_of_a_formula_it_is_not_said_that_it_was_true(formula: str) -> None:
    text = told(against(formula))
    assert "what the formula demands never follows" in text
    assert f"`{formula}`" not in text
