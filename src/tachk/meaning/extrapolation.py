"""Widening of zones by the largest constants that their clocks are compared with."""

from __future__ import annotations

from tachk.meaning import dbm
from tachk.meaning.clock_constants import ClockConstants
from tachk.meaning.dbm import Federation, Zone


def widen(constants: ClockConstants, zone: Zone) -> Federation:
    """The zone without bounds that no constraint of the network can distinguish; there are finitely many such zones."""
    pieces = [zone]
    for diagonal in constants.diagonals:
        sides = (diagonal, dbm.complement(diagonal))
        pieces = [part for piece in pieces for side in sides if (part := dbm.constrain(piece, side)) is not None]
    return [_limited_to_its_side(constants, dbm.extrapolate_max(piece, constants.maximum), piece) for piece in pieces]


def _limited_to_its_side(constants: ClockConstants, widened: Zone, piece: Zone) -> Zone:
    sides = (side for diagonal in constants.diagonals for side in (diagonal, dbm.complement(diagonal)))
    limited = dbm.constrain_all(widened, (side for side in sides if side[2] >= piece[side[0], side[1]]))
    assert limited is not None
    return limited
