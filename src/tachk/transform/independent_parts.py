"""Parts of a network that have nothing to do with each other, and what may be left out of them for runs for ever.

Two processes belong to the same part if one tests a location of the other, or both mention the same variable or channel
that is no constant. Let R be some parts, C the others, and neither have priorities. If R, by itself, is never stuck
(from each of its states some action is possible, now or after a delay) and has no run with infinitely many actions
in finite time, then each run of the whole network, as far as C takes part in it, is one of C that goes on as long:

- with infinitely many actions of C it is an infinite run of C;
- with infinitely many actions of R only, time passes for ever, as R takes no finite time for them: C waits for ever;
- where time passes for ever without further actions C waits for ever, too;
- where it gets stuck, R could do something after some delay. So it is C that does not allow that delay, and all of C's
  actions within the delays that C allows are possible in the whole network, where R allows as much: C is stuck. In a
  committed location of R, R can act at once, so that the network is not stuck; in one of C, C is stuck by itself.

So if no run of C avoids a goal that speaks of C for ever, none of the network does.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tachk.analysis.components import Component, ComponentSet, mentioned_components
from tachk.analysis.edge_steps import steps_of
from tachk.analysis.fold import known_values
from tachk.analysis.recurrent_edges import suspicious
from tachk.base.records import replace
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.traversal import process_expressions
from tachk.transform.blocking_processes import idle
from tachk.transform.cone_of_influence import every_action_counts


def independent_parts(network: Network, targets: Sequence[Expression]) -> tuple[frozenset[int], ...]:
    """The parts of which no target speaks, each by the numbers of its processes; none where every action counts.

    Parts in which clocks stop or with observers are not among them.
    """
    if every_action_counts(network, targets):
        return ()
    known = known_values(network, [])
    named, mentioned = mentioned_components(targets, known)
    parts: list[tuple[set[int], set[Component]]] = [(named, mentioned)]
    for number, process in enumerate(network.processes):
        seen, components = mentioned_components(list(process_expressions(process)), known)
        members, shared = {number, *seen}, set(components)
        separate = []
        for others, theirs in parts:
            if members.isdisjoint(others) and not ComponentSet(theirs).meets(shared):
                separate.append((others, theirs))
            else:
                members, shared = members | others, shared | theirs
        # That of the targets stays the first.
        first = not parts[0][0].isdisjoint(members) or ComponentSet(parts[0][1]).meets(shared)
        parts = [(members, shared), *separate] if first else [*separate, (members, shared)]
    return tuple(frozenset(members) for members, _ in parts[1:] if members and _is_plain(network, members))


def part_alone(network: Network, part: Collection[int]) -> Network:
    """The network in which only a part moves, and the others block nothing."""
    processes = enumerate(network.processes)
    return replace(network, processes=tuple(one if number in part else idle(one) for number, one in processes))


def takes_its_time(network: Network, part: Collection[int]) -> bool:
    """True if a part certainly has no run with infinitely many actions in finite time."""
    alone = part_alone(network, part)
    return not suspicious(frozenset(steps_of(alone, known_values(alone, []))))


def _is_plain(network: Network, part: Collection[int]) -> bool:
    locations = (location for number in part for location in network.processes[number].locations)
    return not any(location.rates or location.hybrid_rates or location.observes for location in locations)
