"""`tachk explain`."""

from __future__ import annotations

import difflib

from tachk.cli.exit_status import ExitStatus
from tachk.diagnostics.codes import CODES, explain
from tachk.diagnostics.diagnostic import UsageError


def run_explain(code: str) -> ExitStatus:
    """Prints what the code of a message means."""
    text = explain(code)
    if text is None:
        close = difflib.get_close_matches(code.upper(), CODES, n=3)
        help = f"did you mean {' or '.join(close)}?" if close else "a code is a letter and four digits, such as E0101"
        raise UsageError(f"no message has the code {code}", help)
    print(text)
    return ExitStatus.AS_EXPECTED
