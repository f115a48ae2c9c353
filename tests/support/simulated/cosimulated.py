"""Units for co-simulation, driven by FMPy, against the simulator."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from zipfile import ZipFile

import fmpy
from fmpy.model_description import ModelDescription
from fmpy.validation import validate_fmu

from tachk.base.records import dataclass
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationEnding, SimulationOptions
from tachk.model.network import Network
from tachk.simulation.columns import all_columns
from tachk.simulation.fmi.archive import write_unit
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.unit import CoSimulationUnit, Role, closed_unit
from tachk.simulation.runs import Runs

_ROUNDING = 1e-7

Rows = list[tuple[int, tuple[int | float, ...]]]
"""Values of all columns at moments in ticks."""


@dataclass(frozen=True, slots=True)
class Driving:
    """How FMPy drives a unit.

    Attributes:
        step: between its communication points, in ticks.
        events: event mode with early return, in version 3.
    """

    version: FmiVersion
    step: int
    events: bool


def disagreements(
    network: Network, drawing: SimulationOptions, run: int, drivings: Sequence[Driving], folder: Path
) -> Iterator[str]:
    """What is different between a run of the simulator and the same run of a unit, and what FMPy finds wrong."""
    unit = closed_unit(network, "random")
    native, end, stop = native_rows(network, drawing, run)
    for version in FmiVersion:
        extracted = extract(unit, version, folder)
        yield from validate_fmu(extracted)
        known = fmpy.read_model_description(extracted, validate=False)
        for driving in drivings:
            if driving.version is not version or end <= 0:
                continue
            found = unit_rows(unit, extracted, known, driving, drawing, run, (end, stop))
            expected = lasting(native) if driving.events else sampled(native, driving.step, end)
            if found != expected:
                at = next((n for n, (a, b) in enumerate(zip(found, expected, strict=False)) if a != b), "the end")
                yield f"{driving}: {len(found)} and {len(expected)} rows, different at {at}"


def extract(unit: CoSimulationUnit, version: FmiVersion, folder: Path) -> str:
    """The folder of a unit. A library that is there already stays: it may be loaded, and is the same for all units."""
    folder.mkdir(exist_ok=True)
    path = folder / f"unit{version}.fmu"
    write_unit(unit, version, path)
    extracted = folder / version
    with ZipFile(path) as archive:
        for name in archive.namelist():
            if not (extracted / name).exists() or not name.startswith("binaries"):
                archive.extract(name, extracted)
    return str(extracted)


def native_rows(network: Network, drawing: SimulationOptions, run: int) -> tuple[Rows, int, int]:
    """The rows of a run of the simulator, where they end, and until when a unit may be asked to go on.

    Of a run that is cut off rows end between two instants. Behind a deadlock a unit stops by itself.
    """
    runs = Runs(network, all_columns(network))
    (drawn,) = runs.draw(drawing, range(run, run + 1), RecordedChanges(observed=True))
    rows: Rows = [
        (time, tuple(values)) for time, values in zip(drawn.times.tolist(), drawn.observed.tolist(), strict=True)
    ]
    end = stop = drawn.end
    if drawn.ending in (SimulationEnding.STEPS, SimulationEnding.FAULT, SimulationEnding.ZENO):
        end = stop = _gap(sorted({time for time, _ in rows}))
    elif drawn.ending is not SimulationEnding.HORIZON:
        stop += TICKS_PER_UNIT
    return [row for row in rows if row[0] <= end], end, stop


def _gap(times: Sequence[int]) -> int:
    """The middle of the last gap that FMPy does not take for rounding."""
    for before, after in reversed(list(pairwise(times))):
        if after - before > _ROUNDING * after:
            return (before + after) // 2
    return 0


def lasting(rows: Rows) -> Rows:
    """The last row of each instant, if it differs from the one before."""
    result: Rows = []
    for time, values in dict(rows).items():
        if not result or result[-1][1] != values:
            result.append((time, values))
    return result


def sampled(rows: Rows, step: int, end: int) -> Rows:
    """What can be seen at the communication points: at first the initial state, then what lasts at each."""
    seen = rows[:1]
    for point in (*range(step, end, step), end):
        seen.append((point, [values for time, values in rows if time <= point][-1]))
    return lasting(seen)


def unit_rows(
    unit: CoSimulationUnit,
    extracted: str,
    known: ModelDescription,
    driving: Driving,
    drawing: SimulationOptions,
    run: int,
    until: tuple[int, int],
) -> Rows:
    """The rows that FMPy records of a unit, up to both times that `native_rows` tells."""
    end, stop = until
    result = fmpy.simulate_fmu(
        extracted,
        validate=False,
        stop_time=float(stop / unit.second),
        output_interval=float(driving.step / unit.second),
        start_values={"seed": drawing.seed, "run": run, "policy": list(Policy).index(drawing.policy)},
        use_event_mode=driving.events,
        early_return_allowed=driving.events,
        model_description=known,
    )
    names = [variable.name for variable in unit.variables if variable.role is Role.OBSERVED]
    rows: Rows = []
    for record in result:
        time = min(round(Fraction(float(record["time"])) * unit.second), end)
        rows.append((time, tuple(record[name].item() for name in names)))
    return lasting(rows)
