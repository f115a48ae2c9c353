from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UnsupportedError, UsageError
from tachk.base.span import Source, Span
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded

FINDING = Diagnostic("E0101", "something is odd", Span(Source("m.ta", "chan c\n"), 0, 4))
REFUSED = Diagnostic("E0750", "floating point is refused", FINDING.span)
WARNING = Diagnostic("W0401", "something is unusual", FINDING.span)


def raising(error: BaseException) -> ExitStatus:
    raise error


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (InputError([FINDING]), ExitStatus.BAD_INPUT, "m.ta:1:1: error[E0101]: something is odd"),
        (InputError([REFUSED, WARNING]), ExitStatus.UNSUPPORTED, "error[E0750]: floating point is refused"),
        (InputError([REFUSED, FINDING]), ExitStatus.BAD_INPUT, "error[E0101]: something is odd"),
        (UnsupportedError(FINDING), ExitStatus.UNSUPPORTED, "m.ta:1:1: error[E0101]: something is odd"),
        (UsageError("no such thing", "look elsewhere"), ExitStatus.BAD_INPUT, "help: look elsewhere"),
        (FileNotFoundError(2, "No such file", "gone"), ExitStatus.BAD_INPUT, "error: gone: No such file"),
        (KeyboardInterrupt(), ExitStatus.INTERRUPTED, "error: interrupted"),
        (ZeroDivisionError(), ExitStatus.INTERNAL_ERROR, "please report it"),
    ],
)
def test_errors_become_messages_and_statuses(
    error: BaseException, status: ExitStatus, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert guarded(lambda: raising(error)) is status
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.out == ""
    assert ("Traceback" in captured.err) is (status is ExitStatus.INTERNAL_ERROR)


def test_a_usage_error_names_the_model_it_is_about(capsys: pytest.CaptureFixture[str]) -> None:
    guarded(lambda: raising(UsageError("no constant N")), "a.ta")
    assert capsys.readouterr().err == "error: a.ta: no constant N\n"


def test_too_many_findings_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    guarded(lambda: raising(InputError([*(replace(WARNING, message=f"warning {n}") for n in range(30)), FINDING])))
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].endswith("something is odd")
    assert lines[-1] == "... and 11 more"


def test_an_unwritable_report_is_a_usage_matter(tmp_path: Path) -> None:
    assert guarded(lambda: raising(PermissionError(13, "Permission denied", str(tmp_path)))) is ExitStatus.BAD_INPUT


def test_the_gravest_status_wins() -> None:
    assert worst([]) is ExitStatus.AS_EXPECTED
    assert worst([ExitStatus.AS_EXPECTED, ExitStatus.UNKNOWN]) is ExitStatus.UNKNOWN
    assert worst([ExitStatus.NOT_AS_EXPECTED, ExitStatus.UNKNOWN]) is ExitStatus.NOT_AS_EXPECTED
    assert worst([ExitStatus.NOT_AS_EXPECTED, ExitStatus.UNSUPPORTED]) is ExitStatus.NOT_AS_EXPECTED
    assert worst([ExitStatus.UNKNOWN, ExitStatus.UNSUPPORTED]) is ExitStatus.UNSUPPORTED
    assert worst([ExitStatus.BAD_INPUT, ExitStatus.NOT_AS_EXPECTED]) is ExitStatus.BAD_INPUT
    assert worst([ExitStatus.BAD_INPUT, ExitStatus.UNSUPPORTED]) is ExitStatus.BAD_INPUT
    assert worst([*ExitStatus][:-2]) is ExitStatus.INTERNAL_ERROR
    assert worst(list(ExitStatus)) is ExitStatus.INTERRUPTED
