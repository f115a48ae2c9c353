"""Formulas that are evaluated on runs of a model, as ``--monitor`` gives them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.records import replace
from tachk.base.span import Source
from tachk.model.network import Network
from tachk.recordings.monitors.compiler import arrival_argument, column_name
from tachk.recordings.monitors.conditions import with_numbers_as_conditions
from tachk.recordings.monitors.formulas import NamedFormula, beside_columns, formula_source, formulas_in
from tachk.recordings.monitors.offline import evaluate_formulas
from tachk.recordings.monitors.row_names import TIME
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace, TraceSource
from tachk.recordings.traces.trace_files import open_trace
from tachk.simulation.columns import Column, all_columns, chosen_columns, columns_for
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind


def formulas_for(
    given: str | None, network: Network, chosen: Mapping[str, object] | None = None
) -> tuple[NamedFormula, ...]:
    """As `formulas_about`, of a formula, a sentence, or those of a file; none where None is given."""
    return () if given is None else formulas_about(formula_source(given), network, chosen)


def formulas_about(
    source: Source, network: Network, chosen: Mapping[str, object] | None = None
) -> tuple[NamedFormula, ...]:
    """The formulas of a text, about runs of a model.

    The constants of the model have their values in them. A file of formulas may have constants of its own, which come
    first.

    Args:
        source: as `formula_source` reads it.
        chosen: values of constants of the model that count in the place of a constant of the file, too.
    """
    formulas = _formulas_with(source, ())
    own = {name for each in formulas for name in each.constant_names}
    if values := tuple((name, str(value)) for name, value in (chosen or {}).items() if name in own):
        formulas = _formulas_with(source, values)
    return tuple(replace(each, constants={**dict(network.constants), **(each.constants or {})}) for each in formulas)


@lru_cache(maxsize=64)
def _formulas_with(source: Source, values: tuple[tuple[str, str], ...]) -> tuple[NamedFormula, ...]:
    """Kept, because the same formulas are evaluated on the runs of many cells of a sweep."""
    return formulas_in(source, dict(values))


def columns_with(network: Network, record: Sequence[str], formulas: Collection[NamedFormula]) -> tuple[Column, ...]:
    """The recorded columns: the chosen ones, and those that the formulas read. Raises InputError for arrivals."""
    names = {name for each in formulas for name in each.siblings or {}}
    read = [each.within(()) for each in beside_columns(formulas, _of_model(network, names))]
    _check_arrivals(network, read)
    needed = dict.fromkeys(name for f in read for name in f.columns - f.constant_names)
    of_rows = {TIME}.difference(_of_model(network, [TIME]))
    return columns_for(network, record, (name for name in needed if name not in of_rows))


def _check_arrivals(network: Network, formulas: Iterable[NamedFormula]) -> None:
    """Raises InputError for `arrived(x)`: a run has values and no messages."""
    found = []
    for named in formulas:
        for call in nodes_of_kind(named.formula, ast.CallExpression):
            if (argument := arrival_argument(call)) is not None:
                topic = column_name(argument)
                message = f"a run of a model does not show when `{topic}` arrives"
                found.append(Diagnostic("E0901", message, call.span, _instead_of_arrival(network, topic)))
    if found:
        raise InputError(found)


def _instead_of_arrival(network: Network, topic: str) -> str:
    if _of_model(network, [topic]):
        is_location = chosen_columns(network, [topic])[0].truth and topic not in {c.name for c in all_columns(network)}
        return f"write `rise({topic})`" if is_location else f"write `change({topic})`, if the value changes then"
    place = next((f"{each.name}.{location.name}" for each in network.processes for location in each.locations), "P.loc")
    return f"write `rise({place})` of the location that a synchronization leads to, or `change(x)` of what it assigns"


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
    recording = open_trace(trace)
    verdicts = evaluate_formulas(
        with_conditions(formulas, recording), recording, EvaluationOptions(robustness=False)
    ).verdicts
    return {verdict.name: verdict.truth for verdict in verdicts}


def with_conditions(formulas: Iterable[NamedFormula], recording: TraceSource) -> list[NamedFormula]:
    """The formulas about the columns of a recording, in which numbers are conditions as in models."""
    whole = (each.within(recording.columns) for each in formulas)
    return [replace(each, formula=with_numbers_as_conditions(each.formula)) for each in whole]
