"""Random networks as hypothesis draws them: it can shrink the ones that fail."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tachk.model.random_networks import RandomCase, Shape, random_case

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy


_PLAIN = Shape()


def cases(shape: Shape = _PLAIN) -> SearchStrategy[RandomCase]:
    """`random_case` as a hypothesis strategy."""
    from hypothesis import strategies

    return strategies.randoms(use_true_random=False).map(lambda random: random_case(random, shape))
