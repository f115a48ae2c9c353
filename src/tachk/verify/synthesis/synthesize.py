"""From a model, a property and ranges of constants to the region where the property holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from time import monotonic

import numpy as np

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.job import StoppedError, current_job, limited, under_way
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, TIME_LIMIT
from tachk.frontend.loaded import LoadedModel, with_constants
from tachk.model.query import Query
from tachk.verify.plan import Analysis, analysis_of
from tachk.verify.questions import Questions
from tachk.verify.synthesis.bounds_of_parameters import NoBound, ParameterBound, bounds_of_parameters
from tachk.verify.synthesis.cells import DecidedCells
from tachk.verify.synthesis.inequalities import Description, describe
from tachk.verify.synthesis.parameters import VariedConstant, checked_parameters
from tachk.verify.synthesis.region import CellEvidence, Region, RegionCell, shown_by_a_run
from tachk.verify.synthesis.walk import AxisKind, CellStatus, walk
from tachk.verify.verdict import Answer


def synthesize(
    model: LoadedModel,
    questions: Questions,
    parameters: Sequence[VariedConstant],
    wanted: Answer = Answer.HOLDS,
    options: Options = Options(),
    limits: Limits = Limits(),
    infer: bool = True,
    reuse: bool = True,
    certify: bool = False,
) -> Region:
    """The values of constants for which a property has the wanted answer.

    Args:
        questions: exactly one.
        limits: those on states, memory and depth hold for each search, the one on seconds for all together.
        infer: let one answer stand for others where `bounds_of_parameters` allows it.
        reuse: try the runs, and the certificates if there are some, of cells nearby before a search.
        certify: make a certificate of each searched cell in which something is never reached.

    None of the last three changes an answer that is known.

    Raises:
        InputError: the model or the query is wrong, with all values.
        UsageError: there is no such property or constant, or nothing to vary, or no one question.
        UnsupportedError: the query cannot be checked.
    """
    began = monotonic()
    with under_way(current_job().narrowed(limits.seconds)):  # without time all cells are unknown
        parameters = checked_parameters(parameters)
        query = _only_query(model, questions)
        cells = DecidedCells(model, questions, parameters, options, limits, reuse, certify)
        bounds: Mapping[str, ParameterBound | NoBound] = {}
        if infer:
            try:
                with limited(limits.seconds, limits.memory_bytes):
                    bounds = _bounds(model, questions, parameters)
            except StoppedError:
                pass
        known = tuple(bounds.get(p.name, NoBound("this was not requested")) for p in parameters)
        statuses = np.zeros([len(parameter.values) for parameter in parameters], dtype=np.int8)
        walk(statuses, [_axis(bound) for bound in known], cells.decide, cells.may_infer)
        if cells.wrong is not None and all(cell.reason.startswith("wrong model") for cell in cells.found.values()):
            raise cells.wrong
        box = tuple(_cell(cells, query, place, CellStatus(int(status))) for place, status in np.ndenumerate(statuses))
        return Region(
            questions.path,
            query,
            wanted,
            parameters,
            known,
            box,
            _description(box, wanted),
            cells.interrupted,
            tuple(pair for pair in model.heading.constants if pair[0] not in {p.name for p in parameters}),
            monotonic() - began,
        )


def _only_query(model: LoadedModel, questions: Questions) -> Query:
    found = questions.about(model)
    if len(found) != 1:
        names = ", ".join(query.name for query in model.queries) or "none"
        raise UsageError(
            f"a region is that of one property, but {len(found)} are given", f"--property NAME; there is: {names}"
        )
    (query,) = found
    if not isinstance(query, Query):
        raise UsageError(f"{query.name} is not checked: {query.text}")
    if analysis_of(query) is Analysis.EXTREMES:
        raise UsageError(f"{query.kind.value} has a value and no answer", "compare it with a bound: A[] x <= 5")
    return query


def _bounds(
    model: LoadedModel, questions: Questions, parameters: Sequence[VariedConstant]
) -> Mapping[str, ParameterBound | NoBound]:
    """The direction in which each parameter bounds; None where the model cannot be elaborated with open constants."""
    names = [parameter.name for parameter in parameters]
    first = {parameter.name: parameter.low for parameter in parameters}
    try:
        opened = with_constants(model, first, questions.names, names)
        (query,) = questions.about(opened)
        network = opened.network
    except InputError:
        return {}
    if not isinstance(query, Query):
        return {}
    ranges = {parameter.name: (parameter.values[0], parameter.values[-1]) for parameter in parameters}
    return bounds_of_parameters(network, query, opened.context.open_constants, ranges)


def _axis(bound: ParameterBound | NoBound) -> AxisKind:
    match bound:
        case ParameterBound.UPPER:
            return AxisKind.MORE
        case ParameterBound.LOWER:
            return AxisKind.LESS
        case ParameterBound.ABSENT:
            return AxisKind.SAME
        case NoBound():
            return AxisKind.ANY


def _cell(cells: DecidedCells, query: Query, place: tuple[int, ...], status: CellStatus) -> RegionCell:
    """The evidence about a cell, its own or that of others."""
    known = cells.found.get(place)
    if known is not None and (known.answer is not Answer.UNKNOWN or status is CellStatus.UNKNOWN):
        return known
    values = tuple(p.values[number] for p, number in zip(cells.parameters, place, strict=True))
    reached = shown_by_a_run(query)
    match status:
        case CellStatus.REACHED:
            answer = reached
        case CellStatus.UNREACHED:
            answer = Answer.HOLDS if reached is Answer.FAILS else Answer.FAILS
        case CellStatus.OPEN | CellStatus.UNKNOWN:
            reason = INTERRUPTED if cells.interrupted else TIME_LIMIT
            return RegionCell(values, Answer.UNKNOWN, CellEvidence.NONE, reason)
    return RegionCell(values, answer, CellEvidence.IMPLIED)


def _description(cells: Sequence[RegionCell], wanted: Answer) -> Description | None:
    inside = [cell.values for cell in cells if cell.answer is wanted]
    outside = [cell.values for cell in cells if cell.answer not in (wanted, Answer.UNKNOWN)]
    return describe(np.array(inside, dtype=np.int64), np.array(outside, dtype=np.int64))
