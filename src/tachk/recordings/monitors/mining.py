"""The tightest value of a parameter with which traces satisfy a formula: `tachk monitor --find` and `tachk.mine`.

Where a larger value is proved to make the formula only easier, or only harder (`monotone`), the border is found by
bisection over all values at which something can change (`candidates`), which is exact. Elsewhere values are tried one
by one. A trace satisfies a formula unless it violates it, or leaves it open where the end counts as a violation.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import lcm
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import exact_number
from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.base.time_units import length_of
from tachk.logic.constant_values import value_of
from tachk.recordings.monitors.candidates import (
    MOST_OCCURRENCES,
    Candidates,
    Lattice,
    common_step,
    evaluate,
    places,
    value_at,
    values_within,
)
from tachk.recordings.monitors.column_kinds import read_columns
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.monitors.given_constants import constants_by_name
from tachk.recordings.monitors.locations import located
from tachk.recordings.monitors.mined import Mined, MinedTrace
from tachk.recordings.monitors.mined_ranges import given_ranges
from tachk.recordings.monitors.monotone import Monotonicity, Occurrence, joint_effect, occurrences
from tachk.recordings.monitors.offline import counted, ending_of, evaluate_formulas, formulas_of, prepare, selected
from tachk.recordings.monitors.row_names import TIME, row_columns, with_row_columns
from tachk.recordings.monitors.trace_semantics import HeldValues
from tachk.recordings.monitors.value_names import with_named_values
from tachk.recordings.traces.conventions import EvaluationOptions, TraceEnding
from tachk.recordings.traces.logs.set_of_runs import SeveralRuns
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace, TraceSource
from tachk.recordings.traces.trace_files import open_trace
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tachk.syntax.walk import nodes_of_kind

MOST_TRIED = 100_000
"""Values that are tried one by one."""


def mine(
    formula: str | os.PathLike[str] | Sequence[NamedFormula],
    traces: Sequence[Any],
    over: str | Iterable[str] | Mapping[str, range | str | tuple[float | str | Fraction, float | str | Fraction]],
    *,
    step: float | str | Fraction | None = None,
    time: str | None = None,
    unit: str | None = None,
    end: str = "undetermined",
    constants: Mapping[str, str | float | Fraction] | None = None,
    select: Sequence[str] = (),
) -> Mined:
    """As `tachk.api.mining.mine`."""
    formulas = selected(formulas_of(formula, constants), select)
    if len(formulas) != 1:
        names = ", ".join(named.name for named in formulas)
        raise UsageError(f"one formula at a time, not {len(formulas)}: {names}", "choose one with --property")
    ranges = given_ranges(over)
    if len(ranges) != 1:
        names = ", ".join(ranges) or "none"
        raise UsageError(
            f"one parameter is mined at a time, not {len(ranges)}: {names}",
            "give the others values with -D, as in -D C=5, and mine again for each of them",
        )
    ((name, (least, greatest)),) = ranges.items()
    low, high = _number(name, least), _number(name, greatest)
    if not low < high:
        raise UsageError(f"{name} has nothing between {low} and {high}", "the least value comes first")
    if not traces:
        raise UsageError("there is no trace", "the traces follow the formula")
    if name not in formulas[0].names:
        raise UsageError(f"the formula has no name {name!r}", "write it in place of a bound or of a number")
    opened = [open_trace(trace, time, unit) for trace in traces]
    recordings = [run for each in opened for run in (each.runs.values() if isinstance(each, SeveralRuns) else (each,))]
    columns = {column for recording in recordings for column in recording.columns}
    named = located(_with_common_values(formulas[0], name, recordings).within(columns), columns)
    loaded = [_loaded(recording, named, name) for recording in recordings]
    search = _ParameterSearch(named, name, low, high, tuple(loaded), ending_of(end))
    return search.run(None if step is None else _number("the step", step))


def _number(name: str, given: float | str | Fraction) -> Fraction:
    try:
        return exact_number(str(given))
    except ValueError:
        raise UsageError(f"{name} = {str(given)[:40]}: expected a number", "such as 2.5") from None


def _with_common_values(named: NamedFormula, parameter: str, recordings: Sequence[TraceSource]) -> NamedFormula:
    """The formula with the values that names in it, but for the parameter, have in all recordings. Raises UsageError
    where these differ."""
    fixed = replace(named, constants={**(named.constants or {}), parameter: 0})
    found = [with_named_values([fixed], recording)[0] for recording in recordings]
    if any(each.formula != found[0].formula for each in found):
        raise UsageError("names in the formula mean different values in the recordings", "write the values")
    return replace(found[0], constants=named.constants)


def _loaded(recording: TraceSource, named: NamedFormula, name: str) -> Trace:
    """The columns of a trace that a formula reads."""
    if name in recording.columns:
        raise UsageError(f"{recording.name} has a column {name!r}", "give the parameter another name")
    of_rows = row_columns([named], recording.columns)
    own = {*recording.columns, *(name for name in of_rows if name != TIME)}
    wanted = set(named.columns).intersection(own)
    trace = read_columns(recording, [named.formula], wanted)
    return with_row_columns(trace, [TIME] if TIME in of_rows else [])


@dataclass(frozen=True, slots=True)
class _ParameterSearch:
    named: NamedFormula
    name: str
    low: Fraction
    high: Fraction
    traces: tuple[Trace, ...] = field(repr=False)
    ending: TraceEnding

    def run(self, step: Fraction | None) -> Mined:
        found = occurrences(self.named.formula, self.name)
        effect = joint_effect(found)
        candidates, exact = self._candidates(found, step)
        if effect is Monotonicity.UNKNOWN:
            return self._enumerated(Lattice(self.low, self.high, step or Fraction(1)))
        return self._bisected(candidates, effect, exact)

    # ---- candidates ----

    def _candidates(self, found: tuple[Occurrence, ...], step: Fraction | None) -> tuple[Candidates, bool]:
        """The values that matter, and whether these are all."""
        if step is not None:
            return Lattice(self.low, self.high, step), False
        bounds = [occurrence.slope for occurrence in found if occurrence.slope is not None]
        if len(bounds) == len(found) <= MOST_OCCURRENCES:
            return Lattice(self.low, self.high, self._time_step()), True
        sides = [_other_side(occurrence.threshold, self.name) for occurrence in found]
        if all(side is not None for side in sides):
            values = [self._values(side, trace) for side in sides if side is not None for trace in self.traces]
            return values_within(values, self.low, self.high), True
        return Lattice(self.low, self.high, Fraction(1)), False

    def _time_step(self) -> Fraction:
        scales: list[Fraction] = []
        ticks = lcm(*(trace.ticks_per_unit for trace in self.traces))
        for trace in self.traces:
            for duration in nodes_of_kind(self.named.formula, syntax.Duration):
                at_zero, at_one = (_bound(duration, self.named, trace.unit, {self.name: n}) for n in (0, 1))
                ticks = lcm(ticks, at_zero.denominator)
                if at_one != at_zero and trace is self.traces[0]:
                    scales.append(at_one - at_zero)
        return common_step(Fraction(1, ticks), scales)

    def _values(self, side: ast.Expression, trace: Trace) -> Any:
        atom = syntax.Atom(side.span, ast.BinaryExpression(side.span, BinaryOperator.EQUAL, side, side))
        named = replace(self.named, formula=atom, sentence="")
        program = prepare([named], open_trace(trace))[1][0]
        return evaluate(program.atoms[0].left, program.columns, trace)

    # ---- results ----

    def _bisected(self, candidates: Candidates, effect: Monotonicity, exact: bool) -> Mined:
        """The least tight of the tightest places of all traces."""
        total = places(candidates) if exact else len(candidates)

        def value(place: int) -> Fraction:
            """Places go from the tightest value to the easiest."""
            at = place if effect is Monotonicity.EASIER else total - 1 - place
            return value_at(candidates, at if exact else 2 * at)

        tightest: list[int] = []
        for trace in self.traces:
            first, last = -1, total
            while last - first > 1:
                check_job()
                middle = 0 if first < 0 and last == total else (first + last) // 2
                if self._satisfies(trace, value(middle)):
                    last = middle
                else:
                    first = middle
            tightest.append(last)
        worst = max(range(len(tightest)), key=lambda number: tightest[number])
        place = tightest[worst]
        record = None
        if place > 0:
            named = self._with(value(place - 1))
            record = evaluate_formulas(
                [named], open_trace(self.traces[worst]), EvaluationOptions(self.ending, robustness=False)
            )

        def result_at(at: int) -> tuple[Fraction | None, bool]:
            """The border, and whether it belongs to what satisfies."""
            if at == total:
                return None, False
            if exact and at % 2:
                return value(at - 1), False
            return value(at), True

        rows = tuple(MinedTrace(trace.name, *result_at(at)) for trace, at in zip(self.traces, tightest, strict=True))
        return Mined(
            self.named.name,
            self.named.text,
            self.name,
            self.low,
            self.high,
            "least" if effect is Monotonicity.EASIER else "greatest",
            *result_at(place),
            exact,
            None if place == 0 else self.traces[worst].name,
            None if place == 0 else value(place - 1),
            record,
            rows,
            () if place == total else self._open(value(place)),
            (),
        )

    def _open(self, value: Fraction) -> tuple[str, ...]:
        """The traces that neither satisfy nor violate the formula with a value."""
        return tuple(trace.name for trace in self.traces if self._measured(trace, value) is Truth.UNDETERMINED)

    def _enumerated(self, lattice: Lattice) -> Mined:
        if len(lattice) > MOST_TRIED:
            raise UsageError(
                f"{len(lattice)} values would be tried one by one, for it is not known that a larger {self.name} makes "
                f"the formula only easier or only harder; {MOST_TRIED} are the most",
                "make the range smaller, or the step larger",
            )
        good: list[tuple[Fraction, Fraction]] = []
        before = False
        for value in (lattice[n] for n in range(len(lattice))):
            check_job()
            satisfied = all(self._satisfies(trace, value) for trace in self.traces)
            if satisfied:
                good.append((good.pop()[0], value) if before else (value, value))
            before = satisfied
        return Mined(
            self.named.name,
            self.named.text,
            self.name,
            self.low,
            self.high,
            None,
            None,
            False,
            False,
            None,
            None,
            None,
            (),
            (),
            tuple(good),
        )

    def _with(self, value: Fraction) -> NamedFormula:
        return replace(self.named, given={**(self.named.given or {}), self.name: value})

    def _satisfies(self, trace: Trace, value: Fraction) -> bool:
        return counted(self._measured(trace, value), self.ending) is not Truth.FALSE

    def _measured(self, trace: Trace, value: Fraction) -> Truth:
        prepared, (program,) = prepare([self._with(value)], open_trace(trace))
        return HeldValues().truth(program, prepared).measured


def _bound(duration: syntax.Duration, named: NamedFormula, unit: str, parameter: Mapping[str, int]) -> Fraction:
    """A bound in units of the trace."""
    own = duration.unit or named.unit or unit
    first, second = length_of(own), length_of(unit)
    scale = Fraction(1) if first is None or second is None else first / second
    if isinstance(duration.value, Fraction):
        return duration.value * scale
    constants = {**named.numbers(named.unit or unit), **parameter}
    return value_of(duration.value, constants_by_name(constants)) * scale


def _other_side(comparison: ast.BinaryExpression | None, name: str) -> ast.Expression | None:
    """The other side of a comparison with a parameter, if the parameter is all of one side and not in the other."""
    if comparison is None:
        return None
    for side, other in ((comparison.left, comparison.right), (comparison.right, comparison.left)):
        if isinstance(side, ast.NameExpression) and side.name == name:
            if all(each.name != name for each in nodes_of_kind(other, ast.NameExpression)):
                return other
    return None
