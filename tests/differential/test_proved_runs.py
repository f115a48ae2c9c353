"""What `verify` proves is false on no simulated run (`bench/proved_runs.py` looks at more), and replays judge alike."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.cli.main import app
from tachk.runtime.node_signal import Truth
from tachk.testing.simulated.proved import FORMS, proved_on_runs


def test_a_proved_formula_is_false_on_no_simulated_run() -> None:
    found = [judged for seed in (*range(10), 5291, 5330) for judged in proved_on_runs(seed, runs=3, forms=FORMS)]
    assert len(found) > 50
    assert [judged for judged in found if judged.truth is Truth.FALSE] == []


TIME_LOCK = (
    "clock x; process P() { init location a { invariant x <= 5; to b { guard x >= 6; } } location b; } system P;"
)
DEAD_END = "process P() { init location a { to b; } committed location b; location c; } system P;"


@pytest.mark.parametrize(
    ("model", "formula", "proved", "verdict"),
    [
        (TIME_LOCK, "G (rise(P.a) -> F[0,5] P.b)", True, "undetermined"),
        (TIME_LOCK, "G (P.a -> F[0,4] P.b)", False, "false"),
        (TIME_LOCK, "F[0,5) P.b", False, "undetermined"),
        (TIME_LOCK, "F P.b", False, "undetermined"),
        (TIME_LOCK, "G P.a", True, "true"),
        (DEAD_END, "G !P.b", True, "undetermined"),
    ],
)
def test_a_run_that_ends_in_a_time_lock_is_judged_alike(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], model: str, formula: str, proved: bool, verdict: str
) -> None:
    file, run = tmp_path / "m.ta", tmp_path / "m.run"
    file.write_text(model, encoding="utf-8")

    def tachk(*arguments: str) -> tuple[int, str]:
        capsys.readouterr()
        status = app.main(list(arguments), prog_name="tachk", standalone_mode=False)
        return int(status), capsys.readouterr().out

    assert tachk("verify", str(file), formula)[0] == (0 if proved else 10)
    drawn = tachk("simulate", str(file), "--until", "20", "--monitor", formula, "--all-runs", "-o", str(run))[1]
    assert f"{verdict} on 1" in drawn
    replayed = tachk("replay", str(file), str(run), "--monitor", formula, "--quiet")[1]
    assert replayed.splitlines()[-1].endswith(f": {verdict}")
