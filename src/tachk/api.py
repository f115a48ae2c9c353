"""The toolchain as a library.

    import tachk

    model = tachk.load("fischer.ta", N=5)
    report = model.verify()
    report["mutual_exclusion"].answer          # Answer.HOLDS

`load` takes a file, `loads` a text, and `Model` a network that `tachk.model.builder` made.

Wrong input raises `InputError` with every finding; a limit that is hit is an answer (`Answer.UNKNOWN`), not an error.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from io import StringIO
from time import monotonic
from typing import TYPE_CHECKING, Any, overload

from tachk.diagnostics.diagnostic import Diagnostic, InputError, TachkError, UnsupportedError, UsageError
from tachk.diagnostics.span import Source
from tachk.diagnostics.suggestion import closest, unknown_key
from tachk.engines.options import Extrapolation, Limits, Options, SearchOrder
from tachk.frontend.loaded import LoadedModel, elaborate_query_file, other_readings_of
from tachk.frontend.priority_readings import FIRST
from tachk.frontend.queries.queries import UncheckedQuery
from tachk.loading.load import load_model
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.properties.readings import agreed
from tachk.properties.verdict import Answer, Verdict
from tachk.report.record import NotChecked, RunRecord
from tachk.syntax.source_files import read_source
from tachk.time_limit import time_limit

if TYPE_CHECKING:
    from tachk.drawing.svg import Picture
    from tachk.properties.verify import VerifyProgress
    from tachk.report.json_report import Json
    from tachk.report.run.told_run import Run

__all__ = [
    "Answer",
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
    "diff",
    "draw",
    "export",
    "load",
    "loads",
    "random_network",
]


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


def loads(text: str, /, **constants: int | bool | str) -> Model:
    """Reads and instantiates a model from its text, in tachk's language or UPPAAL's XML.

    Imports are relative to the current folder. Otherwise as `load`.
    """
    return Model(load_model(Source("<text>", text), constants), "<text>", tuple(constants))


def diff(before: Model, after: Model) -> str:
    """What is different in the behaviour of two models, as `tachk diff` tells it; empty if nothing is."""
    from tachk.formats.difference import least_difference, print_difference
    from tachk.formats.plain.expansion import expand

    first, second = (expand(model._written, repair_names=False) for model in (before, after))
    return print_difference(least_difference(first, second))


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


def export(model: Model, format: str, observers: bool = True) -> str:
    """A model as text for another program.

    Args:
        format: such as ``xml`` or ``tchecker``: the value of an `ExportFormat` of `tachk.formats.catalogue`.
        observers: give temporal properties observer automata where the format has no formulas.

    Raises:
        UsageError: there is no such format.
        UnsupportedError: something in the model cannot be said in it.
    """
    from tachk.formats.catalogue import ExportFormat, export_model
    from tachk.formats.exported import Writing

    try:
        wanted = ExportFormat(format)
    except ValueError:
        raise UsageError(f"there is no format {format!r}", f"one of {', '.join(ExportFormat)}") from None
    return export_model(model._written, wanted, Writing(model.definitions, observers=observers)).text


def random_network(seed: int = 0) -> Model:
    """A small random network, the same for the same seed: something to try a program on."""
    from random import Random

    from tachk.testing.networks import random_case

    return Model(random_case(Random(seed)).network, f"<random network {seed}>")


@dataclass(frozen=True, slots=True, init=False)
class Model:
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
        loaded = _made(network, path) if isinstance(network, Network) else network
        for name, value in (("path", path), ("loaded", loaded), ("definitions", definitions)):
            object.__setattr__(self, name, value)

    @property
    def _written(self) -> LoadedModel:
        """The model as far as it is or can be written down.

        Raises:
            UsageError: it was made in Python, and the language cannot say it.
        """
        if not self.loaded.items:
            raise UsageError(
                f"{self.path} cannot be written as a model, only be checked", _why_not_written(self.network)
            )
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
        return self.loaded.warnings

    @property
    def refusals(self) -> tuple[Diagnostic, ...]:
        """The constructs that tachk does not check: with any, every answer about the model is unknown."""
        return self.loaded.refusals

    def verify(
        self,
        *queries: str,
        property: str | Iterable[str] = (),
        query_files: Iterable[str | os.PathLike[str]] = (),
        options: Options | None = None,
        limits: Limits | None = None,
        trace: bool = True,
        progress: VerifyProgress | None = None,
    ) -> Report:
        """Checks the given queries and the named properties; without either, every property of the model.

        Args:
            queries: formulas such as ``"A[] not deadlock"``.
            property: the name of a property of the model, or several.
            query_files: files of formulas, each with its optional expectation.
            trace: compute the run that shows a violation or a witness.
            progress: called now and then during a long search, with its statistics and the names of its queries.

        Raises:
            InputError: one of ``queries`` is wrong. A wrong query of a file is listed as not checked.
            UsageError: there is no property of that name.
            UnsupportedError: the model uses a feature that the query cannot be decided with.
            OutOfTimeError: the limit on seconds was over before the queries were read.
        """
        from tachk.properties.verify import refused
        from tachk.properties.verify import verify as verify_queries

        started = monotonic()
        options, limits = options or Options(), limits or Limits()
        names = (property,) if isinstance(property, str) else tuple(property)
        sources = [Source("<query>", text) for text in queries]
        files = [read_source(path) for path in query_files]
        with time_limit(limits.seconds):
            formulas = self._formulas(names, files, sources)
        checked = _checked(formulas)
        if self.refusals:
            network, verdicts = self.loaded.heading, refused(checked, self.refusals[0])
        else:
            network = self.network
            left = limits.after(monotonic() - started)
            verdicts = verify_queries(network, checked, options, left, progress, trace)
        others = []
        open_ = any(verdict.answer is not Answer.UNKNOWN for verdict in verdicts)
        for place, reading in other_readings_of(self.loaded) if open_ else ():
            asked = _checked(Model(reading, self.path, self.definitions)._formulas(names, files, sources))
            left = limits.after(monotonic() - started)
            others.append((place, verify_queries(reading.network, asked, options, left, progress, trace=False)))
        verdicts = tuple(
            agreed(verdict, FIRST, [(place, found[number]) for place, found in others])
            for number, verdict in enumerate(verdicts)
        )
        not_checked = tuple(
            NotChecked(f.name, f.text, _why_not(f), f.diagnostics, f.title, f.span, number)
            for number, f in enumerate(formulas, 1)
            if isinstance(f, UncheckedQuery)
        )
        record = RunRecord(
            self.path, network, verdicts, not_checked, options, limits, self.definitions, self.refusals, trace
        )
        return Report(record)

    def _formulas(
        self, names: Sequence[str], files: Sequence[Source], sources: Sequence[Source]
    ) -> tuple[Query | UncheckedQuery, ...]:
        """What is asked for, in order: the named properties and the queries of the texts, else all of the model."""
        if not names and not sources and not files:
            return self.loaded.formulas
        given = self._given(files, sources)
        return (*(self._property(name) for name in names), *given)

    def _given(self, files: Iterable[Source], sources: Iterable[Source]) -> tuple[Query | UncheckedQuery, ...]:
        """The queries of several texts, numbered through in their order whether they are checked or not."""
        formulas: list[Query | UncheckedQuery] = []
        diagnostics: list[Diagnostic] = []
        for source, typed in [(file, False) for file in files] + [(source, True) for source in sources]:
            found, others = elaborate_query_file(self.loaded, source, len(formulas) + 1)
            formulas += sorted((*found, *others), key=lambda formula: formula.span.start)
            if typed:
                diagnostics += (finding for query in others if query.is_wrong for finding in query.diagnostics)
        if diagnostics:
            raise InputError(diagnostics)
        return tuple(formulas)

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
        from tachk.compiler.features import check_selections
        from tachk.engines.zone_graph import zone_graph
        from tachk.properties.verify import check_initial_state
        from tachk.report.run.zone_view import as_networkx
        from tachk.semantics.discrete import prepare

        check_selections(self.network)
        check_initial_state(prepare(self.network))
        return as_networkx(self.network, zone_graph(self.network, limit))

    def __repr__(self) -> str:
        set_ = "".join(f", {name}={self.constants[name]}" for name in self.definitions if name in self.constants)
        return f"<Model {self.path}{set_}>"

    def _repr_html_(self) -> str:
        constants = ", ".join(f"{name} = {value}" for name, value in self.constants.items())
        title = f"<p><b>{escape(self.path)}</b>{escape(f' — {constants}' if constants else '')}</p>"
        try:
            picture = draw(self).svg
        except TachkError:
            return title
        return f"{title}\n{picture}"

    def _property(self, name: str) -> Query:
        for query in self.properties:
            if query.name == name:
                return query
        for unchecked in self.loaded.unchecked:
            if unchecked.name == name:
                if unchecked.diagnostics:
                    raise InputError(unchecked.diagnostics)
                raise UsageError(f"{self.path}: {name} is not checked: {_why_not(unchecked)}")
        names = [query.name for query in self.properties]
        close = closest(name, names)
        raise UsageError(
            f"{self.path} has no property {name!r}",
            f"did you mean {close}?" if close else f"it has: {', '.join(names) or 'none'}",
        )


def _made(network: Network, name: str) -> LoadedModel:
    """A network with the names that queries may use and, where the language can say it, the text that it would have."""
    from tachk.formats.network_document import NotWritable, empty_document, network_document
    from tachk.frontend.made_network import made_model

    try:
        document = network_document(network, name)
    except NotWritable:
        document = empty_document(name)
    return made_model(network, document)


def _why_not_written(network: Network) -> str:
    from tachk.formats.network_document import NotWritable, network_document

    try:
        network_document(network, "")
    except NotWritable as reason:
        return f"it has {reason}"
    return "it has no process"


def _checked(formulas: Iterable[Query | UncheckedQuery]) -> tuple[Query, ...]:
    return tuple(formula for formula in formulas if isinstance(formula, Query))


def _why_not(query: UncheckedQuery) -> str:
    if query.diagnostics:
        return query.diagnostics[0].message
    return f"{query.family} query"


@dataclass(frozen=True, slots=True)
class Report(Sequence[Verdict]):
    """The verdicts of one run, in the order of the queries; ``report["name"]`` finds one by name."""

    record: RunRecord

    @overload
    def __getitem__(self, index: int | str) -> Verdict: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Verdict, ...]: ...
    def __getitem__(self, index: int | str | slice) -> Verdict | tuple[Verdict, ...]:
        if isinstance(index, str):
            for verdict in self.record.verdicts:
                if verdict.query.name == index:
                    return verdict
            for query in self.record.not_checked:
                if query.name == index:
                    raise KeyError(f"{index} is not checked: {query.reason}")
            raise unknown_key(index, (verdict.query.name for verdict in self.record.verdicts))
        return self.record.verdicts[index]

    def __len__(self) -> int:
        return len(self.record.verdicts)

    @property
    def met(self) -> bool | None:
        """Whether every answer is as expected: False if one is not, else None if one is unknown, else True."""
        return self.record.met

    def run(self, index: int | str) -> Run | None:
        """The run that shows why an answer is as it is, None where there is none: it can be printed and looked at."""
        from tachk.report.run.told_run import Run

        verdict = self[index]
        return None if verdict.trace is None else Run(self.record.network, verdict)

    def to_dict(self) -> dict[str, Json]:
        """The run as docs/schema/verify.schema.json describes it."""
        from tachk.report.json_report import run_to_json

        return run_to_json(self.record)

    def to_rows(self) -> list[dict[str, str | int | float | bool | None]]:
        """One flat dictionary for each verdict, with the model's constants: what `pandas.DataFrame` takes."""
        return [
            {
                "model": self.record.model,
                **dict(self.record.network.constants),
                "property": verdict.query.name,
                "answer": verdict.answer.value,
                "met": verdict.met,
                "states_stored": verdict.statistics.states_stored,
                "states_explored": verdict.statistics.states_explored,
                "transitions": verdict.statistics.transitions,
                "seconds": verdict.statistics.seconds,
                "peak_bytes": verdict.statistics.peak_bytes,
            }
            for verdict in self.record.verdicts
        ]

    def to_text(self, every_trace: bool = False, clocks: bool = False) -> str:
        """What `tachk verify` prints."""
        from rich.console import Console

        from tachk.report.run.telling import Telling
        from tachk.report.text_report import print_run

        out = StringIO()
        print_run(self.record, Console(file=out, width=1000, highlight=False), every_trace, Telling(clocks))
        return out.getvalue()

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        answers = [f"{verdict.query.name}: {verdict.answer.value}" for verdict in self.record.verdicts]
        answers += [f"{query.name}: not checked" for query in self.record.not_checked]
        return f"<Report on {self.record.model}: {', '.join(answers) or 'nothing checked'}>"

    def _repr_html_(self) -> str:
        from tachk.report.html_report import run_to_html

        return run_to_html(self.record)
