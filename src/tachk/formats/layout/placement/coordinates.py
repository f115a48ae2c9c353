"""Coordinates across the flow for nodes whose order on each layer is fixed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate, pairwise

from tachk.base.job import check_job
from tachk.formats.layout.placement.layers import Layering

Extent = tuple[float, float]
"""The room that a node needs before and after its coordinate."""

_LEVEL = 2.0
"""Distances below this are not worth a difference."""

_SAME = 0.5
"""Two nodes closer than this stand level."""


def across(
    layering: Layering,
    extents: Mapping[int, Extent],
    weight: Callable[[int, int], float],
    gap: float,
    sweeps: int,
) -> dict[int, float]:
    """A coordinate for each node: close to its neighbours', in the order of its layer, without overlap.

    Each layer in turn is placed optimally for fixed neighbouring layers: the least weighted squares of the distances,
    which with fixed distances of the nodes of a layer is an isotonic regression. In the second half of the sweeps the
    weights are divided by the distances met, which approaches the least sum of distances: few lines bend, the others
    are straight.

    Args:
        weight: how important it is that two linked nodes stand level.
        gap: the room between two nodes of a layer.
        sweeps: how often the layers are gone through, down and up by turns.
    """
    offsets: dict[int, float] = {}
    for layer in layering.layers:
        steps = (extents[a][1] + gap + extents[b][0] for a, b in pairwise(layer))
        offsets.update(zip(layer, accumulate(steps, initial=0.0), strict=bool(layer)))
    at = dict(offsets)
    for layer in layering.layers:
        for node in layer:
            at[node] -= offsets[layer[-1]] / 2
    for sweep in range(sweeps):
        straightening = 2 * sweep >= sweeps
        downwards = sweep % 2 == 0
        for layer in layering.layers if downwards else layering.layers[::-1]:
            wanted, weights = [], []
            for node in layer:
                near = layering.above[node] if downwards else layering.below[node]
                if straightening or not near:
                    near = [*layering.above[node], *layering.below[node]]
                pulls = [weight(node, other) for other in near]
                if straightening:
                    distances = (max(_LEVEL, abs(at[node] - at[other])) for other in near)
                    pulls = [pull / distance for pull, distance in zip(pulls, distances, strict=True)]
                total = sum(pulls)
                place = sum(p * at[other] for p, other in zip(pulls, near, strict=True)) / total if total else at[node]
                wanted.append(place - offsets[node])
                weights.append(total or 0.001)
            for node, place in zip(layer, _isotonic(wanted, weights), strict=True):
                at[node] = place + offsets[node]
    _Blocks(layering, extents, weight, gap, at).settle()
    return at


class _Blocks:
    """Nodes that stand level with a neighbour, moved together: a chain cannot get straight node by node."""

    def __init__(
        self,
        layering: Layering,
        extents: Mapping[int, Extent],
        weight: Callable[[int, int], float],
        gap: float,
        at: dict[int, float],
    ) -> None:
        self.at = at
        self.weight = weight
        self.near = {node: [*layering.above[node], *layering.below[node]] for node in at}
        self.before: dict[int, tuple[int, float]] = {}
        self.after: dict[int, tuple[int, float]] = {}
        for layer in layering.layers:
            for a, b in pairwise(layer):
                distance = extents[a][1] + gap + extents[b][0]
                self.before[b] = a, distance
                self.after[a] = b, distance

    def settle(self) -> None:
        """Moves blocks as long as the sum of the distances gets smaller, a few times at most."""
        for _ in range(12):
            check_job()
            if not sum(self._move(block) for block in self._blocks()):
                break
        for block in self._blocks():
            for node in block:
                self.at[node] = self.at[block[0]]

    def _blocks(self) -> list[list[int]]:
        seen: set[int] = set()
        blocks = []
        for node in self.at:
            if node in seen:
                continue
            seen.add(node)
            block = [node]
            for member in block:
                for other in self.near[member]:
                    if other not in seen and abs(self.at[other] - self.at[member]) < _SAME:
                        seen.add(other)
                        block.append(other)
            blocks.append(block)
        return blocks

    def _move(self, block: list[int]) -> bool:
        """Moves a block to the weighted median of where its neighbours stand, as far as there is room."""
        inside = set(block)
        pulls = sorted(
            (self.at[other] - self.at[node], self.weight(node, other))
            for node in block
            for other in self.near[node]
            if other not in inside
        )
        half = sum(weight for _, weight in pulls) / 2
        sums = accumulate(weight for _, weight in pulls)
        step = next((step for (step, _), total in zip(pulls, sums, strict=True) if total > half - 1e-9), 0.0)
        for node in block:
            other, distance = self.before.get(node, (node, 0.0))
            if other not in inside and other != node:
                step = max(step, min(0.0, self.at[other] + distance - self.at[node]))
            other, distance = self.after.get(node, (node, 0.0))
            if other not in inside and other != node:
                step = min(step, max(0.0, self.at[other] - distance - self.at[node]))
        before = sum(weight * abs(pull) for pull, weight in pulls)
        after = sum(weight * abs(pull - step) for pull, weight in pulls)
        if after > before - 0.5:
            return False
        for node in block:
            self.at[node] += step
        return True


def _isotonic(wanted: Sequence[float], weights: Sequence[float]) -> list[float]:
    """The non-decreasing sequence closest to the wanted one (pooling of adjacent violators)."""
    blocks: list[tuple[float, float, int]] = []
    for place, weight in zip(wanted, weights, strict=True):
        blocks.append((place, weight, 1))
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (p, v, n), (q, w, m) = blocks[-2], blocks[-1]
            blocks[-2:] = [((p * v + q * w) / (v + w), v + w, n + m)]
    return [place for place, _, length in blocks for _ in range(length)]
