"""The questions about a set of requirements, and the findings from the answers.

Sources: Post, Hoenicke, Podelski, "rt-inconsistency: a new property for real-time requirements" (FASE 2011).
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import partial
from typing import Any

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE, Source
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel
from tachk.logic.constant_values import value_of
from tachk.logic.simplify import simplify
from tachk.meaning.run_view import Snapshot, view_trace
from tachk.syntax import ast
from tachk.syntax.formula import And, Atom, Formula, Not, Or, TruthConstant, operands
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.rewrite import rewrite
from tachk.syntax.walk import nodes_of_kind
from tachk.verify.requirements.rules import Demand, RequirementRule, RequirementTrigger, rules_of
from tachk.verify.requirements.signals import NotFollowed, Signals, signals_of
from tachk.verify.requirements.world import NOW, SETTLED, World
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify

_COMPARED = {
    BinaryOperator.LESS: operator.lt,
    BinaryOperator.LESS_EQUAL: operator.le,
    BinaryOperator.EQUAL: operator.eq,
    BinaryOperator.NOT_EQUAL: operator.ne,
    BinaryOperator.GREATER: operator.gt,
    BinaryOperator.GREATER_EQUAL: operator.ge,
}


def folded(formula: Formula) -> Formula:
    """The formula without conditions that are constant. Its robustness is not kept, its truth is."""
    changed = rewrite(formula, _folded)
    return simplify(changed) if next(nodes_of_kind(changed, TruthConstant), None) is not None else changed


def _folded(node: Any) -> Any:
    match node:
        case ast.BinaryExpression(operator=sign, left=left, right=right) if sign in _COMPARED:
            try:
                truth = _COMPARED[sign](value_of(left, _no_constant), value_of(right, _no_constant))
            except (InputError, NotFollowed):
                return node
            return ast.BooleanLiteral(node.span, bool(truth))
        case Atom(span=span, expression=ast.BooleanLiteral(value=value)):
            return TruthConstant(span, value)
        case _:
            return node


def _no_constant(expression: ast.Expression) -> int:
    raise NotFollowed(NOWHERE, "it is not a constant")


@dataclass(frozen=True, slots=True)
class Requirement:
    """``formula``: durations are whole numbers; ``unfollowed``: why no rule says the same, else empty."""

    name: str
    formula: Formula
    rules: tuple[RequirementRule, ...] = ()
    unfollowed: str = ""


class FindingKind(StrEnum):
    INCONSISTENT = "inconsistent"
    """No run without end satisfies all of them."""
    COLLIDING = "colliding"
    """A run that has broken nothing yet cannot be saved: what is due collides."""
    REDUNDANT = "redundant"
    """One says nothing that the others do not say."""
    VACUOUS = "vacuous"
    """A requirement whose trigger never happens where all hold."""


@dataclass(frozen=True, slots=True)
class WitnessMoment:
    """``values``: of the signals that matter, from this time on, as text."""

    time: Fraction
    values: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class RequirementFinding:
    """Attributes:
    names: the requirement found fault with, or those that together are to blame.
    by: those that make it so.
    run: the shortest that shows it; the last entry is the moment at which nothing can go on. Empty where none does.
    """

    kind: FindingKind
    names: tuple[str, ...]
    by: tuple[str, ...] = ()
    run: tuple[WitnessMoment, ...] = ()


@dataclass(frozen=True, slots=True)
class RequirementAnalysis:
    """Attributes:
    signals: their names.
    undecided: questions without an answer, each a sentence.
    """

    requirements: tuple[Requirement, ...]
    signals: tuple[str, ...]
    findings: tuple[RequirementFinding, ...]
    undecided: tuple[str, ...]


def analyse(named: Iterable[tuple[str, Formula]], limits: Limits = Limits()) -> RequirementAnalysis:
    """The analysis of requirements: are they consistent, can they collide, is one redundant or vacuous?

    Args:
        named: durations are whole numbers of one unit of time.
        limits: of each search.
    """
    numbers: dict[str, bool] = {}
    requirements = tuple(_followed(name, formula, numbers) for name, formula in named)
    return _Analyst(requirements, limits).analysis()


def _followed(name: str, formula: Formula, numbers: dict[str, bool]) -> Requirement:
    """A requirement; the signals of those that are followed are added to ``numbers``."""
    formula = folded(formula)
    try:
        signals, rules = signals_of([formula], numbers), rules_of(formula)
        numbers.update(signals.are_numbers)
        return Requirement(name, formula, rules)
    except NotFollowed as reason:
        return Requirement(name, formula, unfollowed=f"`{reason.span.text}`: {reason.reason}")


class _Undecided(Exception):
    """A search ended without an answer; the message says why."""


class _Analyst:
    def __init__(self, requirements: tuple[Requirement, ...], limits: Limits) -> None:
        self.requirements = requirements
        self.followed = tuple(each for each in requirements if not each.unfollowed)
        self.limits = limits
        self.signals: Signals = signals_of([each.formula for each in self.followed])
        self.findings: list[RequirementFinding] = []
        self.undecided: list[str] = []
        self.dead_ends: dict[tuple[str, ...], tuple[WitnessMoment, ...]] = {}
        # Requirements whose own trigger never happens where they and the others of a set hold.
        self.forbidden: dict[tuple[Requirement, ...], list[Requirement]] = {}

    def analysis(self) -> RequirementAnalysis:
        for each in self.requirements:
            if each.unfollowed:
                self.undecided.append(f"{each.name} is not followed: {each.unfollowed}")
        for group in self._groups():
            self.followed = group
            found = len(self.findings)
            self._examine(f"whether {_listed(group)} can be satisfied", self._consistency)
            if len(self.findings) > found:
                continue
            self._examine(f"whether some of {_listed(group)} can collide", self._collisions)
            for each in group:
                self._examine(f"whether {each.name} says something of its own", partial(self._own_part, each))
            for core, members in self.forbidden.items():
                self._report(FindingKind.VACUOUS, members, core)
            self.forbidden.clear()
        names = tuple(signal.name for signal in self.signals.all)
        return RequirementAnalysis(self.requirements, names, tuple(self.findings), tuple(self.undecided))

    def _groups(self) -> list[tuple[Requirement, ...]]:
        """The requirements that have to do with one another: those of different groups share no signal."""
        groups: list[tuple[frozenset[int], list[Requirement]]] = []
        for each in self.followed:
            used = self.signals.named_in(each.formula)
            joined = [group for group in groups if group[0] & used]
            groups = [group for group in groups if not group[0] & used]
            members = [member for group in joined for member in group[1]]
            groups.append((used.union(*(group[0] for group in joined)), [*members, each]))
        order = {each.name: number for number, each in enumerate(self.followed)}
        return [tuple(sorted(members, key=lambda each: order[each.name])) for _, members in groups]

    def _examine(self, what: str, question: Callable[[], None]) -> None:
        try:
            question()
        except _Undecided as reason:
            self.undecided.append(f"{what} is not known: {reason}")

    # ---- the questions ----------------------------------------------------------------------------------------------

    def _consistency(self) -> None:
        if not self._is_inconsistent(self.followed):
            return
        core = self._smallest(self.followed, self._is_inconsistent)
        self._report(FindingKind.INCONSISTENT, core, run=self._dead_end(core))

    def _is_inconsistent(self, chosen: Sequence[Requirement]) -> bool:
        """True if no run without end satisfies the requirements. Raises _Undecided."""
        world = self._world(chosen)
        if self._reached(world, world.quiet) is not None or not self._dead_end(chosen):
            return False
        last = sum(rule.length for rule in world.rules) + 1
        clock = f"process Age() {{ clock age; init location A {{ to B {{ guard age > {last}; }} }} location B; }}"
        model = world.text().replace("system World", f"{clock}\nsystem Age, World")
        if self._verdict(model, "E<> Age.B").answer is Answer.FAILS:
            return True
        raise _Undecided("all runs that were found have something open at any time, and some runs cannot go on")

    def _collisions(self) -> None:
        """Sets of requirements that can collide, each of which is as small as possible; sets that share all but one
        requirement with one that is reported already are not looked for."""
        left = self.followed
        while self._dead_end(left):
            core = self._smallest(left, lambda chosen: bool(self._dead_end(chosen)))
            self._report(FindingKind.COLLIDING, core, run=self._dead_end(core))
            left = tuple(each for each in left if each != core[-1])

    def _own_part(self, each: Requirement) -> None:
        """A requirement whose trigger never happens says nothing either; that is the more telling finding."""
        found = len(self.findings)
        self._vacuity(each)
        if len(self.findings) == found:
            self._redundancy(each)

    def _redundancy(self, each: Requirement) -> None:
        others = self._others(each)
        if not self._implied(each, others):
            return
        core = self._smallest(others, lambda chosen: self._implied(each, chosen))
        self._report(FindingKind.REDUNDANT, (each,), core)

    def _implied(self, each: Requirement, others: Sequence[Requirement]) -> bool:
        if isinstance(each.formula, TruthConstant):
            return each.formula.value
        encoded = rewrite(each.formula, self._encoded)
        text = print_formula(encoded)
        if _is_condition(encoded):  # about the beginning: models have no such property
            text = f"F[0, 0] ({text})"
        verdict = self._verdict(self._world(others, speaking=each).text(), text, decided=False)
        return verdict.answer is Answer.HOLDS

    def _vacuity(self, each: Requirement) -> None:
        triggers = [
            rule.trigger for rule in each.rules if rule.trigger != RequirementTrigger() and not rule.trigger.initially
        ]
        if len(triggers) < len(each.rules) or not triggers:
            return
        if not self._never(each, triggers, self.followed):
            return
        never = partial(self._never, each, triggers)
        others = self._others(each)
        if never(others):
            self._report(FindingKind.VACUOUS, (each,), self._smallest(others, never))
        elif not all(_forbids(rule) for rule in each.rules):
            core = self._smallest(self.followed, never)
            self.forbidden.setdefault(core, []).append(each)

    def _never(self, each: Requirement, triggers: Sequence[RequirementTrigger], others: Sequence[Requirement]) -> bool:
        anything = ast.BooleanLiteral(NOWHERE, True)
        world = self._world(others, [RequirementRule(trigger, Demand.NOW, anything) for trigger in triggers], each)
        return all(self._reached(world, world.triggered(trigger)) is None for trigger in triggers)

    # ---- means ------------------------------------------------------------------------------------------------------

    def _others(self, each: Requirement) -> tuple[Requirement, ...]:
        return tuple(other for other in self.followed if other != each)

    def _smallest(
        self, given: Sequence[Requirement], has: Callable[[Sequence[Requirement]], bool]
    ) -> tuple[Requirement, ...]:
        """Requirements that have a property together, and none of which can be left out; the first are kept."""
        needed = list(given)
        for each in reversed(given):
            fewer = [other for other in needed if other != each]
            try:
                if has(fewer):
                    needed = fewer
            except _Undecided:
                continue
        return tuple(needed)

    def _dead_end(self, chosen: Sequence[Requirement]) -> tuple[WitnessMoment, ...]:
        """A run that cannot go on; empty if there is none."""
        names = tuple(each.name for each in chosen)
        if names not in self.dead_ends:
            place = f"({SETTLED} || World.Start) && deadlock"
            self.dead_ends[names] = self._reached(self._world(chosen), place) or ()
        return self.dead_ends[names]

    def _world(
        self, chosen: Sequence[Requirement], more: Sequence[RequirementRule] = (), speaking: Requirement | None = None
    ) -> World:
        """``speaking``: another requirement, whose signals there must be as well."""
        all_ = [*chosen, *([speaking] if speaking is not None else [])]
        used = frozenset[int]().union(*(self.signals.named_in(each.formula) for each in all_))
        return World(self.signals, (*(rule for each in chosen for rule in each.rules), *more), tuple(sorted(used)))

    def _reached(self, world: World, place: str) -> tuple[WitnessMoment, ...] | None:
        """A run to such a place; None if there is none. Raises _Undecided."""
        model = load_model(Source("requirements", world.text([f"property p : E<> {place};"])))
        verdict = self._decided(model)
        if verdict.answer is Answer.FAILS:
            return None
        assert verdict.trace is not None
        view = view_trace(model.network, verdict.trace)
        states = [view.initial, *(step.state for step in view.steps)]
        return self._moments(states)

    def _verdict(self, model: str, property_: str, decided: bool = True) -> Verdict:
        loaded = load_model(Source("requirements", f"{model}\nproperty p : {property_};"))
        if not decided and not loaded.queries:
            raise _Undecided("tachk has no observer for it")
        return self._decided(loaded)

    def _decided(self, model: LoadedModel) -> Verdict:
        (verdict,) = verify(model.network, model.queries, Options(shortest=True), self.limits)
        if verdict.reason == INTERRUPTED:
            raise KeyboardInterrupt
        if verdict.answer is Answer.UNKNOWN:
            raise _Undecided(verdict.reason or "the search came to no end")
        return verdict

    def _moments(self, states: Sequence[Snapshot]) -> tuple[WitnessMoment, ...]:
        found: list[WitnessMoment] = []
        for state in states:
            variables = dict(state.variables)
            assert state.time is not None
            if ("World", "Running") in state.locations and variables["begun"]:
                values = {
                    signal.name: signal.shown(int(variables[f"{NOW}{n}"]))
                    for n, signal in enumerate(self.signals.all)
                    if f"{NOW}{n}" in variables
                }
                moment = WitnessMoment(state.time, values)
                if not found or found[-1].values != moment.values:
                    found.append(moment)
        last = states[-1]
        assert last.time is not None
        if found and last.time > found[-1].time:
            found.append(replace(found[-1], time=last.time))
        return tuple(found) or (WitnessMoment(Fraction(0), {}),)

    def _encoded(self, node: Any) -> Any:
        if isinstance(node, Atom):
            return replace(node, expression=self.signals.encoded(node.expression, NOW))
        return node

    def _report(
        self,
        kind: FindingKind,
        requirements: Iterable[Requirement],
        by: Iterable[Requirement] = (),
        run: tuple[WitnessMoment, ...] = (),
    ) -> None:
        names = tuple(each.name for each in requirements)
        self.findings.append(RequirementFinding(kind, names, tuple(each.name for each in by), run))


def _forbids(rule: RequirementRule) -> bool:
    """True if a rule says of its trigger only that it must not happen."""
    return rule.demand is not Demand.COME and rule.condition == ast.BooleanLiteral(rule.condition.span, False)


def _listed(requirements: Sequence[Requirement]) -> str:
    return ", ".join(each.name for each in requirements)


def _is_condition(formula: Formula) -> bool:
    """True if no operator in it is about time."""
    pending = [formula]
    while pending:
        each = pending.pop()
        if not isinstance(each, (TruthConstant, Atom, Not, And, Or)):
            return False
        pending += operands(each)
    return True
