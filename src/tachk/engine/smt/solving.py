"""Asking z3 so that limits and Ctrl-C are obeyed meanwhile."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import z3

from tachk.base.records import dataclass
from tachk.engine.outcome import TIME_LIMIT
from tachk.engine.smt.terms import Formula
from tachk.engine.solver_context import release_from_any_thread

_POLL_SECONDS = 0.1
"""Seconds between two looks at the keyboard while z3 works."""


class GaveUpError(Exception):
    """z3 has not answered; ``reason`` says why."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


@dataclass(slots=True)
class SolverOptions:
    """Settings of z3, and statistics of its use.

    Attributes:
        deadline: on the clock of `time.monotonic`; None: no limit.
        megabytes: the memory that z3 may take.
        report: called now and then while z3 works.
        queries: the number of queries so far.
    """

    deadline: float | None = None
    megabytes: int | None = None
    report: Callable[[], None] | None = None
    queries: int = 0

    def solver(self) -> z3.Solver:
        """A new solver. All share one context, so that queries come one after the other."""
        release_from_any_thread()
        made = z3.Solver()
        made.set("ctrl_c", False)  # Python handles Ctrl-C, not z3
        return made

    def is_satisfiable(self, solver: z3.Solver, *assumptions: Formula, deadline: float | None = None) -> bool:
        """True if there is a model of the assertions of the solver and of the assumptions.

        Raises GaveUpError, and KeyboardInterrupt.
        """
        if any(formula is False for formula in assumptions):
            return False
        ends = [moment for moment in (self.deadline, deadline) if moment is not None]
        left = min(ends) - time.monotonic() if ends else None
        if left is not None and left <= 0:
            raise GaveUpError(TIME_LIMIT)
        solver.set("timeout", 2**32 - 1 if left is None else max(int(left * 1000), 1))
        if self.megabytes is not None:
            solver.set("max_memory", self.megabytes)
        self.queries += 1
        found: list[z3.CheckSatResult | BaseException] = []
        terms = [formula for formula in assumptions if not isinstance(formula, bool)]

        def check() -> None:
            try:
                found.append(solver.check(*terms))
            except BaseException as error:  # handed to the thread that waits
                found.append(error)

        thread = threading.Thread(target=check, daemon=True)
        thread.start()
        try:
            while thread.is_alive():
                thread.join(_POLL_SECONDS)
                if thread.is_alive() and self.report is not None:
                    self.report()
        except BaseException:
            while thread.is_alive():  # until the interruption has arrived
                solver.interrupt()
                thread.join(_POLL_SECONDS / 10)
            raise
        answer = found[0]
        if isinstance(answer, BaseException):
            if isinstance(answer, z3.Z3Exception):
                raise GaveUpError(_why(str(answer))) from None
            raise answer
        if answer == z3.unknown:
            raise GaveUpError(_why(solver.reason_unknown()))
        return bool(answer == z3.sat)


def _why(reason: str) -> str:
    if "timeout" in reason or "canceled" in reason:
        return TIME_LIMIT
    if "memory" in reason:
        return "memory limit"
    return f"z3: {reason}"
