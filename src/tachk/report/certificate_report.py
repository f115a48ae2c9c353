"""The results of checking certificates, as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from tachk.base.plain_data import Fields, PlainData
from tachk.base.records import dataclass
from tachk.base.words import QueryKind
from tachk.engine.reduced_statistics import members_in_words
from tachk.meaning.dbm import Zone
from tachk.meaning.judge.certificate import CertificateReader, Objection, zone_at
from tachk.meaning.run_view import RunNames
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.report.reductions_text import for_all
from tachk.report.run.zone_view import ZoneState, constraint_texts, event_text
from tachk.transform.observed import observed
from tachk.verify.certificates import Checker


@dataclass(frozen=True, slots=True)
class Judgement:
    """The result for one certificate.

    Attributes:
        network: without observer.
        query: the query that it decides.
        checker: who has judged it; None where its header shows that it is about another model.
        reason: why it is rejected; empty if it is accepted.
        objection: what of it is wrong, where it is for this model and this property.
        seconds: how long the check took.
    """

    network: Network
    query: Query
    certificate: CertificateReader
    checker: Checker | None
    reason: str
    objection: Objection | None
    seconds: float

    @property
    def accepted(self) -> bool:
        return not self.reason

    @property
    def proved(self) -> str:
        """The answer that the certificate proves."""
        refuted = self.query.holds_when_reached or self.query.kind is QueryKind.POTENTIALLY_ALWAYS
        return "fails" if refuted else "holds"

    def state(self) -> ZoneState | None:
        """The element that is wrong."""
        if self.objection is None or self.objection.discrete is None:
            return None
        names = self._names()
        snapshot = names.snapshot(self.objection.discrete)
        zone = self._zone()
        clocks = [names.layout.names[slot] for slot in names.layout.clock_slots]
        number = self.objection.zone
        return ZoneState(number, snapshot.locations, snapshot.variables, constraint_texts(zone, clocks), zone)

    def transition(self) -> str:
        """The transition that leaves the set, or cannot be evaluated; else empty."""
        found = self.objection
        if found is None or found.discrete is None or found.transition is None:
            return ""
        return event_text(self._names().event(found.discrete, found.transition))

    def exchanged(self) -> list[str]:
        """The groups of which one state stands for all."""
        names = [process.name for process in observed(self.network, self.query.observer).network.processes]
        return [members_in_words(group.slots, group.cyclic, names) for group in self.certificate.header.groups]

    def _names(self) -> RunNames:
        return RunNames(observed(self.network, self.query.observer).network)

    def _zone(self) -> Zone:
        assert self.objection is not None and self.objection.discrete is not None
        return zone_at(self.certificate, self.objection.discrete, self.objection.zone)


def judgement_lines(judgements: Iterable[Judgement]) -> Iterable[str]:
    """The report for people."""
    for judgement in judgements:
        header, found = judgement.certificate.header, judgement.certificate
        yield f"{'✓' if judgement.accepted else '✗'} {header.name}: {judgement.query.text}"
        size = f"{_count(found.zones, 'zone')} of {_count(found.groups, 'discrete state')}"
        by = f" by the {judgement.checker.value} checker" if judgement.checker is not None else ""
        if judgement.accepted:
            yield f"    accepted{by}: it {judgement.proved}, by {size}"
            for members in judgement.exchanged():
                yield f"    {for_all(members)}"
            continue
        yield f"    rejected{by}: {judgement.reason}"
        if (state := judgement.state()) is not None:
            yield f"    at        {state}"
        if text := judgement.transition():
            yield f"    by        {text}"


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def judgements_to_json(model: str, file: str, checker: str, judgements: Iterable[Judgement]) -> dict[str, Any]:
    """As docs/schema/certify.schema.json describes it."""
    return {"model": model, "file": file, "checker": checker, "certificates": _PLAIN(list(judgements))}


_PLAIN = PlainData(
    {
        Judgement: Fields(
            "property=certificate.header.name query=query.text kind=certificate.header.kind checker accepted proves "
            "discrete_states=certificate.groups zones=certificate.zones exchanged seconds reason state transition",
            proves=lambda judgement: judgement.proved if judgement.accepted else None,
            exchanged=Judgement.exchanged,
            reason=lambda judgement: judgement.reason or None,
            state=Judgement.state,
            transition=lambda judgement: judgement.transition() or None,
        ),
        ZoneState: Fields(
            "zone=number locations variables constraints",
            locations=lambda state: dict(state.locations),
            variables=lambda state: dict(state.variables),
        ),
    }
)
