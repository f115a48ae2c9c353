"""The formulas of ``--monitor``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.model.network import Network
from tachk.recordings.monitors.conditions import with_numbers_as_conditions
from tachk.recordings.monitors.formulas import NamedFormula, read_formulas
from tachk.recordings.monitors.offline import Judging, judge
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_files import open_trace
from tachk.simulation.columns import Column, columns_for


def formulas_for(given: str | None, definitions: Mapping[str, str]) -> tuple[NamedFormula, ...]:
    """A formula, a sentence, or those of a file; the constants count for files that may use them."""
    if given is None:
        return ()
    return read_formulas(given, dict(definitions) if Path(given).suffix in (".ta", ".xta", ".xml", ".stl") else {})


def columns_with(network: Network, record: Sequence[str], formulas: Iterable[NamedFormula]) -> tuple[Column, ...]:
    """What is recorded: the chosen columns, and those that the formulas read."""
    read = [each.beside(_of_model(network, each.named_formulas)).within(()) for each in formulas]
    return columns_for(network, record, (name for f in read for name in f.columns - f.constant_names))


def _of_model(network: Network, names: Iterable[str]) -> list[str]:
    """The names that the model has."""
    known = []
    for name in names:
        with suppress(InputError, UsageError):
            columns_for(network, (), [name])
            known.append(name)
    return known


def truths_on(trace: Trace, formulas: tuple[NamedFormula, ...]) -> dict[str, Truth]:
    """The verdict of each formula."""
    if not formulas:
        return {}
    conditions = [replace(each, formula=with_numbers_as_conditions(each.formula)) for each in formulas]
    verdicts = judge(conditions, open_trace(trace), Judging(robustness=False)).verdicts
    return {verdict.name: verdict.truth for verdict in verdicts}
