from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from io import StringIO

import pytest
from rich.console import Console

from tachk.meaning.run_view import Snapshot, TraceView, ViewStep
from tachk.model.query import Expectation
from tachk.report import text_report
from tachk.report.record import RunRecord
from tachk.report.run.display import RunDisplay
from tachk.report.run.trace_text import print_trace
from tachk.report.text_report import print_run
from tachk.verify.verdict import Answer


def printed(record: RunRecord, **options: bool) -> str:
    out = StringIO()
    print_run(record, Console(file=out, width=120), **options)
    return out.getvalue()


def test_a_narrow_terminal_gets_words_rather_than_costs(record: RunRecord) -> None:
    headings = {}
    for width in (120, 60, 48):
        out = StringIO()
        print_run(record, Console(file=out, width=width, color_system=None))
        lines = out.getvalue().splitlines()
        headings[width] = next(line.split() for line in lines if "property" in line)
        assert all(verdict.answer.value in out.getvalue() for verdict in record.verdicts)
    everything = ["property", "answer", "expected", "states", "time", "memory", "meaning"]
    assert headings[120] == everything
    assert headings[48] == ["property", "answer", "expected", "meaning"]
    assert len(headings[48]) < len(headings[60]) < len(everything)


def test_only_runs_behind_surprises_are_reported(record: RunRecord) -> None:
    text = printed(record)
    assert "always_off is violated by this run of 2 steps" in text
    assert "can_light is satisfied" not in text
    assert "can_light is satisfied" in printed(record, every_trace=True)


def test_a_step_reports_who_did_what_when_and_what_changed(record: RunRecord) -> None:
    text = printed(record)
    assert "25 ms (+25 ms)" in text
    assert "press[1]!  User: idle → done" in text
    assert "press[1]?  Lamp: off → on" in text
    assert "the user loses patience" in text
    assert "full light" in text
    assert "n: 0 → 3, lit: false → true" in text
    assert "scratch" not in text


def test_clocks_are_printed_on_demand(record: RunRecord) -> None:
    assert "User.x" not in printed(record)
    assert "User.x = 5/2" in printed(record, display=RunDisplay(clocks=True))


def test_what_was_not_inspected_is_reported_once(record: RunRecord) -> None:
    assert "not looked for" not in printed(record)
    first, second, *others = record.verdicts
    named = [replace(first, unexamined=("Link", "n")), replace(second, unexamined=("Link", "n")), *others]
    text = " ".join(printed(replace(record, verdicts=tuple(named))).split())
    names = f"{first.query.name}, {second.query.name}"
    assert f"run-time errors of Link, n were not looked for, as {names} do not depend on them" in text
    assert text.count("not looked for") == 1


def test_a_run_time_error_shows_the_source_line(record: RunRecord) -> None:
    text = printed(record)
    assert "error[E0761]: run-time error: a value is outside its declared range\n" in text
    assert "    2 |   n = n + 1;\n      |   ^^^^^^^^^\nhelp: " in text


def test_one_reason_is_reported_once(record: RunRecord) -> None:
    bad = record.verdicts[3]
    other = replace(bad, query=replace(bad.query, name="worse"))
    text = printed(replace(record, verdicts=(bad, other)))
    assert "bad, worse are unknown: run-time error" in text
    assert text.count("a value is outside its declared range") == 1


def test_summary_counts(record: RunRecord) -> None:
    assert printed(record).endswith("1 passed, 1 failed, 2 unknown\n")
    good = replace(record, verdicts=record.verdicts[1:2])
    assert printed(good).endswith("1 passed\n")


def test_a_known_defect_shows_how_its_run_ends(record: RunRecord) -> None:
    verdict = record.verdicts[0]
    assert verdict.trace is not None
    rest = verdict.trace.steps[-1]
    different = (replace(rest, delay=Fraction(number)) for number in range(1, 10))
    trace = replace(verdict.trace, steps=(verdict.trace.steps[0], *different))
    known = replace(verdict, query=replace(verdict.query, expectation=Expectation.FAILS), trace=trace)
    text = printed(replace(record, verdicts=(known,), not_checked=()))
    assert "always_off is violated, as expected, by this run of 10 steps, at time" in text
    numbers = [line.split()[0] for line in text.splitlines() if "time passes" in line or "(7 steps)" in line]
    assert numbers == ["...", "8", "9", "10"]
    assert "start in" not in text
    whole = printed(replace(record, verdicts=(known,)), every_trace=True)
    assert "start in" in whole
    assert "steps)" not in whole


def test_a_long_run_to_an_error_is_reported_shortly(record: RunRecord) -> None:
    verdict = record.verdicts[3]
    assert verdict.fault is not None
    long = replace(verdict, fault=replace(verdict.fault, path=verdict.fault.path * 5000))
    text = printed(replace(record, verdicts=(long,)))
    assert "happens 5000 times in a row, to step 5000" in text
    assert len(text.splitlines()) < 60


def test_no_run_is_reported_where_none_was_requested(record: RunRecord) -> None:
    text = printed(replace(record, runs=False))
    assert "run-time error" in text
    assert "start in" not in text


def test_a_short_run_of_a_known_defect_is_reported_whole(record: RunRecord) -> None:
    verdict = record.verdicts[0]
    known = replace(verdict, query=replace(verdict.query, expectation=Expectation.FAILS))
    text = printed(replace(record, verdicts=(known,), not_checked=()))
    assert "by this run of 2 steps" in text
    assert "start in User.idle, Lamp.off" in text
    assert "..." not in text


def test_an_expectation_of_other_constants_reads_as_such(record: RunRecord) -> None:
    verdict = record.verdicts[0]
    elsewhere = replace(record, verdicts=(verdict,), not_checked=(), definitions=("MAX",))
    assert elsewhere.met is False
    assert "≠ always_off  fails" in printed(elsewhere)
    assert "1 differs from what the model expects of other constants" in printed(elsewhere)
    for query in (replace(verdict.query, expectation=None), replace(verdict.query, conditional=True)):
        spoken_of = replace(elsewhere, verdicts=(replace(verdict, query=query),))
        assert "✗ always_off  fails" in printed(spoken_of)
        assert printed(spoken_of).endswith("1 failed\n")


def test_square_brackets_of_queries_are_not_markup(record: RunRecord) -> None:
    query = replace(record.verdicts[0].query, title="", text="A[] not [red]x[/red]")
    changed = replace(record, verdicts=(replace(record.verdicts[0], query=query),))
    assert "A[] not [red]x[/red]" in printed(changed)


def test_success_of_a_record(record: RunRecord) -> None:
    assert record.met is False
    assert replace(record, verdicts=record.verdicts[1:3]).met is None
    assert replace(record, verdicts=record.verdicts[1:2]).met is True
    assert record.verdicts[2].answer is Answer.UNKNOWN


def test_neighbouring_cells_of_an_array_change_together() -> None:
    before = Snapshot((), (("a[0]", 1), ("a[1]", 2), ("a[2]", 0), ("b[0]", 0), ("b[1]", 0), ("b[2]", 0), ("c", 0)))
    after = Snapshot((), (("a[0]", 2), ("a[1]", 0), ("a[2]", 5), ("b[0]", 1), ("b[1]", 0), ("b[2]", 1), ("c", 1)))
    out = StringIO()
    print_trace(TraceView(before, (ViewStep(None, None, after),)), Console(file=out, width=200))
    assert "a[0..2]: 1 2 0 → 2 0 5, b[0]: 0 → 1, b[2]: 0 → 1, c: 0 → 1" in out.getvalue()


def test_only_some_of_many_constants_are_listed_those_from_outside_first(record: RunRecord) -> None:
    network = replace(record.network, constants=tuple((f"C{i}", i) for i in range(20)))
    text = printed(replace(record, network=network, definitions=("C17",)))
    assert "lamp.ta   C17 = 17, C0 = 0, " in text
    assert "and 12 more constants" in text


def test_long_tables_look_like_short_ones(record: RunRecord, monkeypatch: pytest.MonkeyPatch) -> None:
    short = [line.rstrip() for line in printed(record).splitlines()]
    monkeypatch.setattr(text_report, "_WRAPPED_ROWS", 0)
    assert [line.rstrip() for line in printed(record).splitlines()] == short


def test_many_unknown_properties_are_counted(record: RunRecord) -> None:
    verdicts = tuple(
        replace(
            record.verdicts[0],
            query=replace(record.verdicts[0].query, name=f"q{number}"),
            answer=Answer.UNKNOWN,
            reason="time limit",
        )
        for number in range(400)
    )
    text = printed(replace(record, verdicts=verdicts))
    assert "q17, q18, q399 (400 in all) are unknown: time limit" in " ".join(text.split())
    assert "\n? q398 " in text
