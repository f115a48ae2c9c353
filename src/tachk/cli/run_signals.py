"""The signals of a single run: evaluated and written."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from tachk.base.whole_files import write_whole
from tachk.meaning.run_view import RunNames
from tachk.model.run import TimedTrace
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.formulas import columns_with, truths_on
from tachk.simulation.stepping import run_scenario
from tachk.simulation.stepping.run_file import SUFFIX, run_text
from tachk.simulation.stepping.signals import signals_of
from tachk.simulation.tables import run_writer
from tachk.syntax.printing.scenario_text import scenario_name


def write_run(
    output: Path,
    names: RunNames,
    run: TimedTrace,
    record: Sequence[str],
    formulas: Sequence[NamedFormula],
    model: str,
    constants: Mapping[str, int],
) -> None:
    """Writes the signals of a run, those of the formulas besides the chosen ones, its steps into a .run file, or its
    events as a scenario into a .ta file.

    Says so if the file cannot hold the times. Raises UsageError for an unknown ending.
    """
    if output.suffix.lower() == SUFFIX:
        write_whole(output, run_text(names, run, [f"a run of {model}"], constants))
        return
    if output.suffix.lower() == run_scenario.SUFFIX:
        write_whole(output, run_scenario.scenario_of_run(names, run, scenario_name(output)))
        return
    recorded = signals_of(names, columns_with(names.network, record, formulas), run, str(output), decimal_times=True)
    if not recorded.exact:
        print(f"{output}: times are rounded down to 1e-9 time units", file=sys.stderr)
    with run_writer(output) as write:
        write(0, recorded.trace)


def evaluated_run(names: RunNames, run: TimedTrace, formulas: tuple[NamedFormula, ...], name: str) -> dict[str, Truth]:
    """The verdict of each formula."""
    if not formulas:
        return {}
    return truths_on(signals_of(names, columns_with(names.network, (), formulas), run, name).trace, formulas)
