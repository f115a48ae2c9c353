"""`arrived(x)` where each column has times of its own, and what is said where nothing tells when something arrives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.recordings.traces.trace_files import open_trace

DUMP = """$timescale 1 us $end
$scope module bus $end
$var event 1 ! tick $end
$var wire 1 " ack $end
$var reg 4 # word $end
$scope module sub $end
$var wire 1 $ other $end
$upscope $end
$upscope $end
$enddefinitions $end
#0
$dumpvars
x!
0"
bx #
0$
$end
#2 1! b11 #
#3 1" bx #
#5 1! 1! b11 #
#6 $dumpall 1! 1" b11 # 0$ $end
#9 0"
#12 1!
#13
"""


def dump(tmp_path: Path) -> Path:
    path = tmp_path / "wave.vcd"
    path.write_text(DUMP)
    return path


def arrivals(path: object, topic: str, *others: str) -> list[float]:
    """When something arrives, by the clock."""
    trace = open_trace(path).read([f"arrived({topic})", *others])
    flags = trace.columns[f"arrived({topic})"]
    return [float(trace.clock(int(tick))) for tick, arrived in zip(trace.times, flags, strict=True) if arrived]


def test_a_change_in_a_dump_is_an_arrival_also_without_another_value(tmp_path: Path) -> None:
    path = dump(tmp_path)
    assert arrivals(path, "bus.tick") == [2, 5, 12]
    assert arrivals(path, "bus.word") == [2, 5]  # x is not a value, a checkpoint no change
    assert arrivals(path, "bus.ack") == [3, 9]
    assert arrivals(path, "bus.sub") == []
    assert arrivals(path, "bus") == [2, 3, 5, 9, 12]
    assert arrivals(path, "bus.tick", "bus.ack") == [2, 5, 12]


@pytest.mark.parametrize(
    ("formula", "word"),
    [
        ("G[0, 6 us] F[0, 7 us] arrived(bus.tick)", "true"),
        ("G[0, 6 us] F[0, 6 us] arrived(bus.tick)", "false"),
        ("G[0, 8 us] F[0, 5 us] change(bus.ack)", "false"),
        ("F[12 us, 12 us] arrived(bus.tick)", "true"),
        ("F[6 us, 6 us] arrived(bus.tick)", "false"),
        ("G (arrived(bus.tick) -> F[0, 1 us] arrived(bus.ack))", "false"),
        ("G (arrived(bus.ack) -> O[0, 4 us] arrived(bus.tick))", "true"),
        ("arrived(bus.ack)", "false"),
    ],
)
def test_formulas_over_arrivals_in_a_dump(formula: str, word: str, tmp_path: Path) -> None:
    assert tachk.monitor(formula, dump(tmp_path)).truth.word == word


def test_channels_of_mdf_arrive_with_the_samples_of_their_group(tmp_path: Path) -> None:
    asammdf = pytest.importorskip("asammdf")
    path = tmp_path / "log.mf4"
    with asammdf.MDF() as file:
        for name, times in (("hb.n", [0.2, 0.4, 0.4, 1.4]), ("hb.m", [0.3, 0.4]), ("slow", [0.0, 1.0])):
            file.append([asammdf.Signal(np.ones(len(times)), np.array(times), name=name)])
        file.save(path, overwrite=True)
    assert arrivals(path, "hb.n") == [0.2, 0.4, 1.4]
    assert arrivals(path, "hb") == [0.2, 0.3, 0.4, 1.4]
    assert arrivals(path, "hb.m", "slow") == [0.3, 0.4]
    assert arrivals(path, "slow", "hb.n") == [1.0]  # before 0.2 the value of `hb.n` is not known
    formulas = ["G[0, 0.6 s] F[0, 0.5 s] arrived(hb.n)", "G[0, 0.6 s] F[0, 1 s] arrived(hb.n)"]
    assert [verdict.truth.word for verdict in tachk.monitor(formulas, path)] == ["false", "true"]
    assert tachk.monitor("F[0.3 s, 0.3 s] (arrived(hb) && slow == 1)", path).truth.word == "true"


def test_files_that_are_joined_begin_with_what_has_a_value(tmp_path: Path) -> None:
    early, late = tmp_path / "a.csv", tmp_path / "b.csv"
    early.write_text("time,hb.n,x\n0,1,1\n1,1,\n2,1,\n8,1,\n")
    late.write_text("time,hb.m,y\n4,1,1\n5,,1\n6,1,1\n")
    both = [str(early), str(late)]
    assert arrivals(both, "hb.n") == [0, 1, 2, 8]
    assert arrivals(both, "hb") == [0, 1, 2, 4, 6, 8]
    assert arrivals(both, "hb.m", "x") == [4, 6]
    assert arrivals(both, "hb", "y") == [4, 6, 8]


def test_a_file_of_which_columns_are_called_arrives_with_all_of_them(tmp_path: Path) -> None:
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"
    one.write_text("time,n,x\n0,1,1\n1,1,\n2,,2\n")
    two.write_text("time,n,x\n0,1,1\n3,1,1\n")
    both = [str(one), str(two)]
    assert arrivals(both, "one.n") == [0, 1]
    assert arrivals(both, "one") == [0, 1, 2]
    assert arrivals(both, "two.x") == [0, 3]


MODEL = """chan go;
int n = 0;
process P() { init location A { to B { sync go!; assign n = n + 1; } } location B { to A { } } }
process Q() { init location C { to C { sync go?; } } }
system P, Q;
"""


@pytest.mark.parametrize(
    ("topic", "help_"),
    [
        ("n", "write `change(n)`"),
        ("P", "write `change(P)`"),
        ("P.B", "write `rise(P.B)`"),
        ("go", "write `rise(P.A)`"),
        ("P.go", "write `rise(P.A)`"),
    ],
)
def test_a_run_of_a_model_has_no_arrivals(topic: str, help_: str, tmp_path: Path) -> None:
    model, run = tmp_path / "m.ta", tmp_path / "m.run"
    model.write_text(MODEL)
    call = CliRunner().invoke
    assert call(app, ["simulate", str(model), "--until", "5", "-o", str(run)]).exit_code == 0
    for command in (["simulate", str(model)], ["replay", str(model), str(run)]):
        result = call(app, [*command, "--monitor", f"F arrived({topic})"])
        assert result.exit_code == 2
        assert f"E0901]: a run of a model does not show when `{topic}` arrives" in result.output
        assert help_ in result.output
    result = call(app, ["verify", str(model), "F[0, 5] arrived(n)"])
    assert (result.exit_code, "of a model write `rise(P.location)`" in result.output) == (2, True)


def test_the_time_of_a_run_has_a_name(tmp_path: Path) -> None:
    model = tmp_path / "m.ta"
    model.write_text(MODEL)
    call = CliRunner().invoke
    assert call(app, ["simulate", str(model), "--until", "5", "--monitor", "F (time > 2)"]).exit_code == 0
    assert call(app, ["simulate", str(model), "--until", "5", "--monitor", "G (time < 2)"]).exit_code == 10


def test_a_capture_says_which_column_to_take() -> None:
    path = Path(__file__).parents[3] / "data/captures/created_again.pcap"
    recording = open_trace(path)
    client = next(name for name in recording.columns if name.endswith(".to_agent.delivered")).rpartition(".")[0]
    with pytest.raises(UsageError, match="does not show when") as error:
        tachk.monitor(f"F arrived({client})", path)
    assert f"write `change({client}.delivered)`" in str(error.value.help)


def test_a_trace_in_memory_has_values_only() -> None:
    trace = open_trace({"time": [0, 1, 2], "x": [1.0, 1.0, 2.0]}).read()
    with pytest.raises(UsageError, match="does not show when `x` arrives") as error:
        tachk.monitor("F arrived(x)", trace)
    assert "`change(x)`" in str(error.value.help)


def test_what_is_seen_has_no_counts_of_arrivals(tmp_path: Path) -> None:
    """The monitor counts arrivals; the number says nothing to a reader."""
    (tmp_path / "log.csv").write_text("time,hb,cmd\n0,1,\n1,2,\n5,,2\n6,3,\n", encoding="utf-8")
    told = tachk.monitor("G (arrived(cmd) -> F[0,0.5] (arrived(hb) && hb > 0))", tmp_path / "log.csv").to_text()
    assert "seen at 5.5: hb = 2\n" in told
    alone = tachk.monitor("G F[0,2] arrived(hb)", tmp_path / "log.csv").to_text()
    assert "`arrived(hb)` is never true" in alone and "seen at" not in alone
