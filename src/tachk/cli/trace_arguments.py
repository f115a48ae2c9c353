"""The arguments that `tachk monitor` and `tachk plot` share, and the exit status for their verdicts."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass

from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus
from tachk.recordings.monitors.formulas import NamedFormula, check_order, read_formulas
from tachk.recordings.monitors.offline import selected
from tachk.recordings.traces.logs.joined import with_decimals
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import TraceSource
from tachk.recordings.traces.trace_files import open_trace


@dataclass(frozen=True, slots=True)
class TraceArguments:
    """A trace and the formulas that are evaluated on it.

    Attributes:
        formula: a formula, a sentence, or the path of a file of formulas or of a model.
        trace: a path, or ``-`` for standard input.
        others: further paths, whose columns are joined to it.
        time, unit, ports: as of `open_trace`.
        names: of the formulas that are taken; none: all.
        definitions: values of constants, as ``T=2.5``.
        decimals: the number of decimals to which times are rounded; None: not rounded, but see `tachk.monitor`.
        run: the number of one run in a file of several; None: all runs.
        called: the name of the trace in reports; None: the name of its file.
    """

    formula: str
    trace: str
    others: tuple[str, ...] = ()
    time: str | None = None
    unit: str | None = None
    ports: tuple[int, ...] = ()
    names: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()
    decimals: int | None = None
    run: int | None = None
    called: str | None = None

    def formulas(self) -> tuple[NamedFormula, ...]:
        """Raises InputError, UsageError."""
        check_order(self.formula, self.trace)
        return selected(read_formulas(self.formula, parse_definitions(self.definitions)), self.names)

    def recording(self) -> TraceSource:
        """Raises InputError, UsageError."""
        source = [self.trace, *self.others] if self.others else self.trace
        return with_decimals(open_trace(source, self.time, self.unit, self.ports, self.run), self.decimals)


def print_warnings(warnings: Iterable[str]) -> None:
    """Prints the warnings about a trace that could be read."""
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)


def exit_status(truths: set[Truth]) -> ExitStatus:
    """The exit status of the command for these verdicts."""
    if Truth.FALSE in truths:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if Truth.UNDETERMINED in truths else ExitStatus.AS_EXPECTED
