"""Runs in reports of `tachk verify --format json`."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import exact_number
from tachk.base.words import Direction
from tachk.simulation.stepping.claims import ClaimedMove, ClaimedRun, ClaimedState, ClaimedStep

_HOW = "tachk verify MODEL --property NAME --format json -o TRACE.json makes one"
_ROLES = {"internal": None, "sends": Direction.SEND, "receives": Direction.RECEIVE}


def read_report(document: object, name: str, prop: str | None = None) -> ClaimedRun:
    """The run of a report about a property; without a property the only one.

    Raises UsageError for what is no such report, or has no such run.
    """
    runs = document.get("runs") if isinstance(document, dict) else None
    if not isinstance(runs, list):
        raise UsageError(f"{name} is no report of tachk verify", _HOW)
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


def _run(name: str, constants: Mapping[str, int], states: list[dict[str, Any]]) -> ClaimedRun:
    state = initial = _merged(ClaimedState({}, {}, {}), states[0], Fraction(0))
    claims = []
    for told in states[1:]:
        waited = exact_number(told["delay"])
        state = _merged(state, told, waited)
        transition = told["transition"] or {"channel": None, "participants": []}
        moves = tuple(
            ClaimedMove(
                part["process"],
                part["source"],
                part["target"],
                None,
                {key: int(value) for key, value in part.get("select", {}).items()},
                _ROLES[part["role"]],
            )
            for part in transition["participants"]
        )
        claims.append(ClaimedStep(waited, True, moves, transition["channel"] or "", True, state))
    return ClaimedRun(name, {key: int(value) for key, value in constants.items()}, tuple(claims), initial)


def _merged(before: ClaimedState, told: Mapping[str, Any], waited: Fraction) -> ClaimedState:
    """The state before, as time has passed, with what is told to be different."""
    passed = {name: value + waited for name, value in before.clocks.items()}
    return ClaimedState(
        {**before.locations, **told.get("locations", {})},
        {**before.variables, **told.get("variables", {})},
        {**passed, **{name: exact_number(value) for name, value in (told.get("clocks") or {}).items()}},
        exact_number(told["time"]),
    )
