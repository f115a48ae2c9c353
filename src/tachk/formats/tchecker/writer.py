"""A network as TChecker's text format (.tck).

TChecker has one flat name space, processes and vectors of synchronised events. Each process of the network is one of
TChecker's; each binary channel gives one vector for each pair of a sender and a receiver, each broadcast channel one
vector for each sender with the receivers in weak synchronisation. ``select`` is expanded.

An assignment outside a variable's range ends tachk's search with an error; TChecker takes the edge to be disabled.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tachk.analysis.conditions import split_conjunction
from tachk.analysis.fold import Known, fold_place, known_values
from tachk.base.diagnostics.diagnostic import Diagnostic, Label, UnsupportedError
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.formats.exported import Exported, Writing
from tachk.formats.tchecker.edge_expansion import EdgeExpansion, FlatEdge, choices
from tachk.formats.tchecker.expression_writer import TermPrinter, slot_name, unsupported, written_out
from tachk.formats.tchecker.label_writer import QueryLabels, query_labels
from tachk.formats.tchecker.leaves import field_paths, indices_of, leaf_types, leaf_values
from tachk.frontend.loaded import LoadedModel
from tachk.model.expressions import Constant, Expression, Field, Index, Reference, Variable
from tachk.model.network import Network, Process
from tachk.model.query import Query
from tachk.model.traversal import walk
from tachk.model.types import ChannelType, ClockType, Type
from tachk.model.variable_layout import begun_clocks, slot_range

_WORDS = frozenset(
    {"clock", "edge", "event", "int", "location", "process", "sync", "system", "if", "then", "else", "end", "while"}
    | {"do", "nop", "local"}
)


@dataclass(frozen=True, slots=True)
class TCheckerModel:
    """Attributes:
    text: the content of the .tck file.
    labels: which labels to search for each query, or why labels cannot ask it.
    """

    text: str
    labels: tuple[QueryLabels, ...]


def export_tchecker(model: LoadedModel, writing: Writing) -> Exported:
    """A row of `tachk.formats.catalogue`; the system has the name of the model's file."""
    return Exported(to_tchecker(model.network, model.queries, Path(model.document.span.source.name).stem).text)


def to_tchecker(network: Network, queries: Sequence[Query] = (), name: str = "network") -> TCheckerModel:
    """The network in TChecker's words.

    Raises:
        UnsupportedError: E0802, with the place of everything that TChecker cannot say.
    """
    return _Exporter(network, known_values(network, [])).run(queries, name)


@dataclass(slots=True)
class _Exporter:
    network: Network
    known: Known
    errors: list[UnsupportedError] = field(default_factory=list)
    taken: set[str] = field(default_factory=lambda: set(_WORDS))
    names: dict[tuple[Variable, tuple[str, ...]], str] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)

    def run(self, queries: Sequence[Query], name: str) -> TCheckerModel:
        self._check_features()
        self._raise_errors()
        processes = [self._fresh(process.name) for process in self.network.processes]
        arrays = {v for e in self._expressions() for v in _computed(e)}
        for variable in self.network.all_variables():
            self._name_leaves(variable)
        printer = TermPrinter(self.names, arrays, self.known.values)
        labels = [query_labels(query, self.network, self.known, f"q{i}") for i, query in enumerate(queries, 1)]
        body: list[str] = []
        edges = [self._flat_edges(process, printer) for process in self.network.processes]
        self._raise_errors()
        vectors, events, labelled = self._synchronise(edges, processes)
        for number, process in enumerate(self.network.processes):
            body += ["", f"process:{processes[number]}"]
            body += self._locations(number, processes[number], printer, labels)
            for edge, event in labelled[number]:
                body.append(self._edge(process, processes[number], edge, event))
        self._raise_errors()
        head = [f"system:{_sanitised(name)}", "", *(f"event:{event}" for event in events)]
        head += ["", *self._declarations(printer)]
        self._raise_errors()
        remarks = [f"# {line}" for found in labels for line in found.remarks()]
        text = "\n".join([*head, *body, "", *vectors, *([""] if remarks else []), *remarks])
        return TCheckerModel(re.sub(r"\n{3,}", "\n\n", text).strip() + "\n", tuple(labels))

    # ---- refusals ---------------------------------------------------------------------------------------------------

    def _check_features(self) -> None:
        network = self.network
        for variable in network.all_variables():
            for leaf in leaf_types(variable.type):
                if isinstance(leaf, ChannelType) and leaf.urgent:
                    help_ = "make a location urgent where nothing else may happen before the synchronisation"
                    self._refuse("urgent channels", variable.span, help_)
                    break
            if any(p != network.default_priority for p in variable.priorities):
                self._refuse("priorities of channels", variable.span)
        for variable in begun_clocks(network):
            self._refuse("clocks that do not begin with 0", variable.span, "set the clock on the first edge")
        for process in network.processes:
            if process.priority != network.processes[0].priority:
                self._refuse("priorities of processes", process.span)
                break
        for process in network.processes:
            for location in process.locations:
                if location.rates:
                    self._refuse("clocks that stand still", location.rates[0][0].span)

    def _refuse(self, what: str, span: Span, help_: str | None = None) -> None:
        self.errors.append(unsupported(what, span, help_))

    def _raise_errors(self) -> None:
        """Raises the first refusal; the others are labels of it."""
        if not self.errors:
            return
        first, *others = dict.fromkeys(error.diagnostic for error in self.errors)
        labels = tuple(Label(other.span, other.message) for other in others if other.span.source is first.span.source)
        raise UnsupportedError(Diagnostic(first.code, first.message, first.span, first.help, labels))

    # ---- names and declarations -------------------------------------------------------------------------------------

    def _fresh(self, name: str) -> str:
        wanted = _sanitised(name)
        result, number = wanted, 1
        while result in self.taken:
            number += 1
            result = f"{wanted}_{number}"
        self.taken.add(result)
        return result

    def _name_leaves(self, variable: Variable) -> None:
        for path in field_paths(variable.type):
            if path[1] is not None:
                self.names[variable, path[0]] = self._fresh("_".join((variable.name, *path[0])))

    def _declarations(self, printer: TermPrinter) -> Iterator[str]:
        for variable in self.network.all_variables():
            if variable in self.known.values:
                continue
            for fields, leaf in field_paths(variable.type):
                if leaf is not None:
                    yield from self._declaration(variable, fields, leaf, printer)

    def _declaration(
        self, variable: Variable, fields: tuple[str, ...], leaf: Type, printer: TermPrinter
    ) -> Iterator[str]:
        name = self.names[variable, fields]
        values = list(leaf_values(variable, fields))
        if variable in printer.arrays:
            if isinstance(leaf, ClockType):
                yield f"clock:{len(values)}:{name}"
                return
            low, high = slot_range(leaf)
            if len({value for _, value in values}) > 1:
                self._refuse(
                    f"arrays with different initial values: `{variable.name}`",
                    variable.span,
                    "assign them on a first edge",
                )
                return
            yield f"int:{len(values)}:{low}:{high}:{values[0][1]}:{name}"
            return
        for indices, value in values:
            slot = slot_name(name, indices) if indices else name
            if isinstance(leaf, ClockType):
                yield f"clock:1:{slot}"
            else:
                low, high = slot_range(leaf)
                yield f"int:1:{low}:{high}:{value}:{slot}"

    # ---- edges ------------------------------------------------------------------------------------------------------

    def _expressions(self) -> Iterator[Expression]:
        for process in self.network.processes:
            for location in process.locations:
                if location.invariant is not None:
                    yield written_out(location.invariant, self.known)
            for edge in process.edges:
                for known in choices(edge, self.known):
                    if edge.guard is not None:
                        yield written_out(edge.guard, known)
                    yield from (written_out(update, known) for update in edge.updates)
                    if edge.synchronisation is not None:
                        channel = fold_place(edge.synchronisation.channel, known)
                        yield from (node.index for node in walk(channel) if isinstance(node, Index))

    def _flat_edges(self, process: Process, printer: TermPrinter) -> list[FlatEdge]:
        expansion = EdgeExpansion(self.network, self.known, printer)
        result: list[FlatEdge] = []
        for edge in process.edges:
            try:
                result += expansion.expanded(edge)
            except UnsupportedError as error:
                self.errors.append(error)
        return result

    # ---- synchronisation --------------------------------------------------------------------------------------------

    def _synchronise(
        self, edges: Sequence[Sequence[FlatEdge]], processes: Sequence[str]
    ) -> tuple[list[str], list[str], list[list[tuple[FlatEdge, str]]]]:
        """The vectors, the events, and the edges that can ever be taken, each with its event."""
        internal = self._fresh("tau")
        used: dict[tuple[Variable, int], dict[Direction, list[int]]] = {}
        for number, own in enumerate(edges):
            for edge in own:
                if edge.channel is not None and edge.direction is not None:
                    users = used.setdefault(edge.channel, {Direction.SEND: [], Direction.RECEIVE: []})
                    if number not in users[edge.direction]:
                        users[edge.direction].append(number)
        vectors: list[str] = []
        events: dict[tuple[Variable, int, Direction], str] = {}
        active: set[tuple[Variable, int, Direction, int]] = set()
        for (variable, slot), users in used.items():
            broadcast = any(isinstance(t, ChannelType) and t.broadcast for t in leaf_types(variable.type))
            base = slot_name(variable.name, indices_of(variable.type, slot))
            send = events[variable, slot, Direction.SEND] = self._fresh(f"{base}_send")
            receive = events[variable, slot, Direction.RECEIVE] = self._fresh(f"{base}_receive")
            for sender in users[Direction.SEND]:
                others = [r for r in users[Direction.RECEIVE] if r != sender]
                if others or broadcast:
                    active.add((variable, slot, Direction.SEND, sender))
                active |= {(variable, slot, Direction.RECEIVE, r) for r in others}
                if broadcast and others:
                    weak = ":".join(f"{processes[r]}@{receive}?" for r in others)
                    vectors.append(f"sync:{processes[sender]}@{send}:{weak}")
                elif not broadcast:
                    vectors += [f"sync:{processes[sender]}@{send}:{processes[r]}@{receive}" for r in others]
            if broadcast and users[Direction.SEND]:
                self._check_weak(edges, (variable, slot))
        labelled = [
            [
                (edge, internal if edge.channel is None else events[(*edge.channel, _direction(edge))])
                for edge in own
                if edge.channel is None or (*edge.channel, _direction(edge), number) in active
            ]
            for number, own in enumerate(edges)
        ]
        names = list(dict.fromkeys(event for own in labelled for _, event in own))
        return vectors, names, labelled

    def _check_weak(self, edges: Sequence[Sequence[FlatEdge]], channel: tuple[Variable, int]) -> None:
        for own in edges:
            for edge in own:
                if edge.channel == channel and edge.direction is Direction.RECEIVE and edge.guard:
                    self._refuse(
                        f"guards on edges that receive a broadcast, here over `{channel[0].name}`",
                        edge.span,
                        "receive in any case, and decide on an edge behind a committed location",
                    )

    # ---- text -------------------------------------------------------------------------------------------------------

    def _locations(self, number: int, name: str, printer: TermPrinter, labels: Iterable[QueryLabels]) -> Iterator[str]:
        process = self.network.processes[number]
        for index, location in enumerate(process.locations):
            attributes = []
            if index == process.initial:
                attributes.append("initial:")
            if location.committed:
                attributes.append("committed:")
            elif location.urgent:
                attributes.append("urgent:")
            if location.invariant is not None:
                text = self._invariant(location.invariant, printer)
                if text:
                    attributes.append(f"invariant: {text}")
            own = [label for found in labels for label in found.of(number, index)]
            if own:
                attributes.append(f"labels: {','.join(own)}")
            yield f"location:{name}:{_location_name(location.name)}{{{' : '.join(attributes)}}}"

    def _invariant(self, invariant: Expression, printer: TermPrinter) -> str:
        try:
            split = split_conjunction(written_out(invariant, self.known), self.known)
            parts = [printer.condition(written_out(c, self.known)) for c in split.integers]
            for condition, atom in split.clocks:
                if condition is not None:
                    raise unsupported("invariants in which a clock condition depends on variables", atom.span)
                parts.append(printer.atom(atom))
            return " && ".join(part for part in parts if part != "1 == 1")
        except UnsupportedError as error:
            self.errors.append(error)
            return ""

    def _edge(self, process: Process, name: str, edge: FlatEdge, event: str) -> str:
        attributes = []
        if edge.guard:
            attributes.append(f"provided: {' && '.join(edge.guard)}")
        if edge.updates:
            attributes.append(f"do: {'; '.join(edge.updates)}")
        source, target = (_location_name(process.locations[i].name) for i in (edge.source, edge.target))
        return f"edge:{name}:{source}:{target}:{event}{{{' : '.join(attributes)}}}"


def _direction(edge: FlatEdge) -> Direction:
    assert edge.direction is not None
    return edge.direction


def _sanitised(name: str) -> str:
    text = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_")
    return text if text and not text[0].isdigit() else f"_{text}"


def _location_name(name: str) -> str:
    text = _sanitised(name)
    return f"{text}_" if text in _WORDS else text


def _computed(expression: Expression) -> Iterator[Variable]:
    """The variables that are indexed by something the state decides."""
    for node in walk(expression):
        if isinstance(node, Index) and not isinstance(node.index, Constant):
            base: Expression = node
            while isinstance(base, Index | Field):
                base = base.base
            if isinstance(base, Reference):
                yield base.variable
