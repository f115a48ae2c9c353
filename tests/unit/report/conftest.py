"""A lamp with a patient user: one run, answers of every kind."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.span import Source, Span
from tachk.base.words import Direction, QueryKind
from tachk.engine.outcome import Statistics
from tachk.model.expressions import BOOL, Assign, Constant, Index, Reference, Variable, VariableKind
from tachk.model.fault import RuntimeErrorKind
from tachk.model.network import Edge, Location, Network, Process, Synchronisation
from tachk.model.query import Expectation, Query
from tachk.model.run import DiscreteState, Participant, RunTimeFault, TimedState, TimedStep, TimedTrace, Transition
from tachk.model.types import ArrayType, BoolType, ChannelType, ClockType, IntType
from tachk.report.record import NotChecked, RunRecord
from tachk.verify.verdict import Answer, Verdict

SOURCE = Source("lamp.ta", "line one\n  n = n + 1;\nline three\n")


@pytest.fixture
def network() -> Network:
    press = Variable("press", ArrayType(ChannelType(), IntType(0, 1)), VariableKind.GLOBAL, (0, 0))
    n = Variable("n", IntType(0, 5), VariableKind.GLOBAL, (0,))
    lit = Variable("lit", BoolType(), VariableKind.GLOBAL, (0,))
    scratch = Variable("scratch", IntType(0, 9), VariableKind.GLOBAL, (0,), declared_meta=True)
    x = Variable("User.x", ClockType(), VariableKind.LOCAL, (0,))
    which = Variable("b", IntType(0, 1), VariableKind.BOUND)

    def channel(index: Reference | Constant) -> Index:
        return Index(Reference(press), index, ChannelType())

    def assign(variable: Variable, value: int) -> Assign:
        return Assign(Reference(variable), Constant(value), variable.type)

    user = Process(
        "User",
        "User",
        (Location("idle"), Location("done")),
        (
            Edge(
                0,
                1,
                (which,),
                None,
                Synchronisation(channel(Reference(which)), Direction.SEND),
                (assign(n, 3), assign(scratch, 7)),
                doc="the user loses patience",
                spans=(Span(SOURCE, 11, 20),),
            ),
        ),
        variables=(x,),
    )
    lamp = Process(
        "Lamp",
        "Lamp",
        (Location("off"), Location("on", doc="full light")),
        (
            Edge(
                0,
                1,
                synchronisation=Synchronisation(channel(Constant(1)), Direction.RECEIVE),
                updates=(assign(lit, 1),),
            ),
        ),
    )
    return Network((user, lamp), (press, n, lit, scratch), constants=(("MAX", 5),), time_unit="10 ms")


@pytest.fixture
def trace() -> TimedTrace:
    start = TimedState(DiscreteState((0, 0), (0, 1, 0, 0, 0, 1)), (Fraction(0),), Fraction(0))
    end = TimedState(DiscreteState((1, 1), (0, 1, 3, 1, 7, 1)), (Fraction(5, 2),), Fraction(5, 2))
    transition = Transition((Participant(0, 0, (1,)), Participant(1, 0)))
    rest = TimedState(end.discrete, (Fraction(17, 6),), Fraction(17, 6))
    return TimedTrace(start, (TimedStep(Fraction(5, 2), transition, end), TimedStep(Fraction(1, 3), None, rest)))


@pytest.fixture
def record(network: Network, trace: TimedTrace) -> RunRecord:
    statistics = Statistics(10, 7, 20, 0.25, 4096)

    def query(name: str, kind: QueryKind, expectation: Expectation | None, text: str) -> Query:
        return Query(name, kind, Constant(1, BOOL), text=text, title=f"about {name}", expectation=expectation)

    off = query("always_off", QueryKind.INVARIANTLY, Expectation.HOLDS, "A[] Lamp.off")
    on = query("can_light", QueryKind.POSSIBLY, Expectation.HOLDS, "E<> Lamp.on")
    far = query("far", QueryKind.INVARIANTLY, None, "A[] n < 5 && n >= 0")
    bad = query("bad", QueryKind.INVARIANTLY, None, "A[] n < 4")
    fault = RunTimeFault(RuntimeErrorKind.RANGE, Span(SOURCE, 11, 20), trace_path(trace), None)
    return RunRecord(
        "lamp.ta",
        network,
        (
            Verdict(off, Answer.FAILS, True, "", statistics, trace),
            Verdict(on, Answer.HOLDS, True, "", statistics, trace),
            Verdict(far, Answer.UNKNOWN, True, "state limit", statistics),
            Verdict(bad, Answer.UNKNOWN, True, "run-time error", statistics, fault=fault),
        ),
        (NotChecked("q5", "Pr[<=10](<> Lamp.on)", "statistical"),),
    )


def trace_path(trace: TimedTrace) -> tuple[Transition, ...]:
    return tuple(step.transition for step in trace.steps if step.transition is not None)
