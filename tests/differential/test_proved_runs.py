"""What `verify` proves is false on no simulated run (`bench/proved_runs.py` looks at more), and replays judge alike."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.cli.main import app
from tachk.engine.simulation.simulator import SimulationEnding
from tachk.recordings.traces.node_signal import Truth
from tests.support.seeds import enough, seeds
from tests.support.simulated.proved import FORMS, proved_on_runs
from tests.support.simulated.replayed import judged_twice

pytestmark = pytest.mark.drawn


def test_a_proved_formula_is_false_on_no_simulated_run() -> None:
    found = [judged for seed in seeds((5291, 5330, *range(10))) for judged in proved_on_runs(seed, runs=3, forms=FORMS)]
    assert enough(len(found) > 50)
    assert [judged for judged in found if judged.truth is Truth.FALSE] == []


def test_runs_that_end_early_are_evaluated_as_their_replays() -> None:
    found = [judged for seed in seeds(range(80)) for judged in judged_twice(seed, runs=2)]
    assert [judged for judged in found if not judged.agrees] == []
    assert enough(
        {judged.ending for judged in found}
        >= set(SimulationEnding)
        - {
            SimulationEnding.INITIAL,
            SimulationEnding.ZENO,
            SimulationEnding.END_OF_TIME,
        }
    )
    assert enough(
        {judged.ending for judged in found if judged.simulated is Truth.FALSE}
        >= {
            SimulationEnding.STEPS,
            SimulationEnding.HORIZON,
        }
    )


TWO_STEPS = "process P() { clock x; init location a { to b { guard x >= 1; } } location b { to a; } } system P;"
URGENT = "process P() { init location a { to b; } urgent location b { to a; } location c; } system P;"
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
def test_a_run_that_ends_in_a_time_lock_is_evaluated_alike(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], model: str, formula: str, proved: bool, verdict: str
) -> None:
    assert verdicts(tmp_path, capsys, model, formula, ()) == (0 if proved else 10, verdict, verdict)


@pytest.mark.parametrize(
    ("model", "formula", "steps", "verdict"),
    [
        (TWO_STEPS, "G P.a", 1, "false"),
        (TWO_STEPS, "G P.a", 2, "false"),
        (URGENT, "G P.a", 1, "undetermined"),
        (URGENT, "G (P.b -> O P.c)", 1, "undetermined"),
        (URGENT, "G P.a", 2, "true"),
    ],
)
def test_a_run_that_ends_after_some_steps_is_evaluated_alike(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], model: str, formula: str, steps: int, verdict: str
) -> None:
    assert verdicts(tmp_path, capsys, model, formula, ("--max-steps", str(steps)))[1:] == (verdict, verdict)


def verdicts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], model: str, formula: str, limits: tuple[str, ...]
) -> tuple[int, str, str]:
    """The status of `verify`, and what `simulate` and `replay` say of a run."""
    file, run = tmp_path / "m.ta", tmp_path / "m.run"
    file.write_text(model, encoding="utf-8")

    def tachk(*arguments: str) -> tuple[int, str]:
        capsys.readouterr()
        status = app.main(list(arguments), prog_name="tachk", standalone_mode=False)
        return int(status), capsys.readouterr().out

    status = tachk("verify", str(file), formula)[0]
    evaluation = ("--monitor", formula, "--all-runs", "-o", str(run), *limits)
    drawn = tachk("simulate", str(file), "--until", "20", *evaluation)[1]
    (simulated,) = (word for word in ("true", "false", "undetermined") if f"{word} on 1" in drawn)
    replayed = tachk("replay", str(file), str(run), "--monitor", formula, "--quiet")[1]
    return status, simulated, replayed.splitlines()[-1].rpartition(": ")[2]
