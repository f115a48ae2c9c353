"""Exit statuses of a query file in which some queries are checked and others cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import RunReporting
from tachk.cli.verification import VerifyArguments, run_verify
from tachk.engine.options import Limits

QUIET = RunReporting(quiet=True)
MODEL = "int n = 0; process P() { init location A { to B { assign n = 1; } } location B; } system P;"


@pytest.mark.parametrize(
    ("queries", "status"),
    [
        ("E<> n == 1", ExitStatus.AS_EXPECTED),
        ("E<> n == 1\nE<> sin(n) < 1", ExitStatus.UNSUPPORTED),
        ("E<> n == 1\nE<> nobody == 1", ExitStatus.BAD_INPUT),
        ("E<> sin(n) < 1\nE<> nobody == 1", ExitStatus.BAD_INPUT),
        ("E<> n == 1\nE<> deadlock + 1 == 1", ExitStatus.UNSUPPORTED),
        ("Pr[<=10](<> n == 1)", ExitStatus.AS_EXPECTED),
        ("Pr[<=10](<> n == 1) >= 0.9", ExitStatus.AS_EXPECTED),
        ("Pr[<=10](<> n == 2) >= 0.9", ExitStatus.NOT_AS_EXPECTED),
        ("Pr[<=10](<> deadlock)", ExitStatus.UNSUPPORTED),
        ("Pr[<=10](<> nobody)", ExitStatus.BAD_INPUT),
        ("control: A[] n == 0", ExitStatus.UNSUPPORTED),
        ("A[] n == 0\nE<> sin(n) < 1", ExitStatus.NOT_AS_EXPECTED),
    ],
)
def test_a_query_that_is_not_checked_counts_although_others_were(
    queries: str, status: ExitStatus, tmp_path: Path
) -> None:
    model, file = tmp_path / "m.ta", tmp_path / "m.q"
    model.write_text(MODEL)
    file.write_text(f"{queries}\n")
    assert run_verify(VerifyArguments((str(model),), (file,)), reporting=QUIET) is status


def test_one_unknown_answer_beside_others_is_unknown(tmp_path: Path) -> None:
    model, file = tmp_path / "m.ta", tmp_path / "m.q"
    model.write_text(MODEL)
    file.write_text("E<> n == 0\nA[] n <= 1\n")
    asked = VerifyArguments((str(model),), (file,))
    assert run_verify(asked, limits=Limits(depth=0), reporting=QUIET) is ExitStatus.UNKNOWN
