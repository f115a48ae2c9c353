"""Coordinates across the flow for nodes whose order on each layer is fixed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate, pairwise

from tachk.export.placement_layers import Layering

Extent = tuple[float, float]
"""How much room a node needs before and after its coordinate."""


def across(
    layering: Layering,
    extents: Mapping[int, Extent],
    weight: Callable[[int, int], float],
    gap: float,
    sweeps: int,
) -> dict[int, float]:
    """A coordinate for each node: close to its neighbours', in the order of its layer, without overlap.

    Each layer in turn is placed optimally for fixed neighbouring layers: the least weighted squares of the distances,
    which with fixed distances of the nodes of a layer is an isotonic regression.

    Args:
        weight: how important it is that two linked nodes stand level.
        gap: the room between two nodes of a layer.
        sweeps: how often the layers are gone through, down and up by turns.
    """
    offsets = {}
    for layer in layering.layers:
        steps = (extents[a][1] + gap + extents[b][0] for a, b in pairwise(layer))
        offsets.update(zip(layer, accumulate(steps, initial=0.0), strict=bool(layer)))
    at = dict(offsets)
    for layer in layering.layers:
        for node in layer:
            at[node] -= offsets[layer[-1]] / 2
    for sweep in range(sweeps):
        last = sweep >= sweeps - 4
        downwards = sweep % 2 == 0
        for layer in layering.layers if downwards else layering.layers[::-1]:
            wanted, weights = [], []
            for node in layer:
                near = layering.above[node] if downwards else layering.below[node]
                if last or not near:
                    near = [*layering.above[node], *layering.below[node]]
                total = sum(weight(node, other) for other in near)
                place = sum(weight(node, other) * at[other] for other in near) / total if total else at[node]
                wanted.append(place - offsets[node])
                weights.append(total or 0.01)
            for node, place in zip(layer, _isotonic(wanted, weights), strict=True):
                at[node] = place + offsets[node]
    return at


def _isotonic(wanted: Sequence[float], weights: Sequence[float]) -> list[float]:
    """The non-decreasing sequence closest to the wanted one (pooling of adjacent violators)."""
    blocks: list[tuple[float, float, int]] = []
    for place, weight in zip(wanted, weights, strict=True):
        blocks.append((place, weight, 1))
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (p, v, n), (q, w, m) = blocks[-2], blocks[-1]
            blocks[-2:] = [((p * v + q * w) / (v + w), v + w, n + m)]
    return [place for place, _, length in blocks for _ in range(length)]
