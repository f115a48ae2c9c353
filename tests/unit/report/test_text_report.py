from __future__ import annotations

from dataclasses import replace
from io import StringIO

from rich.console import Console

from tachk.properties.verdict import Answer
from tachk.report.record import RunRecord
from tachk.report.text_report import print_run


def printed(record: RunRecord, **options: bool) -> str:
    out = StringIO()
    print_run(record, Console(file=out, width=120), **options)
    return out.getvalue()


def test_only_runs_behind_surprises_are_told(record: RunRecord) -> None:
    text = printed(record)
    assert "always_off is violated by this run of 2 steps" in text
    assert "can_light is satisfied" not in text
    assert "can_light is satisfied" in printed(record, every_trace=True)


def test_a_step_tells_who_did_what_when_and_what_changed(record: RunRecord) -> None:
    text = printed(record)
    assert "25 ms (+25 ms)" in text
    assert "press[1]!  User: idle → done  [b = 1]" in text
    assert "press[1]?  Lamp: off → on" in text
    assert "the user loses patience" in text
    assert "full light" in text
    assert "n: 0 → 3, lit: false → true" in text
    assert "scratch" not in text


def test_clocks_are_printed_on_demand(record: RunRecord) -> None:
    assert "User.x" not in printed(record)
    assert "User.x = 5/2" in printed(record, clocks=True)


def test_a_run_time_error_shows_the_source_line(record: RunRecord) -> None:
    text = printed(record)
    assert "a value is outside the declared range" in text
    assert "2 |   n = n + 1;\n  |   ^^^^^^^^^\n" in text


def test_summary_counts(record: RunRecord) -> None:
    assert printed(record).endswith("1 of 4 as expected, 1 not, 2 unknown\n")
    good = replace(record, verdicts=record.verdicts[1:2])
    assert printed(good).endswith("1 of 1 as expected\n")


def test_square_brackets_of_queries_are_not_markup(record: RunRecord) -> None:
    query = replace(record.verdicts[0].query, title="", text="A[] not [red]x[/red]")
    changed = replace(record, verdicts=(replace(record.verdicts[0], query=query),))
    assert "A[] not [red]x[/red]" in printed(changed)


def test_success_of_a_record(record: RunRecord) -> None:
    assert record.met is False
    assert replace(record, verdicts=record.verdicts[1:3]).met is None
    assert replace(record, verdicts=record.verdicts[1:2]).met is True
    assert record.verdicts[2].answer is Answer.UNKNOWN
