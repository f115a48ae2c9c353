"""Steps of a run as a sequence chart needs them, from a report of `tachk verify`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass

_HOW = "tachk verify MODEL --property NAME --trace some --format json -o RUN.json makes one"
_LOST, _COPIED = "losses", "copies"
"""The budgets of the links of models/lib; what grows says what a link does."""


@dataclass(frozen=True, slots=True)
class RunStep:
    """A transition of a run.

    Attributes:
        time: when it happens, in units of the model.
        channel: empty for an internal edge.
        sender: the process that sends, or that acts alone; empty if a process sends that the report leaves out.
        receivers: who takes part beside it.
        carried: values of meta variables, which messages of models/lib are made of.
        is_lost, is_copied: a link loses the message that is sent, or keeps a copy of what it delivers.
        news: by process, what the model marks as news.
        locations: where processes are behind the step, as far as it moves them.
    """

    time: Fraction
    channel: str
    sender: str
    receivers: tuple[str, ...]
    payload: Mapping[str, int]
    is_lost: bool
    is_copied: bool
    news: tuple[tuple[str, str], ...]
    locations: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class RunSteps:
    """Attributes:
    title: what the run is about.
    query: the property that it is the evidence for.
    unit: of time; may be empty.
    constants: of the model.
    processes: that are not hidden, in the order of the model.
    initial: their first locations.
    steps: in order.
    end: when the run ends.
    remark: what the run shows at its end.
    """

    title: str
    query: str
    unit: str
    constants: Mapping[str, int]
    processes: tuple[str, ...]
    initial: Mapping[str, str]
    steps: tuple[RunStep, ...]
    end: Fraction
    remark: str

    @property
    def has_messages(self) -> bool:
        return any(step.channel for step in self.steps)


def steps_of_report(document: object, file: str, name: str | None) -> RunSteps:
    """The steps of a run in a report of `tachk verify --format json`.

    Args:
        name: of the property; None for the first that has a run.

    Raises UsageError for what is no such report, or has no such run.
    """
    return steps_of_result(*_chosen(document, file, name))


def steps_of_result(run: Mapping[str, Any], result: Mapping[str, Any]) -> RunSteps:
    """The steps of the run behind one result of a run of `tachk verify`, as docs/schema/verify.schema.json has them."""
    initial, *states = result["trace"]
    values: dict[str, Any] = dict(initial["variables"])
    steps = []
    for state in states:
        changes = state.get("variables", {})
        if state["transition"] is not None:
            steps.append(_of_report(state, values, changes))
        values.update(changes)
    end = Fraction(result["trace"][-1]["time"] or 0)
    remark = f"{result['name']} {result['answer']}"
    title = f"{result['name']}: {result['title'] or result['query']}"
    processes = tuple(initial["locations"])
    return RunSteps(
        title,
        result["query"],
        run["time_unit"],
        run["constants"],
        processes,
        initial["locations"],
        tuple(steps),
        end,
        remark,
    )


def _chosen(document: object, file: str, name: str | None) -> tuple[dict[str, Any], dict[str, Any]]:
    runs = document.get("runs") if isinstance(document, dict) else None
    if not isinstance(runs, list):
        raise UsageError(f"{file} is neither a capture nor a report of tachk verify", _HOW)
    try:
        found = [(run, result) for run in runs for result in run["results"] if result["trace"]]
        names = [result["name"] for _, result in found]
    except (KeyError, TypeError):
        raise UsageError(f"{file} is not a report of tachk verify", _HOW) from None
    if not found:
        raise UsageError(f"{file} has no run of a model", _HOW)
    if name is not None and name not in names:
        raise UsageError(f"{file} has no run for {name}", f"it has runs for {', '.join(names)}")
    return found[0 if name is None else names.index(name)]


def _of_report(state: Mapping[str, Any], values: Mapping[str, Any], changes: Mapping[str, Any]) -> RunStep:
    transition = state["transition"]
    participants: Sequence[Mapping[str, Any]] = transition["participants"]
    received_only = participants[0]["role"] == "receives"
    return RunStep(
        Fraction(state["time"] or 0),
        transition["channel"] or "",
        "" if received_only else participants[0]["process"],
        tuple(part["process"] for part in (participants if received_only else participants[1:])),
        transition.get("carries", {}),
        changes.get(_LOST, 0) > values.get(_LOST, 0),
        changes.get(_COPIED, 0) > values.get(_COPIED, 0),
        tuple((part["process"], " ".join(part["news"].split())) for part in participants if "news" in part),
        {part["process"]: part["target"] for part in participants},
    )
