"""A simulator as a student would write it: dictionaries, lists and the race of delays, in plain Python.

It reads the same networks as tachk and draws runs with the same meaning, without any of the tricks of the core: every
process draws anew in each step, every clock is a number that grows, guards are functions. Expressions are translated to
Python once, so that it is no slower than a program that was written by hand for one model. Ranges are not checked.

    python -m bench.simulation speed    compares the two
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.words import Direction
from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Declare,
    Evaluate,
    Expression,
    Function,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Return,
    Statement,
    Unary,
    Variable,
    VariableKind,
    While,
)
from tachk.model.network import Edge, Network
from tachk.model.traversal import reads_clock
from tachk.model.types import ArrayType, ChannelType, ClockType, Type, bounds

SYMBOLS = {
    "&&": "({0} and {1})",
    "||": "({0} or {1})",
    "imply": "(not {0} or {1})",
    "/": "int({0} / {1})",
    "%": "divmod({0}, {1})[1]",
    "<?": "min({0}, {1})",
    ">?": "max({0}, {1})",
}
MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "=="}


@dataclass
class Way:
    """An edge with chosen select values."""

    target: int
    test: Callable[..., Any]
    atoms: list[tuple[str, str, Callable[..., Any]]]
    channel: Callable[..., Any] | None
    sends: bool
    broadcast: bool
    urgent: bool
    update: Callable[..., Any]


@dataclass
class Place:
    invariant: Callable[..., Any]
    atoms: list[tuple[str, str, Callable[..., Any]]]
    committed: bool
    urgent: bool
    ways: list[Way] = field(default_factory=list)


class PlainSimulator:
    def __init__(self, network: Network) -> None:
        self.network = network
        self.names: dict[Variable, str] = {}
        self.functions: dict[Function, str] = {}
        self.library: dict[str, Any] = {"divmod": divmod, "min": min, "max": max}
        self.values: dict[str, Any] = {}
        self.clocks: list[str] = []
        for variable in network.all_variables():
            leaf = variable.type
            while isinstance(leaf, ArrayType):
                leaf = leaf.element
            if isinstance(leaf, ClockType):
                self.clocks += [variable.name] if variable.type is leaf else []
            elif not isinstance(leaf, ChannelType):
                self.values[variable.name] = self.shaped(variable.type, list(variable.initial))
        self.places = [[self.place(location) for location in process.locations] for process in network.processes]
        for process, places in zip(network.processes, self.places, strict=True):
            for edge in process.edges:
                ranges = [bounds(each.type) for each in edge.selects]
                for chosen in product(*(range(low, high + 1) for low, high in ranges)):
                    self.names |= {each: str(v) for each, v in zip(edge.selects, chosen, strict=True)}
                    places[edge.source].ways.append(self.way(edge))

    # ---- expressions as Python ----

    def shaped(self, type_: Type, cells: list[int]) -> Any:
        if isinstance(type_, ArrayType):
            return [self.shaped(type_.element, cells) for _ in range(type_.size)]
        return cells.pop(0) if cells else 0

    def code(self, e: Expression) -> str:
        match e:
            case Constant(value):
                return str(value)
            case Reference(variable):
                if variable in self.names:
                    return self.names[variable]
                if isinstance(variable.type, ClockType):
                    return f"x[{variable.name!r}]"
                if variable.kind in (VariableKind.FRAME, VariableKind.BOUND):
                    return "_" + variable.name.replace(".", "_")
                return f"v[{variable.name!r}]"
            case Index(base, index):
                assert isinstance(base.type, ArrayType)
                low = f" - {base.type.low}" if base.type.low else ""
                return f"{self.code(base)}[{self.code(index)}{low}]"
            case Aggregate(items):
                return "[" + ", ".join(map(self.code, items)) + "]"
            case Unary(operator, operand):
                return f"({'not' if operator is UnaryOperator.NOT else '-'} {self.code(operand)})"
            case Binary(operator, left, right):
                form = SYMBOLS.get(operator.value, f"({{0}} {operator.value} {{1}})")
                return form.format(self.code(left), self.code(right))
            case Conditional(condition, then, otherwise):
                return f"({self.code(then)} if {self.code(condition)} else {self.code(otherwise)})"
            case Quantifier(kind, variable, body):
                low, high = bounds(variable.type)  # type: ignore[arg-type]
                call = {QuantifierKind.FORALL: "all", QuantifierKind.EXISTS: "any", QuantifierKind.SUM: "sum"}[kind]
                name = "_" + variable.name.replace(".", "_")
                return f"{call}({self.code(body)} for {name} in range({low}, {high + 1}))"
            case Call(function, arguments):
                return f"{self.function(function)}(v, x{''.join(', ' + self.code(each) for each in arguments)})"
            case LocationTest(process, location):
                return f"(v['locations'][{process}] == {location})"
            case _:
                raise NotImplementedError(type(e).__name__)

    def lines(self, s: Statement, margin: str) -> list[str]:
        match s:
            case Evaluate(e):
                return self.effect(e, margin)
            case Declare(variable, initial):
                empty = "0" if not isinstance(variable.type, ArrayType) else repr(self.shaped(variable.type, []))
                value = empty if initial is None else self.code(initial)
                return [f"{margin}_{variable.name.replace('.', '_')} = {value}"]
            case Block(statements):
                return [line for each in statements for line in self.lines(each, margin)] or [f"{margin}pass"]
            case If(condition, then, otherwise):
                found = [f"{margin}if {self.code(condition)}:", *self.lines(then, margin + " ")]
                return found if otherwise is None else [*found, f"{margin}else:", *self.lines(otherwise, margin + " ")]
            case While(condition, body, test_first):
                if test_first:
                    return [f"{margin}while {self.code(condition)}:", *self.lines(body, margin + " ")]
                stop = f"{margin} if not {self.code(condition)}: break"
                return [f"{margin}while True:", *self.lines(body, margin + " "), stop]
            case Iterate(variable, body):
                low, high = bounds(variable.type)  # type: ignore[arg-type]
                head = f"{margin}for _{variable.name.replace('.', '_')} in range({low}, {high + 1}):"
                return [head, *self.lines(body, margin + " ")]
            case Return(value):
                return [f"{margin}return {'' if value is None else self.code(value)}"]
            case Assert():
                return [f"{margin}pass"]

    def effect(self, e: Expression, margin: str = "") -> list[str]:
        match e:
            case Assign(target, value, _, operator):
                symbol = "" if operator is None else operator.value
                copied = f"list({self.code(value)})" if isinstance(target.type, ArrayType) else self.code(value)
                return [f"{margin}{self.code(target)} {symbol}= {copied}"]
            case Increment(target, delta):
                return [f"{margin}{self.code(target)} += {delta}"]
            case Comma(items):
                return [line for each in items for line in self.effect(each, margin)]
            case Conditional(condition, then, otherwise):
                test = f"{margin}if {self.code(condition)}:"
                return [test, *self.effect(then, margin + " "), f"{margin}else:", *self.effect(otherwise, margin + " ")]
            case _:
                return [f"{margin}{self.code(e)}"]

    def function(self, function: Function) -> str:
        if function not in self.functions:
            name = self.functions[function] = f"function_{len(self.functions)}"
            given = "".join(f", _{each.name.replace('.', '_')}" for each in function.parameters)
            self.define(name, f"v, x{given}", self.lines(function.body, " "))
        return self.functions[function]

    def define(self, name: str, parameters: str, lines: list[str]) -> Callable[..., Any]:
        exec(f"def {name}({parameters}):\n" + "\n".join(lines or [" pass"]), self.library)
        made: Callable[..., Any] = self.library[name]
        return made

    def given(self, e: str) -> Callable[..., Any]:
        made: Callable[..., Any] = eval(f"lambda v, x: {e}", self.library)
        return made

    # ---- edges and locations ----

    def condition(self, e: Expression | None) -> tuple[Callable[..., Any], list[tuple[str, str, Callable[..., Any]]]]:
        """A test of everything, and the comparisons of one clock, which say when it holds."""
        atoms = []
        for part in self.conjuncts(e):
            if isinstance(part, Binary) and part.operator.value in MIRRORED and reads_clock(part):
                clock, symbol, bound = part.left, part.operator.value, part.right
                if isinstance(bound.type, ClockType):
                    clock, symbol, bound = bound, MIRRORED[symbol], clock
                if isinstance(clock, Reference):
                    atoms.append((clock.variable.name, symbol, self.given(self.code(bound))))
        return self.given("True" if e is None else self.code(e)), atoms

    def conjuncts(self, e: Expression | None) -> list[Expression]:
        if isinstance(e, Binary) and e.operator is BinaryOperator.AND:
            return [*self.conjuncts(e.left), *self.conjuncts(e.right)]
        return [] if e is None else [e]

    def place(self, location: Any) -> Place:
        test, atoms = self.condition(location.invariant)
        return Place(test, atoms, location.committed, location.urgent)

    def way(self, edge: Edge) -> Way:
        test, atoms = self.condition(edge.guard)
        update = self.define("update", "v, x", [line for each in edge.updates for line in self.effect(each, " ")])
        if edge.synchronisation is None:
            return Way(edge.target, test, atoms, None, True, False, False, update)
        place, indices = edge.synchronisation.channel, []
        kind = place.type
        assert isinstance(kind, ChannelType)
        while isinstance(place, Index):
            indices.append(self.code(place.index))
            place = place.base
        assert isinstance(place, Reference)
        key = self.given(f"({place.variable.name!r}, {', '.join(reversed(indices))})")
        sends = edge.synchronisation.direction is Direction.SEND
        return Way(edge.target, test, atoms, key, sends, kind.broadcast, kind.urgent, update)

    # ---- runs ----

    def run(self, until: float, seed: int) -> int:
        """How many transitions a run has."""
        dice = random.Random(seed)
        v = {name: self.copy(value) for name, value in self.values.items()}
        x = dict.fromkeys(self.clocks, 0.0)
        here = v["locations"] = [process.initial for process in self.network.processes]
        now, transitions = 0.0, 0
        while now < until:
            wait, order = self.race(v, x, here, dice)
            if now + wait > until:
                break
            now += wait
            if wait:
                for clock in x:
                    x[clock] += wait
            if any(self.act(process, v, x, here, dice) for process in order):
                transitions += 1
            elif not wait:
                break
        return transitions

    def copy(self, value: Any) -> Any:
        return [self.copy(each) for each in value] if isinstance(value, list) else value

    def race(self, v: Any, x: Any, here: list[int], dice: random.Random) -> tuple[float, list[int]]:
        """After which delay somebody acts, and who is asked first."""
        current = [self.places[p][n] for p, n in enumerate(here)]
        everybody = list(range(len(here)))
        dice.shuffle(everybody)
        frozen = [p for p in everybody if current[p].committed or current[p].urgent]
        if frozen or any(
            way.urgent and way.sends and way.test(v, x) and self.heard(p, way, v, x, here)
            for p in everybody
            for way in current[p].ways
        ):
            first = [p for p in everybody if current[p].committed]
            return 0.0, first or frozen + [p for p in everybody if p not in frozen]
        delays = {}
        for p in everybody:
            end = self.window(current[p].atoms, v, x)[1]
            begins = [self.window(way.atoms, v, x) for way in current[p].ways if way.sends]
            begin = min((low for low, high in begins if low <= high), default=float("inf"))
            if begin <= end < float("inf"):
                delays[p] = dice.uniform(begin, end)
            else:
                delays[p] = begin + dice.expovariate(1) if begin < float("inf") else end
        winner = min(everybody, key=delays.__getitem__)
        if delays[winner] == float("inf"):
            return float("inf"), []
        return delays[winner], [winner]

    def window(self, atoms: list[tuple[str, str, Callable[..., Any]]], v: Any, x: Any) -> tuple[float, float]:
        low, high = 0.0, float("inf")
        for clock, symbol, bound in atoms:
            left = bound(v, x) - x[clock]
            if symbol in (">", ">=", "=="):
                low = max(low, left)
            if symbol in ("<", "<=", "=="):
                high = min(high, left)
        return low, high

    def heard(self, sender: int, way: Way, v: Any, x: Any, here: list[int]) -> list[list[tuple[int, Way]]]:
        """For each process that can receive, how."""
        assert way.channel is not None
        key = way.channel(v, x)
        found = []
        for p, n in enumerate(here):
            if p == sender:
                continue
            ways = [
                (p, other)
                for other in self.places[p][n].ways
                if not other.sends and other.channel is not None and other.test(v, x) and other.channel(v, x) == key
            ]
            if ways:
                found.append(ways)
        return found

    def act(self, process: int, v: Any, x: Any, here: list[int], dice: random.Random) -> bool:
        ways = [way for way in self.places[process][here[process]].ways if way.sends and way.test(v, x)]
        dice.shuffle(ways)
        for way in ways:
            moves = [(process, way)]
            if way.channel is not None:
                found = self.heard(process, way, v, x, here)
                if not found and not way.broadcast:
                    continue
                chosen = found if way.broadcast else [dice.choice(found)]
                moves += [dice.choice(each) for each in chosen]
            before = ({name: self.copy(value) for name, value in v.items()}, dict(x))
            for p, each in moves:
                each.update(v, x)
                here[p] = each.target
            if all(self.places[p][n].invariant(v, x) for p, n in enumerate(here)):
                return True
            v.update(before[0])
            x.update(before[1])
            here[:] = before[0]["locations"]
            v["locations"] = here
        return False
