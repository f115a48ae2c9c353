"""What both ways of monitoring share: the options and the exit status."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tachk.cli.exit_status import ExitStatus
from tachk.runtime.node_signal import Truth


@dataclass(frozen=True, slots=True)
class MonitorRequest:
    """The options of the command as they were given."""

    formula: str
    trace: str
    time: str | None = None
    unit: str | None = None
    end: str = "undetermined"
    names: tuple[str, ...] = ()
    robustness: bool = True
    online: bool = False
    follow: bool = False
    decimals: int | None = None
    format: str = "text"
    output: Path | None = None
    quiet: bool = False
    interpolation: str = "constant"
    time_robustness: bool = False


def exit_status(truths: set[Truth]) -> ExitStatus:
    """What the verdicts mean for the status of the command."""
    if Truth.FALSE in truths:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if Truth.UNDETERMINED in truths else ExitStatus.AS_EXPECTED
