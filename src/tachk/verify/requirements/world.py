"""A model of everything that may happen while no rule is broken, written in the modelling language.

All signals change together, at most once at an instant: so a value at an instant is what lasts from then on. A change
that breaks a rule at once cannot be chosen, and time does not pass a deadline that is not met. A run that cannot go on
has broken nothing yet, and nothing can save it. A clock that ticks keeps a run from counting as one that cannot go on
where only time passes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression
from tachk.verify.requirements.rules import Demand, RequirementRule, RequirementTrigger
from tachk.verify.requirements.signals import Signals

SETTLED = "World.Running"
"""The location between two changes."""

NOW, NEXT, CHOSEN = "s", "n", "a"
"""Prefixes of the values before a change, after it, and of those that are tried."""


@dataclass(frozen=True, slots=True)
class World:
    """Some rules over signals.

    Attributes:
        rules: numbered by their order.
        used: the numbers of the signals that there are.
    """

    signals: Signals
    rules: tuple[RequirementRule, ...]
    used: tuple[int, ...]

    def text(self, properties: Iterable[str] = ()) -> str:
        """The model, with the given lines behind it."""
        lines = ["broadcast chan step;", "int[0, 1] begun;"]
        for number in self.used:
            largest = self.signals.all[number].largest
            lines += [f"int[0, {largest}] {NOW}{number};", f"int[0, {largest}] {NEXT}{number};"]
        lines += [f"int[0, 1] r{number}; clock x{number};" for number in range(len(self.rules))]
        lines += [f"int[0, 1] o{number};" for number in range(len(self._once()))]
        lines += self._world()
        names = ["World", "Ticks"]
        lines.append("process Ticks() { clock z; init location T { to T { guard z >= 1; assign z = 0; } } }")
        for number, rule in enumerate(self.rules):
            process = self._process(number, rule)
            lines += process
            names += [f"R{number}"] if process else []
        return "\n".join((*lines, f"system {', '.join(names)};", *properties))

    def triggered(self, trigger: RequirementTrigger) -> str:
        """The predicate that a trigger is there at the instant of a change."""
        return f"World.Chosen && {self._at(trigger, NEXT)}"

    @property
    def quiet(self) -> str:
        """A state in which nothing is awaited, so that it may last for ever."""
        waiting = [f"r{number} == 0" for number, rule in enumerate(self.rules) if rule.demand is Demand.COME]
        return " && ".join((SETTLED, *waiting))

    # ---- processes --------------------------------------------------------------------------------------------------

    def _world(self) -> list[str]:
        numbers = self.used
        ranges = ", ".join(f"{CHOSEN}{n} : int[0, {self.signals.all[n].largest}]" for n in numbers)
        select = f"select {ranges};" if ranges else ""
        allowed = " && ".join(f"({part})" for part in self._allowed()) or "true"
        change = " || ".join(f"{CHOSEN}{n} != {NOW}{n}" for n in numbers) or "false"
        moves = ", ".join(f"{NEXT}{n} = {CHOSEN}{n}" for n in numbers)
        assign = f"assign {moves};" if moves else ""
        latched = [f"o{n} = {self._held(n, NEXT)} ? 1 : 0" for n in range(len(self._once()))]
        moved = [f"{NOW}{n} = {NEXT}{n}" for n in numbers] + [f"{NEXT}{n} = 0" for n in numbers]
        taken = ", ".join((*latched, *moved, "begun = 1", "w = 0"))
        return [
            "process World() {",
            "clock w;",
            f"urgent init location Start {{ to Chosen {{ {select} guard {allowed}; {assign} }} }}",
            f"committed location Chosen {{ to Running {{ sync step!; assign {taken}; }} }}",
            (f"location Running {{ to Chosen {{ {select} guard w > 0 && ({change}) && {allowed}; {assign} }} }}"),
            "}",
        ]

    def _allowed(self) -> list[str]:
        """The condition that a change must not break at once."""
        found = []
        for number, rule in enumerate(self.rules):
            now = self._at(rule.trigger, CHOSEN)
            holds = self._text(rule.condition, CHOSEN)
            match rule.demand:
                case Demand.NOW:
                    found.append(f"!({now}) || {holds}")
                case Demand.STAY:
                    found.append(f"!(r{number} == 1 || ({now})) || {holds}")
                case Demand.COME:
                    found.append(f"r{number} == 0 || x{number} < {rule.length} || {holds}")
        return found

    def _process(self, number: int, rule: RequirementRule) -> list[str]:
        now = self._at(rule.trigger, NEXT)
        match rule.demand:
            case Demand.NOW:
                return []
            case Demand.COME:
                comes = self._text(rule.condition, NEXT)
                return [
                    f"process R{number}() {{",
                    (
                        f"init location Idle {{ to Waiting {{ guard ({now}) && !({comes}); sync step?;"
                        f" assign x{number} = 0, r{number} = 1; }} }}"
                    ),
                    (
                        f"location Waiting {{ invariant x{number} <= {rule.length};"
                        f" to Idle {{ guard {comes}; sync step?; assign r{number} = 0; }} }}"
                    ),
                    "}",
                ]
            case Demand.STAY:
                return self._staying(number, rule, now)

    def _staying(self, number: int, rule: RequirementRule, now: str) -> list[str]:
        clock = f"x{number}"
        begins = f"guard {now}; sync step?; assign {clock} = 0, r{number} = 1;"
        free, length = f"assign r{number} = 0;", rule.length
        head = [f"process R{number}() {{", f"init location Free {{ to Held {{ {begins} }} }}"]
        if not rule.trigger.is_instant:
            # As long as the trigger lasts; then for the length, its end left out.
            return [
                *head,
                f"location Held {{ to Rest {{ guard !({now}); sync step?; assign {clock} = 0; }} }}",
                (
                    f"location Rest {{ invariant {clock} <= {length}; to Held {{ {begins} }}"
                    f" to Free {{ guard {clock} >= {length}; {free} }} }}"
                ),
                "}",
            ]
        after = (
            f"to Last {{ guard {clock} >= {length}; assign {clock} = 0; }}"
            if rule.closed
            else f"to Free {{ guard {clock} >= {length}; {free} }}"
        )
        last = f"location Last {{ to Held {{ {begins} }} to Free {{ guard {clock} > 0; {free} }} }}"
        return [
            *head,
            f"location Held {{ invariant {clock} <= {length}; to Held {{ {begins} }} {after} }}",
            last if rule.closed else "",
            "}",
        ]

    # ---- conditions -------------------------------------------------------------------------------------------------

    def _at(self, trigger: RequirementTrigger, after: str) -> str:
        """The predicate that the trigger is there at a change to the values of ``after``."""
        parts = [self._text(condition, after) for condition in trigger.conditions]
        for condition in trigger.rises:
            before, now = self._text(condition, NOW), self._text(condition, after)
            parts.append(f"!(begun == 1 && {before}) && {now}")
        for condition in trigger.falls:
            before, now = self._text(condition, NOW), self._text(condition, after)
            parts.append(f"begun == 1 && {before} && !{now}")
        parts += [self._held(self._once().index(condition), after) for condition in trigger.once]
        if trigger.initially:
            parts.append("begun == 0")
        return " && ".join(f"({part})" for part in parts) or "true"

    def _held(self, number: int, after: str) -> str:
        return f"(o{number} == 1 || {self._text(self._once()[number], after)})"

    def _once(self) -> Sequence[ast.Expression]:
        return list(dict.fromkeys(condition for rule in self.rules for condition in rule.trigger.once))

    def _text(self, condition: ast.Expression, prefix: str) -> str:
        return f"({print_expression(self.signals.encoded(condition, prefix))})"
