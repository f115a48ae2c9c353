"""The report for people: the table of answers, then the runs that explain them, step by step."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from io import StringIO
from typing import TYPE_CHECKING, assert_never

from rich.console import Console
from rich.table import Table
from rich.text import Text

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.diagnostics.render import render
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.meaning.run_view import view_event, view_path, view_trace
from tachk.model.network import Network
from tachk.model.quantity import bytes_, duration, grouped, seconds
from tachk.model.query import Observer, Query
from tachk.model.run import Due, Ending, RunTimeFault, TimedTrace
from tachk.report.extreme_text import answer_text, value_lines, value_shown
from tachk.report.plain_console import plain_console
from tachk.report.record import RunRecord
from tachk.report.reductions_text import reduction_lines
from tachk.report.run.display import Ends, RunDisplay
from tachk.report.run.trace_text import event_lines, print_trace
from tachk.report.run_formats import ReportWriter
from tachk.verify.fault_explanation import diagnostic_of
from tachk.verify.verdict import Answer, Verdict

if TYPE_CHECKING:
    from tachk.simulation.statistics.answers import StatisticalAnswer
from tachk.meaning.run_view import ProcessMove, TraceView, TransitionView

_TIMES_LISTED = 3


def news_line(trace: TraceView, time_unit: str) -> str:
    """One sentence part for each kind of news, in the order of first occurrence; empty where nothing is marked.

    ``send[PUB_UP][DATA] lost at 3 s; subscriber falls asleep at 0 s``
    """
    found: dict[str, list[str]] = {}
    for number, step in enumerate(trace.steps, start=1):
        for move in () if step.event is None else step.event.moves:
            if move.news and step.event is not None:
                time = step.state.time
                when = f"in step {number}" if time is None else f"at {duration(time, time_unit)}"
                found.setdefault(_words(step.event, move), []).append(when)
    return "; ".join(f"{words} {_listed(times)}" for words, times in found.items())


def _words(event: TransitionView, move: ProcessMove) -> str:
    """A hidden process is named after the process that it acts on."""
    actor = event.channel if move.hidden and event.channel else move.process
    return f"{actor} {' '.join(move.doc.split())}"


def _listed(times: list[str]) -> str:
    if len(times) <= _TIMES_LISTED:
        return ", ".join(times)
    return f"{len(times)} times from {times[0].split(' ', 1)[1]} to {times[-1].split(' ', 1)[1]}"


_CONSTANTS_SHOWN = 8
_FAULT_ENDS = Ends(10, 30)
"""The steps that are shown of a longer run to a run-time error."""

_DEFECT_ENDS = Ends(0, 3)
"""The last steps, which alone are shown of the run behind a violation that the model expects."""

_COSTS = ("states", "time", "memory")
_COLUMNS = ("  property", "answer", "expected", *_COSTS, "meaning")
_BETWEEN = 2
"""Blanks between columns."""
_ROOM_FOR_VALUES = 45
_SEE_BELOW = "see below"
"""Instead of values that need more columns than that."""
_ROOM_FOR_WORDS = 30
"""Columns that a meaning gets, before costs get some."""
_WRAPPED_ROWS = 300
"""A table of more rows is printed line by line, and long meanings are not wrapped: rich measures every cell of a table
several times, which took longer than a search that a limit of one second stops."""
_NAMES_SHOWN = 20
"""The number of names that are listed of properties that are unknown for the same reason."""

_STYLES = {Answer.HOLDS: "green", Answer.FAILS: "red", Answer.UNKNOWN: "yellow"}


class TextReport(ReportWriter):
    """Writes about each model when it has been checked, with an empty line between two models."""

    _separator = ""

    def add(self, record: RunRecord) -> None:
        self.out.write(self._separator)
        self._separator = "\n"
        shown = self.presentation
        print_run(record, shown.console(self.out), shown.every_trace, shown.display)


def print_run(
    record: RunRecord, console: Console, every_trace: bool = False, display: RunDisplay = RunDisplay()
) -> None:
    """Prints the answers of one run.

    Args:
        every_trace: show also the runs behind answers that are as expected.
        display: display options of runs; of those that the model expects only the last steps are shown.
    """
    console.print(_title(record))
    if record.verdicts:
        console.print()
        _print_table(record, console)
    _print_estimates(record, console)
    for query in record.not_checked:
        if not query.diagnostics:
            text = " ".join(query.text.split())
            console.print(Text(f"  {query.name} is not checked: {text} ({query.reason})", style="dim"))
    for number, line in enumerate(reduction_lines(record.verdicts)):
        blank = "" if number else "\n"
        console.print(Text(f"{blank}  {line}", style="dim"), soft_wrap=True)
    _print_values(record, console)
    _print_unknown(record, console, display.every_step)
    _print_unexamined(record.verdicts, console)
    for verdict in record.verdicts:
        if verdict.assumption:
            console.print(Text(f"\n{verdict.query.name}: {verdict.assumption}", style="yellow"))
        for note in verdict.notes:
            console.print(Text(f"\n{verdict.query.name}: {note}", style="yellow"), soft_wrap=True)
    for verdict in record.verdicts if record.runs else ():
        if verdict.trace is None:
            continue
        known_defect = verdict.answer is Answer.FAILS and verdict.met is True and not every_trace
        if every_trace or known_defect or verdict.met is not True:
            console.print()
            shown = replace(display, ends=_DEFECT_ENDS) if known_defect else display
            _print_evidence(record.network, verdict, verdict.trace, console, shown)
    console.print()
    console.print(_summary(record))


def _print_estimates(record: RunRecord, console: Console) -> None:
    """The answers to statistical queries, with a mark where they are not as expected."""
    if not record.estimates:
        return
    from tachk.report.statistics.answered import answered_lines

    for answer in record.estimates:
        mark = {True: " ", False: "✗", None: "?"}[answer.met]
        first, *others = answered_lines(answer)
        console.print(Text(f"\n{mark} {first}", style="red" if answer.met is False else ""), soft_wrap=True)
        for line in others:
            console.print(Text(f"  {line}"), soft_wrap=True)


def _print_evidence(
    network: Network, verdict: Verdict, trace: TimedTrace, console: Console, display: RunDisplay
) -> None:
    """The run behind an answer, what is news in it first."""
    view = view_trace(network, trace)
    console.print(Text(_trace_title(network, verdict), style="bold"))
    if verdict.query.observer is not None and verdict.query.observer.formula:
        console.print(_observer_line(verdict, verdict.query.observer, network.time_unit), soft_wrap=True)
    if trace.due is not None and verdict.query.kind is QueryKind.LEADS_TO:
        console.print(_due_line(verdict.query, trace.due, network.time_unit), soft_wrap=True)
    news = news_line(view, network.time_unit)
    if news:
        console.print(Text(f"  {news}", style="italic"), soft_wrap=True)
    print_trace(view, console, network.time_unit, display)


def evidence_text(network: Network, verdict: Verdict, display: RunDisplay = RunDisplay()) -> str:
    """The run behind an answer, or the run-time error that there is instead of one, as text; empty where there is
    neither. Arguments as for `print_run`."""
    out = StringIO()
    console = plain_console(out)
    if verdict.trace is not None:
        _print_evidence(network, verdict, verdict.trace, console, display)
    elif verdict.fault is not None:
        print_fault(network, verdict.fault, console, every_step=display.every_step)
    return out.getvalue().rstrip("\n")


def _print_values(record: RunRecord, console: Console) -> None:
    """The values of `sup`, `inf` and `bounds` for which the table has no room."""
    below = [verdict for verdict in record.verdicts if _answer(record, verdict) == _SEE_BELOW]
    if below:
        console.print()
    for verdict in below:
        for line in value_lines(verdict, record.network.time_unit):
            console.print(Text(f"  {verdict.query.name}: {line}"), soft_wrap=True)


def _print_unknown(record: RunRecord, console: Console, every_step: bool) -> None:
    """Prints why answers are unknown: each reason, each run-time error once, with the names of all it concerns."""
    for query in record.not_checked:
        for found in query.diagnostics:
            console.print(Text(f"\n{query.name} cannot be checked:", style="yellow"))
            console.print(_rendered(found), soft_wrap=True)
    unknown: dict[tuple[str, RunTimeFault | None], list[str]] = {}
    uncheckable: dict[Diagnostic, list[str]] = {}
    for verdict in record.verdicts:
        if verdict.unsupported is not None:
            uncheckable.setdefault(verdict.unsupported, []).append(verdict.query.name)
        elif verdict.answer is Answer.UNKNOWN:
            unknown.setdefault((verdict.reason, verdict.fault), []).append(verdict.query.name)
    for found, names in uncheckable.items():
        console.print(Text(f"\n{_names_listed(names)} cannot be checked:", style="yellow"))
        console.print(_rendered(found), soft_wrap=True)
    for (reason, fault), names in unknown.items():
        console.print(Text(f"\n{_names_listed(names)} {_are(names)} unknown: {reason}", style="yellow"))
        if fault is not None:
            console.print()
            print_fault(record.network, fault, console, record.runs, every_step)


def _names_listed(names: Sequence[str]) -> str:
    """The names, the first of them and the last where there are many."""
    few = names if len(names) <= _NAMES_SHOWN else [*names[: _NAMES_SHOWN - 1], f"{names[-1]} ({len(names)} in all)"]
    return ", ".join(few)


def _print_unexamined(verdicts: Iterable[Verdict], console: Console) -> None:
    """The parts left out that might have run-time errors, once for all queries for which they are the same."""
    by_names: dict[tuple[str, ...], list[str]] = {}
    for verdict in verdicts:
        if verdict.unexamined:
            by_names.setdefault(verdict.unexamined, []).append(verdict.query.name)
    for names, queries in by_names.items():
        depend = "does" if len(queries) == 1 else "do"
        them = "it" if len(names) == 1 else "them"
        text = (
            f"\nrun-time errors of {', '.join(names)} were not looked for, "
            f"as {', '.join(queries)} {depend} not depend on {them}; the query E<> false looks for all"
        )
        console.print(Text(text, style="yellow"))


def _are(names: list[str]) -> str:
    return "is" if len(names) == 1 else "are"


def print_fault(
    network: Network, fault: RunTimeFault, console: Console, run: bool = True, every_step: bool = False
) -> None:
    """Prints a run-time error of the model: the place, what was going on, and the run that leads there.

    Args:
        run: print the run.
        every_step: print all of it, however long it is.
    """
    console.print(_rendered(diagnostic_of(fault)), soft_wrap=True)
    if fault.transition is not None:
        console.print("while this was tried:")
        for line in event_lines(view_event(network, fault.path, fault.transition)):
            console.print(Text.assemble("       ", line), soft_wrap=True)
    if not run:
        return
    console.print("after:")
    view = view_path(network, fault.path) if fault.run is None else view_trace(network, fault.run)
    print_trace(view, console, network.time_unit, RunDisplay(every_step=every_step, ends=_FAULT_ENDS))


def recorded_run(record: RunRecord, verdict: Verdict) -> str:
    """The run-time error and the run that show an answer, as text without colours for files."""
    out = StringIO()
    console = plain_console(out, width=120)
    if verdict.fault is not None:
        print_fault(record.network, verdict.fault, console, record.runs)
    if verdict.trace is not None and record.runs:
        print_trace(view_trace(record.network, verdict.trace), console, record.network.time_unit)
    return out.getvalue()


def _rendered(diagnostic: Diagnostic) -> Text:
    return Text.from_ansi(render(diagnostic, colour=True))


def _title(record: RunRecord) -> Text:
    title = Text(record.model, style="bold")
    ordered = sorted(record.network.constants, key=lambda constant: constant[0] not in record.definitions)
    constants = [f"{name} = {value}" for name, value in ordered]
    shown = max(_CONSTANTS_SHOWN, len(record.definitions))
    if len(constants) > shown:
        constants[shown:] = [f"and {len(constants) - shown} more constants"]
    if constants:
        title.append("   " + ", ".join(constants), style="not bold dim")
    return title


def _print_table(record: RunRecord, console: Console) -> None:
    """One row for each answer; on a narrow terminal without what the answers cost, so that words have room."""
    rows = [_row(record, verdict) for verdict in record.verdicts]
    shown = list(_COLUMNS)
    widths = {name: max(len(name), *(len(row[name]) for row in rows)) for name in shown}
    for costly in ("memory", "time", "states"):
        taken = sum(widths[name] + _BETWEEN for name in shown[:-1])
        if taken + min(widths["meaning"], _ROOM_FOR_WORDS) + _BETWEEN <= console.width:
            break
        shown.remove(costly)
    if len(rows) > _WRAPPED_ROWS:
        for row in ({name: Text(name, style="bold") for name in shown}, *rows):
            for name in shown[:-1]:
                row[name].align("right" if name in _COSTS else "left", widths[name])
            console.print(Text(" " * _BETWEEN).join(row[name] for name in shown), soft_wrap=True)
        return
    table = Table(box=None, padding=(0, _BETWEEN, 0, 0))
    for name in shown:
        table.add_column(
            name, justify="right" if name in _COSTS else "left", no_wrap=name != "meaning", overflow="fold"
        )
    for row in rows:
        table.add_row(*(row[name] for name in shown))
    console.print(table)


def _row(record: RunRecord, verdict: Verdict) -> dict[str, Text]:
    query, statistics = verdict.query, verdict.statistics
    mark = "≠" if record.leaves_the_model(verdict) else {True: " ", False: "✗", None: "?"}[verdict.met]
    expected = query.expectation.value if query.expectation else "-"
    cells = (
        Text.assemble((f"{mark} ", "red"), query.name),
        Text(_answer(record, verdict), style=_STYLES[verdict.answer]),
        Text(expected, style="" if verdict.met is not False else "bold red"),
        Text(grouped(statistics.states_stored)),
        Text(seconds(statistics.seconds)),
        Text(bytes_(statistics.peak_bytes)),
        Text(query.title or query.text, style="dim"),
    )
    return dict(zip(_COLUMNS, cells, strict=True))


def _answer(record: RunRecord, verdict: Verdict) -> str:
    """The answer in the table; values that need more room are below it."""
    text = answer_text(verdict, record.network.time_unit)
    return text if len(text) <= _ROOM_FOR_VALUES else _SEE_BELOW


def _summary(record: RunRecord) -> Text:
    uncheckable = sum(bool(query.diagnostics) for query in record.not_checked)
    is_counted: list[Verdict | StatisticalAnswer] = [
        *record.verdicts,
        *(answer for answer in record.estimates if answer.is_counted),
    ]
    estimated = len(record.verdicts) + len(record.estimates) - len(is_counted)
    total = len(is_counted) + uncheckable
    if record.nothing_checked:
        unread = any(not each.is_unsupported for query in record.not_checked for each in query.diagnostics)
        reason = "no query could be read" if unread else "tachk supports none of the given queries"
        return Text(f"nothing was checked: {reason}", style="yellow")
    if total == 0 and not estimated:
        return Text("nothing to check: the model has no property and no query was given", style="yellow")
    other = sum(map(record.leaves_the_model, record.verdicts))
    wrong = sum(answer.met is False for answer in is_counted) - other
    unknown = sum(answer.met is None for answer in is_counted)
    passed = total - wrong - other - unknown - uncheckable
    parts = [f"{passed} passed"] if passed else []
    if wrong:
        parts.append(f"{wrong} failed")
    if other:
        verb = "differs" if other == 1 else "differ"
        parts.append(f"{other} {verb} from what the model expects of other constants")
    if unknown:
        parts.append(f"{unknown} unknown")
    if uncheckable:
        parts.append(f"{uncheckable} cannot be checked")
    if estimated:
        parts.append(f"{estimated} estimated")
    style = "red" if wrong else "yellow" if other or unknown or uncheckable else "green"
    return Text(", ".join(parts), style=style)


def _trace_title(network: Network, verdict: Verdict) -> str:
    assert verdict.trace is not None
    steps = len(verdict.trace.steps)
    end = duration(verdict.trace.states[-1].time, network.time_unit)
    plural = "step" if steps == 1 else "steps"
    if verdict.extremes:
        value = value_shown(verdict, network.time_unit)
        return f"{verdict.query.name}: {value} at the end of this run of {steps} {plural}, at time {end}:"
    shows = "is satisfied" if verdict.answer is Answer.HOLDS else "is violated"
    as_expected = ", as expected," if verdict.met and verdict.answer is Answer.FAILS else ""
    shown = f"{verdict.query.name} {shows}{as_expected} by this run of {steps} {plural}"
    match verdict.trace.ending:
        case Ending.OPEN:
            return f"{shown}, at time {end}:"
        case Ending.IDLE:
            return f"{shown}, after which time passes for ever:"
        case Ending.STUCK:
            return f"{shown}, after which nothing can happen:"
        case Ending.PERIODIC | Ending.RECURRENT:
            first = verdict.trace.loop_start or 0
            again = "the last of which repeats" if first == steps - 1 else f"the last {steps - first} of which repeat"
            return f"{shown}, {again} for ever:" if first else f"{shown}, which repeat{'s' * (steps == 1)} for ever:"
        case never:
            assert_never(never)


def _due_line(query: Query, due: Due, time_unit: str) -> Text:
    """The line about the beginning of the obligation of ``-->`` or of a formula that the run does not meet."""
    behind = f"after step {due.steps}" if due.steps else "before the first step"
    when = duration(due.time, time_unit)
    if query.observer is not None:  # its predicates are locations of the observer
        return Text(f"  From {when} on, {behind}: what the formula demands never follows", style="italic")
    assert query.predicate is not None
    (awaited,) = query.operands
    begins, ends = (" ".join(side.span.text.split()) for side in (query.predicate, awaited))
    in_time = "" if query.deadline is None else " in time"
    return Text(f"  From {when} on, {behind}: `{begins}` was true, and `{ends}` never follows{in_time}", style="italic")


def _observer_line(verdict: Verdict, observer: Observer, time_unit: str) -> Text:
    """The last obligation of the observer: when it began, and when the violation was certain."""
    idle = [number for number, move in enumerate(verdict.moves) if move.location == "Idle"]
    followed = verdict.moves[idle[-1] + 1 :] if idle else verdict.moves
    bad = observer.process.locations[observer.bad].name
    words = [
        f"{'violated' if move.location == bad else move.location} at {duration(move.time, time_unit)}"
        for move in followed
    ]
    if not words:
        # It was there from the start: what is missing never came.
        words = [f"{observer.process.locations[observer.process.initial].name} at {duration(Fraction(0), time_unit)}"]
    return Text(f"  {observer.formula}: {', '.join(words)}", style="italic")
