"""What simulated runs are written to: their signals, or their steps."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from tachk.api.model import Model
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import write_whole
from tachk.engine.simulation.simulator import Simulated
from tachk.meaning.run_view import RunNames
from tachk.simulation.runs import Runs, steps_of
from tachk.simulation.stepping.run_file import SUFFIX, steps_text
from tachk.simulation.tables import RUN, run_writer

Write = Callable[[Simulated, Runs], None]


def holds_steps(output: Path | None) -> bool:
    """Whether a file is one of steps, for which the actions of runs have to be recorded."""
    return output is not None and output.suffix.lower() == SUFFIX


@contextmanager
def run_files(output: Path, model: Model, chosen: Collection[str], runs: int) -> Iterator[Write]:
    """What writes runs.

    Args:
        chosen: the constants that were given another value.
        runs: how many runs there are.

    Raises UsageError for an unknown ending, and for one file of several runs where it can hold one.
    """
    if not holds_steps(output):
        with run_writer(output) as write:
            yield lambda run, drawn: write(run.number, drawn.trace(run))
        return
    if RUN not in output.name and runs > 1:
        help = f"write {output.stem}-{RUN}{SUFFIX} for a file for each run"
        raise UsageError(f"{output}: a file of steps holds one run", help)
    names = RunNames(model.network)
    constants = {name: value for name, value in model.constants.items() if name in chosen}

    def write_steps(run: Simulated, drawn: Runs) -> None:
        heading = [f"run {run.number} of {model.path}, which ends with: {run.ending}"]
        text = steps_text(names, steps_of(run), heading, constants)
        write_whole(output.with_name(output.name.replace(RUN, str(run.number))), text)

    yield write_steps
