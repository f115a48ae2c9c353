"""Deciding one combination of values after the other."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from time import monotonic

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, Severity, UnsupportedError
from tachk.base.job import StoppedError, current_job, limited
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, Statistics
from tachk.formats.network_json.digest import digest
from tachk.frontend.loaded import LoadedModel, with_constants
from tachk.meaning.discrete import prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.meaning.judge.certificate import MalformedCertificateError
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import Participant, Transition
from tachk.model.types import BoolType, IntType, ScalarType, bounds
from tachk.transform.observed import observed
from tachk.verify.answering import answers
from tachk.verify.certificates import Proof, check_natively, find_proof, is_provable
from tachk.verify.questions import Questions
from tachk.verify.synthesis.parameters import VariedConstant
from tachk.verify.synthesis.region import CellEvidence, RegionCell, shown_by_a_run
from tachk.verify.synthesis.walk import Cell, CellStatus, PendingCell
from tachk.verify.verdict import Answer, Verdict, answers_of


def retimed(network: Network, query: Query, path: Sequence[Transition]) -> Verdict | None:
    """The verdict that the states the query looks for are reached, if these transitions lead there; else None.

    The run has been replayed. Raises InputError where the initial state violates an invariant.

    Args:
        path: transitions of the network with the observer of the query.
    """
    watched = observed(network, query.observer)
    whole = watched.network
    if not all(_exists(whole, participant) for transition in path for participant in transition.participants):
        return None
    check_initial_state(prepare(network))
    model = prepare(whole)
    try:
        run = concretise(model, path, query.target)
        if run is None:
            return None
        replay(model, run, query.target)
    except (ValueError, ReplayError):
        return None
    moves = watched.moves(run)
    return Verdict(
        query, answers_of(query)[0], True, "", Statistics(), watched.lift(run), moves=moves, path=tuple(path)
    )


def _exists(network: Network, participant: Participant) -> bool:
    """True if the network has such an edge with such values of its select variables."""
    if participant.process >= len(network.processes):
        return False
    edges = network.processes[participant.process].edges
    if participant.edge >= len(edges) or len(edges[participant.edge].selects) != len(participant.selects):
        return False
    for variable, value in zip(edges[participant.edge].selects, participant.selects, strict=True):
        assert isinstance(variable.type, IntType | BoolType | ScalarType)
        low, high = bounds(variable.type)
        if not low <= value <= high:
            return False
    return True


def proof_of(network: Network, verdict: Verdict, options: Options, limits: Limits) -> Proof | None:
    """A certificate of a verdict, checked; None for a verdict of another kind, or if a limit ends it."""
    if not is_provable(verdict):
        return None
    found = find_proof(network, digest(network), verdict.query, options, limits)
    return None if isinstance(found, str) else found


def proof_again(network: Network, query: Query, proof: Proof) -> tuple[Verdict, Proof] | None:
    """The verdict that the states the query looks for are not reached, if a certificate about other values shows it.

    Raises InputError where the initial state violates an invariant.
    """
    if query.target is None:
        return None
    check_initial_state(prepare(network))
    try:
        if check_natively(observed(network, query.observer).network, query, proof.header, proof.columns) is not None:
            return None
    except MalformedCertificateError:
        return None
    header = replace(proof.header, query=query.text, model=digest(network), constants=dict(network.constants))
    return Verdict(query, answers_of(query)[1], True, "", Statistics()), replace(proof, header=header)


@dataclass(slots=True)
class DecidedCells:
    """The evidence about each decided cell.

    Attributes:
        questions: one of them.
        limits: those on states, memory and depth hold for each search, the one on seconds for all together: each cell
            has the same share of what is left of them.
        reuse: try the runs, and the certificates if there are some, of cells nearby before a search.
        certify: make a certificate where something is never reached.
        found: by the numbers of the values.
        wrong: why the model is wrong with the values of a cell, for the first such cell.
    """

    model: LoadedModel
    questions: Questions
    parameters: Sequence[VariedConstant]
    options: Options
    limits: Limits
    reuse: bool = True
    certify: bool = False
    found: dict[Cell, RegionCell] = field(default_factory=dict)
    interrupted: bool = False
    wrong: InputError | None = None
    _started: float = field(default_factory=monotonic)
    _paths: dict[Cell, tuple[Transition, ...]] = field(default_factory=dict)
    _proofs: dict[Cell, Proof] = field(default_factory=dict)

    def decide(self, requested: PendingCell) -> CellStatus:
        """The status of one cell."""
        values = self._values(requested.cell)
        try:
            verdict, evidence, proof = self._verdict(requested)
        except StoppedError as error:
            known = RegionCell(values, Answer.UNKNOWN, CellEvidence.NONE, error.reason)
        except InputError as error:
            self.wrong = self.wrong or error
            known = RegionCell(values, Answer.UNKNOWN, CellEvidence.NONE, f"wrong model: {_first(error).message}")
        except KeyboardInterrupt:
            self.interrupted = True
            known = RegionCell(values, Answer.UNKNOWN, CellEvidence.NONE, INTERRUPTED)
        else:
            self.interrupted |= verdict.reason == INTERRUPTED
            known = _explained(values, verdict, evidence, proof)
            if verdict.path:
                self._paths[requested.cell] = verdict.path
            if proof is not None:
                self._proofs[requested.cell] = proof
        self.found[requested.cell] = known
        return self._status(known)

    def may_infer(self, corners: Sequence[Cell]) -> bool:
        """True if the model is right with the values of each of these cells; then it is with all between them."""
        for corner in corners:
            try:
                with limited(self._left()):
                    model, _ = self._model(corner)
                    check_initial_state(prepare(model.network))
            except (InputError, UnsupportedError, StoppedError):
                return False
            except KeyboardInterrupt:
                self.interrupted = True
                return False
        return True

    def _values(self, cell: Cell) -> tuple[int, ...]:
        return tuple(p.values[number] for p, number in zip(self.parameters, cell, strict=True))

    def _left(self) -> float | None:
        return current_job().seconds_left

    def _status(self, known: RegionCell) -> CellStatus:
        if known.answer is Answer.UNKNOWN or known.verdict is None:
            return CellStatus.UNKNOWN
        return CellStatus.REACHED if known.answer is shown_by_a_run(known.verdict.query) else CellStatus.UNREACHED

    def _model(self, cell: Cell) -> tuple[LoadedModel, Query]:
        names = (parameter.name for parameter in self.parameters)
        constants = dict(zip(names, self._values(cell), strict=True))
        model = with_constants(self.model, constants, self.questions.names)
        if model.refusals:
            raise UnsupportedError(model.refusals[0])
        (query,) = self.questions.about(model)
        assert isinstance(query, Query)
        return model, query

    def _verdict(self, requested: PendingCell) -> tuple[Verdict, CellEvidence, Proof | None]:
        """Raises what decides nothing: StoppedError, InputError, KeyboardInterrupt; and UnsupportedError."""
        if self.interrupted:
            raise KeyboardInterrupt
        left = self._left()
        limits = replace(self.limits, seconds=None if left is None else left / requested.left)
        with limited(limits.seconds):
            with limited(memory=limits.memory_bytes):
                model, query = self._model(requested.cell)
                if self.reuse and query.target is not None and not model.network.has_priorities:
                    again = self._again(requested.cell, model.network, query)
                    if again is not None:
                        return again
            verdict = answers(model, self.questions, [query], self.options, limits, trace=True)[0]
            if verdict.unsupported is not None:
                raise UnsupportedError(verdict.unsupported)
            proof = None
            if self.certify:
                proof = proof_of(model.network, verdict, self.options, limits)
            return verdict, CellEvidence.SEARCH, proof

    def _again(self, cell: Cell, network: Network, query: Query) -> tuple[Verdict, CellEvidence, Proof | None] | None:
        """The verdict that the evidence of the nearest cells also gives here; None if it gives none."""
        nearest = _nearest(cell, self._paths)
        if nearest is not None:
            verdict = retimed(network, query, self._paths[nearest])
            if verdict is not None:
                return verdict, CellEvidence.RUN, None
        nearest = _nearest(cell, self._proofs)
        if nearest is not None:
            shown = proof_again(network, query, self._proofs[nearest])
            if shown is not None:
                return shown[0], CellEvidence.CERTIFICATE, shown[1]
        return None


def _nearest(cell: Cell, others: Iterable[Cell]) -> Cell | None:
    return min(others, key=lambda other: sum(abs(a - b) for a, b in zip(cell, other, strict=True)), default=None)


def _explained(values: tuple[int, ...], verdict: Verdict, evidence: CellEvidence, proof: Proof | None) -> RegionCell:
    if verdict.answer is Answer.UNKNOWN:
        return RegionCell(values, Answer.UNKNOWN, CellEvidence.NONE, verdict.reason, verdict)
    return RegionCell(values, verdict.answer, evidence, "", verdict, proof)


def _first(error: InputError) -> Diagnostic:
    return next(found for found in error.diagnostics if found.severity is Severity.ERROR)
