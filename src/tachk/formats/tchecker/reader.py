"""TChecker's text format (.tck) to a document.

Processes become templates without parameters. A vector of two events becomes a channel from the first to the second; a
vector of one event and weakly synchronised ones becomes a broadcast channel, and one of three or more events several of
them (`tachk.formats.tchecker.meetings`). Other vectors are refused by name. A process with several initial locations
begins in a committed one more. Labels become signals. Updates with ``if`` or ``while`` become functions.

TChecker takes an edge to be disabled if an assignment leaves the range of a variable; here that is an error of the
model, reported when it happens.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.base.span import Source, Span
from tachk.base.words import Direction
from tachk.formats.tchecker.expression_reader import TCheckerExpressionReader, failure
from tachk.formats.tchecker.meetings import Meeting, Whereabouts, choices, guard_of
from tachk.syntax import ast
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.rewrite import fresh_name

_LINE = re.compile(
    r"[ \t]*(?P<kind>[a-z]+)[ \t]*:(?P<rest>[^\n#{]*)(?P<attributes>\{[^}]*\})?[ \t\r]*(?:#[^\n]*)?(?:\n|\Z)"
)
_IDLE = re.compile(r"[ \t\r]*(?:#[^\n]*)?(?:\n|\Z)")
_ARGUMENTS = {"system": 1, "process": 1, "event": 1, "clock": 2, "int": 5, "location": 2, "edge": 4}
_LOCATION_ATTRIBUTES = ("initial", "urgent", "committed", "invariant", "labels")
_EDGE_ATTRIBUTES = ("provided", "do")


@dataclass(frozen=True, slots=True)
class Entry:
    """One line of the file: its arguments and its attributes, with their places."""

    kind: str
    arguments: tuple[Span, ...]
    attributes: tuple[tuple[Span, Span], ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Vector:
    """A ``sync`` line: process, event and whether it is weak, in order."""

    parts: tuple[tuple[str, str, bool], ...]
    span: Span

    @property
    def joins_many(self) -> bool:
        """True if three or more processes take part, all of them."""
        return len(self.parts) > 2 and not any(weak for _, _, weak in self.parts)


@dataclass(slots=True)
class TCheckerProcess:
    name: ast.Identifier
    places: dict[str, str] = field(default_factory=dict)
    locations: list[ast.LocationDeclaration] = field(default_factory=list)
    edges: list[tuple[str, ast.EdgeDeclaration]] = field(default_factory=list)


def parse_tchecker(source: Source) -> tuple[ast.Document | None, tuple[Diagnostic, ...]]:
    """The model of a .tck file and what is to be said about it; None together with errors."""
    reader = _TCheckerReader(source)
    try:
        return reader.read(), tuple(reader.diagnostics)
    except InputError as error:
        return None, (*reader.diagnostics, *error.diagnostics)


@dataclass(slots=True)
class _Participation:
    """What the edges of processes take part in.

    Attributes:
        synchronised: the events in some vector, each with its process.
        uses: channels and what is done with them, by process and event.
        meetings: by process and the number of its edge.
    """

    synchronised: set[tuple[str, str]] = field(default_factory=set)
    uses: dict[tuple[str, str], list[tuple[str, Direction]]] = field(default_factory=dict)
    meetings: dict[tuple[str, int], list[Meeting]] = field(default_factory=dict)


@dataclass(slots=True)
class _TCheckerReader:
    source: Source
    diagnostics: list[Diagnostic] = field(default_factory=list)
    taken: set[str] = field(default_factory=set)
    names: dict[str, str] = field(default_factory=dict)
    events: set[str] = field(default_factory=set)
    processes: dict[str, TCheckerProcess] = field(default_factory=dict)
    declarations: list[ast.Declaration] = field(default_factory=list)
    functions: list[ast.Declaration] = field(default_factory=list)
    labels: dict[str, list[tuple[Span, str, str]]] = field(default_factory=dict)
    vectors: list[Vector] = field(default_factory=list)
    meetings: list[Meeting] = field(default_factory=list)
    places: dict[str, Whereabouts] = field(default_factory=dict)

    def read(self) -> ast.Document:
        self.taken |= set(lexer().keywords)
        entries = list(_entries(self.source))
        self._check_order(entries)
        handlers: dict[str, Callable[[Entry], None]] = {
            "process": self._process,
            "event": self._event,
            "clock": self._clock,
            "int": self._int,
            "location": self._location,
            "edge": self._edge,
            "sync": self._sync,
        }
        for kind in ("clock", "int", "event", "process", "location", "sync", "edge"):
            for entry in entries:
                if entry.kind == kind:
                    handlers[kind](entry)
        whole = Span(self.source, 0, len(self.source.text))
        for process in self.processes.values():
            self._begin_once(process)
        channels = self._channels()
        self._meet()
        part = self._participation(channels)
        templates = [self._template(name, process, part) for name, process in self.processes.items()]
        system = ast.SystemLine(whole, (tuple(process.name for process in self.processes.values()),))
        if not self.processes:
            raise failure("there is no process", whole)
        items: list[ast.Item] = [
            *self.declarations,
            *(declaration for _, declaration in channels.values()),
            *self.functions,
            *templates,
            system,
            *self._signals(),
        ]
        return ast.Document(whole, tuple(items))

    def _check_order(self, entries: list[Entry]) -> None:
        for entry in entries[1:]:
            if entry.kind == "system":
                raise failure("a second `system` line", entry.span)

    # ---- declarations -----------------------------------------------------------------------------------------------

    def _fresh(self, name: str) -> str:
        word = re.sub(r"\W", "_", name)
        result = fresh_name(f"{word}_1" if word in lexer().keywords else word, self.taken)
        self.taken.add(result)
        return result

    def _declare(self, place: Span) -> ast.Identifier:
        name = _word(place)
        if name in self.names:
            raise failure(f"`{name}` is declared twice", place)
        self.names[name] = self._fresh(name)
        return ast.Identifier(place, self.names[name])

    def _process(self, entry: Entry) -> None:
        (place,) = entry.arguments
        name = _word(place)
        if name in self.processes:
            raise failure(f"process `{name}` is declared twice", place)
        self.processes[name] = TCheckerProcess(ast.Identifier(place, self._fresh(name)))

    def _event(self, entry: Entry) -> None:
        self.events.add(_word(entry.arguments[0]))

    def _clock(self, entry: Entry) -> None:
        size, name = entry.arguments
        type_ = ast.TypeExpression(entry.span, (), ast.BuiltinType(entry.span, "clock"))
        declarator = ast.Declarator(name, self._declare(name), _dimensions(size))
        self.declarations.append(ast.VariableDeclaration(entry.span, type_, (declarator,)))

    def _int(self, entry: Entry) -> None:
        size, low, high, initial, name = entry.arguments
        bounds = ast.RangeType(entry.span, _literal(low), _literal(high))
        type_ = ast.TypeExpression(entry.span, (), bounds)
        value: ast.Expression = _literal(initial)
        dimensions = _dimensions(size)
        if dimensions:
            value = ast.InitialiserList(initial, ((None, value),) * _number(size))
        declarator = ast.Declarator(name, self._declare(name), dimensions, value)
        self.declarations.append(ast.VariableDeclaration(entry.span, type_, (declarator,)))

    # ---- processes --------------------------------------------------------------------------------------------------

    def _owner(self, place: Span) -> TCheckerProcess:
        process = self.processes.get(_word(place))
        if process is None:
            raise failure(f"there is no process `{_word(place)}`", place)
        return process

    def _location(self, entry: Entry) -> None:
        owner, place = entry.arguments
        process = self._owner(owner)
        name = _word(place)
        if name in process.places:
            raise failure(f"location `{name}` is declared twice", place)
        known = self._attributes(entry, _LOCATION_ATTRIBUTES)
        taken = {*self.names.values(), *lexer().keywords, *process.places.values()}
        word = re.sub(r"\W", "_", name)
        process.places[name] = fresh_name(word, taken)
        identifier = ast.Identifier(place, process.places[name])
        invariant = self._condition(known.get("invariant"))
        for label in self._words(known.get("labels")):
            self.labels.setdefault(label, []).append((entry.span, process.name.name, identifier.name))
        process.locations.append(
            ast.LocationDeclaration(
                entry.span,
                identifier,
                invariant,
                initial="initial" in known,
                urgent="urgent" in known,
                committed="committed" in known,
            )
        )

    def _edge(self, entry: Entry) -> None:
        owner, source, target, event = entry.arguments
        process = self._owner(owner)
        ends = []
        for place in (source, target):
            name = process.places.get(_word(place))
            if name is None:
                raise failure(f"process `{_word(owner)}` has no location `{_word(place)}`", place)
            ends.append(ast.Identifier(place, name))
        if _word(event) not in self.events:
            raise failure(f"there is no event `{_word(event)}`", event)
        known = self._attributes(entry, _EDGE_ATTRIBUTES)
        guard = self._condition(known.get("provided"))
        edge = ast.EdgeDeclaration(entry.span, ends[0], ends[1], (), guard, None, self._updates(known.get("do")))
        process.edges.append((_word(event), edge))

    def _attributes(self, entry: Entry, known: Iterable[str]) -> dict[str, Span]:
        found: dict[str, Span] = {}
        for key, value in entry.attributes:
            name = key.text.strip()
            if name in known:
                found[name] = value
            else:
                message = f"attribute `{name}` of this {entry.kind} is not read"
                self.diagnostics.append(Diagnostic("W0130", message, key))
        return found

    def _condition(self, place: Span | None) -> ast.Expression | None:
        if place is None or not place.text.strip():
            return None
        reader = TCheckerExpressionReader(self.source, place.start, place.end, self.names)
        result = reader.expression()
        reader.finish()
        return result

    def _updates(self, place: Span | None) -> tuple[ast.Expression, ...]:
        if place is None:
            return ()
        reader = TCheckerExpressionReader(self.source, place.start, place.end, self.names)
        block = reader.block()
        reader.finish()
        simple = [s for s in block.statements if isinstance(s, ast.ExpressionStatement)]
        if not block.declarations and all(
            isinstance(s, ast.ExpressionStatement | ast.EmptyStatement) for s in block.statements
        ):
            return tuple(statement.expression for statement in simple)
        name = ast.Identifier(place, self._fresh(f"update_{len(self.functions) + 1}"))
        nothing = ast.TypeExpression(place, (), ast.BuiltinType(place, "void"))
        self.functions.append(ast.FunctionDeclaration(place, nothing, name, (), block))
        return (ast.CallExpression(place, ast.NameExpression(place, name.name), ()),)

    def _words(self, place: Span | None) -> list[str]:
        return [] if place is None else [word for word in re.split(r"[,\s]+", place.text.strip()) if word]

    # ---- synchronisation --------------------------------------------------------------------------------------------

    def _sync(self, entry: Entry) -> None:
        parts = []
        for place in entry.arguments:
            process, at, event = _word(place).removesuffix("?").partition("@")
            if not at or process not in self.processes or event not in self.events:
                raise failure(f"`{_word(place)}` does not name an event of a process", place)
            parts.append((process, event, _word(place).endswith("?")))
        self.vectors.append(Vector(tuple(parts), entry.span))

    def _channels(self) -> dict[Vector, tuple[str, ast.VariableDeclaration]]:
        """The channel of each vector."""
        result: dict[Vector, tuple[str, ast.VariableDeclaration]] = {}
        idle = self._idle_vectors()
        order = list(self.processes)
        for vector in self.vectors:
            names = [process for process, _, _ in vector.parts]
            weak = [flag for _, _, flag in vector.parts]
            receivers = [order.index(name) for name in names[1:]]
            if len(set(names)) < len(names) or len(names) < 2:
                raise failure("a vector names at least two different processes", vector.span)
            if weak[0] or (any(weak[1:]) and not all(weak[1:])):
                raise InputError(
                    [
                        Diagnostic(
                            "E0821",
                            "a vector of this form has no counterpart among channels",
                            vector.span,
                            "write events that all must happen, or one event followed by weak ones",
                        )
                    ]
                )
            if any(weak) and receivers != sorted(receivers):
                raise InputError(
                    [
                        Diagnostic(
                            "E0821",
                            "the weak events of this vector are not in the order of the processes",
                            vector.span,
                            "a broadcast updates its receivers in that order; list the events in the same order",
                        )
                    ]
                )
            if not vector.joins_many and vector not in idle:
                result[vector] = self._channel(vector, any(weak))
        return result

    def _idle_vectors(self) -> set[Vector]:
        """Vectors that never happen, as a process has no edge for its event, and without which no edge loses all of
        its vectors. Networks that are generated have many."""
        with_edge = {(name, event) for name, process in self.processes.items() for event, _ in process.edges}
        possible = {
            vector
            for vector in self.vectors
            if all((name, event) in with_edge for name, event, weak in vector.parts if not weak)
        }
        served = {part[:2] for vector in possible for part in vector.parts}
        return {
            vector
            for vector in self.vectors
            if vector not in possible and with_edge.intersection(part[:2] for part in vector.parts) <= served
        }

    def _channel(self, vector: Vector, broadcast: bool) -> tuple[str, ast.VariableDeclaration]:
        prefixes = ("broadcast",) if broadcast else ()
        type_ = ast.TypeExpression(vector.span, prefixes, ast.BuiltinType(vector.span, "chan"))
        name = self._fresh(vector.parts[0][1])
        declarator = ast.Declarator(vector.span, ast.Identifier(vector.span, name))
        return name, ast.VariableDeclaration(vector.span, type_, (declarator,))

    def _begin_once(self, process: TCheckerProcess) -> None:
        """Adds a location that leads to each initial one, if there are several."""
        initial = [location for location in process.locations if location.initial]
        if len(initial) < 2:
            return
        taken = {*self.names.values(), *lexer().keywords, *process.places.values()}
        span = process.name.span
        start = ast.Identifier(span, fresh_name("begins", taken))
        process.locations[:] = [replace(location, initial=False) for location in process.locations]
        process.locations.insert(0, ast.LocationDeclaration(span, start, None, initial=True, committed=True))
        for location in initial:
            process.edges.append(("", ast.EdgeDeclaration(span, start, location.name, (), None, None, ())))

    def _meet(self) -> None:
        """The meetings of all vectors of three or more events, and where their processes are."""
        joining = [vector for vector in self.vectors if vector.joins_many]
        edges = {name: process.edges for name, process in self.processes.items()}
        for name in dict.fromkeys(name for vector in joining for name, _, _ in vector.parts[1:]):
            process = self.processes[name]
            if len(process.locations) < 2:
                continue
            numbers = {location.name.name: number for number, location in enumerate(process.locations)}
            self.places[name] = Whereabouts(self._fresh(f"place_of_{name}"), numbers)
            initial = next((each.name.name for each in process.locations if each.initial), next(iter(numbers)))
            self.declarations.append(self.places[name].declaration(process.name.span, initial))
        for vector in joining:
            for chosen in choices([part[:2] for part in vector.parts], edges):
                check_job()
                channel, declaration = self._channel(vector, broadcast=True)
                self.declarations.append(declaration)
                taken = [edges[name][number][1] for name, number in chosen.items()]
                updates = tuple(update for edge in taken for update in edge.updates)
                self.meetings.append(Meeting(channel, chosen, guard_of(chosen, edges, self.places), updates))

    def _participation(self, channels: dict[Vector, tuple[str, ast.VariableDeclaration]]) -> _Participation:
        part = _Participation()
        for vector in self.vectors:
            part.synchronised.update(one[:2] for one in vector.parts)
        for vector, (channel, _) in channels.items():
            for one in dict.fromkeys(one[:2] for one in vector.parts):
                direction = Direction.SEND if vector.parts[0][:2] == one else Direction.RECEIVE
                part.uses.setdefault(one, []).append((channel, direction))
        for meeting in self.meetings:
            for of_process in meeting.edges.items():
                part.meetings.setdefault(of_process, []).append(meeting)
        return part

    def _template(self, name: str, process: TCheckerProcess, part: _Participation) -> ast.Template:
        edges: list[ast.EdgeDeclaration] = []
        for number, (event, edge) in enumerate(process.edges):
            if (name, event) not in part.synchronised:
                edges.append(edge)
            for meeting in part.meetings.get((name, number), ()):
                sends = meeting.sender == name
                direction = Direction.SEND if sends else Direction.RECEIVE
                label = ast.SynchronisationLabel(edge.span, ast.NameExpression(edge.span, meeting.channel), direction)
                guard, updates = (meeting.guard, meeting.updates) if sends else (None, ())
                edges.append(ast.EdgeDeclaration(edge.span, edge.source, edge.target, (), guard, label, updates))
            for channel, direction in part.uses.get((name, event), ()):
                label = ast.SynchronisationLabel(edge.span, ast.NameExpression(edge.span, channel), direction)
                edges.append(
                    ast.EdgeDeclaration(edge.span, edge.source, edge.target, (), edge.guard, label, edge.updates)
                )
        if name in self.places:
            edges = [self.places[name].followed(edge) for edge in edges]
        return ast.Template(process.name.span, process.name, (), (), tuple(process.locations), (), tuple(edges))

    def _signals(self) -> Iterator[ast.SignalDeclaration]:
        for label, places in self.labels.items():
            tests: list[ast.Expression] = [
                ast.MemberExpression(span, ast.NameExpression(span, process), ast.Identifier(span, location))
                for span, process, location in places
            ]
            value = tests[0]
            for test in tests[1:]:
                value = ast.BinaryExpression(test.span, BinaryOperator.OR, value, test)
            span = places[0][0]
            yield ast.SignalDeclaration(span, ast.Identifier(span, self._fresh(label)), value)


# ---- lines ----------------------------------------------------------------------------------------------------------


def _entries(source: Source) -> Iterator[Entry]:
    start = 0
    while start < len(source.text):
        check_job()
        idle = _IDLE.match(source.text, start)
        if idle is not None:
            start = idle.end()
            continue
        line = _LINE.match(source.text, start)
        if line is None or (line["kind"] not in _ARGUMENTS and line["kind"] != "sync"):
            end = source.text.find("\n", start)
            raise failure("this is not a declaration", Span(source, start, end if end >= 0 else len(source.text)))
        span = Span(source, line.start("kind"), line.end("attributes" if line["attributes"] else "rest"))
        arguments = tuple(_pieces(source, line.start("rest"), line.end("rest")))
        wanted = _ARGUMENTS.get(line["kind"])
        if wanted is not None and len(arguments) != wanted:
            raise failure(f"`{line['kind']}` takes {wanted} arguments, not {len(arguments)}", span)
        attributes: tuple[tuple[Span, Span], ...] = ()
        if line["attributes"]:
            pieces = list(_pieces(source, line.start("attributes") + 1, line.end("attributes") - 1))
            if len(pieces) % 2 and (len(pieces) > 1 or pieces[0].text.strip()):
                raise failure("an attribute is a name, a colon and a value", span)
            attributes = tuple(zip(pieces[::2], pieces[1::2], strict=False))
        yield Entry(line["kind"], arguments, attributes, span)
        start = line.end()


def _pieces(source: Source, start: int, end: int) -> Iterator[Span]:
    """The parts between colons."""
    while True:
        colon = source.text.find(":", start, end)
        yield Span(source, start, end if colon < 0 else colon)
        if colon < 0:
            return
        start = colon + 1


def _word(place: Span) -> str:
    return place.text.strip()


def _number(place: Span) -> int:
    if re.fullmatch(r"-?\d{1,10}", _word(place)) is None:
        raise failure(f"`{_word(place)}` is not a number", place)
    return int(_word(place))


def _literal(place: Span) -> ast.IntegerLiteral:
    return ast.IntegerLiteral(place, _number(place))


def _dimensions(size: Span) -> tuple[ast.Expression, ...]:
    count = _number(size)
    if not 1 <= count <= 2**16:
        raise failure("the size is not between 1 and 65536", size)
    return (ast.IntegerLiteral(size, count),) if count > 1 else ()
