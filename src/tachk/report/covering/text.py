"""The report on a test suite for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from tachk.engine.edge_paths import Place
from tachk.model.network import Network
from tachk.model.quantity import duration
from tachk.report.covering.names import KINDS, counted, listed, place_text, size_text
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.suite import CoveringSuite


def suite_to_text(network: Network, suite: CoveringSuite, model: str, files: Sequence[str]) -> str:
    """The size of a suite, its runs, and what they do not cover.

    Args:
        files: the name of each run; empty if none is written.
    """
    return "".join(f"{line}\n" for line in _lines(network, suite, model, files))


def _lines(network: Network, suite: CoveringSuite, model: str, files: Sequence[str]) -> Iterator[str]:
    yield f"{model}: {size_text(suite)}"
    what, done = KINDS[suite.coverage]
    for number, each in enumerate(suite.runs):
        name = files[number] if files else f"run {number + 1}"
        end = duration(each.run.states[-1].time, network.time_unit)
        steps = counted(len(each.run.path), "step")
        yield f"  {name}: {steps}, to {end}, {counted(len(each.new), f'more {what}')}"
    yield from _missing(network, suite.coverage, f"cannot be {done}", suite.impossible)
    yield from _missing(network, suite.coverage, "unknown", suite.unknown)


def _missing(network: Network, coverage: Coverage, heading: str, missing: Iterable[tuple[Place, str]]) -> Iterator[str]:
    """The places that are not covered, with the reasons."""
    names = [f"{place_text(network, coverage, place)}: {reason}" for place, reason in missing]
    return listed(f"{heading}:", names)
