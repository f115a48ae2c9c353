"""The arrays of zones set clocks as the plain zones of the reference semantics do."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from tachk.meaning import dbm
from tachk.meaning.dbm import LESS_EQUAL_ZERO, raw_bound
from tachk.meaning.judge.zone_arrays import assigned, before_assigning, canonical
from tests.support.seeds import seeds


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_setting_clocks_to_clocks(seed: int) -> None:
    random, zone = Random(seed), dbm.up(dbm.point((0, 0, 0)))
    for _ in range(3):
        zone = dbm.up(dbm.assign(zone, ((random.randint(1, 3), random.randint(0, 3), random.randint(0, 3)),)))
        constraint = (random.randint(1, 3), 0, raw_bound(random.randint(3, 9), random.random() < 0.5))
        zone = dbm.constrain(zone, constraint) or zone
    clocks = random.sample(range(1, 4), random.randint(1, 3))
    values = tuple((clock, random.randint(0, 3), random.randint(0, 3)) for clock in clocks)
    matrices = np.array([zone.bounds]).reshape(1, 4, 4)
    assert tuple(assigned(matrices, values).ravel().tolist()) == dbm.assign(zone, values).bounds
    before = canonical(before_assigning(values, matrices))
    expected = dbm.undo_assign(zone, values)
    if expected is None:
        assert (np.diagonal(before[0]) < LESS_EQUAL_ZERO).any()
    else:
        assert tuple(before.ravel().tolist()) == expected.bounds
