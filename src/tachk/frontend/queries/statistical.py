"""Statistical queries: the text of one, as the grammar takes it for one token, with its names resolved.

UPPAAL's forms: ``Pr[bound](<> p)``, ``[]`` and ``p U q``, and formulas with several of these and intervals, compared
with a number or with another one;
``E[bound; N](max: e)``; ``simulate [bound; N] {e, f}``, or ``simulate N [bound] {e, f}`` as version 4 has it.
"""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UnsupportedError
from tachk.base.exact_numbers import exact_number
from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.base.span import Span
from tachk.base.time_units import NANOSECONDS, length_of
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition, constant_integer, expression
from tachk.frontend.expressions.typing import is_integral
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.hybrid_clocks import DeclaredNames, computed_clocks, declared_names, named_clocks
from tachk.frontend.loaded import LoadedModel, with_hybrid_clocks
from tachk.frontend.queries.queries import UncheckedQuery
from tachk.frontend.queries.run_formulas import OperandReader, operators_in, read_run_formula, refuse_foreign
from tachk.model.expressions import Conditional, Expression
from tachk.model.floating import DOUBLE
from tachk.model.statistical import (
    ExpectedValue,
    FormulaPath,
    Path,
    PathProperty,
    Probability,
    ProbabilityComparison,
    Question,
    RunBound,
    Scale,
    StatisticalQuery,
    Threshold,
    Trajectories,
)
from tachk.model.traversal import reads_hybrid
from tachk.model.types import ClockType, Type
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_expression

_BLANK = re.compile(r"\s+|//[^\n]*|/\*[\s\S]*?\*/")
_NUMBER = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_DURATION = re.compile(r"((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-z]*)")
_MOST_RUNS = 10**9
_EXAMPLE = "for example Pr[<=100](<> P.location), E[<=100; 1000](max: n) or simulate [<=100; 5] {n, P.location}"
_ONE_STATE = "write a condition or a number of one state here; Pr takes formulas, for example Pr[<=100](<>[0,3] p)"


class StatisticalReader:
    """Reads statistical queries of one model; what the model declares is looked up once."""

    def __init__(self, model: LoadedModel) -> None:
        self._model = model
        self._declared = declared_names(model.items)
        self._hybrid: dict[frozenset[str], LoadedModel] = {}

    def read(self, query: UncheckedQuery) -> StatisticalQuery:
        """The query with its names resolved.

        Raises:
            InputError: it is wrong.
            UnsupportedError: it is of a form that is not estimated.
        """
        names: frozenset[str] = frozenset()
        seen = self._model
        while True:
            try:
                question = _StatisticalQueryReader(query.span, seen, self._declared).question()
            except _ComputesError as computes:
                names |= computes.clocks
                seen = self._with_hybrid_clocks(names)
                network = seen.network
            else:
                other = network if names else None
                return StatisticalQuery(query.name, question, query.text, query.title, query.span, other)

    def _with_hybrid_clocks(self, names: frozenset[str]) -> LoadedModel:
        if names not in self._hybrid:
            self._hybrid[names] = with_hybrid_clocks(self._model, names)
        return self._hybrid[names]


class _ComputesError(Exception):
    """A query computes with clocks that are not hybrid."""

    def __init__(self, clocks: frozenset[str]) -> None:
        super().__init__()
        self.clocks = clocks


class _StatisticalQueryReader:
    """Reads the text of a query from left to right."""

    def __init__(self, span: Span, model: LoadedModel, declared: DeclaredNames) -> None:
        self._declared = declared
        self._span = span
        self._text = span.text
        self._at = 0
        self._model = model
        self._findings = DiagnosticCollector()
        self._context: Context = replace(model.context, findings=self._findings, in_query=True)

    def question(self) -> Question:
        if self._taken("Pr"):
            result = self._probability()
        elif self._taken("E"):
            result = self._expectation()
        elif self._taken("simulate"):
            result = self._trajectories()
        else:
            raise self._wrong("expected Pr, E or simulate")
        self._skip()
        if self._at < len(self._text):
            raise self._unsupported("this form of query is not estimated")
        return result

    # ---- forms ----

    def _probability(self) -> Question:
        path = self._path()
        for text, at_least in ((">=", True), ("<=", False)):
            if not self._taken(text):
                continue
            if self._taken("Pr"):
                other = self._path()
                return ProbabilityComparison(path, other) if at_least else ProbabilityComparison(other, path)
            return Threshold(path, at_least, self._threshold())
        return Probability(path)

    def _path(self) -> PathProperty:
        bounded = self._peek() != "("
        bound, runs = self._bound() if bounded else (None, None)
        inner = self._bracketed("(")
        refuse_foreign(inner, self._model.scope)
        operators = operators_in(inner)
        text = inner.text.lstrip()
        start = inner.end - len(text)
        if len(operators) == 1 and text.startswith(("<>", "[]")):
            always, before, rest = text.startswith("[]"), None, Span(inner.source, start + 2, inner.end)
        elif operators == ("U",) and (until := _split(inner, "U")) is not None:
            always, (before, rest) = False, until
        elif operators:
            return self._formula_path(inner, bound, runs)
        else:
            raise self._wrong("expected <> p, [] p or p U q", inner)
        since = 0
        if bound is None or _begins_with_interval(rest):
            interval = None if _is_half_open(rest) else self._interval(rest)
            if interval is None or not _is_within(interval[0][1], bound):
                return self._formula_path(inner, bound, runs)
            (since, bound), rest = interval
        # The parts are read from left to right, so that the first mistake in the text is reported.
        held = None if before is None else self._condition(before)
        return Path(bound, runs, always, self._condition(rest), held, since)

    def _formula_path(self, inner: Span, bound: RunBound | None, runs: int | None) -> FormulaPath:
        """A formula with several operators. Its runs end where it is decided, or at the bound before."""
        if bound is not None and bound.scale is not Scale.TIME:
            raise self._unsupported("the bound of a formula with intervals is a time", inner)
        operands = OperandReader(self._condition, self._value, self._model.scope, self._context)
        found = read_run_formula(inner, None if bound is None else bound.limit, operands)
        reach = found.reach if bound is None else min(found.reach, bound.limit)
        return FormulaPath(RunBound(Scale.TIME, reach), runs, found.formula)

    def _interval(self, span: Span) -> tuple[tuple[int, RunBound], Span] | None:
        """The interval at the beginning of a text, and what is behind it; None where it begins within a time unit."""
        text = span.text.lstrip()
        start = span.end - len(text)
        end = _partner(text, 0) if text.startswith("[") else None
        if end is None:
            raise self._wrong("expected an interval such as [2,10], or a bound behind Pr: Pr[<=100](<> p)", span)
        parts = _parts(Span(span.source, start + 1, start + end), ",")
        if len(parts) != 2:
            raise self._wrong("an interval has two ends", Span(span.source, start, start + end + 1))
        since, limit = map(self._time, parts)
        if since > limit:
            raise self._wrong("an interval must not end before it begins", Span(span.source, start, start + end + 1))
        if since.denominator != 1:
            return None
        return (int(since), RunBound(Scale.TIME, limit)), Span(span.source, start + end + 1, span.end)

    def _expectation(self) -> ExpectedValue:
        bound, runs = self._bound()
        inner = self._bracketed("(")
        match = re.match(r"\s*(max|min)\s*:", inner.text)
        if match is None:
            raise self._wrong("expected max: or min: and an expression", inner)
        value = self._value(Span(inner.source, inner.start + match.end(), inner.end))
        return ExpectedValue(bound, runs, match[1] == "max", value)

    def _trajectories(self) -> Trajectories:
        number = self._number_of_runs()
        bound, runs = self._bound()
        values = tuple(self._value(part) for part in _parts(self._bracketed("{"), ","))
        runs = number or runs or 1
        if not self._taken(":"):
            return Trajectories(bound, runs, values)
        rest = Span(self._span.source, self._span.start + self._at, self._span.end)
        self._at = len(self._text)
        most, condition = _picking(rest)
        return Trajectories(bound, runs, values, self._condition(condition), None if most is None else self._runs(most))

    def _number_of_runs(self) -> int | None:
        self._skip()
        match = re.compile(r"\d+").match(self._text, self._at)
        if match is None:
            return None
        self._at = match.end()
        return self._runs(Span(self._span.source, self._span.start + match.start(), self._span.start + match.end()))

    def _threshold(self) -> float:
        self._skip()
        match = _NUMBER.match(self._text, self._at)
        if match is None or not 0 <= float(match[0]) <= 1:
            raise self._wrong("expected a probability between 0 and 1")
        self._at = match.end()
        return float(match[0])

    # ---- bounds ----

    def _bound(self) -> tuple[RunBound, int | None]:
        parts = _parts(self._bracketed("["), ";")
        if len(parts) > 2:
            raise self._wrong("expected one bound and perhaps a number of runs", parts[2])
        runs = self._runs(parts[1]) if len(parts) == 2 else None
        sides = _split(parts[0], "<=")
        if sides is None:
            raise self._wrong("expected a bound such as <= 100, # <= 50 or x <= 20", parts[0])
        measured, limit = sides
        match measured.text.strip():
            case "":
                return RunBound(Scale.TIME, self._time(limit)), runs
            case "#":
                return RunBound(Scale.STEPS, Fraction(self._constant(limit))), runs
            case _:
                clock = self._value(measured)
                if reads_hybrid(clock):
                    return RunBound(Scale.CLOCK, Fraction(0), beyond=self._beyond(measured, limit)), runs
                if not isinstance(clock.type, ClockType):
                    raise self._wrong("a run is bounded by its time, by # or by a clock", measured)
                return RunBound(Scale.CLOCK, self._time(limit), clock), runs

    def _beyond(self, measured: Span, limit: Span) -> Expression:
        """The condition that a hybrid clock is larger than its bound."""
        whole = Span(measured.source, measured.start, limit.end)
        node = ast.BinaryExpression(whole, BinaryOperator.GREATER, self._node(measured), self._node(limit))
        return self._pure(condition(node, self._model.scope, self._context))

    def _runs(self, span: Span) -> int:
        runs = self._constant(span)
        if not 1 <= runs <= _MOST_RUNS:
            raise self._wrong(f"the number of runs must be at least 1 and at most {_MOST_RUNS}", span)
        return runs

    def _time(self, span: Span) -> Fraction:
        match = _DURATION.fullmatch(span.text.strip())
        if match is None:
            return Fraction(self._constant(span))
        try:
            number = exact_number(match[1])
        except ValueError as error:
            raise self._wrong(str(error), span) from None
        if not match[2]:
            return number
        length = length_of(self._context.time_unit)
        if match[2] not in NANOSECONDS or length is None:
            what = "the model has no time unit" if length is None else f"unknown unit {match[2]}"
            raise self._wrong(what, span, "give a number of time units of the model")
        return number * NANOSECONDS[match[2]] / length

    def _constant(self, span: Span) -> int:
        value = constant_integer(self._node(span), "a bound", self._model.scope, self._context)
        if value is None:
            raise self._found()
        if value < 0:
            raise self._wrong("a bound must not be negative", span)
        return value

    # ---- expressions ----

    def _condition(self, span: Span) -> Expression:
        found = re.search(r"\bdeadlock\b", span.text)
        if found is not None and self._model.scope.lookup("deadlock") is None:
            place = Span(span.source, span.start + found.start(), span.start + found.end())
            raise self._unsupported("`deadlock` is not looked for in runs that are drawn", place)
        return self._pure(condition(self._read(span, measured=False), self._model.scope, self._context))

    def _value(self, span: Span) -> Expression:
        value = self._pure(expression(self._read(span, measured=True), self._model.scope, self._context))
        if not _is_number(value.type):
            raise self._wrong("expected a number, a condition or a clock", span)
        if isinstance(value, Conditional) and isinstance(value.type, ClockType):
            # Which clock is meant changes with the state, as that of a process that a variable names.
            raise _ComputesError(named_clocks(self._node(span), self._declared))
        return value

    def _pure(self, value: Expression | None) -> Expression:
        if value is None or not self._context.require_pure(value, "a query") or self._findings.has_errors:
            raise self._found()
        return value

    def _read(self, span: Span, measured: bool) -> ast.Expression:
        """The expression in a text. Raises _ComputesError where it needs clocks to be hybrid."""
        node = self._node(span)
        clocks = computed_clocks(node, self._declared, measured) - self._context.hybrid_clocks
        if clocks:
            raise _ComputesError(clocks)
        return node

    def _node(self, span: Span) -> ast.Expression:
        node, diagnostics = parse_expression(span)
        if node is None or diagnostics:
            if operators_in(span):
                raise self._wrong("a temporal operator is only read within Pr", span, _ONE_STATE)
            raise InputError(diagnostics) if diagnostics else self._wrong("expected an expression", span)
        return node

    def _found(self) -> InputError | UnsupportedError:
        found = self._findings.sorted()
        if self._findings.has_mistakes:
            return InputError(found)
        return UnsupportedError(next(each for each in found if each.is_unsupported))

    # ---- text ----

    def _skip(self) -> None:
        while match := _BLANK.match(self._text, self._at):
            self._at = match.end()

    def _peek(self) -> str:
        self._skip()
        return self._text[self._at : self._at + 1]

    def _taken(self, text: str) -> bool:
        self._skip()
        found = self._text.startswith(text, self._at)
        if found:
            self._at += len(text)
        return found

    def _bracketed(self, opening: str) -> Span:
        """The text between the bracket here and its partner, which is left behind."""
        if self._peek() != opening:
            raise self._wrong(f"expected {opening}")
        end = _partner(self._text, self._at)
        if end is None:
            raise self._wrong(f"{opening} is never closed")
        start, self._at = self._at + 1, end + 1
        return Span(self._span.source, self._span.start + start, self._span.start + end)

    def _here(self) -> Span:
        self._skip()
        start = self._span.start + self._at
        return Span(self._span.source, min(start, self._span.end - 1), self._span.end)

    def _wrong(self, message: str, span: Span | None = None, help_: str = _EXAMPLE) -> InputError:
        return InputError([Diagnostic("E0147", message, span or self._here(), help_)])

    def _unsupported(self, message: str, span: Span | None = None) -> UnsupportedError:
        return UnsupportedError(Diagnostic("E0728", message, span or self._here(), _EXAMPLE))


def _picking(span: Span) -> tuple[Span | None, Span]:
    """The part of ``simulate`` after its first colon: how many runs are shown, and which condition picks them."""
    match = re.match(r"([^:?]*):", span.text)
    if match is None:
        return None, span
    return Span(span.source, span.start, span.start + match.end(1)), Span(
        span.source, span.start + match.end(), span.end
    )


def _is_number(type_: Type) -> bool:
    return is_integral(type_) or type_ == DOUBLE or isinstance(type_, ClockType)


def _partner(text: str, start: int) -> int | None:
    """The end of the bracket that begins at a place. Brackets of intervals may differ: ``[0, 5)``."""
    depth = 0
    for place in range(start, len(text)):
        depth += (text[place] in "([{") - (text[place] in ")]}")
        if depth == 0:
            return place
    return None


def _is_within(limit: RunBound, bound: RunBound | None) -> bool:
    """True if an interval ends before the bound of the query does."""
    return bound is None or (bound.scale is Scale.TIME and limit.limit <= bound.limit)


def _begins_with_interval(span: Span) -> bool:
    text = span.text.lstrip()
    return text.startswith("[") or _is_half_open(span)


def _is_half_open(span: Span) -> bool:
    """True if a text begins with an interval that lacks one of its ends, or both: with a comma in round brackets."""
    text = span.text.lstrip()
    end = _partner(text, 0) if text.startswith(("[", "(")) else None
    if end is None or (text[0], text[end]) == ("[", "]"):
        return False
    start = span.end - len(text)
    return len(_parts(Span(span.source, start + 1, start + end), ",")) == 2


def _places(span: Span, separator: str) -> list[int]:
    """The places of a separator outside of all brackets."""
    text, depth, places = span.text, 0, []
    word = separator.isalpha()
    for place, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if depth or not text.startswith(separator, place):
            continue
        around = text[max(place - 1, 0) : place] + text[place + len(separator) : place + len(separator) + 1]
        if not word or not re.search(r"\w", around):
            places.append(place)
    return places


def _split(span: Span, separator: str) -> tuple[Span, Span] | None:
    places = _places(span, separator)
    if not places:
        return None
    first = span.start + places[0]
    return Span(span.source, span.start, first), Span(span.source, first + len(separator), span.end)


def _parts(span: Span, separator: str) -> list[Span]:
    cuts = [span.start - 1, *(span.start + place for place in _places(span, separator)), span.end]
    return [Span(span.source, first + 1, last) for first, last in pairwise(cuts)]
