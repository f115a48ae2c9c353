"""Edges that wait in vain: those that would be taken with another one, on channels on which no other process has it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.compiler.program import ProgramChannel, ProgramEdge


def waiting_in_vain(edges: Sequence[ProgramEdge], channels: Sequence[ProgramChannel]) -> Iterator[int]:
    """The numbers of the edges that no other process has a part for. Who broadcasts needs nobody."""
    ways = [(edge.sends, range(edge.channel, edge.channel + edge.channels)) for edge in edges]
    users: dict[tuple[bool, range], set[int]] = {}
    for edge, way in zip(edges, ways, strict=True):
        users.setdefault(way, set()).add(edge.process)
    of_channel: dict[tuple[bool, int], set[int]] = {}
    for (sends, named), processes in users.items():
        for channel in named:
            of_channel.setdefault((sends, channel), set()).update(processes)
    partners: dict[tuple[bool, range], set[int]] = {
        (sends, named): set().union(*(of_channel.get((not sends, channel), ()) for channel in named))
        for sends, named in users
        if not any(sends and channels[channel].broadcast for channel in named)
    }
    return (
        number
        for number, (edge, way) in enumerate(zip(edges, ways, strict=True))
        if edge.channel >= 0 and way in partners and partners[way] <= {edge.process}
    )
