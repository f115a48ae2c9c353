"""The report on a test suite that kills mutants of a system."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tachk.model.network import Network
from tachk.model.quantity import duration, grouped
from tachk.report.covering.names import counted, listed, place_text
from tachk.simulation.testing.mutant_suite import MutantSuite, SuiteScript
from tachk.simulation.testing.mutants import SystemMutant
from tachk.verify.covering.coverage import Coverage


def mutant_text(network: Network, mutant: SystemMutant) -> str:
    """``Lamp: Off -> On: bound larger (x >= 3 by 1)``"""
    if mutant.edge is not None:
        place = place_text(network, Coverage.EDGES, (mutant.process, mutant.edge))
    else:
        assert mutant.location is not None
        place = place_text(network, Coverage.LOCATIONS, (mutant.process, mutant.location))
    return f"{place}: {mutant.operator.value}" + (f" ({mutant.detail})" if mutant.detail else "")


def mutants_to_text(network: Network, suite: MutantSuite, model: str, files: Sequence[str]) -> str:
    """How many mutants the scripts kill, and which survive.

    Args:
        files: the name of each script; empty if none is written.
    """
    return "".join(f"{line}\n" for line in _lines(network, suite, model, files))


def _lines(network: Network, suite: MutantSuite, model: str, files: Sequence[str]) -> Iterator[str]:
    inputs = sum(script.inputs for script in suite.scripts)
    yield (
        f"{model}: {counted(len(suite.scripts), 'script')} with {counted(inputs, 'input')} "
        f"{'kills' if len(suite.scripts) == 1 else 'kill'} {grouped(suite.killed)} of "
        f"{counted(len(suite.mutants), 'mutant')}"
    )
    for number, script in enumerate(suite.scripts):
        yield f"  {files[number] if files else f'script {number + 1}'}: {_script_text(network, script)}"
    if suite.equivalent:
        yield f"equivalent to the system, since no run takes their edge: {grouped(len(suite.equivalent))}"
    names = [mutant_text(network, mutant) for mutant in suite.mutants]
    yield from listed(f"survived {grouped(suite.tests)} tests:", [names[each] for each in suite.survived])
    yield from listed(
        "neither killed nor passed by all tests:", [f"{names[each]}: {reason}" for each, reason in suite.inconclusive]
    )
    yield from listed("cannot stand for the system:", [f"{names[each]}: {reason}" for each, reason in suite.unusable])
    yield from listed("not tried, as the time was over:", [names[each] for each in suite.untried])


def _script_text(network: Network, script: SuiteScript) -> str:
    end = duration(script.recording.end, network.time_unit)
    return f"{counted(script.inputs, 'input')}, to {end}, {counted(len(script.kills), 'more mutant')}"


def mutants_to_json(network: Network, suite: MutantSuite, model: str, files: Sequence[str]) -> dict[str, Any]:
    """One object, as docs/schema/mutant_tests.schema.json describes it."""
    by = {number: place for place, script in enumerate(suite.scripts) for number in script.kills}
    inconclusive, unusable = dict(suite.inconclusive), dict(suite.unusable)
    groups = {
        "killed": by,
        "equivalent": suite.equivalent,
        "inconclusive": inconclusive,
        "unusable": unusable,
        "untried": suite.untried,
    }

    def row(number: int, mutant: SystemMutant) -> dict[str, Any]:
        result = next((word for word, numbers in groups.items() if number in numbers), "survived")
        return {
            "name": mutant_text(network, mutant),
            "operator": mutant.operator.value,
            "result": result,
            "script": by.get(number),
            "reason": inconclusive.get(number, unusable.get(number, "")),
        }

    return {
        "model": model,
        "time_unit": network.time_unit,
        "cover": "mutants",
        "count": len(suite.mutants),
        "killed": suite.killed,
        "tests": suite.tests,
        "scripts": [
            {
                "file": files[number] if files else "",
                "inputs": script.inputs,
                "end": str(script.recording.end),
                "kills": [mutant_text(network, suite.mutants[each]) for each in script.kills],
            }
            for number, script in enumerate(suite.scripts)
        ],
        "mutants": [row(number, mutant) for number, mutant in enumerate(suite.mutants)],
    }
