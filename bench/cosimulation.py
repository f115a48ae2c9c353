"""Units for co-simulation: `python -m bench.cosimulation agree NETWORKS SEED` and `python -m bench.cosimulation speed`.

`agree` makes units of random networks for both versions of FMI, has FMPy validate and simulate them with several step
sizes, and compares every run with that of the simulator; it prints every disagreement with the seed that reproduces it,
and ends with status 1 after one. `speed` drives units through the C interface alone, without FMPy.
"""

from __future__ import annotations

import ctypes
import sys
import tempfile
import time
from pathlib import Path
from random import Random
from xml.etree import ElementTree

from random_agreement import SHAPES

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, SimulationOptions
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.unit import closed_unit
from tests.support import random_case
from tests.support.simulated.cosimulated import Driving, disagreements, extract

MODELS = (
    ("models/classics/train_gate.ta", {"N": 6}, 100_000.0),
    ("models/classics/fischer.ta", {"N": 6}, 100_000.0),
    ("models/micro_xrce_dds/paper.ta", {}, 300_000.0),
)

STEPS = tuple(TICKS_PER_UNIT * numerator // denominator for numerator, denominator in ((1, 1), (3, 10), (7, 5), (5, 1)))


def agree(count: int, seed: int) -> int:
    compared, wrong = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(seed, seed + count):
            random = Random(number)
            network = random_case(random, SHAPES[number % len(SHAPES)]).network
            policy = random.choice(list(Policy))
            drawing = SimulationOptions(number, 20 * TICKS_PER_UNIT, policy, steps=100)
            drivings = [Driving(FmiVersion.THREE, random.choice(STEPS), True)]
            drivings += [Driving(version, random.choice(STEPS), False) for version in FmiVersion]
            try:
                found = list(disagreements(network, drawing, number % 7, drivings, Path(folder)))
            except (UnsupportedError, InputError):
                continue
            compared += 1
            wrong += bool(found)
            for difference in found:
                print(f"seed {number}, {policy}: {difference}")
    print(f"{compared} of {count} networks are simulated, each in three ways; {wrong} disagree")
    return min(wrong, 1)


def speed() -> None:
    for path, constants, seconds in MODELS:
        network = tachk.load(path, **constants).network
        with tempfile.TemporaryDirectory() as folder:
            extracted = extract(closed_unit(network, "unit"), FmiVersion.THREE, Path(folder))
            events, used = max((_events(extracted, seconds) for _ in range(3)), key=lambda found: found[0] / found[1])
        print(f"{path}: {events / used / 1e3:.0f} thousand events/s ({events} events)")


def _events(extracted: str, seconds: float) -> tuple[int, float]:
    """How many events a unit has up to a time, each with a step and event mode of its own, and how long that takes."""
    (binary,) = Path(extracted).glob("binaries/*/unit.*")
    library = ctypes.CDLL(str(binary))
    token = ElementTree.parse(f"{extracted}/modelDescription.xml").getroot().attrib["instantiationToken"]
    library.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
    names = (b"unit", token.encode(), f"{extracted}/resources/".encode())
    made = library.fmi3InstantiateCoSimulation(*names, False, False, True, True, None, 0, None, None, None)
    assert made
    unit, zero, end = ctypes.c_void_p(made), ctypes.c_double(), ctypes.c_double(seconds)
    library.fmi3EnterInitializationMode(unit, False, zero, zero, False, zero)
    library.fmi3ExitInitializationMode(unit)
    again, over, early = ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool()
    flags = [ctypes.byref(flag) for flag in (again, over, ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool())]
    next_time, here = ctypes.c_double(), ctypes.c_double()
    told = [*flags[:2], ctypes.byref(early), ctypes.byref(here)]
    update, step, event, go_on = (
        getattr(library, f"fmi3{name}")
        for name in ("UpdateDiscreteStates", "EnterStepMode", "EnterEventMode", "DoStep")
    )
    events, began, until = 0, time.process_time(), ctypes.byref(next_time)
    while not over.value:
        update(unit, *flags, until)
        events += 1
        if again.value:
            continue
        step(unit)
        go_on(unit, here, ctypes.c_double(seconds - here.value), False, *told)
        if not early.value:
            break
        event(unit)
    used = time.process_time() - began
    assert here.value == end.value or over.value
    library.fmi3FreeInstance(unit)
    return events, used


def main(arguments: list[str]) -> int:
    match arguments:
        case ["agree", count, seed]:
            return agree(int(count), int(seed))
        case ["speed"]:
            speed()
            return 0
        case _:
            print(__doc__)
            return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
