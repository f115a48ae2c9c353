"""`tachk-verifyta` and `tachk verifyta`: UPPAAL's verifyta as scripts know it, answered by tachk.

What scripts read is where UPPAAL writes it: verdicts on standard output, traces and errors on standard error, which
stays empty otherwise; programs around verifyta take anything there for a failure. A query without an answer is an
error there, never an empty place, and the exit status says so.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TextIO

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, Severity, UnsupportedError, UsageError
from tachk.base.job import is_interrupted
from tachk.base.span import Source as Text
from tachk.base.whole_files import write_whole
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.verifyta_options import TraceChoice, VerifytaOptions
from tachk.engine.options import Options, Pace
from tachk.engine.outcome import INTERRUPTED
from tachk.formats.uppaal.intermediate import network_to_intermediate
from tachk.formats.uppaal.trace_xml import run_to_trace_xml
from tachk.formats.uppaal.xtr import run_to_xtr
from tachk.frontend.loaded import LoadedModel, elaborate_query_file, other_interpretations_of
from tachk.frontend.priority_interpretations import FIRST
from tachk.frontend.queries.queries import UncheckedQuery, is_statistical
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.report.run.verifyta_trace import concrete_trace, symbolic_trace
from tachk.report.statistics.verifyta import Bars, Form, statistical_lines, statistical_summary
from tachk.report.verifyta_notes import note
from tachk.report.verifyta_report import (
    ending_lines,
    evidence,
    heading_lines,
    option_lines,
    place_of,
    summary_lines,
    verdict_lines,
)
from tachk.simulation.simulated import simulated
from tachk.simulation.statistics.answers import answer_statistical, has_run_time_error
from tachk.simulation.statistics.deciding import Errors
from tachk.simulation.statistics.estimate import Settings
from tachk.simulation.statistics.sampling import RunSource
from tachk.syntax.source_files import read_source
from tachk.verify.answering import agreed
from tachk.verify.verdict import Answer, Verdict, all_unsupported
from tachk.verify.verify import verify

Formula = Query | UncheckedQuery


def run_verifyta(options: VerifytaOptions) -> ExitStatus:
    """Checks the queries of a command line. Raises UsageError, OSError."""
    try:
        return _check(options)
    except InputError as error:
        errors = [found for found in error.diagnostics if found.severity is Severity.ERROR]
        _print_errors(errors)
        return ExitStatus.UNSUPPORTED if all(found.is_unsupported for found in errors) else ExitStatus.BAD_INPUT
    except UnsupportedError as error:
        _print_errors([error.diagnostic])
        return ExitStatus.UNSUPPORTED


def _check(options: VerifytaOptions) -> ExitStatus:
    shown_as = form()
    model = api.load(options.model)
    if os.environ.get("UPPAAL_COMPILE_ONLY"):
        sys.stdout.write(network_to_intermediate(model.network))
        return ExitStatus.AS_EXPECTED
    source = _source(options)
    formulas = _formulas(model.loaded, source)
    wanted = [(n, f) for n, f in enumerate(formulas, 1) if options.only in (None, n)]
    if not wanted:
        missing = f"there is no query {options.only - 1}, they count from 0" if options.only else "there are no queries"
        raise UsageError(missing, "give a file of queries behind the model")
    notes = [*options.notes, *(f"{found.span}: warning: {found.message}" for found in model.warnings)]
    if options.show_options:
        trace = "no" if options.trace is TraceChoice.NONE else options.trace.value
        _print(option_lines(trace, options.order, options.seed, notes))
    else:
        _print(map(note, notes[len(options.notes) :]))
    if model.refusals:
        if not all(is_statistical(formula) for _, formula in wanted):
            _print_errors(model.refusals)
        network = model.loaded.heading
    else:
        network = model.network

    def verdicts_on(numbered: Sequence[tuple[int, Formula]]) -> dict[int, Verdict]:
        checked = [(number, formula) for number, formula in numbered if isinstance(formula, Query)]
        queries = tuple(query for _, query in checked)
        found = all_unsupported(queries, model.refusals[0]) if model.refusals else _verdicts(network, queries, options)
        others = []
        for place, interpretation in interpretations:
            meant = _formulas(interpretation, source)
            also = [formula for formula in (meant[number - 1] for number, _ in checked) if isinstance(formula, Query)]
            others.append((place, _verdicts(interpretation.network, also, options)))
        return {
            number: agreed(verdict, FIRST, [(place, verdicts[at]) for place, verdicts in others])
            for at, ((number, _), verdict) in enumerate(zip(checked, found, strict=True))
        }

    interpretations = tuple(other_interpretations_of(model.loaded))

    known = verdicts_on(wanted) if options.reuse else {}
    statuses = []
    simulations = cache(lambda: simulated(model.loaded, options.model))
    for number, formula in wanted:
        _print(heading_lines(number, formula.span))
        if is_statistical(formula):
            statuses.append(_report_statistical(simulations, formula, options, shown_as))
        elif isinstance(formula, UncheckedQuery):
            statuses.append(_report_unchecked(formula))
        else:
            verdict = known.get(number) or verdicts_on([(number, formula)])[number]
            statuses.append(_report(number, verdict, network, options))
    return worst(statuses)


def _source(options: VerifytaOptions) -> Text | None:
    """The file of queries, if one is given."""
    if not options.queries:
        return None
    return Text("<stdin>", sys.stdin.read()) if options.queries == "-" else read_source(options.queries)


def _formulas(loaded: LoadedModel, source: Text | None) -> tuple[Formula, ...]:
    """The queries to check, in the order in which UPPAAL counts them."""
    if source is None:
        return loaded.formulas
    queries, unchecked = elaborate_query_file(loaded, source)
    return tuple(sorted((*queries, *unchecked), key=lambda formula: formula.span.start))


def _verdicts(network: Network, queries: Sequence[Query], options: VerifytaOptions) -> tuple[Verdict, ...]:
    how = Options(
        options.order,
        options.seed % 2**32,
        options.extrapolation,
        shortest=options.trace is TraceChoice.SHORTEST,
        pace=Pace.FASTEST if options.trace is TraceChoice.FASTEST else Pace.EARLY,
    )
    found = verify(network, queries, how, trace=options.trace is not TraceChoice.NONE)
    if is_interrupted():
        raise KeyboardInterrupt
    return found


def _report(number: int, verdict: Verdict, network: Network, options: VerifytaOptions) -> ExitStatus:
    """Prints the answer to a formula, with its trace."""
    _print(verdict_lines(verdict))
    if verdict.trace is not None:
        _write_trace(number, verdict, network, options)
    if options.summary:
        _print(summary_lines(verdict))
    if verdict.unsupported is not None:
        _print_errors([verdict.unsupported])
        return ExitStatus.UNSUPPORTED
    if verdict.answer is Answer.UNKNOWN and verdict.exact:
        _error(place_of(verdict.query.span), f"no answer: {verdict.reason}")
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED


def _report_statistical(
    load: Callable[[], LoadedModel], query: UncheckedQuery, options: VerifytaOptions, shown_as: Form
) -> ExitStatus:
    """Answers a statistical query and prints the answer."""
    errors = Errors(options.alpha, options.beta, min(options.below, options.above))
    settings = Settings(RunSource(options.seed % 2**32), 1 - options.alpha, options.epsilon, errors=errors)
    answer = answer_statistical(load, [query], settings)[1]
    if isinstance(answer, UncheckedQuery):
        return _report_unchecked(answer)
    if answer.reason == INTERRUPTED:
        raise KeyboardInterrupt
    _print(statistical_lines(answer, shown_as, Bars(options.bar_width, options.bar_count)))
    if options.summary:
        _print(statistical_summary(answer))
    if answer.found is None:
        _error(place_of(query.span), answer.reason)
        return ExitStatus.UNSUPPORTED
    if has_run_time_error(answer.found):
        _error(place_of(query.span), "runs end with a run-time error")
        return ExitStatus.UNKNOWN
    if answer.met is None:
        _error(place_of(query.span), "no answer: no decision after so many runs")
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED


def form() -> Form:
    """The version of verifyta whose lines answer statistical queries. Raises UsageError."""
    wanted = os.environ.get("TACHK_VERIFYTA_FORM", Form.V4)
    try:
        return Form(wanted)
    except ValueError:
        raise UsageError(f"TACHK_VERIFYTA_FORM is {wanted!r}", f"it is one of {', '.join(Form)}") from None


def _report_unchecked(formula: UncheckedQuery) -> ExitStatus:
    if formula.diagnostics:
        _print([note(f"not checked: {formula.diagnostics[0].message}")])
        _print_errors(formula.diagnostics)
        return ExitStatus.BAD_INPUT if formula.is_wrong else ExitStatus.UNSUPPORTED
    reason = f"{formula.family} queries are not checked by tachk"
    _print([note(f"not checked: {reason}")])
    _error(place_of(formula.span), reason)
    return ExitStatus.UNSUPPORTED


def _write_trace(number: int, verdict: Verdict, network: Network, options: VerifytaOptions) -> None:
    run, shows = verdict.trace, evidence(verdict)
    assert run is not None
    try:
        if options.xtr:
            _write(f"{options.xtr}-{number}.xtr", run_to_xtr(network, run), f"Writing {shows} to ", sys.stderr)
        if options.xml:
            _write(f"{options.xml}{number}.xml", run_to_trace_xml(network, run), "XMLTrace outputted to: ", sys.stdout)
        _print([*([] if options.xtr or options.xml else [f"Showing {shows}."]), *ending_lines(run)])
        if not options.xtr and not options.xml:
            print((symbolic_trace if options.symbolic else concrete_trace)(network, run), file=sys.stderr, flush=True)
    except EvaluationFault as fault:
        _error(place_of(verdict.query.span), f"no symbolic trace: {fault}")


def _write(path: str, text: str, announced: str, stream: TextIO) -> None:
    write_whole(Path(path), text)
    print(f"{announced}{path}", file=stream, flush=True)


def _print(lines: Iterable[str]) -> None:
    """Writes lines at once, so that a script has the answers so far when it ends the program."""
    for line in lines:
        print(line)
    sys.stdout.flush()


def _print_errors(diagnostics: Iterable[Diagnostic]) -> None:
    for found in diagnostics:
        _error(str(found.span), f"{found.message} [{found.code}]")
        if found.help:
            print(f"    {found.help}", file=sys.stderr)


def _error(place: str, message: str) -> None:
    """A line as UPPAAL writes it; scripts look for the word in brackets."""
    print(f"{place}: [error] {message}.", file=sys.stderr, flush=True)
