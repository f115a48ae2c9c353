"""Sweeps: what they find, what their file keeps, what a kill leaves."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from multiprocessing import active_children
from pathlib import Path
from xml.etree import ElementTree

import jsonschema
import pandas
import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.verify.campaign.job import KILLED
from tachk.verify.campaign.run import Progress

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
FISCHER = ROOT / "models/classics/fischer.ta"
SCHEMA = json.loads((ROOT / "docs/schema/sweep.schema.json").read_text(encoding="utf-8"))

COUNTER = """
const int MOST = 3;
const int STEP = 1;
int[0,30] n;
clock x;
process Counter() {
    state Go { x <= 1 };
    init Go;
    trans Go -> Go { guard x == 1 && n < MOST; assign n = n + STEP, x = 0; };
}
system Counter;
property reached: E<> n == MOST;
property largest: sup: n;
property exact: A[] n <= MOST;
"""


@pytest.fixture(scope="module")
def counter(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sweep") / "counter.ta"
    path.write_text(COUNTER, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def swept(counter: Path) -> tachk.api.model.Sweep:
    return tachk.load(counter).sweep(over=["MOST=2..4", "STEP=1..2"], processes=2)


def test_answers_are_those_of_single_checks(counter: Path, swept: tachk.api.model.Sweep) -> None:
    expected = [
        (limit, step, verdict.query.name, verdict.answer.value, verdict.statistics.states_stored)
        for limit in (2, 3, 4)
        for step in (1, 2)
        for verdict in tachk.load(counter, MOST=limit, STEP=step).verify()
    ]
    found = [(r["MOST"], r["STEP"], r["property"], r["answer"], r["states_stored"]) for r in swept.rows]
    assert found == expected


def test_processes_take_chains_as_long_as_the_program_does(tmp_path: Path) -> None:
    chain = " else ".join(f"if (n == {number}) {{ n = 0; }}" for number in range(1500))
    model = tmp_path / "chain.ta"
    model.write_text(
        f"const int MOST = 1; int[0,30] n; void reset() {{ {chain} }}"
        "process P() { init location a { to b { assign n = MOST, reset(); } } location b { } } system P;"
        "property back: E<> P.b && n == 0;",
        encoding="utf-8",
    )
    found = tachk.load(model).sweep(over="MOST=1..2", processes=1)
    assert [row["answer"] for row in found.rows] == ["holds", "holds"]


def test_figures(swept: tachk.api.model.Sweep) -> None:
    rows = {(row["MOST"], row["STEP"], row["property"]): row for row in swept.rows}
    assert rows[4, 1, "largest"]["upper"] == 4
    assert rows[3, 2, "largest"]["upper"] == 4
    assert (rows[4, 2, "reached"]["run_steps"], rows[4, 2, "reached"]["run_end"]) == (2, 2.0)
    assert rows[3, 2, "reached"]["run_steps"] is None


def test_forms(swept: tachk.api.model.Sweep, tmp_path: Path) -> None:
    """They all hold the same table."""
    jsonschema.validate(swept.to_dict(), SCHEMA)
    table = tmp_path / "table.csv"
    table.write_text(swept.to_csv(), encoding="utf-8")
    swept.to_parquet(tmp_path / "table.parquet")
    csv, parquet = pandas.read_csv(table), pandas.read_parquet(tmp_path / "table.parquet")
    assert len(csv) == len(parquet) == len(swept.rows) == 18
    for column in ("MOST", "STEP", "property", "answer", "states_stored", "seconds"):
        assert csv[column].tolist() == parquet[column].tolist() == [row[column] for row in swept.rows]


def test_a_name_says_that_a_file_holds_the_table(counter: Path, tmp_path: Path) -> None:
    arguments = ["sweep", str(counter), "-D", "MOST=2,3", "--property", "reached", "-j", "1"]
    table = tmp_path / "table.csv"
    result = CliRunner().invoke(app, [*arguments, "-o", str(table)])
    assert pandas.read_csv(table)["MOST"].tolist() == [2, 3]
    assert "reached: " in result.stdout, "the report is printed"
    assert CliRunner().invoke(app, [*arguments, "-o", str(table), "--format", "json"]).stdout == ""
    assert [row["MOST"] for row in json.loads(table.read_text(encoding="utf-8"))["rows"]] == [2, 3]


def test_a_program_from_standard_input_sweeps(counter: Path) -> None:
    """There is no file of it that the processes could import."""
    program = f"import tachk\nprint(tachk.load({str(counter)!r}).sweep(over='MOST=2,3', processes=1).rows, __file__)\n"
    ended = subprocess.run([sys.executable, "-"], input=program, capture_output=True, text=True, check=False)
    assert ended.stderr == ""
    assert "killed" not in ended.stdout and ended.stdout.count("'answer': 'holds'") > 0
    assert ended.stdout.endswith("<stdin>\n")


def test_a_program_without_a_guard_is_warned_of_it(counter: Path, tmp_path: Path) -> None:
    """It would run again in each process."""
    program = tmp_path / "program.py"
    program.write_text(f"import tachk\ntachk.load({str(counter)!r}).sweep(over=['MOST=2,3'], processes=1)\n")
    ended = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert ended.stderr.count("Traceback") == 1
    assert "it would sweep again" in ended.stderr and '__name__ == "__main__"' in ended.stderr


def test_what_a_cell_cannot_answer(counter: Path) -> None:
    """A wrong cell does no harm to the others."""
    rows = tachk.load(counter).sweep(over=["MOST=19,20", "STEP=1,3,1/0,999"], property="reached", processes=2).rows
    assert [row["answer"] for row in rows] == ["holds", "fails", "unknown", "unknown"] * 2
    assert "division" in str(rows[2]["reason"])
    assert "outside" in str(rows[3]["reason"])


def test_limit_of_each_cell(counter: Path) -> None:
    rows = (
        tachk.load(counter).sweep(over="MOST=2,20", property="exact", limits=tachk.Limits(states=5), processes=1).rows
    )
    assert [(row["answer"], row["reason"]) for row in rows] == [("holds", ""), ("unknown", "state limit")]


def test_maps(swept: tachk.api.model.Sweep, tmp_path: Path) -> None:
    """A map for each property, with a square for each cell."""
    swept.plot(tmp_path / "map.svg")
    drawn = ElementTree.parse(tmp_path / "map.svg")
    texts = ["".join(each.itertext()).strip() for each in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert {"reached", "largest", "exact"} <= set(texts)
    swept.plot(tmp_path / "states.svg", "upper")
    with pytest.raises(tachk.UsageError, match="no column 'state'"):
        swept.plot(tmp_path / "map.svg", "state")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"over": "MOSTS=1..2"}, "no constant `MOSTS`"),
        ({"over": "n=1..2"}, "is a variable"),
        ({"over": "STEP=1", "property": "reach"}, "no property 'reach'"),
        ({"over": "STEP=1", "dask": "tcp://127.0.0.1:1"}, "--dask tcp://127.0.0.1:1"),
    ],
)
def test_mistakes(counter: Path, given: dict[str, str], message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.verify.campaign.cluster.PATIENCE", "0.2s")
    with pytest.raises(tachk.UsageError, match=message):
        tachk.load(counter).sweep(**given)


class TestFile:
    def test_finished_cells_are_not_computed_again(self, counter: Path, tmp_path: Path) -> None:
        model, store = tachk.load(counter), tmp_path / "cells.sqlite"
        model.sweep(over=["MOST=2..3", "STEP=1..2"], store=store, processes=1)
        more = model.sweep(over=["MOST=2..4", "STEP=1..2"], store=store, processes=1)
        assert more.campaign.earlier == 4
        assert len(more.rows) == 18

    def test_other_programs_read_it(self, counter: Path, tmp_path: Path) -> None:
        store = tmp_path / "cells.sqlite"
        tachk.load(counter).sweep(over="MOST=2..4", store=store, processes=1)
        with sqlite3.connect(store) as database:
            found = database.execute("select MOST, answer from rows where property = 'reached' order by 1").fetchall()
        database.close()
        assert found == [(2, "holds"), (3, "holds"), (4, "holds")]

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"property": "exact"}, "queries was all properties of the model, now it is exact"),
            ({"over": ["MOST=2", "STEP=1"]}, "constants was MOST, now it is MOST, STEP"),
            ({"limits": tachk.Limits(states=7)}, "--max-states was None, now it is 7"),
        ],
    )
    def test_of_another_sweep(self, counter: Path, tmp_path: Path, change: dict[str, object], message: str) -> None:
        store = tmp_path / "cells.sqlite"
        tachk.load(counter).sweep(over="MOST=2", store=store, processes=1)
        with pytest.raises(tachk.UsageError, match=message):
            tachk.load(counter).sweep(**{"over": "MOST=2", "store": store, "processes": 1, **change})  # type: ignore[arg-type]

    def test_of_another_model(self, counter: Path, tmp_path: Path) -> None:
        store = tmp_path / "cells.sqlite"
        tachk.load(counter).sweep(over="MOST=2", store=store, processes=1)
        changed = tmp_path / "changed.ta"
        changed.write_text(COUNTER.replace("x == 1", "x >= 1"), encoding="utf-8")
        with pytest.raises(tachk.UsageError, match="the text of the model has changed"):
            tachk.load(changed).sweep(over="MOST=2", store=store, processes=1)

    def test_no_such_file(self, counter: Path, tmp_path: Path) -> None:
        (tmp_path / "text").write_text("no database, but some text that is long enough" * 9, encoding="utf-8")
        with pytest.raises(tachk.UsageError, match="not a database"):
            tachk.load(counter).sweep(over="MOST=2", store=tmp_path / "text")
        with pytest.raises(tachk.UsageError, match="can the file be written"):
            tachk.load(counter).sweep(over="MOST=2", store=tmp_path / "none/such")


def _sweep(*arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tachk", "sweep", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def _until(lines: Iterator[str], cells: int) -> None:
    """Reads what a sweep says about its progress until so many cells are finished."""
    for line in lines:
        if int(line.split()[0]) >= cells:
            return
    raise AssertionError("it ended")


def test_killed_half_way(tmp_path: Path) -> None:
    """Of 60 cells the finished ones are kept, and only the others computed."""
    store = tmp_path / "cells.sqlite"
    arguments = FISCHER, "-D", "N=3..4", "-D", "WRITE=1..6", "-D", "WAIT=1..5", "--property", "all", "-j", 2
    with _sweep(*arguments, "--store", store) as process:
        assert process.stderr is not None
        _until(process.stderr, 30)
        os.killpg(process.pid, signal.SIGKILL)
    before = _cells(store)
    assert 30 <= len(before) < 60
    with _sweep(*arguments, "--store", store, "--format", "json") as process:
        assert process.stdout is not None
        report = json.load(process.stdout)
    assert process.returncode == 0
    jsonschema.validate(report, SCHEMA)
    after = _cells(store)
    assert len(after) == 60 and before.items() <= after.items()
    assert len(report["rows"]) == 240
    fails = {
        (r["WRITE"], r["WAIT"])
        for r in report["rows"]
        if r["property"] == "mutual_exclusion" and r["answer"] == "fails"
    }
    assert fails == {(write, wait) for write in range(1, 7) for wait in range(1, 6) if write > wait}


def _cells(store: Path) -> dict[str, float]:
    with sqlite3.connect(store) as database:
        found = dict(database.execute("select cell, seconds from cells"))
    database.close()
    return found


@pytest.mark.parametrize("tries", [1, 2])
def test_process_that_is_killed(tries: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its cell is tried again, or else unknown; the others are computed."""
    monkeypatch.setattr("tachk.verify.campaign.local.TRIES", tries)

    def kill(now: Progress) -> None:
        """The first cell is finished, the process is at the second, which takes a while."""
        if now.finished == 1:
            (process,) = active_children()
            assert process.pid is not None
            os.kill(process.pid, signal.SIGKILL)

    found = tachk.load(FISCHER).sweep(over="N=2,8,3", property="mutual_exclusion", processes=1, progress=kill)
    killed = ["", KILLED, ""] if tries == 1 else ["", "", ""]
    assert [row["reason"] for row in found.rows] == killed


def test_limit_on_time(counter: Path) -> None:
    found = tachk.load(counter).sweep(over="MOST=1..20", seconds=0.0, processes=1)
    assert found.campaign.unfinished == 20
    assert found.rows == ()
