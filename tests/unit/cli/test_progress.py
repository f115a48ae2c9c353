from __future__ import annotations

import pytest

from tachk.cli import progress
from tachk.engine.outcome import Statistics


def test_line_reports_the_rate_since_the_last_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 0.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now)
    monkeypatch.setenv("COLUMNS", "100")
    line = progress.ProgressLine()
    line(Statistics(states_explored=10, seconds=0.1), ["safe"])
    assert capsys.readouterr().err == ""
    now = 1.0
    line(Statistics(states_explored=1000, states_stored=500, seconds=1.0, peak_bytes=2_000_000), ["safe"])
    now = 2.0
    line(Statistics(states_explored=4000, states_stored=900, seconds=2.0, peak_bytes=2_000_000), ["safe", "live"])
    said = "safe and 1 more: 4,000 states explored, 900 stored, 3,000/s, 2.0 MB, 2.0 s"
    assert capsys.readouterr().err.split("\r\x1b[K")[-1] == said
    line.clear()
    assert capsys.readouterr().err == "\r\x1b[K"
    line.clear()
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("columns", [80, 40])
def test_line_fits_into_the_terminal(
    columns: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 0.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now)
    monkeypatch.setenv("COLUMNS", str(columns))
    line = progress.ProgressLine()
    now = 1000.0
    many = Statistics(states_explored=10**12, states_stored=10**12, seconds=1000.0, peak_bytes=10**12)
    line(many, ["a_very_long_name_of_a_property_that_somebody_wrote"])
    (shown,) = capsys.readouterr().err.split("\r\x1b[K")[1:]
    assert shown.startswith("a_very_long_name_of_a_prope...: 1,0")
    assert len(shown) < columns
