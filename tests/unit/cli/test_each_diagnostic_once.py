"""Each diagnostic is printed once, on standard error or in the report that stands beside it."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from tachk.cli.main import app

MODEL = """int n; double d = 0.5; const int K = 1;
process P() { clock x = 2.5; init location A { invariant x <= 5; to A { guard x >= 5; assign x = 0, d = d + 1; } } }
system P;
property q : A[] P.A;
property z : A[] n < 3;
"""
REFUSED = "error[E0750]: an initial value of a clock that is not an integer is not supported"
WARNED = "warning[W0406]: tachk does not check the floating point variable `d`"


def printed(*arguments: str) -> tuple[int, int, int]:
    """The exit status, and how often the refusal and the warning are printed, in all."""
    found = CliRunner().invoke(app, list(arguments))
    return found.exit_code, found.output.count(REFUSED), found.output.count(WARNED)


@pytest.fixture
def model(tmp_path: Path) -> str:
    path = tmp_path / "a.ta"
    path.write_text(MODEL, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    "options",
    [
        ("verify",),
        ("verify", "--property", "q"),
        ("verify", "--quiet"),
        ("verify", "--engine", "smt"),
        ("verify", "A[] n < 2"),
        ("verify", "A[] d < 2"),  # refused for another reason, and the model is still refused
        ("check",),
        ("check", "--deep"),
        ("check", "--for", "uppaal-5.0"),
        ("sweep", "--over", "K=0..1"),
        ("synthesize", "--over", "K=0..1", "--property", "q"),
        ("time", "P.A"),
        ("convert", "--format", "xta"),
        ("step",),
    ],
    ids=" ".join,
)
def test_each_diagnostic_once(model: str, options: tuple[str, ...]) -> None:
    status, refused, warned = printed(options[0], model, *options[1:])
    assert refused <= 1
    assert warned <= 1
    assert status != 70
    if options[0] in ("verify", "check", "synthesize", "sweep"):
        assert (refused, warned) == (1, 1)


def test_report_in_a_file_and_messages_on_screen(model: str, tmp_path: Path) -> None:
    """Both are read: one of them is for somebody who is not there."""
    for form in ("text", "json", "junit"):
        report = tmp_path / f"report.{form}"
        assert printed("verify", model, "--format", form, "-o", str(report))[1:] == (1, 1)
        assert "E0750" in report.read_text(encoding="utf-8")


def test_properties_that_are_rejected_for_one_reason(model: str) -> None:
    assert "\nq, z cannot be checked:\n" in CliRunner().invoke(app, ["verify", model]).output


def test_two_files_have_their_own_diagnostics(model: str, tmp_path: Path) -> None:
    other = tmp_path / "b.ta"
    other.write_text(MODEL, encoding="utf-8")
    assert printed("verify", model, str(other))[1:] == (2, 2)
    assert printed("verify", model)[1:] == (1, 1)  # another call begins anew
