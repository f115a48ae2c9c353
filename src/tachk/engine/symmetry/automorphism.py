"""The proof that a renaming of a network is an automorphism.

A renaming (`tachk.engine.symmetry.renaming`) is an automorphism if the renamed text of each process is the text of its
image, up to the order of edges, and if it keeps constants, ranges, priorities and predicates. Then it maps transitions
to transitions.

An automorphism need not keep the initial values. An explored state represents its orbit: a state that is reachable from
it is, up to an automorphism, reachable from the initial state, and a predicate holds for all states of an orbit or for
none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Hashable, Iterable, Iterator, Mapping, Sequence

from tachk.analysis.fold import Known
from tachk.base.records import dataclass, field, replace
from tachk.engine.symmetry.index_types import ArrayTree, AsymmetryReason, IndexTypes, Range, RecordTree, Tree, nodes_of
from tachk.engine.symmetry.predicates import Term, UnorderedJunction, flat, predicate_term
from tachk.engine.symmetry.renaming import KnownRenamings, Renaming
from tachk.engine.symmetry.terms import IndexValue, ProcessNumber, TermReader, Token, slot_nodes
from tachk.engine.symmetry.unit_texts import Atom, UnitText, UnitTexts
from tachk.engine.symmetry.units import TermUnit, read_edge, read_location
from tachk.model.expressions import Expression, Variable, VariableKind
from tachk.model.network import Network
from tachk.model.traversal import written_variables
from tachk.model.types import ArrayType, Type, slot_count
from tachk.model.variable_layout import default_values

_Limit = tuple[int, Range]
"""The shift of a node of an index type, and numbers that are limited there."""
_PredicateSet = tuple[Sequence[Term], Sequence[Hashable], dict[Atom, list[int]]]
"""The parts of a predicate, what each is without a renaming, and the numbers of those that mention an atom."""


@dataclass(slots=True)
class NetworkTerms:
    """A network and its predicates as terms.

    Attributes:
        locations, edges: those of each process. Edges with the same outline stand side by side.
        location_texts, edge_texts: their texts, once the index types are settled.
        tested: the processes whose locations are tested somewhere.
        colours: the equitable partition (`tachk.engine.symmetry.equitable_partition`) once it is computed.
        without_predicates: those of the network alone, if these were made of them.
        shared: what is known about the renamings of the network, whatever the predicates.
    """

    network: Network
    reader: TermReader
    locations: list[list[TermUnit]]
    edges: list[list[TermUnit]]
    predicates: list[Term]
    texts: UnitTexts
    location_texts: list[list[UnitText]] = field(default_factory=list)
    edge_texts: list[list[UnitText]] = field(default_factory=list)
    tested: frozenset[ProcessNumber] = frozenset()
    colours: Sequence[int] | None = None
    without_predicates: NetworkTerms | None = None
    shared: KnownRenamings = field(default_factory=KnownRenamings)
    _touched: dict[Atom, list[tuple[int, bool, int]]] = field(default_factory=dict)
    _limits: dict[int, tuple[list[_Limit], list[_Limit], list[_Limit]]] = field(default_factory=dict)
    _of_index_type: dict[int, list[Variable]] = field(default_factory=dict)
    _predicate_sets: list[_PredicateSet] = field(default_factory=list)

    @property
    def index_types(self) -> IndexTypes:
        return self.reader.index_types

    @property
    def of_network(self) -> NetworkTerms:
        """Those that decide whether a renaming maps the network onto itself."""
        return self.without_predicates or self

    def settle(self) -> None:
        """Ends the unification of index types, and indexes the units by the atoms that they mention."""
        self.location_texts = [list(map(self.texts.read, units)) for units in self.locations]
        self.edge_texts = [list(map(self.texts.read, units)) for units in self.edges]
        for process, both in enumerate(zip(self.location_texts, self.edge_texts, strict=True)):
            for is_edge, texts in enumerate(both):
                for number, text in enumerate(texts):
                    for atom in text.names:
                        self._touched.setdefault(atom, []).append((process, bool(is_edge), number))
        self.tested = frozenset(atom for atom in self._touched if isinstance(atom, ProcessNumber))
        self._note_predicates()
        for variable, tree in self.reader.trees.items():
            for root in {self.index_types.find(node)[0] for node in nodes_of(tree)}:
                self._of_index_type.setdefault(root, []).append(variable)

    def _note_predicates(self) -> None:
        for term in self.predicates:
            parts = term.parts if isinstance(term, UnorderedJunction) else (term,)
            mentioning: dict[Atom, list[int]] = {}
            for number, part in enumerate(parts):
                for atom in set(self.atoms(flat([part]))):
                    mentioning.setdefault(atom, []).append(number)
            images = [self._term_image(part, Renaming()) for part in parts]
            self._predicate_sets.append((parts, images, mentioning))

    def with_predicates(self, predicates: Sequence[Expression]) -> NetworkTerms | None:
        """The same network with these predicates; None if they constrain the numbers in the network more than it does
        itself, or change a variable."""
        if written_variables(predicates):
            return None
        reader = self.reader.copy()
        roots = reader.index_types.roots()
        terms = [predicate_term(reader, each) for each in predicates]
        if any(reader.index_types.find(root)[0] != root for root in roots):
            return None
        with_predicates = replace(
            self, reader=reader, predicates=terms, without_predicates=self.of_network, _limits={}, _predicate_sets=[]
        )
        with_predicates._note_predicates()
        return with_predicates

    def atoms(self, tokens: Iterable[Token]) -> Iterable[Atom]:
        find = self.index_types.find
        for token in tokens:
            if isinstance(token, IndexValue):
                root, shift = find(token.node)
                yield root, token.value - shift
            elif isinstance(token, Variable | ProcessNumber):
                yield token

    # ---- images -----------------------------------------------------------------------------------------------------

    def image(self, tokens: Iterable[Token], renaming: Renaming) -> tuple[Hashable, ...]:
        """Renamed tokens, without the index types of numbers."""
        image: list[Hashable] = []
        index_types = self.index_types
        for token in tokens:
            if isinstance(token, IndexValue):
                image.append(renaming.value(index_types, token.node, token.value))
            elif isinstance(token, Variable):
                image.append(renaming.variables.get(token, token))
            elif isinstance(token, ProcessNumber):
                image.append(ProcessNumber(renaming.processes.get(token.process, token.process)))
            else:
                image.append(token)
        return tuple(image)

    def _term_image(self, term: Term, renaming: Renaming) -> Hashable:
        if isinstance(term, UnorderedJunction):
            parts = Counter(self._term_image(part, renaming) for part in term.parts)
            return term.conjunctive, frozenset(parts.items())
        return self.image(term, renaming)

    # ---- the proof --------------------------------------------------------------------------------------------------

    def objection(self, renaming: Renaming) -> AsymmetryReason | None:
        """The reason why a renaming, which is a permutation, does not map the network onto itself; None if it does."""
        return (
            self._index_types_objection(renaming)
            or self._process_objection(renaming)
            or self._variable_objection(renaming)
            or self._text_objection(renaming, renaming.atoms())
        )

    def objection_of_predicates(self, renaming: Renaming) -> AsymmetryReason | None:
        """The reason why a renaming, which maps the network onto itself, does not keep the predicates; or None."""
        return self._index_types_objection(renaming) or self._predicate_objection(renaming, renaming.atoms())

    def objection_of_tests(self, processes: Mapping[int, int]) -> AsymmetryReason | None:
        """The reason why no renaming that moves the processes so keeps the predicates, as far as the processes named in
        tests of locations show; or None."""
        moved = Renaming(processes).atoms()
        for parts, _, mentioning in self._predicate_sets:
            touched = [parts[number] for number in {number for atom in moved for number in mentioning.get(atom, ())}]
            if Counter(_tests(part, {}) for part in touched) != Counter(_tests(part, processes) for part in touched):
                return AsymmetryReason("the query distinguishes them")
        return None

    def _index_types_objection(self, renaming: Renaming) -> AsymmetryReason | None:
        for root in renaming.values:
            plain = self.no_name(root)
            if plain is not None:
                return plain
        for root, moved in renaming.values.items():
            objection = self._limits_objection(root, moved)
            if objection is not None:
                return objection
        return None

    def _limits_objection(self, root: int, moved: Mapping[int, int]) -> AsymmetryReason | None:
        if not self._limits:
            kinds = self.index_types
            for kind, all_limits in enumerate((kinds.ranges, kinds.cycles, kinds.defaults)):
                for limit in all_limits:
                    one, shift = kinds.find(limit.node)
                    self._limits.setdefault(one, ([], [], []))[kind].append((shift, limit))
        ranges, cycles, defaults = self._limits.get(root, ((), (), ()))
        for shift, limit in ranges:
            for value, image in moved.items():
                if (limit.low <= value + shift <= limit.high) != (limit.low <= image + shift <= limit.high):
                    reason = f"the range [{limit.low}, {limit.high}] holds the number of one and not that of another"
                    return AsymmetryReason(reason, limit.span)
        for shift, cycle in cycles:
            size = cycle.high + 1
            images = [moved.get(value - shift, value - shift) + shift for value in range(size)]
            if images != [(value + images[0]) % size for value in range(size)]:
                return AsymmetryReason(f"the model counts round with them, modulo {size}", cycle.span)
        for shift, default in defaults:
            if moved.get(default.low - shift, default.low - shift) + shift != default.low:
                return AsymmetryReason(f"a variable begins with {default.low}, the number of one of them", default.span)
        return None

    def no_name(self, root: int) -> AsymmetryReason | None:
        """The reason why numbers of an index type are not permuted; None if they may be."""
        plain = self.index_types.plain(root)
        if plain is None:
            return None
        return AsymmetryReason(f"the model {plain.reason}" if _is_verb(plain.reason) else plain.reason, plain.span)

    def _process_objection(self, renaming: Renaming) -> AsymmetryReason | None:
        processes = self.network.processes
        for one, other in renaming.processes.items():
            first, second = processes[one], processes[other]
            if first.priority != second.priority:
                return AsymmetryReason("they have different priorities", second.span)
            if first.initial != second.initial or len(first.locations) != len(second.locations):
                return AsymmetryReason("they begin in different locations", second.span)
        return None

    def keeps_initial_values(self, renaming: Renaming) -> bool:
        """True if a renaming that maps the network onto itself maps the initial state onto itself."""
        return all(self._keeps_values(variable, renaming) for variable in self.moved_variables(renaming))

    def moved_variables(self, renaming: Renaming) -> Iterator[Variable]:
        """The variables that are moved, and those that may hold, or are indexed by, numbers that are moved."""
        touched = dict.fromkeys(renaming.variables)
        for root in renaming.values:
            touched.update(dict.fromkeys(self._of_index_type.get(root, ())))
        return (variable for variable in touched if variable.kind not in (VariableKind.BOUND, VariableKind.FRAME))

    def _keeps_values(self, variable: Variable, renaming: Renaming) -> bool:
        """True if what a variable begins with becomes that of its image."""
        other = renaming.variables.get(variable, variable)
        tree = self.reader.tree_of(variable)
        nodes, images = slot_nodes(tree, variable.type), slot_images(self.index_types, tree, variable.type, renaming)
        before, after = (each.initial or default_values(each.type) for each in (variable, other))
        return all(
            after[image] == renaming.value(self.index_types, node, value)
            for image, node, value in zip(images, nodes, before, strict=True)
        )

    def _variable_objection(self, renaming: Renaming) -> AsymmetryReason | None:
        for variable in self.moved_variables(renaming):
            objection = self._one_variable(variable, renaming)
            if objection is not None:
                return objection
        return None

    def _one_variable(self, variable: Variable, renaming: Renaming) -> AsymmetryReason | None:
        other = renaming.variables.get(variable, variable)
        tree, others_tree = self.reader.tree_of(variable), self.reader.tree_of(other)
        nodes, of_other = slot_nodes(tree, variable.type), slot_nodes(others_tree, other.type)
        if variable.type != other.type or self.network.resets(variable) != self.network.resets(other):
            return AsymmetryReason(f"`{variable.name}` and `{other.name}` are declared differently", other.span)
        if variable.carries is not None or other.carries is not None:
            return AsymmetryReason(f"`{variable.name}` passes values through a channel", other.span)
        if list(map(self.index_types.find, nodes)) != list(map(self.index_types.find, of_other)):
            return AsymmetryReason(f"`{variable.name}` and `{other.name}` hold different kinds of numbers", other.span)
        images = slot_images(self.index_types, tree, variable.type, renaming)
        if (self.is_constant(variable) or self.is_constant(other)) and not self._keeps_values(variable, renaming):
            return AsymmetryReason(f"the values of `{other.name}` distinguish them", other.span)
        if variable.priorities or other.priorities:
            default = (self.network.default_priority,) * len(images)
            priority, others_priority = variable.priorities or default, other.priorities or default
            if any(others_priority[image] != priority[slot] for slot, image in enumerate(images)):
                return AsymmetryReason(f"the priorities of the channels `{other.name}` distinguish them", other.span)
        return None

    def is_constant(self, variable: Variable) -> bool:
        """True if every transition finds the initial value in it."""
        return variable in self.reader.known.values or self.network.resets(variable)

    def _text_objection(self, renaming: Renaming, moved: Mapping[Atom, Atom]) -> AsymmetryReason | None:
        for one, other in renaming.processes.items():
            locations = zip(self.location_texts[one], self.location_texts[other], strict=True)
            odd = next((image for text, image in locations if self.texts.renamed(text, moved) != image.same), None)
            if odd is None:
                number = self._without_image(self.edge_texts[one], self.edge_texts[other], moved)
                odd = None if number is None else self.edge_texts[other][number]
            if odd is not None:
                return AsymmetryReason("their texts differ in more than their own numbers and variables", odd.span)
        edges: dict[int, list[UnitText]] = {}
        for process, is_edge, number in sorted(set(self._places(moved))):
            if process in renaming.processes:
                continue
            if is_edge:
                edges.setdefault(process, []).append(self.edge_texts[process][number])
                continue
            text = self.location_texts[process][number]
            if self.texts.renamed(text, moved) != text.same:
                return AsymmetryReason(
                    f"the process {self.network.processes[process].name} distinguishes them here", text.span
                )
        for process, texts in edges.items():
            number = self._without_image(texts, texts, moved)
            if number is not None:
                name = self.network.processes[process].name
                return AsymmetryReason(f"the process {name} distinguishes them here", texts[number].span)
        return None

    def _without_image(
        self, texts: Sequence[UnitText], images: Sequence[UnitText], moved: Mapping[Atom, Atom]
    ) -> int | None:
        """The number of the first unit that becomes none of equally many images."""
        left = Counter(image.same for image in images)
        for number, text in enumerate(texts):
            renamed = self.texts.renamed(text, moved)
            if renamed is None or not left[renamed]:
                return number
            left[renamed] -= 1
        return None

    def _places(self, moved: Iterable[Atom]) -> Iterator[tuple[int, bool, int]]:
        """The places that mention moved atoms: the process, whether it is an edge or a location, and its number."""
        return (place for atom in moved for place in self._touched.get(atom, ()))

    def edges_with(self, atoms: Iterable[Atom]) -> set[tuple[int, int]]:
        """The edges that mention one of them: processes and numbers."""
        return {(process, number) for process, is_edge, number in self._places(atoms) if is_edge}

    def _predicate_objection(self, renaming: Renaming, moved: Mapping[Atom, Atom]) -> AsymmetryReason | None:
        for parts, images, mentioning in self._predicate_sets:
            numbers = sorted({number for atom in moved for number in mentioning.get(atom, ())})
            before = Counter(images[number] for number in numbers)
            if before != Counter(self._term_image(parts[number], renaming) for number in numbers):
                return AsymmetryReason("the query distinguishes them")
        return None


def _tests(term: Term, processes: Mapping[int, int]) -> Hashable:
    """A term without names other than those of processes; these are renamed."""
    if isinstance(term, UnorderedJunction):
        return term.conjunctive, frozenset(Counter(_tests(part, processes) for part in term.parts).items())
    return tuple(
        ProcessNumber(processes.get(token.process, token.process))
        if isinstance(token, ProcessNumber)
        else type(token).__name__
        if isinstance(token, Variable | IndexValue)
        else token
        for token in term
    )


def _is_verb(reason: str) -> bool:
    return reason.startswith(("counts", "uses", "is used"))


def slot_images(index_types: IndexTypes, tree: Tree, type_: Type, renaming: Renaming) -> list[int]:
    """For each slot of a variable the slot of its image that a renaming maps it to."""
    match tree, type_:
        case ArrayTree(index, element), ArrayType():
            inner = slot_images(index_types, element, type_.element, renaming)
            size = slot_count(type_.element)
            images = []
            for place in range(type_.size):
                image = renaming.value(index_types, index, type_.low + place) - type_.low
                images += [image * size + slot for slot in inner]
            return images
        case RecordTree(fields), _:
            images, before = [], 0
            for (_, part), (_, of_part) in zip(fields, type_.fields, strict=True):  # type: ignore[union-attr]
                images += [before + slot for slot in slot_images(index_types, part, of_part, renaming)]
                before += slot_count(of_part)
            return images
        case _:
            return [0]


def read(
    network: Network, predicates: Iterable[Expression], known: Known, never: Container[tuple[int, int]]
) -> NetworkTerms:
    """The terms of a network and of the predicates.

    Args:
        never: edges that are never taken, by process and number.
    """
    reader = TermReader(known)
    for variable in network.all_variables():
        reader.tree_of(variable)
    outlines: dict[Hashable, int] = {}

    def rank(unit: TermUnit) -> int:
        return outlines.setdefault(unit.outline, len(outlines))

    locations, edges = [], []
    for number, process in enumerate(network.processes):
        locations.append([read_location(reader, number, each) for each in process.locations])
        taken = (edge for place, edge in enumerate(process.edges) if (number, place) not in never)
        edges.append(sorted((read_edge(reader, number, each, rank) for each in taken), key=rank))
    terms = [predicate_term(reader, each) for each in predicates]
    return NetworkTerms(network, reader, locations, edges, terms, UnitTexts(reader.index_types))
