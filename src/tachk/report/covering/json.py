"""The report on a test suite for programs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from tachk.engine.edge_paths import Place
from tachk.model.network import Network
from tachk.report.covering.names import place_text
from tachk.verify.covering.suite import CoveringSuite


def suite_to_json(network: Network, suite: CoveringSuite, model: str, files: Sequence[Sequence[str]]) -> dict[str, Any]:
    """One object, as docs/schema/tests.schema.json describes it.

    Args:
        files: those of each run; empty if none is written.
    """

    def names(places: Iterable[Place]) -> list[str]:
        return [place_text(network, suite.coverage, place) for place in sorted(places)]

    def missing(places: Iterable[tuple[Place, str]]) -> list[dict[str, str]]:
        return [{"name": place_text(network, suite.coverage, place), "reason": str(why)} for place, why in places]

    return {
        "model": model,
        "time_unit": network.time_unit,
        "cover": suite.coverage.value,
        "count": len(suite.places),
        "covered": len(suite.covered),
        "steps": suite.steps,
        "runs": [
            {
                "files": list(files[number]) if files else [],
                "steps": len(each.run.path),
                "end": str(each.run.states[-1].time),
                "covered": names(each.covered),
                "new": names(each.new),
            }
            for number, each in enumerate(suite.runs)
        ],
        "impossible": missing(suite.impossible),
        "unknown": missing(suite.unknown),
        "states": suite.statistics.states_stored,
    }
