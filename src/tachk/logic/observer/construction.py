"""Observers: automata beside a model that can reach their location `Bad` exactly if the model can violate a formula.

An observer guesses how the formula is violated and checks its guess; it never keeps the model from doing anything. Its
locations have requirements. Where one fails, a broadcast over an urgent channel without receivers is enabled: time
stands still until the observer has left, and a requirement that fails for no time, between two updates at one instant,
does not count. docs/logic.md describes the construction.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.logic.observer.conditions import Conjunction, all_of, is_false, negated, truth
from tachk.logic.observer.goals import Goal, NoObserver, saved_expressions
from tachk.logic.observer.names import location_names
from tachk.logic.observer.past_windows import looking_ahead
from tachk.logic.observer.states import SHOWN, State, answered_in, binds, is_endless, timed_tasks
from tachk.logic.observer.tableau import Tableau, TableauStep
from tachk.logic.observer.violation import violation
from tachk.logic.observer.ways import most_branches
from tachk.syntax import ast
from tachk.syntax.formula import Formula
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.rewrite import fresh_name, names_in

__all__ = ["BAD", "BuiltObserver", "NoObserver", "TrapLocation", "build_observer"]

BAD = "Bad"
"""The location that is reachable if and only if the formula can be violated."""

MAXIMAL_LOCATIONS = 200
MAXIMAL_CLOCKS = 6
MAXIMAL_BRANCHES = 4096
"""Ways to reach a goal at one instant."""
_CLOCKS = ("x", "y", "z", "u", "v", "w")


@dataclass(frozen=True, slots=True)
class TrapLocation:
    """A location that a run violates the formula by never leaving, or that leads to such ones.

    Attributes:
        entry: where a run gets into the ending from elsewhere, and is for one step of the observer; None: it does not.
        condition: what holds in every state there.
        again: the same number at all endings: conditions each of which such a run must meet again and again, in one
            ending or the other. None: it is not met here. A run that ends must end where it meets all.
    """

    location: str
    entry: str | None
    condition: ast.Expression
    again: tuple[ast.Expression | None, ...] = ()


@dataclass(frozen=True, slots=True)
class BuiltObserver:
    """``template``: without parameters and with a location ``Bad``; ``endings``: empty where each violation is seen
    in a finite run. Where there are some, the observer must be able to act in every state (`Location.observes`)."""

    template: ast.Template
    endings: tuple[TrapLocation, ...] = ()


def build_observer(formula: Formula, name: str, taken: Iterable[str] = ()) -> BuiltObserver:
    """The observer of a formula.

    Args:
        formula: durations are numbers of time units.
        name: of the template.
        taken: names that the names inside the template must differ from, beside those in the formula.

    Raises:
        NoObserver: for a formula that no automaton of this kind decides; names the part that is to blame.
    """
    goal = violation(looking_ahead(formula))
    if most_branches(goal) > MAXIMAL_BRANCHES:
        raise NoObserver(formula.span, f"it can be violated in more than {MAXIMAL_BRANCHES} ways")
    used = {*names_in(formula), *taken, name}
    writer = _ObserverWriter(formula.span, goal, name, used)
    return BuiltObserver(writer.template(), writer.endings())


@dataclass(slots=True)
class _Automaton:
    """The part of a tableau from which `SHOWN` or an endless state can be reached."""

    states: list[State] = field(default_factory=list)
    steps: dict[State, list[TableauStep]] = field(default_factory=dict)


class _ObserverWriter:
    def __init__(self, span: Span, goal: Goal, name: str, used: set[str]) -> None:
        self.span = span
        self.name = name
        saved: dict[ast.Expression, str] = {}
        for expression in saved_expressions(goal):
            saved[expression] = fresh_name("saved", used)
            used.add(saved[expression])
        self.saved = saved
        self.tableau = Tableau(goal, span, saved)
        self.automaton = _explored(self.tableau, span)
        self.clocks = self._clock_names(used)
        used.update(self.clocks)
        self.channel = fresh_name("now", used)
        used.add(self.channel)
        self.initial = [entry for entry in self.tableau.initial if entry[0] in self.automaton.steps or not entry[0]]
        first = self.initial[0] if len(self.initial) == 1 else None
        self.start: State | None = first[0] if first is not None and not first[1] else None
        """The only state to begin in; None: an urgent location chooses."""
        idle = self.tableau.idle
        self.idle = idle if idle in self.automaton.steps else None
        self.names = location_names(self.automaton.states, self.idle, used)
        self.has_endings = any(map(is_endless, self.automaton.states))
        self.entries = self._entry_names({*used, *self.names.values()})
        self.bad = BAD
        self.passed = fresh_name("Passed", used)
        self.gives_up = False

    def _clock_names(self, used: set[str]) -> list[str]:
        found = {guard.clock for steps in self.automaton.steps.values() for step in steps for guard in step.clocks}
        names: list[str] = []
        for number in range(max(found, default=-1) + 1):
            if number >= MAXIMAL_CLOCKS:
                raise NoObserver(self.span, f"its observer would need more than {MAXIMAL_CLOCKS} clocks")
            names.append(fresh_name(_CLOCKS[number], used | set(names)))
        return names

    def _entry_names(self, used: set[str]) -> dict[State, str]:
        """A location for each state that binds and is reached from one that does not, or is there from the start."""
        reached = {state for state, _ in self.initial}
        for source, steps in self.automaton.steps.items():
            if not binds(source):
                reached |= {step.target for step in steps}
        names: dict[State, str] = {}
        for state in self.automaton.states:
            if self.has_endings and state in reached and binds(state):
                names[state] = fresh_name("Entry", used)
                used.add(names[state])
        return names

    # ---- the template -----------------------------------------------------------------------------------------------

    def template(self) -> ast.Template:
        locations = [self._location(state) for state in self.automaton.states]
        locations += [self._entry(state) for state in self.entries]
        if self.start is None and self.initial:
            locations = [*self._beginning(), *locations]
        hopeless = not locations and self.start is None
        if self.gives_up or hopeless:
            locations.append(self._plain(self.passed, initial=hopeless))
        locations.append(self._plain(self.bad, initial=self.start == SHOWN))
        return ast.Template(
            self.span, self._identifier(self.name), (), self._declarations(), tuple(locations), classic=False
        )

    def endings(self) -> tuple[TrapLocation, ...]:
        if not self.has_endings:
            return ()
        binding = [state for state in self.automaton.states if binds(state)]
        endless = list(filter(is_endless, binding))
        answered = sorted({task.goal for state in endless for task in answered_in(state)}, key=repr)
        # A further condition to meet: nothing is left to be seen once, and every assertion holds.
        settles = endless != binding or any(map(self.tableau.settled, endless))

        def again(state: State) -> Iterator[ast.Expression | None]:
            if settles:
                yield all_of(self.tableau.settled(state), self.span) if is_endless(state) else None
            for goal in answered:
                yield self.tableau.meets(state, goal) if is_endless(state) else None

        return tuple(
            TrapLocation(
                self.names[state],
                self.entries.get(state),
                all_of(self.tableau.lasting(state), self.span),
                tuple(again(state)),
            )
            for state in binding
        )

    def _declarations(self) -> tuple[ast.VariableDeclaration, ...]:
        found = []
        if self.clocks:
            found.append(self._declaration((), ast.BuiltinType(self.span, "clock"), self.clocks))
        if self.saved:
            high = ast.IntegerLiteral(self.span, 2**31 - 1)
            low = self._binary(
                BinaryOperator.SUBTRACT, ast.UnaryExpression(self.span, PrefixOperator.MINUS, high), self._number(1)
            )
            found.append(self._declaration((), ast.RangeType(self.span, low, high), list(self.saved.values())))
        found.append(self._declaration(("urgent", "broadcast"), ast.BuiltinType(self.span, "chan"), [self.channel]))
        return tuple(found)

    def _declaration(
        self, prefixes: tuple[str, ...], base: ast.BuiltinType | ast.RangeType, names: list[str]
    ) -> ast.VariableDeclaration:
        type_ = ast.TypeExpression(self.span, prefixes, base)
        return ast.VariableDeclaration(
            self.span, type_, tuple(ast.Declarator(self.span, self._identifier(name)) for name in names)
        )

    def _plain(self, name: str, initial: bool = False) -> ast.LocationDeclaration:
        return ast.LocationDeclaration(self.span, self._identifier(name), initial=initial)

    def _beginning(self) -> list[ast.LocationDeclaration]:
        """The locations before the run: the observer guesses its first state before time passes; if the run need not
        settle first and an ending counts from the first state on, it guesses before anything happens."""
        used = {*self.names.values(), *self.entries.values(), self.channel, *self.clocks, self.passed}
        start = fresh_name("Start", used)
        edges = {
            state: self._edge(self._name_of(state, entering=True), self._guard((), condition), [], urgent=False)
            for state, condition in self.initial
        }
        at_once = [edges[state] for state, condition in self.initial if not condition]
        settling = [edges[state] for state, condition in self.initial if condition]
        if not at_once:
            settling.append(self._edge(self._fallback(), None, [], urgent=False))
        if not self.entries or not at_once:
            return [self._chooser(start, [*at_once, *settling], initial=True)]
        if not settling:
            return [self._chooser(start, at_once, initial=True, committed=True)]
        later = fresh_name("Settling", {*used, start})
        settling.append(self._edge(self._fallback(), None, [], urgent=False))
        at_once.append(self._edge(later, None, [], urgent=False))
        return [
            self._chooser(start, at_once, initial=True, committed=True),
            self._chooser(later, settling, initial=False),
        ]

    def _chooser(
        self, name: str, edges: list[ast.EdgeDeclaration], initial: bool, committed: bool = False
    ) -> ast.LocationDeclaration:
        return ast.LocationDeclaration(
            self.span,
            self._identifier(name),
            initial=initial,
            urgent=not committed,
            committed=committed,
            edges=tuple(edges),
        )

    def _entry(self, state: State) -> ast.LocationDeclaration:
        """The location through which a binding state is entered. The observer leaves it at once, so that what is
        awaited from then on is awaited from this state of the run on."""
        limits = [self._compare(*at, BinaryOperator.LESS_EQUAL) for at in sorted(self.tableau.deadlines(state))]
        return ast.LocationDeclaration(
            self.span,
            self._identifier(self.entries[state]),
            all_of(limits, self.span) if limits else None,
            initial=state == self.start,
            committed=True,
            edges=(self._edge(self.names[state], None, [], urgent=False),),
        )

    def _location(self, state: State) -> ast.LocationDeclaration:
        requirement = self.tableau.requirement(state)
        steps = [step for step in self.automaton.steps[state] if not self._is_escape(step, requirement)]
        edges = [self._step(step) for step in steps]
        if requirement:
            guard = None if is_false(requirement) else negated(all_of(requirement, self.span))
            edges.append(self._edge(self._fallback(), guard, self._forgotten(state, None), urgent=True))
        limits = []
        for (clock, value), target in sorted(self.tableau.deadlines(state).items(), key=lambda entry: entry[0]):
            limits.append(self._compare(clock, value, BinaryOperator.LESS_EQUAL))
            where = self._fallback() if target is None else self._name_of(target)
            edges.append(
                self._edge(
                    where,
                    self._compare(clock, value, BinaryOperator.GREATER_EQUAL),
                    self._forgotten(state, target),
                    False,
                )
            )
        return ast.LocationDeclaration(
            self.span,
            self._identifier(self.names[state]),
            all_of(limits, self.span) if limits else None,
            initial=state == self.start and state not in self.entries,
            edges=tuple(edges),
            doc=self._doc(requirement),
        )

    def _doc(self, requirement: Conjunction) -> str:
        if not requirement or is_false(requirement):
            return ""
        return f"while {print_expression(all_of(requirement, self.span))}"

    def _is_escape(self, step: TableauStep, requirement: Conjunction) -> bool:
        """True if the way out that is taken where the requirement fails does the same."""
        return (
            step.target == self.idle
            and not step.clocks
            and step.condition == frozenset((negated(all_of(requirement, self.span)),))
        )

    def _step(self, step: TableauStep) -> ast.EdgeDeclaration:
        clocks = [self._compare(guard.clock, guard.value, guard.operator) for guard in step.clocks]
        updates = []
        if step.reset is not None and step.target != SHOWN and step.reset < len(self.clocks):
            updates.append(self._assign(self.clocks[step.reset], self._number(0)))
        if step.saved is not None:
            updates.append(self._assign(self.saved[step.saved], step.saved))
        updates += self._forgotten(step.source, step.target)
        target = self._name_of(step.target, entering=not binds(step.source))
        return self._edge(target, self._guard(clocks, step.condition), updates, step.forced)

    def _forgotten(self, source: State, target: State | None) -> list[ast.Expression]:
        """Updates that reset saved values that are not read any more, so that states become equal."""
        saved_after = set() if target is None else self._saved_in(target)
        return [self._assign(name, self._number(0)) for name in sorted(self._saved_in(source) - saved_after)]

    def _saved_in(self, state: State) -> set[str]:
        return {name for name in names_in(tuple(self.tableau.requirement(state))) if name in self.saved.values()}

    def _name_of(self, state: State, entering: bool = False) -> str:
        if state == SHOWN:
            return self.bad
        if entering and state in self.entries:
            return self.entries[state]
        return self.names.get(state) or self._fallback()

    def _fallback(self) -> str:
        if self.idle is not None:
            return self.names[self.idle]
        self.gives_up = True
        return self.passed

    # ---- pieces of syntax -------------------------------------------------------------------------------------------

    def _edge(
        self, target: str, guard: ast.Expression | None, updates: list[ast.Expression], urgent: bool
    ) -> ast.EdgeDeclaration:
        label = (
            ast.SynchronisationLabel(self.span, ast.NameExpression(self.span, self.channel), Direction.SEND)
            if urgent
            else None
        )
        return ast.EdgeDeclaration(self.span, None, self._identifier(target), (), guard, label, tuple(updates))

    def _guard(self, clocks: Iterable[ast.Expression], condition: Conjunction) -> ast.Expression | None:
        parts = [*clocks, *([all_of(condition, self.span)] if condition else [])]
        result: ast.Expression | None = None
        for part in parts:
            result = part if result is None else self._binary(BinaryOperator.AND, result, part)
        return None if result == truth(True, self.span) else result

    def _compare(self, clock: int, value: int, operator: BinaryOperator) -> ast.Expression:
        return self._binary(operator, ast.NameExpression(self.span, self.clocks[clock]), self._number(value))

    def _binary(self, operator: BinaryOperator, left: ast.Expression, right: ast.Expression) -> ast.Expression:
        return ast.BinaryExpression(self.span, operator, left, right)

    def _assign(self, name: str, value: ast.Expression) -> ast.Expression:
        return ast.AssignmentExpression(self.span, None, ast.NameExpression(self.span, name), value)

    def _number(self, value: int) -> ast.Expression:
        return ast.IntegerLiteral(self.span, value)

    def _identifier(self, name: str) -> ast.Identifier:
        return ast.Identifier(self.span, name)


def _explored(tableau: Tableau, span: Span) -> _Automaton:
    """All states that can be reached and that lead to `SHOWN` or are endless, in breadth-first order."""
    too_large = NoObserver(span, f"its observer would need more than {MAXIMAL_LOCATIONS} locations")
    initial = [state for state, _ in tableau.initial]
    steps: dict[State, list[TableauStep]] = {}
    waiting = deque([*initial, *([tableau.idle] if tableau.idle is not None else [])])
    seen = set(waiting)

    def notice(state: State) -> None:
        if state not in seen:
            seen.add(state)
            waiting.append(state)
            if len(seen) > MAXIMAL_LOCATIONS:
                raise too_large

    while waiting:
        state = waiting.popleft()
        if state == SHOWN:
            continue
        # Of tasks with clocks each leads to another location.
        if max(len(seen), timed_tasks(state)) > MAXIMAL_LOCATIONS:
            raise too_large
        found: dict[TableauStep, None] = {}
        for step in tableau.steps(state):
            found[step] = None
            notice(step.target)
        for target in tableau.deadlines(state).values():
            if target is not None:
                notice(target)
        steps[state] = list(found)
    useful = {SHOWN, *(state for state in steps if is_endless(state))}
    grown = True
    while grown:
        more = {
            state for state, found in steps.items() if state not in useful and any(s.target in useful for s in found)
        }
        grown = bool(more)
        useful |= more
    states = [state for state in steps if state in useful]
    return _Automaton(states, {state: [step for step in steps[state] if step.target in useful] for state in states})
