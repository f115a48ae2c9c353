from __future__ import annotations

from dataclasses import replace

from tachk.report.html_report import run_to_html
from tachk.report.record import RunRecord


def test_one_row_for_each_answer(record: RunRecord) -> None:
    html = run_to_html(record)
    assert html.count("<tr>") == 1 + len(record.verdicts) + len(record.not_checked)
    assert "unknown (state limit)" in html
    assert "holds ✗" in html


def test_text_of_the_model_is_escaped(record: RunRecord) -> None:
    html = run_to_html(replace(record, model="<script>alert(1)</script>"))
    assert "<script>" not in html
    assert "A[] n &lt; 5 &amp;&amp; n &gt;= 0" in html


def test_a_run_time_error_is_reported(record: RunRecord) -> None:
    html = run_to_html(record)
    assert "error[E0761]: run-time error: a value is outside its declared range</summary>" in html
    assert "<details open>" in html
