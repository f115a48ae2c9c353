"""Files with submitted runs, of either form, and their model."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import exact_number
from tachk.base.words import Direction
from tachk.engine.compiler.hybrid import refuse_hybrid
from tachk.formats.written_reports import json_object
from tachk.model.expressions import Call
from tachk.model.network import Network
from tachk.model.traversal import process_expressions, walk, with_bodies
from tachk.simulation.stepping.run_file import SUFFIX, read_run_file
from tachk.simulation.stepping.submitted import SubmittedMove, SubmittedRun, SubmittedState, SubmittedStep
from tachk.syntax.source_files import LARGEST_RUN, read_source

_HOW = "tachk verify MODEL --property NAME --format json -o TRACE.json makes one"
_ROLES = {"internal": None, "sends": Direction.SEND, "receives": Direction.RECEIVE}


def read_report(document: object, name: str, prop: str | None = None) -> SubmittedRun:
    """The run of a report about a property; without a property the only one.

    Raises UsageError for what is no such report, or has no such run.
    """
    runs = document.get("runs") if isinstance(document, dict) else None
    if not isinstance(runs, list):
        raise UsageError(f"{name} is not a report of tachk verify", _HOW)
    try:
        found = {
            str(result["name"]): (run["constants"], result["trace"])
            for run in runs
            for result in run["results"]
            if result["trace"]
        }
        if not found:
            raise UsageError(f"{name} has no run: no property is shown false, no state is found in it", _HOW)
        names = ", ".join(found)
        if prop is None and len(found) > 1:
            raise UsageError(f"{name} has several runs", f"choose one with --property: {names}")
        if prop is not None and prop not in found:
            raise UsageError(f"{name} has no run for {prop}", f"it has runs for {names}")
        constants, states = found[next(iter(found)) if prop is None else prop]
        return _run(name, constants, states)
    except (LookupError, TypeError, AttributeError, ValueError):
        raise UsageError(f"{name}: a run in this report is damaged", _HOW) from None


def _run(name: str, constants: Mapping[str, int], states: list[dict[str, Any]]) -> SubmittedRun:
    state = initial = _merged(SubmittedState({}, {}, {}), states[0], Fraction(0))
    steps = []
    for entry in states[1:]:
        waited = exact_number(entry["delay"])
        state = _merged(state, entry, waited)
        transition = entry["transition"] or {"channel": None, "participants": []}
        moves = tuple(
            SubmittedMove(
                part["process"],
                part["source"],
                part["target"],
                None,
                {key: int(value) for key, value in part.get("select", {}).items()},
                _ROLES[part["role"]],
            )
            for part in transition["participants"]
        )
        steps.append(SubmittedStep(waited, True, moves, transition["channel"] or "", True, state))
    return SubmittedRun(name, {key: int(value) for key, value in constants.items()}, tuple(steps), initial)


def _merged(before: SubmittedState, entry: Mapping[str, Any], waited: Fraction) -> SubmittedState:
    """The state of the entry: the previous state after the delay, with the values that the entry changes."""
    passed = {name: value + waited for name, value in before.clocks.items()}
    return SubmittedState(
        {**before.locations, **entry.get("locations", {})},
        {**before.variables, **entry.get("variables", {})},
        {**passed, **{name: exact_number(value) for name, value in (entry.get("clocks") or {}).items()}},
        exact_number(entry["time"]),
    )


def read_submitted(path: Path, prop: str | None = None) -> SubmittedRun:
    """The submitted run in a file. Raises InputError, and UsageError for a file of another kind."""
    source = read_source(path, "a run", LARGEST_RUN)
    if not source.text.lstrip().startswith("{"):
        if prop is not None:
            raise UsageError(f"{path}: --property chooses among the runs of a report of tachk verify")
        if path.suffix.lower() in (".xtr", ".xml", ".csv", ".vcd", ".jsonl"):
            raise UsageError(
                f"{path}: this is not a run that can be replayed",
                f"give a report of tachk verify --format json, or a run: tachk step saves one, and"
                f" tachk simulate MODEL -o NAME{SUFFIX} writes it",
            )
        return read_run_file(source)
    document = json_object(source.text, str(path), "a report of tachk verify --format json is expected")
    return read_report(document, str(path), prop)


def check_determined(network: Network) -> None:
    """Raises UsageError for a model whose steps do not determine its states: its updates draw random numbers; and
    UnsupportedError for one with hybrid clocks, which the reference semantics does not know."""
    refuse_hybrid(network, "a replay of runs step by step")
    expressions = with_bodies(e for process in network.processes for e in process_expressions(process))
    for node in (node for expression in expressions for node in walk(expression)):
        if isinstance(node, Call) and node.function.operation is not None and node.function.operation.draws:
            problem = f"{node.span}: `{node.function.name}` draws a number that no run contains"
            raise UsageError(problem, "such a model is simulated, but its runs cannot be replayed")


def constants_of(run: SubmittedRun, known: Mapping[str, int], given: Mapping[str, object]) -> dict[str, int]:
    """The constants that the model needs another value of to be the one of the run.

    Args:
        known: the constants of the model as it is written.
        given: those that the user has chosen.

    Raises UsageError for a constant that the model does not have.
    """
    missing = [name for name in run.constants if name not in known]
    if missing:
        raise UsageError(f"{run.name}: the model has no constant {missing[0]}, so the run is one of another model")
    return {name: value for name, value in run.constants.items() if known[name] != value and name not in given}
