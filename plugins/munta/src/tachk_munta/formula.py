"""Formulas about states: connected comparisons of locations, variables and clocks with constants."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tachk.api.plugin import (
    Binary,
    BinaryOperator,
    Conjunction,
    Deadlock,
    Disjunction,
    Environment,
    Expression,
    Quantifier,
    QuantifierKind,
    ScalarLike,
    Span,
    Unary,
    UnaryOperator,
    Variable,
    bounds,
    depends_on_clocks,
    disjunctive,
    evaluate,
    walk,
)
from tachk_munta.actions import clock_conjunctions, too_many_cases, unsupported
from tachk_munta.cases import CaseFinder, KnownContents, MuntaCase, SlotCondition, TooManyCasesError
from tachk_munta.network import Variables


@dataclass(frozen=True, slots=True)
class Clocks:
    """A constraint on clocks."""

    conjunction: Conjunction


@dataclass(frozen=True, slots=True)
class Every:
    """All of them hold; none is true."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Some:
    """At least one holds; none is false."""

    parts: tuple[Formula, ...]


Formula = SlotCondition | Clocks | Every | Some

TRUE, FALSE = Every(()), Some(())

MOST_ALTERNATIVES = 10_000


class TooManyAlternativesError(Exception):
    """A formula has too many alternatives for a list."""


@dataclass(frozen=True, slots=True)
class FormulaFinder:
    """Where predicates of queries hold."""

    finder: CaseFinder

    def formula(self, predicate: Expression, negated: bool = False) -> Formula:
        """Where a predicate, or its negation, holds whatever its parts are that have no value.

        Raises UnsupportedError.
        """
        return self._formula(predicate, not negated, {})

    def _formula(self, node: Expression, positive: bool, bound: Mapping[Variable, int]) -> Formula:
        match node:
            case Unary(UnaryOperator.NOT, operand):
                return self._formula(operand, not positive, bound)
            case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right):
                flipped = positive if operator is not BinaryOperator.IMPLY else not positive
                parts = [self._formula(left, flipped, bound), self._formula(right, positive, bound)]
                return _joined((operator is BinaryOperator.AND) is positive, parts)
            case Quantifier(QuantifierKind.FORALL | QuantifierKind.EXISTS as kind, variable, body):
                assert isinstance(variable.type, ScalarLike)
                low, high = bounds(variable.type)
                parts = [self._formula(body, positive, {**bound, variable: value}) for value in range(low, high + 1)]
                return _joined((kind is QuantifierKind.FORALL) is positive, parts)
            case _:
                return self._comparison(node, positive, bound)

    def _comparison(self, node: Expression, positive: bool, bound: Mapping[Variable, int]) -> Formula:
        if any(isinstance(part, Deadlock) for part in walk(node)):
            raise unsupported("`deadlock` beside other conditions", node.span, "ask for it alone: `A[] !deadlock`")

        def outcome(environment: Environment, contents: KnownContents) -> Disjunction | None:
            for variable, value in bound.items():
                environment.bind(variable, value)
            if depends_on_clocks(node):
                return clock_conjunctions(disjunctive(node, environment, not positive), node.span) or None
            return [()] if (evaluate(node, environment) != 0) is positive else None

        return _joined(False, [_case(case) for case in self._cases(outcome, node.span)])

    def _cases(self, outcome: object, span: Span) -> list[MuntaCase[Disjunction]]:
        try:
            return self.finder.find(outcome)  # type: ignore[arg-type]
        except TooManyCasesError as error:
            raise too_many_cases("its value", self.finder.range_of(error.slot), span) from None


def _case(case: MuntaCase[Disjunction]) -> Formula:
    clocks = _joined(False, [_joined(True, [Clocks(c)] if c else []) for c in case.outcome])
    return _joined(True, [*case.conditions, clocks])


def _joined(every: bool, parts: Iterable[Formula]) -> Formula:
    """Parts joined by "and" (every) or by "or", as flat as can be."""
    kind, neutral, absorbing = (Every, TRUE, FALSE) if every else (Some, FALSE, TRUE)
    flat: dict[Formula, None] = {}
    for part in parts:
        if part == absorbing:
            return absorbing
        flat |= dict.fromkeys(part.parts if isinstance(part, kind) else (part,))
    found = tuple(part for part in flat if part != neutral)
    return found[0] if len(found) == 1 else kind(found)


def has_clocks(formula: Formula) -> bool:
    match formula:
        case Clocks():
            return True
        case SlotCondition():
            return False
        case Every(parts) | Some(parts):
            return any(map(has_clocks, parts))


def slots_in(formula: Formula) -> set[int]:
    match formula:
        case Clocks():
            return set()
        case SlotCondition(slot):
            return {slot}
        case Every(parts) | Some(parts):
            return {slot for part in parts for slot in slots_in(part)}


def alternatives(formula: Formula) -> list[tuple[tuple[SlotCondition, ...], Conjunction]]:
    """The disjunctive normal form."""
    match formula:
        case Clocks(conjunction):
            return [((), conjunction)]
        case SlotCondition():
            return [((formula,), ())]
        case Some(parts):
            return [one for part in parts for one in alternatives(part)]
        case Every(parts):
            found: list[tuple[tuple[SlotCondition, ...], Conjunction]] = [((), ())]
            for part in parts:
                found = [(a + c, b + d) for a, b in found for c, d in alternatives(part)]
                if len(found) > MOST_ALTERNATIVES:
                    raise TooManyAlternativesError
            return found


def written(formula: Formula, names: Mapping[tuple[int, int], str], variables: Variables, outer: bool = True) -> str:
    """A formula without clocks in Munta's words.

    Args:
        names: of the locations that Munta knows, by process and location: ``P.loc``.
    """
    match formula:
        case SlotCondition(slot, low, high) if slot < 0:
            process = -1 - slot
            inside = [names[process, n] for n in range(low, high + 1) if (process, n) in names]
            return _text(" || ", inside, outer, next(iter(names.values())))
        case SlotCondition():
            return variables.condition(formula)
        case Some(parts):
            texts = [written(part, names, variables) for part in parts]
            return _text(" || ", texts, outer, next(iter(names.values())))
        case Every(parts):
            texts = [written(part, names, variables, False) for part in parts]
            if not texts:
                some = next(iter(names.values()))
                return f"({some} || !({some}))"
            return " && ".join(texts)
        case Clocks():
            raise AssertionError("clocks are tested by an edge")


def _text(junction: str, texts: list[str], outer: bool, some: str) -> str:
    if not texts:
        return f"({some} && !({some}))"
    text = junction.join(texts)
    return text if outer or len(texts) == 1 else f"({text})"
