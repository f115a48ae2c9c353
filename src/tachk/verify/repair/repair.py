"""The changes with which recordings that are rejected become runs of a model: other constants, or an edge.

The edges that go along with the events near the place where a recording leaves the model are put in order by what else
they allow: near that place the recording is changed, an event lost, doubled or moved, and an edge is the better the
fewer of the changed recordings are runs with it. Then each is held against all recordings as a whole.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import ceil

from tachk.base.job import StoppedError
from tachk.base.records import dataclass
from tachk.engine.options import Limits
from tachk.frontend.loaded import LoadedModel
from tachk.model.network import Network
from tachk.model.recording import RecordingMap
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.components import IndependentComponent
from tachk.recordings.conformance.conform import Conformance, Reached, conform, events_along
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.event_streams import Constants, EventStreams
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.nearest_log import NearestLogSearch
from tachk.recordings.conformance.trace_product import TraceProduct, trace_product
from tachk.syntax import ast
from tachk.verify.repair.chosen_search import accepting_choices
from tachk.verify.repair.extended_model import ExtendedModel, extended_model
from tachk.verify.repair.other_constants import RepairingConstant, nearest_values, opened_model, with_named_numbers
from tachk.verify.repair.proposals import KINDS, ProposedEdge, proposals
from tachk.verify.repair.screening import EdgeScreening
from tachk.verify.repair.vocabulary import vocabulary

_PROPOSALS = 3
"""So many edges are looked for."""
_TRIED = 60
"""So many edges of a rank are held against whole recordings at most."""
_FEW, _MORE = (15, range(5, 10)), (60, range(40, 160))
"""So many events before and behind the place are near: all edges are tried on few, the likely ones on more."""
_STEPS = 40
"""In so many steps before the place a process may have been where it lacks an edge."""
_CHANGED = 20
"""So many events near the place are changed, to see what else an edge allows."""


@dataclass(frozen=True, slots=True)
class RepairingEdge:
    """An edge with which all recordings are runs.

    Attributes:
        also_allowed: how many changed recordings are runs with it, too.
    """

    proposal: ProposedEdge
    also_allowed: int


@dataclass(frozen=True, slots=True)
class Repair:
    """The changes of a model that make recordings runs of it.

    Attributes:
        rejected: the numbers of the recordings that are not runs of the model as it is.
        constants: with each of which alone all are, the smallest changes first.
        edges: with each of which all are, the most likely ones first.
        changed: the number of changed recordings that tell edges apart.
        tried: how many edges were tried near the place where a recording leaves the model.
        left_out: what limits left no time for, in words; empty if nothing was left out.
    """

    rejected: tuple[int, ...]
    constants: tuple[RepairingConstant, ...] = ()
    edges: tuple[RepairingEdge, ...] = ()
    changed: int = 0
    tried: int = 0
    left_out: str = ""


@dataclass(frozen=True, slots=True)
class RecordingSet:
    """The recordings that are to be runs of a model.

    Attributes:
        uncertainty: of recorded times.
    """

    recordings: tuple[EventLog, ...]
    constants: Constants
    uncertainty: TimestampUncertainty
    limits: Limits

    def conformance(
        self, network: Network, mapping: RecordingMap, number: int, explain: bool, divide: bool = True
    ) -> Conformance:
        return conform(
            network,
            mapping,
            self.recordings[number],
            self.constants,
            self.uncertainty,
            limits=self.limits,
            run=False,
            explain=explain,
            divide=divide,
        )

    def refusal(self, network: Network, mapping: RecordingMap, number: int) -> Conformance:
        """Where a recording leaves the model, with a part of it that has a process: what a process lacks may be all
        that joins it to a stream of events."""
        found = self.conformance(network, mapping, number, True)
        alone = any(not part.component.processes and not _goes_along(part) for part in found.reached)
        return self.conformance(network, mapping, number, True, divide=False) if alone else found

    def accepted(self, network: Network, mapping: RecordingMap, numbers: Iterable[int]) -> bool:
        """True if all of these are runs."""
        return all(self.conformance(network, mapping, number, False).accepted for number in numbers)


def repair(
    loaded: LoadedModel,
    recordings: Sequence[EventLog],
    uncertainty: TimestampUncertainty,
    limits: Limits,
) -> Repair:
    """The changes with each of which all recordings are runs of a model.

    Args:
        loaded: says how recordings are read.
        limits: of each search; the seconds are those of the job.

    Raises UsageError for recordings that do not fit the model.
    """
    wanted = RecordingSet(tuple(recordings), constants_of(loaded), uncertainty, limits)
    plain = extended_model(loaded, ())
    rejected = [
        (number, found)
        for number in range(len(recordings))
        if not (found := wanted.refusal(plain.network, plain.mapping, number)).accepted
    ]
    located = [(number, found) for number, found in rejected if found.refusal is not None]
    numbers = tuple(number for number, _ in rejected)
    if not located:
        return Repair(numbers, left_out="where the recordings leave the model" if rejected else "")
    focus, found = min(located, key=lambda pair: pair[1].statistics.states_stored)
    visited = _visited(plain, found)
    others = [number for number in range(len(recordings)) if number not in numbers]
    order = [focus, *(number for number in numbers if number != focus), *others]
    constants: list[RepairingConstant] = []
    search = _EdgeSearch(loaded, wanted, order, visited)
    left_out = ""
    try:
        left_out = "further constants, and edges"
        named = with_named_numbers(loaded)
        likely = _likely_values(named, wanted, focus, frozenset(visited))
        constants.extend(
            nearest_values(named, likely, lambda network, mapping: wanted.accepted(network, mapping, order))
        )
        left_out = "further edges"
        for rank in sorted({kind.rank for kind in KINDS}):
            search.try_rank(rank)
            if len(search.found) >= _PROPOSALS or (search.found and rank > 0):
                break
        left_out = ""
    except StoppedError:
        pass
    best = sorted(search.found, key=lambda each: each.also_allowed)[:_PROPOSALS]
    smallest = sorted(constants, key=lambda each: each.change)
    return Repair(numbers, tuple(smallest), tuple(best), search.changed, search.tried, left_out)


def _likely_values(
    loaded: LoadedModel, wanted: RecordingSet, focus: int, templates: frozenset[str]
) -> list[tuple[str, int]]:
    """The values of constants with which the events near the place where a recording leaves the model are a run."""
    model = opened_model(loaded, templates)
    found = wanted.refusal(model.network, model.mapping, focus)
    if found.refusal is None or not model.choices:
        return []
    near = NearestLogSearch(
        model.network, model.mapping, wanted.recordings[focus], wanted.constants, found, wanted.limits
    )

    def product_of(streams: EventStreams, component: IndependentComponent, numbers: frozenset[int]) -> TraceProduct:
        return trace_product(near.network, near.mapping, streams, component.processes)

    likely = accepting_choices(near, near.recording, model.choices, product_of)
    return [model.values[number] for number in sorted(likely)]


def _visited(model: ExtendedModel, found: Conformance) -> dict[str, frozenset[str]]:
    """The templates of the parts of the model that do not go along with a recording, each with the locations in which
    its processes were shortly before."""
    visited: dict[str, set[str]] = {}
    refusing = [part for part in found.reached if not _goes_along(part)]
    for part in refusing or found.reached:
        for process in part.component.processes:
            instance = model.network.processes[process]
            places = visited.setdefault(instance.template, set())
            here = [
                participant.edge
                for transition in map(part.product.lift_transition, part.path)
                for participant in (() if transition is None else transition.participants)
                if participant.process == process
            ][-_STEPS:]
            edges = [instance.edges[edge] for edge in here]
            last = [edges[-1].target] if edges else [instance.initial]
            places.update(instance.locations[place].name for place in [*(edge.source for edge in edges), *last])
    return {template: frozenset(places) for template, places in visited.items()}


def _goes_along(part: Reached) -> bool:
    """True if the part has a run with all its events."""
    happened = events_along(part.product, part.streams, part.path)
    return all(count == len(each.events) for count, each in zip(happened, part.streams.streams, strict=True))


class _EdgeSearch:
    """Args:
        order: the numbers of the recordings: first the one near whose place edges are tried, then the other rejected
            ones.
        visited: the templates, each with the locations at which an edge may begin.

    Attributes:
    found: the edges with which all recordings are runs.
    tried: how many edges were tried near the place.
    changed: how many changed recordings tell edges apart.
    """

    def __init__(
        self,
        loaded: LoadedModel,
        wanted: RecordingSet,
        order: Sequence[int],
        visited: Mapping[str, frozenset[str]],
    ) -> None:
        self.loaded, self.wanted, self.order = loaded, wanted, order
        self.words = [
            vocabulary(item, loaded.items)
            for item in loaded.items
            if isinstance(item, ast.Template) and item.name.name in visited
        ]
        self.visited = visited
        self.found: list[RepairingEdge] = []
        self.tried = 0
        self.changed = 0

    def try_rank(self, rank: int) -> None:
        """Tries all edges of the kinds with this rank."""
        proposed = [
            each for words in self.words for each in proposals(words, rank, self.visited[words.template.name.name])
        ]
        model = extended_model(self.loaded, proposed)
        recording = self.wanted.recordings[self.order[0]]
        found = self.wanted.refusal(model.without_any, model.mapping, self.order[0])
        if found.refusal is None:
            return
        self.tried += len(model.proposed)
        narrow, screening = (
            EdgeScreening(model, recording, self.wanted.constants, found, self.wanted.limits, before, behind)
            for before, behind in (_FEW, _MORE)
        )
        every = range(len(model.proposed))
        likely = screening.accepting(narrow.accepting(every) or every)
        allowed = self._also_allowed(screening, likely, found)
        for number in sorted(likely, key=lambda n: (allowed[n], model.proposed[n].preference, n))[:_TRIED]:
            if self.wanted.accepted(model.with_one(number), model.mapping, self.order):
                self.found.append(RepairingEdge(model.proposed[number], allowed[number]))

    def _also_allowed(self, screening: EdgeScreening, likely: set[int], found: Conformance) -> dict[int, int]:
        """With how many changed recordings each of the edges goes along."""
        count = dict.fromkeys(likely, 0)
        if len(likely) < 2:
            return count
        self.changed = 0
        for recording in _changed(screening, found):
            accepting = screening.accepting(likely, recording)
            if len(accepting) < len(likely):
                self.changed += 1
                for number in accepting:
                    count[number] += 1
        return count


def _changed(screening: EdgeScreening, found: Conformance) -> Iterator[EventLog]:
    """The events near the place where the recording leaves the model, each time with one edit."""
    near, scale = screening.near, found.streams.scale
    shift = 2 * ceil(found.uncertainty.width) + 1
    step = ceil(len(near.numbers) / _CHANGED)
    for number in range(0, len(near.numbers), step):
        for edit in (Edit(number, "lost"), Edit(number, "doubled"), Edit(number, "moved", shift)):
            yield edited(near.recording, edit, scale)
