"""Runs of units within this process."""

from __future__ import annotations

import os
from tempfile import NamedTemporaryFile

from tachk import _core
from tachk.engine.simulation.policy import Policy
from tachk.simulation.fmi.resource_file import resource_file
from tachk.simulation.fmi.unit import CoSimulationUnit, FmiType


def begin_run(unit: CoSimulationUnit, seed: int, policy: Policy) -> _core.UnitRun:
    """A run that has begun. Raises ValueError if there is no initial state."""
    with NamedTemporaryFile(suffix=".bin", delete=False) as file:
        file.write(resource_file(unit).content)
    try:
        run = _core.UnitRun(file.name)
    finally:
        os.unlink(file.name)
    names = [variable.name for variable in unit.variables]
    run.set_number(names.index("seed"), FmiType.NATURAL, seed)
    run.set_number(names.index("policy"), FmiType.ENUMERATION, list(Policy).index(policy))
    run.begin()
    return run
