"""Queries about a network become verdicts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import assert_never

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.job import (
    Job,
    StoppedError,
    current_job,
    is_interrupted,
    limited,
    note_interruption,
    remembering_interruption,
    unhurried,
)
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.engine.compiler.features import check_supported
from tachk.engine.options import Engine, Limits, Options, Pace
from tachk.engine.outcome import INTERRUPTED, MACHINE_OUT_OF_MEMORY
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.selections import check_selections
from tachk.transform.cone_of_influence import every_action_counts
from tachk.transform.observed import check_observable
from tachk.verify.fault_explanation import with_blame
from tachk.verify.plan import Analysis, Search, Task, analysis_of, plan
from tachk.verify.scheduling.in_order import Shares, in_order, processes
from tachk.verify.strategies import avoidable, check_names, extreme, reachable
from tachk.verify.sufficient_conditions import shared_searches
from tachk.verify.verdict import Answer, Verdict, answers_of, none_begun, not_begun, unsupported


def verify(
    network: Network,
    queries: Sequence[Query],
    options: Options = Options(),
    limits: Limits = Limits(),
    trace: bool = True,
) -> tuple[Verdict, ...]:
    """Answer queries about a network, in their order.

    A query that cannot be checked gets the answer UNKNOWN with the diagnostic that says why; the others are not
    affected. Every trace has been replayed by `tachk.meaning.judge` before it is returned; without ``trace`` none is
    made except where it is needed to decide. Several searches may be needed. Each query has the same share of the
    seconds that are left when its search begins, so what one does not need is there for the others; preparing the model
    and compiling it count. With several `Options.processes` it has as many such shares, for as many are used up at the
    same time. The other limits hold for each search. The run behind an answer is made in any case.

    Raises:
        InputError: the initial state violates an invariant.
        UnsupportedError: the network itself uses a feature that cannot be checked.
        UsageError: nothing has a name that is to be left out.
    """
    check_names(options.without)
    try:
        with remembering_interruption(), limited(limits.seconds):
            if is_interrupted():
                return tuple(not_begun(query, INTERRUPTED) for query in queries)
            return _verified(network, queries, options, limits, trace)
    except StoppedError as error:
        return tuple(not_begun(query, error.reason) for query in queries)


def _verified(
    network: Network, queries: Sequence[Query], options: Options, limits: Limits, trace: bool
) -> tuple[Verdict, ...]:
    verdicts: dict[int, Verdict] = {}
    try:
        with limited(memory=limits.memory_bytes):
            check_selections(network)
            model = prepare(network)
            check_initial_state(model)
            tasks = []
            for number, query in enumerate(queries):
                try:
                    _check_answerable(network, query, options)
                except UnsupportedError as error:
                    verdicts[number] = unsupported(query, error.diagnostic)
                else:
                    tasks.append(Task(number, query))
            searches = plan(tasks)
            shared = shared_searches(network, searches, options)
    except StoppedError as error:
        return tuple(verdicts.get(number) or not_begun(query, error.reason) for number, query in enumerate(queries))
    answer = partial(_answer, model, options, trace)
    shares = Shares(limits, len(tasks) + sum(len(search.tasks) for search in shared))
    for task, verdict in _with_tasks(shared, in_order(shared, answer, shares, processes(options))):
        if task.condition is None or verdict.answer is Answer.HOLDS or verdict.reason == INTERRUPTED:
            verdicts[task.number] = verdict
    rest = [search.without(verdicts) for search in searches]
    shares.drop(sum(len(search.tasks) for search in searches) - sum(len(search.tasks) for search in rest))
    verdicts |= in_order([search for search in rest if search.tasks], answer, shares, processes(options))
    job = current_job()
    with unhurried():  # no decided verdict is lost to the limit; the searches for notes share the time that is left
        found = [with_blame(verdicts[number]) for number in range(len(queries))]
        try:
            found = [*_with_momentary_triggers(network, found, limits, job)]
        except KeyboardInterrupt:
            note_interruption()
        answers = (_with_momentary_answers(model, verdict) for verdict in _examined(network, found))
        return tuple(map(_with_note, answers))


def _with_tasks(searches: Sequence[Search], verdicts: Mapping[int, Verdict]) -> Iterator[tuple[Task, Verdict]]:
    return ((task, verdicts[task.number]) for search in searches for task in search.tasks)


def _with_note(verdict: Verdict) -> Verdict:
    """The verdict, with a note where the runs do not decide it, so that it does not matter which ones count."""
    query = verdict.query
    if not query.non_zeno or verdict.unsupported is not None or analysis_of(query) is Analysis.LIVENESS:
        return verdict
    return verdict.noted("--non-zeno makes no difference here: every state counts that some run reaches")


def _with_momentary_triggers(network: Network, found: Sequence[Verdict], limits: Limits, job: Job) -> Sequence[Verdict]:
    """The verdicts with notes about what is true for no time, of which only observers may speak. Searches for them have
    the time that the job has left."""
    if all(verdict.query.observer is None for verdict in found):
        return found
    from tachk.verify.momentary import with_momentary_triggers

    return with_momentary_triggers(network, found, limits, partial(_decided_plainly, job))


def _with_momentary_answers(model: PreparedNetwork, verdict: Verdict) -> Verdict:
    """The verdict with a note about what its run has for no time, of which only observers may speak."""
    if verdict.query.observer is None or verdict.trace is None:
        return verdict
    from tachk.verify.momentary_answers import with_momentary_answers

    return with_momentary_answers(model, verdict)


def _decided_plainly(job: Job, network: Network, queries: Sequence[Query], limits: Limits) -> Sequence[Verdict]:
    return verify(network, queries, Options(processes=1), replace(limits, seconds=job.seconds_left), trace=False)


def _check_answerable(network: Network, query: Query, options: Options) -> None:
    """Raises UnsupportedError for a query that cannot be answered."""
    check_observable(network, query)
    check_supported(network, query)
    if query.deadline is not None:
        from tachk.verify.deadlines import check_deadline

        check_deadline(network, query)
    if query.non_zeno and query.deadline is not None and query.kind is QueryKind.LEADS_TO:
        # No process may act once the deadline is kept.
        message = "queries with `-->[<= t]` are not checked with --non-zeno"
        remedy = "the formula G (p -> F[0, t] q) asks nearly the same of runs of any kind"
        raise UnsupportedError(Diagnostic("E0720", message, query.span, remedy))
    if options.engine is Engine.SMT and analysis_of(query) is not Analysis.REACHABILITY:
        message = f"the engine smt does not answer {query.kind.value}"
        raise UnsupportedError(Diagnostic("E0745", message, query.span, "ask the zone engine: --engine zone"))


def _answer(
    model: PreparedNetwork,
    options: Options,
    trace: bool,
    search: Search,
    limits: Limits,
    processes: int,
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number, on so many cores.

    What was decided before is kept, wherever Ctrl-C comes.
    """
    try:
        with limited(limits.seconds, limits.memory_bytes):
            return _analysed(model, search, replace(options, processes=processes), limits, trace)
    except StoppedError as error:
        return none_begun(search.tasks, error.reason)
    except MemoryError:
        return none_begun(search.tasks, MACHINE_OUT_OF_MEMORY)
    except KeyboardInterrupt:
        note_interruption()
        return none_begun(search.tasks, INTERRUPTED)


def _analysed(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    found = _deciding(search)(model, search, options, limits, trace)
    if options.engine is Engine.BOTH and search.analysis is not Analysis.REACHABILITY:
        found = {number: verdict.noted(_UNCOMPARED) for number, verdict in found.items()}
    if options.pace is Pace.EARLY:
        return found
    from tachk.verify.time_optimal import time_optimal, without_optimum

    if search.analysis is Analysis.REACHABILITY:
        return time_optimal(model, search, found, options, limits)
    return without_optimum(found, options)


_UNCOMPARED = "only the zone engine has answered: the engine smt answers E<> and A[]"


def _deciding(search: Search) -> Callable[[PreparedNetwork, Search, Options, Limits, bool], dict[int, Verdict]]:
    """The function that decides the tasks of a search, by one of the tables of `tachk.verify.strategies`."""
    match search.analysis:
        case Analysis.REACHABILITY:
            return reachable
        case Analysis.EXTREMES:
            return extreme
        case Analysis.LIVENESS if search.observer is not None:
            from tachk.verify import observed_liveness

            return observed_liveness.answer
        case Analysis.LIVENESS if search.tasks[0].query.deadline is not None:
            from tachk.verify import deadlines

            return deadlines.answer
        case Analysis.LIVENESS:
            return avoidable
        case never:
            assert_never(never)


def _examined(network: Network, verdicts: Sequence[Verdict]) -> tuple[Verdict, ...]:
    """The verdicts; if one of them was proved by exploring everything, no run-time error was overlooked for any."""
    for verdict in verdicts:
        if _explored_everything(network, verdict):
            return tuple(replace(other, unexamined=()) for other in verdicts)
    return tuple(verdicts)


def _explored_everything(network: Network, verdict: Verdict) -> bool:
    query = verdict.query
    if query.target is None:
        return False
    proved = verdict.answer is answers_of(query)[1]
    return proved and query.observer is None and every_action_counts(network, [query.target])
