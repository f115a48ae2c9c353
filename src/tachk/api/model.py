"""The toolchain as a library.

    import tachk

    model = tachk.load("fischer.ta", N=5)
    model.verify()["mutual_exclusion"].answer  # Answer.HOLDS

`load` takes a file, `loads` a text, and `Model` a network that `tachk.model.builder` made.

Wrong input raises `InputError` with every finding; a limit that is hit is an answer (`Answer.UNKNOWN`), not an error.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from tachk.api.estimating import Estimable, answers_among, share_of_searches
from tachk.api.running import Runnable
from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, TachkError, UnsupportedError, UsageError
from tachk.base.job import Progress, current_job, followed, limited, remembering_interruption
from tachk.base.records import dataclass, field, replace
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Source
from tachk.engine.options import Engine, Extrapolation, Limits, Options, SearchOrder
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.queries.queries import UncheckedQuery
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.report.answers import Report
from tachk.report.record import NotChecked, RunRecord
from tachk.syntax.source_files import read_source
from tachk.verify.questions import Questions, checked, why_not
from tachk.verify.verdict import Answer, Verdict

if TYPE_CHECKING:
    from tachk.engine.outcome import Statistics
    from tachk.model.grid import Grid
    from tachk.report.campaign.table import Sweep
    from tachk.report.conformance.result import ConformanceReport
    from tachk.report.deep_report import DeepCheckReport
    from tachk.report.drawing.svg import Picture
    from tachk.report.region.synthesis import Synthesis
    from tachk.report.time_report import TimesReport
    from tachk.simulation.statistics.estimate import Settings
    from tachk.verify.campaign.run import Progress as CampaignProgress
    from tachk.verify.synthesis.parameters import VariedConstant

__all__ = [
    "Answer",
    "Engine",
    "Extrapolation",
    "InputError",
    "Limits",
    "Model",
    "Options",
    "Report",
    "SearchOrder",
    "TachkError",
    "UnsupportedError",
    "UsageError",
    "Verdict",
    "conform",
    "diff",
    "draw",
    "export",
    "load",
    "loads",
    "random_network",
]


@checked_arguments
def load(path: str | os.PathLike[str], **constants: int | bool | str) -> Model:
    """Reads and instantiates a model.

    Args:
        path: a file in tachk's language (``.ta``, ``.xta``) or UPPAAL's XML.
        constants: other values for global constants of the model; a string is an expression of the language.

    A model with constructs that tachk does not check is loaded too: see `Model.refusals`.

    Raises:
        InputError: the model is wrong; carries every finding.
        UsageError: the file cannot be read, or there is no such constant.
    """
    return Model(load_model(path, constants), os.fspath(path), tuple(constants))


@checked_arguments
def loads(text: str, /, **constants: int | bool | str) -> Model:
    """Reads and instantiates a model from its text, in tachk's language or UPPAAL's XML.

    Imports are relative to the current folder. Otherwise as `load`.
    """
    return Model(load_model(Source("<text>", text), constants), "<text>", tuple(constants))


@checked_arguments
def conform(
    model: Model | str | os.PathLike[str],
    recording: str | os.PathLike[str],
    tolerance: str | None = None,
    late: str | Mapping[str, str] | None = None,
    unit: str | None = None,
    ports: Iterable[int] = (),
    limits: Limits | None = None,
    applications: Iterable[str | os.PathLike[str]] = (),
    explain: str = "short",
) -> ConformanceReport:
    """Checks if a recording of the real system is a run of a model; its ``recording { ... }`` says how to read it.

    Args:
        recording: a file of events, see docs/conformance.md.
        tolerance, late: durations such as ``"5ms"``, in place of what the model says; the tolerance ``"auto"`` finds
            the least one. ``{"input": "1ms", "output": "20ms"}`` gives the lateness of inputs and outputs apart.
        unit: of the recorded times, where the file does not say it.
        ports: of Agents, where the recording is a capture of packets; without any 8888 and where sessions are created.
        limits: of each search; the seconds are for all of them together.
        applications: files of events that applications noted; beside a capture with times since 1970.
        explain: the explanation for a recording that is not a run. ``"none"``: nothing; ``"short"``: the place where it
            leaves the model, and an edit that would make it a run if one is found in a few seconds; ``"full"``: all
            edits near that place are tried.

    Raises UsageError if the recording does not fit the model, or it says nothing of them, UnsupportedError.
    """
    from tachk.formats.loading.recorded_models import recorded_model
    from tachk.recordings.conformance.conform_file import conform_file
    from tachk.recordings.conformance.question import ExplanationDetail, Question
    from tachk.report.conformance.result import ConformanceReport

    model = model if isinstance(model, Model) else load(model)
    model = Model(recorded_model(model.loaded, model.path, model.definitions), model.path, model.definitions)
    if explain not in list(ExplanationDetail):
        raise UsageError(f"`{explain}` is not a kind of explanation", f"one of {', '.join(ExplanationDetail)}")
    logs = tuple(os.fspath(each) for each in applications)
    requested = Question(tolerance, late, unit, tuple(ports), logs, ExplanationDetail(explain))
    found = conform_file(model.loaded, model.path, os.fspath(recording), requested, limits or Limits())
    return ConformanceReport.of(found, model.path)


@checked_arguments
def diff(before: Model | str | os.PathLike[str], after: Model | str | os.PathLike[str]) -> str:
    """The differences in the behaviour of two models, as `tachk diff` prints them; empty if there are none. Constants
    have the values that they were given when the models were loaded.

    Raises UsageError for a model that cannot be written down, and what `load` raises for paths.
    """
    from tachk.formats.difference import least_difference, print_difference
    from tachk.formats.plain.expansion import expand

    models = (model if isinstance(model, Model) else load(model) for model in (before, after))
    first, second = (expand(model._written, model.definitions, repair_names=False) for model in models)
    return print_difference(least_difference(first, second))


@checked_arguments
def draw(model: Model | str | os.PathLike[str], template: str | None = None) -> Picture:
    """The picture of one template of a model, or of all of them together; see `tachk.report.pictures`.

    Raises:
        InputError: the text is wrong; carries every finding.
        UsageError: the file cannot be read, or has no such template.
    """
    from tachk.formats.layout_json import read_layout_beside
    from tachk.report.pictures import draw as draw_path
    from tachk.report.pictures import draw_document

    if isinstance(model, Model):
        loaded = model._written
        return draw_document(loaded.items, loaded.layout or read_layout_beside(model.path), model.path, template)
    return draw_path(model, template)


@checked_arguments
def export(model: Model | str | os.PathLike[str], format: str, observers: bool = True) -> str:
    """A model, or that of a path, as text for another program.

    Args:
        format: such as ``xml`` or ``tchecker``: one of `tachk.formats.catalogue.EXPORT_FORMATS`.
        observers: give temporal properties observer automata where the format has no formulas.

    Raises:
        UsageError: there is no such format.
        UnsupportedError: something in the model cannot be said in it.
    """
    from tachk.formats.catalogue import EXPORT_FORMATS, export_model
    from tachk.formats.exported import Writing

    if format not in EXPORT_FORMATS:
        raise UsageError(f"there is no format {format!r}", f"one of {', '.join(EXPORT_FORMATS)}")
    model = model if isinstance(model, Model) else load(model)
    return export_model(model._written, format, Writing(model.definitions, observers=observers)).text


@checked_arguments
def random_network(seed: int = 0) -> Model:
    """A small random network, the same for the same seed: something to try a program on."""
    from random import Random

    from tachk.model.random_networks import random_case

    return Model(random_case(Random(seed)).network, f"<random network {seed}>")


@dataclass(frozen=True, slots=True)
class Model(Estimable, Runnable):
    """An instantiated model with the properties it states.

    Attributes:
        path: where it was read from, as given; or what reports call it.
        loaded: the network with everything else that was found in the text.
        definitions: the names of the constants that were given another value.
    """

    path: str
    loaded: LoadedModel = field(repr=False)
    definitions: tuple[str, ...]

    def __init__(
        self, network: Network | LoadedModel, path: str = "<network>", definitions: tuple[str, ...] = ()
    ) -> None:
        """A model of a network that was made in Python, or of what was read from a text."""
        if isinstance(network, Network):
            from tachk.formats.network_document import network_model

            loaded = network_model(network, path)
        else:
            loaded = network
        for name, value in (("path", path), ("loaded", loaded), ("definitions", definitions)):
            object.__setattr__(self, name, value)

    @property
    def _written(self) -> LoadedModel:
        """The model as far as it is or can be written down.

        Raises:
            UsageError: it was made in Python, and the language cannot say it.
        """
        if not self.loaded.items:
            from tachk.formats.network_document import why_not_writable

            reason = why_not_writable(self.network)
            raise UsageError(f"{self.path} cannot be written as a model, only be checked", reason)
        return self.loaded

    @property
    def network(self) -> Network:
        """The processes and variables. Raises UnsupportedError where the model has refusals."""
        return self.loaded.network

    @property
    def properties(self) -> tuple[Query, ...]:
        """The properties that the model states, in order."""
        return self.loaded.queries

    @property
    def constants(self) -> Mapping[str, int]:
        """The global integer constants with their values."""
        return dict(self.loaded.heading.constants)

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The warnings of `tachk check` about the text."""
        return self.loaded.warnings

    @property
    def refusals(self) -> tuple[Diagnostic, ...]:
        """The constructs that tachk does not check: with any, every answer about the model is unknown."""
        return self.loaded.refusals

    @checked_arguments
    def verify(
        self,
        *queries: str,
        property: str | Iterable[str] = (),
        query_files: Iterable[str | os.PathLike[str]] = (),
        non_zeno: bool = False,
        options: Options | None = None,
        limits: Limits | None = None,
        trace: bool = True,
        progress: Progress | None = None,
    ) -> Report:
        """Checks the given queries and the named properties; without either, every property of the model.

        Args:
            queries: formulas such as ``"A[] not deadlock"``.
            property: the name of a property of the model, or several.
            query_files: files of formulas, each with its optional expectation.
            non_zeno: a run with infinitely many transitions counts only if time diverges in it.
            trace: compute the run that shows a violation or a witness.
            progress: called now and then during a long search, with its statistics and the names of its queries.

        Raises:
            InputError: one of ``queries`` is wrong. A wrong query of a file is listed as not checked.
            UsageError: there is no property of that name.
            UnsupportedError: the model uses a feature that the query cannot be decided with.
            StoppedError: the limit on seconds was over before the queries were read.
        """
        from tachk.verify.answering import answers

        options, limits = options or Options(), limits or Limits()
        questions = Questions(
            self.path,
            (property,) if isinstance(property, str) else tuple(property),
            tuple(read_source(path) for path in query_files),
            tuple(Source("<query>", text) for text in queries),
            non_zeno,
            statistical=True,
        )
        with remembering_interruption(), limited(limits.seconds), followed(progress):
            with limited(memory=limits.memory_bytes):
                formulas = questions.about(self.loaded)
            symbolic = checked(formulas)
            left = replace(limits, seconds=current_job().seconds_left)
            share = share_of_searches(left, formulas)
            verdicts = answers(self.loaded, questions, symbolic, options, share, trace)
            found = answers_among(self.loaded, questions, formulas, options, limits)
        record = RunRecord(
            self.path,
            self.loaded.heading if self.refusals else self.network,
            verdicts,
            _not_checked(found.get(number, formula) for number, formula in enumerate(formulas, 1)),
            options,
            limits,
            self.definitions,
            self.refusals,
            trace,
            tuple(each for each in found.values() if not isinstance(each, UncheckedQuery)),
        )
        return Report(record)

    @checked_arguments
    def time(
        self,
        start: str | None = None,
        end: str | None = None,
        last: bool = False,
        best: bool = True,
        worst: bool = True,
        settled: bool = False,
        options: Options | None = None,
        limits: Limits | None = None,
        trace: bool = True,
    ) -> TimesReport:
        """The least and the largest time from one event to the next occurrence of another one, over all runs.

        Args:
            start, end: conditions that become true (``"P.location"``, ``"n == 3"``), channels (``"c[1]!"``) or signals;
                without ``start`` from the start of the run, such as ``time(end="P.location")``.
            last: from the last occurrence of the first event before the second one, not from the first.
            best, worst: what is measured.
            settled: conditions count only where no process is in a committed location.
            trace: make the runs that take these times.

        Raises:
            InputError: an event is wrong.
            UsageError: there is no ``end``, or an event is about a channel that an edge computes.
            UnsupportedError: the model uses a feature that cannot be checked.
        """
        from tachk.api.times import ARGUMENTS, measured_times
        from tachk.report.time_report import TimedInterval

        if end is None:
            raise UsageError("there is no second event", "write time(start, end), or time(end=...) from the start on")
        interval = TimedInterval(self.path, start, end, last)
        chosen = options or Options(), limits or Limits()
        return measured_times(self.loaded, interval, ARGUMENTS, best, worst, settled, *chosen, trace)

    @checked_arguments
    def check(
        self,
        limits: Limits | None = None,
        options: Options | None = None,
        progress: Callable[[Statistics], None] | None = None,
    ) -> DeepCheckReport:
        """Explores the states of the model and looks for what is odd about it although no property asks for it, as
        `tachk check --deep` does: what no run reaches, time-locks, Zeno loops, names that nothing uses.

        Raises:
            InputError: the initial state violates an invariant.
            UnsupportedError: the model has refusals.
        """
        from tachk.frontend.unused_names import unused_names
        from tachk.report.deep_report import DeepCheckReport
        from tachk.verify.semantic_lint.deep_check import deep_check

        loaded = self.loaded
        unused = unused_names(loaded.items, loaded.document.items) if loaded.items else None
        with followed(None if progress is None else lambda statistics, _: progress(statistics)):
            found = deep_check(self.network, self.warnings, unused, options or Options(), limits or Limits())
        return DeepCheckReport.of(found, self.network)

    @checked_arguments
    def synthesize(
        self,
        *query: str,
        over: str | Iterable[str | VariedConstant] | Mapping[str, object] | Grid,
        property: str | None = None,
        answer: Answer = Answer.HOLDS,
        options: Options | None = None,
        limits: Limits | None = None,
        progress: Progress | None = None,
        infer: bool = True,
        reuse: bool = True,
        certify: bool = False,
    ) -> Synthesis:
        """For which values of constants a property or a query has an answer.

        Args:
            query: a formula, in place of ``property``.
            over: such as ``"PERIOD=1..50,DEADLINE=10..100:10"`` or ``{"PERIOD": range(1, 51)}``, or parameters.
            property: the name of a property of the model.
            limits: the one on seconds holds for all searches together, the others for each.
            infer: take the answer for one value of a constant for other values, too, where the constant is proved to
                be an upper bound only, or a lower bound only.
            reuse: try the run, or the certificate, that was found with other values before a search.
            certify: make a certificate of each answer that something is never reached; see `Synthesis.certificates`.

        None of the last three changes an answer that is known. The answer for some values may be unknown.

        Raises:
            InputError: the query is wrong, or the model is with all values.
            UsageError: there is no such property or constant, or not exactly one query.
            UnsupportedError: the query cannot be decided.
        """
        from tachk.report.region.synthesis import Synthesis
        from tachk.verify.synthesis.parameters import parameters_from
        from tachk.verify.synthesis.synthesize import synthesize

        names = () if property is None else (property,)
        with followed(progress):
            region = synthesize(
                self._written,
                Questions(self.path, names, (), tuple(Source("<query>", text) for text in query)),
                parameters_from(over),
                answer,
                options or Options(),
                limits or Limits(),
                infer,
                reuse,
                certify,
            )
        return Synthesis(region, self.loaded.heading.time_unit)

    @checked_arguments
    def sweep(
        self,
        *queries: str,
        over: str | Iterable[str] | Mapping[str, object] | Grid,
        property: str | Iterable[str] = (),
        non_zeno: bool = False,
        store: str | os.PathLike[str] | None = None,
        processes: int | None = None,
        dask: Any = None,
        options: Options | None = None,
        limits: Limits | None = None,
        seconds: float | None = None,
        progress: Callable[[CampaignProgress], None] | None = None,
        settings: Settings | None = None,
        monitor: str | os.PathLike[str] | None = None,
        until: str | float = "100",
        runs: int = 100,
        seed: int = DEFAULT_SEED,
        part: tuple[int, int] = (1, 1),
        merge: Iterable[str | os.PathLike[str]] = (),
    ) -> Sweep:
        """Checks queries and properties for every combination of values of some constants, several at a time.

        Args:
            queries, property, non_zeno: as for `verify`.
            over: such as ``"LOSSES=0..5,SLICE=10,50"`` or ``{"LOSSES": range(6), "SLICE": [10, 50]}``.
            store: an SQLite file for finished cells: a sweep that was stopped, or killed, goes on where it was.
            processes: how many cells are computed at a time; None: as many as the machine has cores.
            dask: the address of a Dask scheduler, or a `distributed.Client`, that computes in place of processes here.
            limits: of each cell.
            seconds: the limit on everything together; what is not finished then is missing in the table.
            progress: called after each cell.
            settings: how statistical queries are answered.
            monitor: a formula, or a file of them, that is evaluated on so many ``runs`` of each cell ``until`` a time,
                such as 10 or ``"2 h"``. Properties of the model are checked then only where they are named.
            part: ``(3, 10)``: compute and return every tenth cell, from the third one on, as one of ten jobs.
            merge: files of the same sweep, such as parts have made, whose cells are taken over.

        The processes import the program that calls this: a script needs ``if __name__ == "__main__":`` around it.

        Raises:
            InputError: a query is wrong.
            UsageError: there is no such property or constant, or the file belongs to another sweep.
        """
        from tachk.model.grid import grid_of_values
        from tachk.report.campaign.table import Sweep
        from tachk.verify.campaign.job import verification
        from tachk.verify.campaign.run import GridPart, computing, run_campaign

        named = (property,) if isinstance(property, str) else tuple(property)
        questions = Questions(self.path, named, (), tuple(Source("<query>", text) for text in queries), non_zeno, True)
        grid = grid_of_values(over)
        formula_runs = None
        if monitor is not None:
            from tachk.verify.campaign.evaluated_runs import evaluated_runs

            formula_runs = evaluated_runs(monitor, str(until), runs, seed)
        common = options or Options(), limits or Limits(), settings, formula_runs
        job, compute = verification(self._written, grid.names, questions, *common), computing(processes, dask)
        return Sweep(self.path, run_campaign(grid, job, store, compute, seconds, progress, GridPart(*part), merge))

    @checked_arguments
    def zone_graph(self, limit: int = 10_000) -> Any:
        """The symbolic states that are reachable and what leads from one to the other, as a `networkx.DiGraph`.

        Its nodes are `tachk.report.run.zone_view.ZoneState`; see `tachk.report.run.zone_view.as_networkx` for what
        edges and the graph itself have. It is made in Python, for graphs that one can look at.

        Args:
            limit: of the number of nodes. If there are more, ``graph.graph["reason"]`` is ``"state limit"``.

        Raises:
            InputError: the initial state violates an invariant.
            UnsupportedError: the model uses a feature that cannot be checked.
        """
        from tachk.engine.zone_graph import zone_graph
        from tachk.meaning.discrete import prepare
        from tachk.meaning.initial_state import check_initial_state
        from tachk.model.selections import check_selections
        from tachk.report.run.zone_view import as_networkx

        check_selections(self.network)
        check_initial_state(prepare(self.network))
        return as_networkx(self.network, zone_graph(self.network, limit))

    def __repr__(self) -> str:
        set_ = "".join(f", {name}={self.constants[name]}" for name in self.definitions if name in self.constants)
        return f"<Model {self.path}{set_}>"

    def _repr_html_(self) -> str:
        from html import escape

        constants = ", ".join(f"{name} = {value}" for name, value in self.constants.items())
        title = f"<p><b>{escape(self.path)}</b>{escape(f' — {constants}' if constants else '')}</p>"
        try:
            picture = draw(self).svg
        except TachkError:
            return title
        return f"{title}\n{picture}"


def _not_checked(formulas: Iterable[object]) -> tuple[NotChecked, ...]:
    return tuple(
        NotChecked(f.name, f.text, why_not(f), f.diagnostics, f.title, f.span, number)
        for number, f in enumerate(formulas, 1)
        if isinstance(f, UncheckedQuery)
    )
