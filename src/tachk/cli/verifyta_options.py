"""The command line of UPPAAL's verifyta: one-letter options in clusters or with their value attached, long options by
any unambiguous beginning, before, between and behind the names of the model and of the file of queries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum, auto
from math import inf, nan
from typing import TypeVar

from tachk.base.diagnostics.diagnostic import InternalError, UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.seeds import DEFAULT_SEED
from tachk.engine.options import Extrapolation, SearchOrder


class TraceChoice(StrEnum):
    NONE = auto()
    SOME = auto()
    SHORTEST = auto()
    FASTEST = auto()


@dataclass(slots=True)
class VerifytaOptions:
    """Attributes:
    model, queries: the files; ``-`` is standard input, an empty name no file.
    symbolic: show traces as sets of clock valuations.
    xtr, xml: prefixes of files for traces; empty for none.
    seed: as given.
    reuse: look for the answers to all queries in one search where that is possible.
    only: the number of the only formula to check, from 1.
    show_options, summary: what is printed besides verdicts.
    alpha, beta: how probable each error of an answer to a statistical query may be.
    epsilon: half the width of the interval of a probability.
    below, above: how far from the probability of a test the region in which both answers are right begins and ends.
    bar_width, bar_count: of the histograms of statistical queries.
    notes: options that were given and have no effect.
    """

    model: str = ""
    queries: str = ""
    trace: TraceChoice = TraceChoice.NONE
    symbolic: bool = False
    xtr: str = ""
    xml: str = ""
    order: SearchOrder = SearchOrder.BFS
    seed: int = DEFAULT_SEED
    extrapolation: Extrapolation = Extrapolation.LU
    reuse: bool = False
    only: int | None = None
    show_options: bool = True
    summary: bool = False
    alpha: float = 0.05
    beta: float = 0.05
    epsilon: float = 0.05
    below: float = 0.01
    above: float = 0.01
    bar_width: float | None = None
    bar_count: int | None = None
    wants_help: bool = False
    wants_version: bool = False
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class _Option:
    short: str
    long: str
    takes_value: bool
    help: str = ""


_OPTIONS = (
    _Option("h", "help", False, "Print this help."),
    _Option("v", "version", False, "Print the version."),
    _Option("t", "diagnostic", True, "Trace: 0 some, 1 shortest, 2 fastest."),
    _Option("f", "trace-file", True, "Write symbolic traces to files VALUE-N.xtr."),
    _Option("X", "xml-trace", True, "Write symbolic traces to files VALUEN.xml."),
    _Option("y", "symbolic-trace", False, "Show traces as sets of clock values."),
    _Option("Y", "concrete-trace", False, "Show traces with the values of clocks (as without -y)."),
    _Option("u", "summary", False, "Print states, time and memory after each verdict."),
    _Option("", "nosummary", False, "Do not print them."),
    _Option("q", "no-options", False, "Do not print the options."),
    _Option("s", "silence-progress", False, "Show no progress; none is shown anyway."),
    _Option("o", "search-order", True, "Search: 0 breadth first, 1 depth first, 2 random depth first."),
    _Option("r", "seed", True, "Seed of the random search, and of the runs of statistical queries."),
    _Option(
        "n", "extrapolation", True, "Extrapolation: 0 automatic, 1 none, 2 and 3 largest bounds, 4 lower and upper."
    ),
    _Option("T", "reuse", False, "Answer several queries with one search."),
    _Option("", "query-index", True, "Check one query only; they count from 0."),
    _Option("S", "statespace-consumption", True, "No effect: all states are stored."),
    _Option("A", "convex-hull", False, "No effect: zones are exact."),
    _Option("C", "no-reduction", False, "No effect."),
    _Option("H", "hashtable-size", True, "No effect."),
    _Option("Z", "bit-state", False, "No effect: the search is complete."),
    _Option("O", "output", True, "No effect on queries that are checked: std or csv."),
    _Option("a", "alpha", True, "Statistical queries: the confidence is 1 - VALUE, the first error of tests; 0.05."),
    _Option("B", "beta", True, "Statistical queries: the second error of tests; 0.05."),
    _Option("E", "epsilon", True, "Statistical queries: half the width of the interval of a probability; 0.05."),
    _Option("", "delta-l", True, "Statistical queries: a test may err this far below the probability; 0.01."),
    _Option("", "delta-u", True, "Statistical queries: a test may err this far above the probability; 0.01."),
    _Option("w", "histogram-bar-width", True, "Statistical queries: the width of bars in histograms."),
    _Option("", "histogram-bar-count", True, "Statistical queries: how many bars histograms have."),
    _Option("D", "discretization", True, "No effect: clocks are not stepped."),
)
_NO_EFFECT = {
    "convex-hull": "zones are kept exact, so no verdict is weakened",
    "no-reduction": "it changes no verdict",
    "hashtable-size": "states are never confused with one another",
    "bit-state": "every state is kept, so no verdict is weakened",
    "discretization": "clocks are not stepped",
}
_OF_OTHER_ANALYSES = (
    *("u0", "u1", "learning-method", "good-runs", "total-runs", "runs-pr-state", "eval-runs", "filter"),
    *(
        "max-iterations",
        "max-reset-learning",
        "reset-no-better",
        "trace-resolution",
        "truncation-error",
        "truncate-time",
    ),
    *("generate-strategy", "memory-limit"),
)
"""With a value. All but the last are about learning, games, or details of statistics."""
_SILENT = ("key", "lease", "lease-request", "lease-duration")
"""With a value, about licences; there is no licence here."""
_SILENT_FLAGS = ("lease-release", "lease-install", "print-strategies")

_ORDERS = {"0": SearchOrder.BFS, "1": SearchOrder.DFS, "2": SearchOrder.RANDOM_DFS}
_OTHER_ORDERS = ("3", "4", "5", "6")
_EXTRAPOLATIONS = {
    "0": Extrapolation.LU,
    "1": Extrapolation.NONE,
    "2": Extrapolation.MAX,
    "3": Extrapolation.MAX,
    "4": Extrapolation.LU,
}
_STATISTICAL = {"alpha": "alpha", "beta": "beta", "epsilon": "epsilon", "delta-l": "below", "delta-u": "above"}
_TRACES = {"0": TraceChoice.SOME, "1": TraceChoice.SHORTEST, "2": TraceChoice.FASTEST}

_BY_LETTER = {option.short: option for option in _OPTIONS if option.short}
_BY_NAME = {
    **{option.long: option for option in _OPTIONS},
    **{name: _Option("", name, True) for name in (*_OF_OTHER_ANALYSES, *_SILENT)},
    **{name: _Option("", name, False) for name in _SILENT_FLAGS},
}


def help_text(program: str) -> str:
    """The help, in the form that scripts look for."""
    lines = [
        f"Usage: {program} [OPTION]... MODEL [QUERIES]",
        "",
        "Check the queries of a UPPAAL model, or those of the file QUERIES (- reads them from standard input), with",
        "the command line and the output of UPPAAL's verifyta. The answers are tachk's.",
        "",
        "Exit status: 0 every query has an answer; 2 wrong input, 3 a query or the model is not supported, 20 a",
        "search stopped at a limit. The status of `tachk verify` also gives the answers.",
        "",
        "Options:",
    ]
    for option in _OPTIONS:
        names = f"-{option.short} [ --{option.long} ]" if option.short else f"--{option.long}"
        lines.append(f"  {names + (' arg' if option.takes_value else ''):<36} {option.help}")
    lines += [
        "",
        "With UPPAAL_COMPILE_ONLY=1 in the environment the model is printed in UPPAAL's intermediate format. With",
        "TACHK_VERIFYTA_FORM=5.0 answers to statistical queries look as UPPAAL 5.0 prints them, with stratego as",
        "Stratego does, else as 4.1 does.",
    ]
    return "\n".join(lines) + "\n"


def parse_arguments(arguments: Sequence[str]) -> VerifytaOptions:
    """The options. Raises UsageError for those that verifyta does not know, and for missing or wrong values."""
    parsed = VerifytaOptions()
    files: list[str] = []
    rest = list(arguments)
    while rest:
        argument = rest.pop(0)
        if argument == "--":
            files += rest
            break
        if argument.startswith("--"):
            name, equals, value = argument[2:].partition("=")
            option = _named(name)
            if option.takes_value and not equals:
                value = _next(rest, f"--{option.long}")
            elif equals and not option.takes_value:
                raise UsageError(f"--{option.long} takes no value")
            _apply(parsed, option, value)
        elif argument.startswith("-") and len(argument) > 1:
            _cluster(parsed, argument[1:], rest)
        else:
            files.append(argument)
    if len(files) > 2:
        raise UsageError(f"one model and one file of queries, not {len(files)} files: {' '.join(files)}")
    parsed.model, parsed.queries = (*files, "", "")[:2]
    _settle_trace(parsed)
    return parsed


def _cluster(parsed: VerifytaOptions, letters: str, rest: list[str]) -> None:
    while letters:
        letter, letters = letters[0], letters[1:]
        option = _BY_LETTER.get(letter)
        if option is None:
            raise UsageError(f"there is no option -{letter}", "the options are listed by -h")
        if option.takes_value:
            _apply(parsed, option, letters or _next(rest, f"-{letter}"))
            return
        _apply(parsed, option, "")


def _next(rest: list[str], option: str) -> str:
    if not rest:
        raise UsageError(f"{option} needs a value")
    return rest.pop(0)


def _named(name: str) -> _Option:
    if name in _BY_NAME:
        return _BY_NAME[name]
    begun = [option for known, option in _BY_NAME.items() if name and known.startswith(name)]
    if len(begun) == 1:
        return begun[0]
    close = closest(name, _BY_NAME)
    raise UsageError(
        f"there is no option --{name}", f"did you mean --{close}?" if close else "the options are listed by -h"
    )


def _apply(parsed: VerifytaOptions, option: _Option, value: str) -> None:
    shown = f"-{option.short}" if option.short else f"--{option.long}"
    match option.long:
        case "help":
            parsed.wants_help = True
        case "version":
            parsed.wants_version = True
        case "diagnostic":
            parsed.trace = _chosen(shown, value, _TRACES)
        case "trace-file":
            parsed.xtr = value
        case "xml-trace":
            parsed.xml = value
        case "symbolic-trace" | "concrete-trace":
            parsed.symbolic = option.long == "symbolic-trace"
        case "summary" | "nosummary":
            parsed.summary = option.long == "summary"
        case "no-options":
            parsed.show_options = False
        case "search-order":
            if value in _OTHER_ORDERS:
                parsed.notes.append(f"there is no search order {value} here: breadth first")
            else:
                parsed.order = _chosen(shown, value, _ORDERS)
        case "seed":
            parsed.seed = _integer(shown, value)
        case "extrapolation":
            parsed.extrapolation = _chosen(shown, value, _EXTRAPOLATIONS)
        case name if name in _STATISTICAL:
            setattr(parsed, _STATISTICAL[name], _share(shown, value))
        case "histogram-bar-width":
            parsed.bar_width = _positive(shown, value)
        case "histogram-bar-count":
            parsed.bar_count = max(1, _integer(shown, value))
        case "reuse":
            parsed.reuse = True
        case "query-index":
            index = _integer(shown, value)
            if index < 0:
                raise UsageError(f"{shown} counts from 0, so there is no {index}")
            parsed.only = index + 1
        case "statespace-consumption":
            _chosen(shown, value, dict.fromkeys("012"))
            if value != "0":
                parsed.notes.append(f"{shown} {value} has no effect: all states are stored")
        case "output":
            _chosen(shown, value, dict.fromkeys(("std", "csv")))
            if value != "std":
                parsed.notes.append(f"{shown} {value} has no effect: it is for statistical queries")
        case "memory-limit":
            parsed.notes.append(f"{shown} has no effect: `tachk verify --max-memory` limits memory")
        case name if name in _NO_EFFECT:
            parsed.notes.append(f"{shown} has no effect: {_NO_EFFECT[name]}")
        case name if name in _OF_OTHER_ANALYSES:
            parsed.notes.append(f"{shown} has no effect: it is for queries that are not checked here")
        case name if name in ("silence-progress", *_SILENT, *_SILENT_FLAGS):
            pass  # there is no progress and no licence
        case _:
            raise InternalError(f"the option --{option.long} is listed and not read")


def _settle_trace(parsed: VerifytaOptions) -> None:
    if parsed.trace is TraceChoice.NONE and (parsed.xtr or parsed.xml):
        parsed.trace = TraceChoice.SOME
    if parsed.trace is TraceChoice.SHORTEST and parsed.order is not SearchOrder.BFS:
        parsed.notes.append("shortest traces are searched for breadth first")
        parsed.order = SearchOrder.BFS


_T = TypeVar("_T")


def _chosen(option: str, value: str, known: dict[str, _T]) -> _T:
    if value not in known:
        raise UsageError(f"{option} does not take {value!r}", f"it takes {', '.join(known)}")
    return known[value]


def _integer(option: str, value: str) -> int:
    try:
        return int(value)
    except ValueError:
        raise UsageError(f"{option} takes a number, not {value!r}") from None


def _positive(option: str, value: str) -> float:
    try:
        number = float(value.removeprefix("="))
    except ValueError:
        number = nan
    if not 0 < number < inf:
        raise UsageError(f"{option} takes a positive number, not {value!r}")
    return number


def _share(option: str, value: str) -> float:
    number = _positive(option, value)
    if not number <= 0.5:
        raise UsageError(f"{option} takes a number above 0 and at most 0.5, not {value!r}")
    return number
