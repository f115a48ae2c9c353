"""A plain command line of `tachk verify` means without click what it means with it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from random import Random

import click
import pytest

from tachk.cli import plain_options
from tachk.cli.commands.verify import command
from tachk.cli.plain_options import Kind, plain_values
from tachk.cli.verification import requested
from tachk.report.run_formats import RUN_FORMATS
from tests.support.seeds import seeds

ROWS = {each.parameter: each for each in vars(plain_options).values() if isinstance(each, plain_options.PlainOption)}

PLAIN = (
    *(["m.ta"], ["there.ta"], ["A[] not deadlock"], ["E<> P.b -> 1"], ["with space.ta"], [""]),
    *(["-D", "N=3"], ["--define", "N = 1, M=2"], ["--property", "p"], ["-q", "there.ta"], ["--queries", "no.q"]),
    *(["--format", form] for form in RUN_FORMATS),
    ["--quiet"],
)
OTHERS = (
    *(["--format=json"], ["--format", "xml"], ["--format"], ["--forma", "json"], ["-DN=3"], ["-D"], ["-D", "-1"]),
    *(["--"], ["-"], ["--help"], ["-h"], ["--non-zeno"], ["--search", "dfs"], ["--property"], ["-j", "2"], ["--no"]),
    *(["-o", "there.ta"], ["--quiet=1"], ["-q", "--quiet"], ["--trace", "shortest"], ["-qthere.ta"]),
)


def with_click(words: list[str]) -> Sequence[object] | None:
    """The arguments of the command; None where it refuses them or answers at once, as with ``--help``."""
    try:
        with command.make_context("verify", list(words)) as context:
            return requested(context.params)
    except (click.ClickException, click.exceptions.Exit):
        return None


@pytest.mark.parametrize("seed", seeds(range(20)))
def test_plain_words_are_read_as_click_reads_them(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("there.ta").touch()
    random = Random(seed)
    for _ in range(50):
        pieces = random.choices(PLAIN, k=random.randint(0, 6))
        with_others = random.random() < 0.3
        if with_others:
            pieces += random.choices(OTHERS, k=random.randint(1, 2))
            random.shuffle(pieces)
        words = [word for piece in pieces for word in piece]
        given = plain_values(words, RUN_FORMATS)
        if given is not None:
            assert requested(given) == with_click(words)
        elif not with_others:
            assert with_click(words) is None, words
    capsys.readouterr()


def test_a_file_that_may_not_be_read_is_left_to_click(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = tmp_path / "m.ta"
    model.touch()
    assert plain_values([str(model)], RUN_FORMATS) == {"arguments": (str(model),)}
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    assert plain_values([str(model)], RUN_FORMATS) is None
    assert plain_values(["m.ta", "-q", str(model)], RUN_FORMATS) is None
    assert plain_values(["no.ta"], RUN_FORMATS) == {"arguments": ("no.ta",)}


@pytest.mark.parametrize("parameter", ROWS)
def test_the_command_has_the_plain_options(parameter: str) -> None:
    row, option = ROWS[parameter], next(each for each in command.params if each.name == parameter)
    assert isinstance(option, click.Option)
    assert tuple(option.opts) == row.names
    assert (option.is_flag, option.multiple) == (row.kind is Kind.FLAG, row.several)
    assert isinstance(option.type, click.Path) == (row.kind is Kind.FILE)


def start(*words: str, cwd: Path) -> tuple[int, str, str]:
    done = subprocess.run(
        [sys.executable, "-m", "tachk", *words], cwd=cwd, capture_output=True, text=True, check=False, timeout=60
    )
    return done.returncode, re.sub(r"[\d.]+ ([kM]i?B|m?s)\b", r"? \1", done.stdout, flags=re.IGNORECASE), done.stderr


MODEL = """process P() { clock x; init location a { to b { guard x >= 1; } } location b; }
system P;
property p : A[] not P.b;
"""


@pytest.mark.parametrize(
    "words",
    [
        ["m.ta", "--format", "verifyta"],
        ["m.ta", "m.ta", "--format", "verifyta"],
        ["m.ta", "--property", "q"],
        ["m.ta", "-D", "N=1"],
        ["no.ta"],
        ["m.ta", "E<> P.c"],
        ["m.ta", "E<> P.b", "--quiet"],
        ["wrong.ta", "m.ta"],
    ],
)
def test_the_program_answers_the_same_with_and_without_click(words: list[str], tmp_path: Path) -> None:
    """Click reads ``--engine``, which says here what holds without it."""
    (tmp_path / "m.ta").write_text(MODEL, encoding="utf-8")
    (tmp_path / "wrong.ta").write_text("system Q;", encoding="utf-8")
    plain = start("verify", *words, cwd=tmp_path)
    assert plain == start("verify", "--engine", "zone", *words, cwd=tmp_path)
    assert "Traceback" not in plain[2]
