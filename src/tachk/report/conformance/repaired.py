"""The report on changes of a model that make recordings runs of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tachk.base.records import dataclass
from tachk.model.quantity import grouped
from tachk.syntax.printing.expression_printer import print_expression
from tachk.verify.repair.other_constants import RepairingConstant
from tachk.verify.repair.proposals import edge_text
from tachk.verify.repair.repair import Repair, RepairingEdge
from tachk.verify.verdict import Answer


@dataclass(frozen=True, slots=True)
class ChangedVerdict:
    """A property whose answer is another one after a change of the model.

    Attributes:
        name: of the property.
    """

    name: str
    before: Answer
    after: Answer


@dataclass(frozen=True, slots=True)
class RepairReport:
    """The changes of a model that make recordings runs of it, each with the answers that change.

    Attributes:
        model: its path.
        recordings: their paths.
        verdicts: for each constant, then for each edge, the properties whose answers change; None where they were not
            checked, since there are none or the model has no such template.
    """

    model: str
    recordings: tuple[str, ...]
    repair: Repair
    verdicts: tuple[tuple[ChangedVerdict, ...] | None, ...]

    def to_text(self) -> str:
        """The output of `tachk conform --repair` behind the answers."""
        return "\n".join(_lines(self)) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """As docs/schema/conform.schema.json describes it."""
        repair, verdicts = self.repair, list(self.verdicts)
        split = len(repair.constants)
        return {
            "rejected": [self.recordings[number] for number in repair.rejected],
            "constants": [
                {"name": each.name, "before": each.before, "nearest": each.after, "farthest": each.far}
                | {"verdicts": _verdicts(changed)}
                for each, changed in zip(repair.constants, verdicts[:split], strict=True)
            ],
            "edges": [
                {
                    "template": each.proposal.template,
                    "source": each.proposal.source,
                    "edge": each.proposal.text,
                    "relaxes": None if each.proposal.relaxes is None else str(each.proposal.relaxes.span),
                    "also_allowed": each.also_allowed,
                    "verdicts": _verdicts(changed),
                }
                for each, changed in zip(repair.edges, verdicts[split:], strict=True)
            ],
            "changed_recordings": repair.changed,
            "tried": repair.tried,
            "left_out": repair.left_out,
        }

    def __str__(self) -> str:
        return self.to_text()


def _verdicts(changed: Sequence[ChangedVerdict] | None) -> list[dict[str, str]] | None:
    if changed is None:
        return None
    return [{"name": each.name, "before": str(each.before), "after": str(each.after)} for each in changed]


def _lines(report: RepairReport) -> Iterator[str]:
    repair = report.repair
    count, rejected = len(report.recordings), len(repair.rejected)
    if not rejected:
        yield "repair: nothing to change, every recording is a run of the model"
        return
    if not repair.constants and not repair.edges:
        tried = f"{grouped(repair.tried)} edges were tried" if repair.tried else "no edge was tried"
        yield f"repair: no change was found that makes {_recordings(count)} of the model; {tried}"
    else:
        yield f"repair: each of these changes alone makes {_recordings(count)} of the model"
    verdicts = iter(report.verdicts)
    for each in repair.constants:
        yield from _constant_lines(each, next(verdicts))
    for number, edge in enumerate(repair.edges, 1):
        yield from _edge_lines(number, edge, repair.changed, next(verdicts))
    if repair.left_out:
        yield f"the time limit was over before everything was tried: {repair.left_out} were left out"


def _recordings(count: int) -> str:
    return "the recording a run" if count == 1 else f"all {grouped(count)} recordings runs"


def _constant_lines(each: RepairingConstant, changed: Sequence[ChangedVerdict] | None) -> Iterator[str]:
    values = f"{each.after}" if each.after == each.far else f"{each.after} to {each.far}"
    yield (
        f"  {values} in place of {each.name}"
        if each.is_number
        else f"  {each.name} = {values} in place of {each.before}"
    )
    yield from _verdict_lines(changed)


def _edge_lines(
    number: int, edge: RepairingEdge, recordings: int, changed: Sequence[ChangedVerdict] | None
) -> Iterator[str]:
    proposal = edge.proposal
    if proposal.relaxes is None:
        yield f"  {number}. one more edge in {proposal.template}, location {proposal.source}:"
        yield f"       {proposal.text}"
    else:
        yield f"  {number}. another guard in {proposal.template}, location {proposal.source}, {proposal.relaxes.span}:"
        yield f"       {edge_text(proposal.relaxes)}"
        guard = "no guard" if proposal.edge.guard is None else f"guard {print_expression(proposal.edge.guard)}"
        yield f"     with {guard}"
    if recordings:
        yield f"     {edge.also_allowed} of {recordings} changed recordings would be runs, too"
    yield from _verdict_lines(changed)


def _verdict_lines(changed: Sequence[ChangedVerdict] | None) -> Iterator[str]:
    if changed is not None:
        yield from (f"     {each.name}: {each.before} becomes {each.after}" for each in changed)
        yield from [] if changed else ["     no answer of a property changes"]
