"""Certificates of what is not reached, with traps that somebody claims, be they traps or not."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from random import Random

import numpy as np

from tachk.engine.compiler.lower import lower
from tachk.engine.cover import Dropped, find_cover
from tachk.engine.options import Limits, Options
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.certificate import (
    CertificateHeader,
    CertificateReader,
    CertificateWriter,
    ProofKind,
    StateBlock,
    read_certificates,
)
from tachk.meaning.judge.trap import FOR_EVER, Trap
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.verify.certificates import Proof

LIMITS = Limits(states=3_000)


def blocks_without(proof: Proof, number: int) -> Iterator[StateBlock]:
    """The blocks of a proof without the discrete state of that number."""
    for block in proof.blocks():
        count = len(block.zones)
        if not 0 <= number < count:
            yield block
        else:
            left = np.arange(count) != number
            zone = np.repeat(left, block.zones)
            constraint = np.repeat(zone, block.constraints)
            yield StateBlock(
                block.discretes[left],
                block.zones[left],
                block.ranks[zone],
                block.constraints[zone],
                block.places[constraint],
                block.bounds[constraint],
            )
        number -= count


def claimed(
    network: Network, query: Query, traps: Sequence[Trap], clauses: Sequence[Sequence[int]] = ()
) -> CertificateReader | str:
    """A certificate that leaves out all states in one of the traps of each clause, or in any trap where no clauses are
    given, whatever there is in them; or the reason why the search for it ends without one."""
    assert query.target is not None
    program, (goal,) = lower(network, [query.target])
    dropped = Dropped(tuple(traps), tuple(map(tuple, clauses)) or (tuple(range(len(traps))),))
    cover = find_cover(program, goal, Options(), LIMITS, dropped)
    if isinstance(cover, str):
        return cover
    layout = prepare(network).layout
    clocks = tuple(layout.names[slot] for slot in layout.clock_slots)
    width = len(network.processes) + len(layout.initial)
    header = CertificateHeader(ProofKind.UNREACHABLE, "", query.text, "", {}, width, clocks, (), tuple(traps))
    stream = io.BytesIO()
    CertificateWriter(stream).write(header, cover.blocks())
    stream.seek(0)
    (certificate,) = read_certificates(stream)
    return certificate


def random_trap(network: Network, random: Random) -> Trap:
    """Any location or variable, now and then with a clock, and anything outside."""
    layout, processes = prepare(network).layout, len(network.processes)
    free = [s for s in range(len(layout.initial)) if s not in (*layout.clock_slots, *layout.channel_slots)]
    if free and random.random() < 0.3:
        slot = random.choice(free)
        low, high = layout.ranges[slot]
        return Trap(processes + slot, 0, tuple((v, 0, FOR_EVER) for v in range(low, high + 1) if random.random() < 0.5))
    process = random.randrange(processes)
    clock = random.randint(0, len(layout.clock_slots))
    outside = []
    for location in range(len(network.processes[process].locations)):
        if random.random() < 0.6:
            first = random.choice((0, 0, random.randint(0, 8))) if clock else 0
            outside.append(
                (location, first, random.choice((FOR_EVER, first + random.randint(0, 6)) if clock else (FOR_EVER,)))
            )
    return Trap(process, clock, tuple(outside))


def altered(trap: Trap, network: Network, random: Random) -> Trap:
    """With one part of what lies outside left out or longer or shorter by one number, or of another slot or clock."""
    outside = list(trap.outside)
    place = random.randrange(len(outside)) if outside else 0
    match random.randrange(6):
        case 0 | 1 if outside:
            del outside[place]
        case 2 | 3 if outside and trap.clock:
            value, first, last = outside[place]
            if random.random() < 0.5 or last == FOR_EVER:
                first = max(first + random.choice((-1, 1)), 0)
            else:
                last += random.choice((-1, 1))
            outside[place] = value, first, max(first, last)
        case 4:
            return Trap(random.randrange(len(network.processes)), trap.clock, trap.outside)
        case _:
            return Trap(trap.slot, random.randint(0, prepare(network).dimension - 1), trap.outside)
    return Trap(trap.slot, trap.clock, tuple(outside))
