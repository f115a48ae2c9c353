"""The picture of how often a property is violated at different loss rates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Estimated:
    """Attributes:
    rate: the probability that a packet is lost.
    low, high: contain the probability of a violation with the confidence of the estimate.
    frequency: of violations among the runs that were drawn.
    """

    rate: float
    low: float
    high: float
    frequency: float

    @property
    def runs_to_see_one(self) -> float:
        """How many runs show a violation with probability 0.95, if the frequency is the probability."""
        return math.log(0.05) / math.log1p(-self.frequency) if self.frequency > 0 else math.inf


def draw_loss_rates(found: Sequence[Estimated], path: Path) -> None:
    """An interval for each loss rate, both axes logarithmic."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    plane = figure.subplots()
    floor = min((each.high for each in found), default=1.0) / 30
    for each in found:
        plane.plot([each.rate] * 2, [max(each.low, floor), each.high], color="#1f3b63", linewidth=2)
        plane.plot(each.rate, max(each.frequency, floor), "o", color="#1f3b63")
    plane.set(xscale="log", yscale="log", xlabel="probability that a packet is lost")
    plane.set_ylabel("probability that a run violates NIWS")
    plane.set_xticks([each.rate for each in found], [f"{each.rate:g}" for each in found])
    plane.minorticks_off()
    plane.grid(color="#dddddd")
    figure.savefig(path, metadata={"Date": None})
