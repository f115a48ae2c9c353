from __future__ import annotations

import pytest

from tachk.cli import progress
from tachk.engines.protocol import Statistics


def test_line_tells_the_rate_since_the_last_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 0.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now)
    line = progress.ProgressLine()
    line(Statistics(states_explored=10, seconds=0.1))
    assert capsys.readouterr().err == ""
    now = 1.0
    line(Statistics(states_explored=1000, states_stored=500, seconds=1.0, peak_bytes=2_000_000))
    now = 2.0
    line(Statistics(states_explored=4000, states_stored=900, seconds=2.0, peak_bytes=2_000_000))
    assert "4,000 states explored, 900 stored   3,000 states/s   2.0 MB   2.0 s" in capsys.readouterr().err
    line.clear()
    assert capsys.readouterr().err == "\r\x1b[K"
    line.clear()
    assert capsys.readouterr().err == ""
