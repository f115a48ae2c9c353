"""A command writes to none of the files that it reads, and to each file once."""

from __future__ import annotations

from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from tachk.cli.main import COMMANDS, app, load_command
from tachk.cli.options import WrittenFile

MODEL = """
process P() { clock x; init location A { invariant x <= 2; to B { guard x >= 1; } } location B; }
system P;
property soon : F[0, 3] P.B;
"""
TRACE = "time,P\n0,A\n2,B\n"
OTHERS = {"convert -o"}
"""Options that overwrite nothing: `convert` refuses a file with other contents itself."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    (tmp_path / "m.ta").write_text(MODEL)
    (tmp_path / "t.csv").write_text(TRACE)
    (tmp_path / "q.q").write_text("E<> P.B\n")
    (tmp_path / "link.ta").symlink_to("m.ta")
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        "verify m.ta --junit m.ta",
        "verify m.ta --format json -o sub/../m.ta",
        "verify m.ta --sarif link.ta",
        "verify m.ta --certificate m.ta",
        "verify m.ta -q q.q -o q.q",
        "verify m.ta --junit new.xml --sarif ./new.xml",
        "check m.ta --sarif m.ta",
        "report m.ta -o m.ta",
        "time m.ta --to P.B -o m.ta",
        "simulate m.ta -o m.ta",
        "step m.ta -o m.ta",
        "monitor m.ta t.csv --unit s -o t.csv",
        "monitor m.ta t.csv --signals t.csv",
    ],
)
def test_a_file_that_is_read_is_not_overwritten(arguments: str, folder: Path) -> None:
    before = {path: path.read_text() for path in folder.iterdir() if path.is_file()}
    result = CliRunner().invoke(app, arguments.split())
    assert result.exit_code == 2
    assert "would overwrite a file that it reads" in result.stderr
    assert {path: path.read_text() for path in folder.iterdir() if path.is_file()} == before


@pytest.mark.parametrize(
    "arguments",
    [
        "verify m.ta --junit new.xml --sarif new.sarif -o new.txt",
        "verify m.ta --junit /dev/null --sarif /dev/null",
        "report m.ta -o t.csv",
    ],
)
def test_other_files_are_written(arguments: str, folder: Path) -> None:
    assert CliRunner().invoke(app, arguments.split()).exit_code == 0


def test_options_that_name_outputs_are_of_this_kind() -> None:
    outputs = {"-o", "--junit", "--sarif", "--certificate", "--chart", "--plot", "--heat-map", "--signals"}
    for name in COMMANDS:
        for parameter in load_command(name).params:
            if isinstance(parameter, click.Option) and outputs & {*parameter.opts}:
                known = {f"{name} {option}" for option in parameter.opts} & OTHERS
                assert isinstance(parameter.type, WrittenFile) != bool(known), f"{name} {parameter.opts}"
