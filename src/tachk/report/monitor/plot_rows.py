"""A picture of a trace with verdicts in numbers: steps of signals, bands of subformulas. No drawing here."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tachk.base.job import check_job
from tachk.recordings.monitors.record import MonitorVerdict
from tachk.recordings.traces.monitor_program import AtomRelation, MonitorProgram, NodeKind, ValueOperator
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.trace import Trace

MOST_ROWS = 9
"""Subformulas that are shown of one formula, the outer ones first."""

MOST_NAMES = 12
"""Values of a column that are written by their names."""

MOST_POINTS = 4000
"""Points of a line; a longer trace is drawn by the extremes of each of as many pieces."""


@dataclass(frozen=True, slots=True, eq=False)
class FormulaRows:
    """The subformulas that are shown, the whole first."""

    nodes: tuple[int, ...]
    texts: tuple[str, ...]
    signals: tuple[NodeSignal, ...]


@dataclass(frozen=True, slots=True)
class PlotRange:
    """The part of a trace that is drawn, in ticks."""

    begin: float
    end: float


@dataclass(frozen=True, slots=True)
class SignalBand:
    """From ``begin`` to ``end``, in ticks; ``widened`` if it is narrower in truth."""

    begin: float
    end: float
    widened: bool = False


def formula_rows(verdict: MonitorVerdict) -> FormulaRows:
    """The subformulas worth a row: neither what a signal shows already, nor negations that an implication hides. A
    condition that the program has negated has the row of its negation, which is what the formula says."""
    explainer = verdict.explainer
    program = verdict.program
    root = len(program.nodes) - 1
    order: dict[int, None] = {root: None}
    pending = [root]
    while pending:
        node = pending.pop(0)
        for operand in program.nodes[node].operands:
            if operand not in order:
                order[operand] = None
                pending.append(operand)
    as_written = _negated_back(program, order)
    drawn = [node for node in order if node == root or node in as_written or not _is_plain(program, node)]
    drawn = [node for node in drawn if node not in as_written.values()][:MOST_ROWS]
    texts = tuple(verdict.formula if node == root else program.nodes[node].text for node in drawn)
    return FormulaRows(tuple(drawn), texts, tuple(explainer.signal(node) for node in drawn))


def _negated_back(program: MonitorProgram, nodes: Iterable[int]) -> dict[int, int]:
    """The negations of comparisons that occur in no other way, each with its comparison."""
    nodes = list(nodes)
    users = defaultdict[int, list[int]](list)
    for node in nodes:
        for operand in program.nodes[node].operands:
            users[operand].append(node)
    comparisons = [
        node
        for node in nodes
        if program.nodes[node].kind is NodeKind.ATOM and not _is_plain(program, node) and len(users[node]) == 1
    ]
    return {users[node][0]: node for node in comparisons if program.nodes[users[node][0]].kind is NodeKind.NOT}


def _is_plain(program: MonitorProgram, node: int) -> bool:
    current = program.nodes[node]
    if current.kind in (NodeKind.TRUE, NodeKind.FALSE):
        return True
    if current.kind is NodeKind.NOT:
        return True
    if current.kind is NodeKind.ATOM:
        atom = program.atoms[current.atom]
        return atom.relation is AtomRelation.TRUTH and len(atom.left) == 1
    return False


def bands_of(signal: NodeSignal, truth: Truth, begin: float, end: float, pixel: float) -> list[SignalBand]:
    """The bands in which a subformula has a value; each is at least a pixel wide, so that no instant is lost."""
    bands: list[SignalBand] = []
    for first, last, value in signal.stretches():
        check_job()
        if value is not truth:
            continue
        left = first / 2 if first % 2 == 0 else (first - 1) / 2
        right = last / 2 if last % 2 == 0 else (last + 1) / 2
        left, right = max(left, begin), min(right, end)
        if right < left:
            continue
        widened = right - left < pixel
        if widened:
            left = max(min(left, end - pixel), begin)
            right = left + pixel
        if bands and left - bands[-1].end < pixel / 2:
            bands[-1] = SignalBand(bands[-1].begin, max(right, bands[-1].end), bands[-1].widened and widened)
        else:
            bands.append(SignalBand(left, right, widened))
    return bands


def steps(trace: Trace, column: str, begin: float, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The points of a step line within a part of the trace, its last value held to the end of the part."""
    first = max(int(trace.times.searchsorted(begin, side="right")) - 1, 0)
    last = int(trace.times.searchsorted(end, side="right"))
    times = trace.times[first:last].astype(np.float64)
    values = trace.columns[column][first:last].astype(np.float64)
    if len(times) > MOST_POINTS:
        times, values = _extremes(times, values)
    stop = min(end, float(trace.end))
    return np.append(times, max(stop, times[-1])), np.append(values, values[-1])


def line(trace: Trace, column: str, begin: float, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The points of a line from row to row that covers a part of the trace, its last value held to the end of it."""
    first = max(int(trace.times.searchsorted(begin, side="right")) - 1, 0)
    last = int(trace.times.searchsorted(end, side="right")) + 1
    times = trace.times[first:last]
    last_of_instant = np.append(times[1:] != times[:-1], True)  # of several rows for one instant the last one counts
    points = times[last_of_instant].astype(np.float64)
    values = trace.columns[column][first:last][last_of_instant].astype(np.float64)
    if len(points) > MOST_POINTS:
        points, values = _extremes(points, values)
    stop = max(min(end, float(trace.end)), points[-1])
    return np.append(points, stop), np.append(values, values[-1])


def _extremes(
    times: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The least and the largest value of each of a number of pieces."""
    edges = np.linspace(0, len(times), MOST_POINTS // 2 + 1).astype(np.int64)[:-1]
    low, high = np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)
    return np.repeat(times[edges], 2), np.column_stack((low, high)).ravel()


@dataclass(frozen=True, slots=True, eq=False)
class NamedValues:
    """Attributes:
    levels: of each point, the place of its value among the names.
    names: of the values that occur, from the lowest level up.
    """

    levels: NDArray[np.float64]
    names: tuple[str, ...]


def named_values(trace: Trace, column: str, values: NDArray[np.float64]) -> NamedValues | None:
    """The values of a column of texts, or of numbers that the file names; None: it has numbers without names. Values
    that occur first stand at the bottom."""
    names: dict[int, str] = dict(enumerate(trace.labels)) if column in trace.texts else {}
    names |= trace.value_names.get(column, {})
    present, first = np.unique(values[np.isfinite(values)], return_index=True)
    if not len(present) or len(present) > MOST_NAMES or any(int(value) not in names for value in present.tolist()):
        return None
    order = [float(value) for value in present[np.argsort(first)]]
    levels = np.full(len(values), np.nan)
    for level, value in enumerate(order):
        levels[values == value] = level
    return NamedValues(levels, tuple(names[int(value)] for value in order))


def thresholds(verdicts: Sequence[MonitorVerdict], column: str) -> list[float]:
    """The constants that a column is compared with."""
    found: set[float] = set()
    for verdict in verdicts:
        program = verdict.program
        for atom in program.atoms:
            if atom.relation is AtomRelation.TRUTH or len(atom.left) != 1 or len(atom.right) != 1:
                continue
            (left,), (right,) = atom.left, atom.right
            if left.operator is ValueOperator.CONSTANT:
                left, right = right, left
            if left.operator is ValueOperator.COLUMN and right.operator is ValueOperator.CONSTANT:
                if program.columns[int(left.operand)] == column:
                    found.add(right.operand)
    return sorted(found)
