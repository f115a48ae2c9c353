"""The check that a network has an initial state."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.meaning.discrete import PreparedNetwork, initial_clocks, initial_discrete
from tachk.meaning.step import satisfies_invariant
from tachk.model.fault import EvaluationFault
from tachk.model.run import TimedState


def check_initial_state(model: PreparedNetwork) -> None:
    """Raises InputError (E0409) where the initial state violates an invariant."""
    start = TimedState(initial_discrete(model), initial_clocks(model), Fraction(0))
    violated = []
    for number, process in enumerate(model.network.processes):
        # An invariant that cannot be evaluated is a run-time error, which the search reports.
        with suppress(EvaluationFault):
            if not satisfies_invariant(model, start, number):
                violated.append((process.name, process.locations[process.initial]))
    if violated:
        raise InputError(
            Diagnostic(
                "E0409",
                f"the invariant of the initial location {name}.{location.name} does not hold in the initial state",
                location.span,
                "every variable has its initial value, and every clock, too: 0 where none is written",
            )
            for name, location in violated
        )
