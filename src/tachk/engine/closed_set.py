"""The check of certificates in C++, for large ones: the counterpart of `tachk.meaning.judge.closed_set`.

It shares with the engine the compiled program and the machine that evaluates expressions, and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tachk import _core
from tachk.base.job import check_job
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import transition_of
from tachk.engine.program_image import encode
from tachk.engine.traps import image_of_trap
from tachk.meaning.judge.certificate import Columns, MalformedCertificateError, Objection
from tachk.meaning.judge.trap import Trap
from tachk.model.run import DiscreteState

_STATES_AT_ONCE = 100


def check_closed_natively(
    program: Program,
    goal: Goal,
    traps: Sequence[Trap],
    clauses: Sequence[Sequence[int]],
    blocks: Iterable[Columns],
) -> Objection | None:
    """The reason why symbolic states do not prove that the goal is unreachable; None if they do.

    Args:
        traps: each has been proved to be one.
        clauses: numbers of traps; a state need not be in the set if it lies in one of each clause.

    Raises MalformedCertificateError for states that are none of the program.
    """
    never = Goal(())
    given = _core.ClosedSet(encode(program, [never, goal]), list(map(image_of_trap, traps)), clauses)
    return _objection(program, given, blocks)


def check_descent_natively(program: Program, goals: Sequence[Goal], blocks: Iterable[Columns]) -> Objection | None:
    """The objection to ranked symbolic states as a proof that each run meets the first goal, from the initial state or
    from each reachable state of the second goal on; None if they are a proof.

    Raises MalformedCertificateError for states that are none of the program.
    """
    return _objection(program, _core.ClosedSet(encode(program, goals), [], []), blocks)


def _objection(program: Program, closed: _core.ClosedSet, blocks: Iterable[Columns]) -> Objection | None:
    try:
        for block in blocks:
            check_job()
            discretes = block.discretes(program.state_slots)
            bounds = block.matrices(program.clocks + 1).ravel()
            closed.add(discretes, block.zones, block.ranks, block.shapes, bounds)
    except (ValueError, IndexError) as error:
        raise MalformedCertificateError(str(error)) from None
    while not closed.check(_STATES_AT_ONCE):
        check_job()
    found = closed.objection()
    if found is None:
        return None
    reason, discrete, zone, edges = found
    processes = len(program.locations)
    return Objection(
        reason,
        DiscreteState(tuple(discrete[:processes]), tuple(discrete[processes:])) if discrete else None,
        zone,
        transition_of(program, edges) if edges else None,
    )
