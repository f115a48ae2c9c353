"""The common part of reports of a region: sentences about it and about the evidence."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.span import NOWHERE, Span
from tachk.model.quantity import duration, grouped
from tachk.verify.synthesis.bounds_of_parameters import NoBound, ParameterBound
from tachk.verify.synthesis.region import CellEvidence, Region, RegionCell, shown_by_a_run
from tachk.verify.verdict import Answer


def summary(region: Region) -> str:
    """The size of the region."""
    wanted, cells = len(region.holding), len(region.cells)
    name, answer = region.query.name, region.wanted.value
    if region.unknown:
        return f"{name} {answer} in {grouped(wanted)} of {grouped(cells)} cells; {len(region.unknown)} are unknown"
    if wanted == cells:
        return f"{name} {answer} everywhere in the box, in {grouped(cells)} cells"
    if not wanted:
        return f"{name} {answer} nowhere in the box, in none of {grouped(cells)} cells"
    return f"{name} {answer} in {grouped(wanted)} of {grouped(cells)} cells"


def inequalities(region: Region) -> str:
    """The region as inequalities; empty where none are known."""
    if region.description is None:
        return ""
    return region.description.text([parameter.name for parameter in region.parameters])


def knowledge(region: Region) -> Iterator[tuple[str, str]]:
    """The proved bounds of each parameter: its name, and a sentence."""
    for parameter, bound in zip(region.parameters, region.bounds, strict=True):
        match bound:
            case ParameterBound.UPPER:
                words = "an upper bound only: more of it only adds behaviour"
            case ParameterBound.LOWER:
                words = "a lower bound only: less of it only adds behaviour"
            case ParameterBound.ABSENT:
                words = "not in anything that is searched: one value stands for all"
            case NoBound(reason, span):
                words = f"value by value: {reason}{_at(span)}"
        yield parameter.name, words


def _at(span: Span) -> str:
    return "" if span.source is NOWHERE.source else f" ({span})"


def evidence(region: Region, cell: RegionCell, time_unit: str) -> str:
    """The evidence for the answer of a cell."""
    verdict = cell.verdict
    if cell.answer is Answer.UNKNOWN:
        return cell.reason
    if verdict is None:
        return "implied by another cell"
    if verdict.trace is not None:
        steps = len(verdict.trace.path)
        end = duration(verdict.trace.states[-1].time, time_unit)
        loop = "" if verdict.trace.loop_start is None else ", with a loop"
        again = ", that of another cell at other times" if cell.evidence is CellEvidence.RUN else ""
        return f"a run of {steps} step{'s' * (steps != 1)}, to time {end}{loop}{again}"
    if cell.answer is shown_by_a_run(region.query):
        return f"found by a search that stored {grouped(verdict.statistics.states_stored)} states"
    proof = "" if cell.certificate is None else f"certificate of {grouped(cell.certificate.zones)} zones"
    if cell.evidence is CellEvidence.CERTIFICATE:
        return f"a {proof}, that of another cell, checked again"
    explored = f"all {grouped(verdict.statistics.states_stored)} states explored"
    return f"{explored}, and a {proof}" if proof else explored


def effort(region: Region) -> str:
    """The number of cells by their evidence, and the work."""
    counts = {kind: sum(cell.evidence is kind for cell in region.cells) for kind in CellEvidence}
    parts = [
        f"{grouped(counts[CellEvidence.SEARCH])} cell{'s' * (counts[CellEvidence.SEARCH] != 1)} searched",
        f"{grouped(counts[CellEvidence.RUN])} by the run of another cell",
        *(
            [f"{grouped(counts[CellEvidence.CERTIFICATE])} by its certificate"]
            if counts[CellEvidence.CERTIFICATE]
            else []
        ),
        f"{grouped(counts[CellEvidence.IMPLIED])} implied",
    ]
    return ", ".join(parts)


def assignment(region: Region, cell: RegionCell) -> str:
    """The values of a cell: ``PERIOD=3 DEADLINE=10``."""
    return " ".join(f"{p.name}={value}" for p, value in zip(region.parameters, cell.values, strict=True))
