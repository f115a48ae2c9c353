"""Ctrl-C and SIGTERM while a file is written: no half of it under its name, nothing beside it, and the status says so.

The signal comes where the file has begun, in the midst of what its writer does, and when it is whole but has not its
name yet.
"""

from __future__ import annotations

import importlib
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tachk.base.unfinished_files import remove_unfinished
from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import app
from tachk.cli.termination import Termination
from tachk.verify.campaign.job import COLUMNS
from tachk.verify.campaign.store import opened

CAPTURE = Path(__file__).parents[2] / "data/captures/created_again.pcap"
MODEL = """
    clock x;
    process P() {
        init location a { invariant x <= 1; to a { guard x >= 1; assign x = 0; } to b { guard x >= 1; } }
        location b;
    }
    system P;
    property reached : E<> P.b;
    property early : A[] x <= 1 || P.b;
"""
BEGUN, NAMED = "tachk.base.whole_files:_empty_part", "os:replace"

WRITERS = [
    (("report", "m.ta", "-o"), "page.html", ()),
    (("verify", "m.ta", "-o"), "report.txt", ()),
    (
        ("verify", "m.ta", "--certificate"),
        "proofs.cert",
        ("tachk.cli.certificate_file:find_proof", "tachk.meaning.judge.certificate:CertificateWriter.write"),
    ),
    (("verify", "m.ta", "--chart"), "run.svg", ()),
    (("simulate", "m.ta", "-o"), "runs.csv", ("tachk.simulation.tables:_columns",)),
    (("simulate", "m.ta", "-o"), "runs.jsonl", ("tachk.simulation.tables:_columns",)),
    (("simulate", "m.ta", "-o"), "runs.parquet", ("pyarrow.parquet:ParquetWriter.write_table",)),
    (("simulate", "m.ta", "-o"), "run.vcd", ("vcd.writer:VCDWriter.change",)),
    (("simulate", "m.ta", "-o"), "run.run", ()),
    (("convert", "--force", "m.ta"), "model.json", ()),
    (("convert", "--force", "m.ta"), "model.fmu", ("zipfile:ZipFile.writestr",)),
    (("xrce", "decode", str(CAPTURE), "--signals"), "streams.parquet", ("pyarrow.parquet:write_table",)),
    (("chart", str(CAPTURE), "-o"), "chart.svg", ()),
]
CASES = [
    (arguments, file, moment, *((signal.SIGTERM, "old") if number % 2 else (signal.SIGINT, None)))
    for arguments, file, moments in WRITERS
    for number, moment in enumerate((BEGUN, *moments, NAMED))
]


@pytest.fixture(autouse=True)
def _as_the_program_takes_signals() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        pytest.skip("signals come to the main thread")
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    Termination().heed()
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def interrupt(monkeypatch: pytest.MonkeyPatch, moment: str, number: signal.Signals) -> None:
    """Lets the signal come when a function returns, or, for that which gives a file its name, when it is called."""
    module, _, path = moment.partition(":")
    *owners, name = path.split(".")
    owner: Any = importlib.import_module(module)
    for each in owners:
        owner = getattr(owner, each)
    function: Callable[..., Any] = getattr(owner, name)

    def interrupted(*arguments: Any, **named: Any) -> Any:
        if moment == NAMED:
            signal.raise_signal(number)
        result = function(*arguments, **named)
        signal.raise_signal(number)
        return result

    monkeypatch.setattr(owner, name, interrupted)


@pytest.mark.parametrize(("arguments", "file", "moment", "number", "before"), CASES)
def test_what_is_interrupted_leaves_what_was_there(
    arguments: tuple[str, ...],
    file: str,
    moment: str,
    number: signal.Signals,
    before: str | None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if "parquet" in file:
        pytest.importorskip("pyarrow.parquet")
    monkeypatch.chdir(tmp_path)
    Path("m.ta").write_text(MODEL, encoding="utf-8")
    if before is not None:
        Path(file).write_text(before, encoding="utf-8")
    there = sorted(tmp_path.iterdir())
    interrupt(monkeypatch, moment, number)
    with pytest.raises(SystemExit) as ended:
        app([*arguments, file], prog_name="tachk")
    assert ended.value.code == ExitStatus.INTERRUPTED
    # What a function had not returned yet when the signal came is removed when the program ends.
    remove_unfinished()
    assert sorted(tmp_path.iterdir()) == there
    if before is not None:
        assert Path(file).read_text(encoding="utf-8") == before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_store_has_cells_whole_or_not_at_all(number: signal.Signals, tmp_path: Path) -> None:
    path = tmp_path / "cells.db"
    row = dict.fromkeys(COLUMNS) | {"property": "reached", "answer": "holds"}

    class Interrupting(dict[str, Any]):
        def __getitem__(self, name: str) -> Any:
            signal.raise_signal(number)
            return super().__getitem__(name)

    with opened(path, ("N",), {}) as store:
        store.add((1,), [row], 0.5)
        with pytest.raises(KeyboardInterrupt):
            store.add((2,), [row, Interrupting(row)], 0.5)
    with opened(path, ("N",), {}) as store:
        assert store.finished() == {(1,)}
        assert len([*store.rows([(1,)])]) == 1
    assert [each.name for each in tmp_path.iterdir()] == ["cells.db"]
