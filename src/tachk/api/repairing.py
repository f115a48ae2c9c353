"""Changes of a model that make recordings runs of it, with what they change in its properties."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from tachk.api.model import Model, load
from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.job import limited
from tachk.engine.options import Limits
from tachk.formats.loading.recorded_models import recorded_model
from tachk.frontend.loaded import LoadedModel, with_constants
from tachk.recordings.conformance.conform_file import AUTO, allowances_of, read_recording, recording_map
from tachk.recordings.conformance.question import Question
from tachk.report.conformance.repaired import ChangedVerdict, RepairReport
from tachk.syntax import ast
from tachk.verify.repair.extended_model import with_edge
from tachk.verify.repair.other_constants import with_named_numbers
from tachk.verify.repair.proposals import ProposedEdge
from tachk.verify.repair.repair import repair as repaired
from tachk.verify.verdict import Answer

_SECONDS = 10.0
"""The properties of the model before and after each change are checked for so long."""


@checked_arguments
def repair(
    model: Model | str | os.PathLike[str],
    recordings: Iterable[str | os.PathLike[str]],
    tolerance: str | None = None,
    late: str | Mapping[str, str] | None = None,
    unit: str | None = None,
    ports: Iterable[int] = (),
    limits: Limits | None = None,
    applications: Iterable[str | os.PathLike[str]] = (),
) -> RepairReport:
    """The changes of a model, each alone, that make all recordings runs of it: other values of constants and numbers,
    and edges that it lacks or whose guard is too narrow, the most likely ones first. docs/repair.md says how they are
    found.

    Args:
        recordings, tolerance, late, unit, ports, applications: as of `tachk.conform`; without the tolerance ``"auto"``.
        limits: of each search; the seconds are for all of them together.

    Raises UsageError if a recording does not fit the model, or it says nothing of them, UnsupportedError.
    """
    model = model if isinstance(model, Model) else load(model)
    if tolerance == AUTO:
        raise UsageError("the tolerance `auto` makes recordings runs by itself", "give a tolerance, such as 5ms")
    held = recorded_model(model.loaded, model.path, model.definitions)
    limits = limits or Limits()
    said = recording_map(held, model.path).allowances
    allowances = allowances_of(tolerance, late, held.network.time_unit).over(said)
    logs = tuple(os.fspath(each) for each in applications)
    question = Question(tolerance, late, unit, tuple(ports), logs)
    paths = [os.fspath(each) for each in recordings]
    with limited(limits.seconds):
        events = [read_recording(Path(each), question, held) for each in paths]
        found = repaired(held, events, allowances.uncertainty(), limits)
        changed = [_with_value(model.loaded, each.name, each.after) for each in found.constants]
        changed += [_with_edge(model.loaded, each.proposal) for each in found.edges]
        before = _answers(model.loaded, model.path) if any(each is not None for each in changed) else {}
        verdicts = [
            None if each is None or not before else _differences(before, _answers(each, model.path)) for each in changed
        ]
    return RepairReport(model.path, tuple(paths), found, tuple(verdicts))


def _with_value(loaded: LoadedModel, name: str, value: int) -> LoadedModel | None:
    """The model with a constant or a number changed; None if it has none of that name, or is wrong with it."""
    named = with_named_numbers(loaded)
    if name not in dict(named.network.constants):
        return None
    try:
        return with_constants(named, {name: value}, [query.name for query in loaded.queries])
    except (InputError, UsageError):
        return None


def _with_edge(loaded: LoadedModel, proposal: ProposedEdge) -> LoadedModel | None:
    """The model with an edge more; None if it has no such template."""
    templates = {item.name.name for item in loaded.items if isinstance(item, ast.Template)}
    try:
        return with_edge(loaded, proposal) if proposal.template in templates else None
    except InputError:
        return None


def _answers(loaded: LoadedModel, path: str) -> dict[str, Answer]:
    """The answers of the properties of a model that are known after some seconds."""
    if not loaded.queries:
        return {}
    report = Model(loaded, path).verify(limits=Limits(seconds=_SECONDS), trace=False)
    return {each.query.name: each.answer for each in report.record.verdicts}


def _differences(before: dict[str, Answer], after: dict[str, Answer]) -> tuple[ChangedVerdict, ...]:
    return tuple(
        ChangedVerdict(name, answer, after[name])
        for name, answer in before.items()
        if after.get(name, answer) != answer
    )
