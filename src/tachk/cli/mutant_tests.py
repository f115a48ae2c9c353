"""`tachk tests --cover mutants`: scripts of inputs with which changed systems fail."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from math import ceil
from pathlib import Path

from tachk.api.model import Model
from tachk.base.job import limited
from tachk.base.whole_files import write_whole
from tachk.cli.exit_status import ExitStatus
from tachk.engine.options import Limits
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.event_tables import event_rows
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.report.covering.mutants import mutants_to_json, mutants_to_text
from tachk.report.covering.replaying_file import pytest_file
from tachk.simulation.testing.mutant_suite import MutantSuite, Script, mutant_suite
from tachk.simulation.testing.mutants import system_mutants
from tachk.simulation.testing.tested_model import nanoseconds_of, replacing_map
from tachk.simulation.testing.tester import TestedModel
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.suite import CoveringSuite, covering_suite

_STATES, _STATES_OF_COVER = 20_000, 50_000
"""So many states a search of a test, and the search for runs that take all edges, store at most."""
_SECONDS_OF_COVER = 10.0
"""That search gives what it has found by then."""


def run_mutant_tests(
    model: Model,
    definitions: tuple[str, ...],
    folder: Path | None,
    states: int | None,
    seconds: float | None,
    form: str,
) -> tuple[ExitStatus, str]:
    """Finds the scripts and writes them; the exit status, and the report.

    Args:
        folder: None: nothing is written.
        states: that a search stores at most.
    """
    network, mapping = with_location_variables(model.network, replacing_map(model.loaded, model.path))
    tested = TestedModel.of(network, mapping, constants_of(model.loaded))
    uncertainty = mapping.allowances.uncertainty()
    with limited(seconds):
        limits_of_cover = Limits(states=states or _STATES_OF_COVER, seconds=_SECONDS_OF_COVER)
        edges = covering_suite(network, Coverage.EDGES, limits=limits_of_cover)
        mutants = tuple(system_mutants(network, mapping, ceil(uncertainty.width) + 1))
        limits = Limits(states=states or _STATES)
        never = {place for place, _ in edges.impossible}
        suite = mutant_suite(tested, mutants, _scripts(tested, edges), never, uncertainty, limits)
    files = [] if folder is None else _write(model, definitions, folder, suite)
    if form == "json":
        report = json.dumps(mutants_to_json(network, suite, model.path, files), indent=2) + "\n"
    else:
        report = mutants_to_text(network, suite, model.path, files)
    return ExitStatus.UNKNOWN if suite.untried or suite.is_at_limit else ExitStatus.AS_EXPECTED, report


def _scripts(model: TestedModel, suite: CoveringSuite) -> list[Script]:
    """The inputs of the runs of a suite."""
    return [script for each in suite.runs if (script := model.inputs_of(each.run))]


def _write(model: Model, definitions: tuple[str, ...], folder: Path, suite: MutantSuite) -> Sequence[str]:
    """Writes the scripts, and the file that plays them. Returns the names of the scripts."""
    stem, length = Path(model.path).stem, nanoseconds_of(model.network.time_unit)
    names = []
    for number, script in enumerate(suite.scripts, start=1):
        names.append(f"{stem}-mutants-{number}.jsonl")
        write_whole(folder / names[-1], "".join(event_rows(script.recording, length)))
    path = os.path.relpath(model.path, folder).replace(os.sep, "/")
    write_whole(folder / "test_mutants.py", pytest_file(path, definitions, [], names, names))
    return names
