"""Which processes of a model are interchangeable for searches, and what tells others apart."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tachk.engine.exchanged import members_in_words
from tachk.engine.symmetry.detection import Difference, find_symmetry
from tachk.engine.symmetry.kinds import AsymmetryReason
from tachk.engine.symmetry.tables import tables_of
from tachk.model.network import Network
from tachk.verify.semantic_lint.findings import LintAnswer

_QUESTION = "interchangeable processes"


def interchange_parts(network: Network) -> tuple[LintAnswer, ...]:
    """Nothing about a network in which no two processes have the same text up to numbers and variables.

    A query that names processes leaves only the others interchangeable.
    """
    if not _repeats(network):
        return ()
    symmetry = find_symmetry(network, [])
    told: list[str] = []
    refused = list(symmetry.differences)
    for each, table in tables_of(network, symmetry):
        if isinstance(table, AsymmetryReason):
            first, second = (network.processes[team[0]] for team in each.members[:2])
            refused.append(Difference(first.template, first.name, second.name, table))
        else:
            told.append(members_in_words(table.slots, table.cyclic, [process.name for process in network.processes]))
    told += _differences(refused)
    return (LintAnswer(_QUESTION, "; ".join(told)),) if told else ()


def _repeats(network: Network) -> bool:
    """Whether two processes may have the same text: a quick look."""
    shapes = [(len(p.locations), len(p.edges), len(p.variables), p.initial) for p in network.processes if p.edges]
    return len(set(shapes)) < len(shapes)


def _differences(differences: Sequence[Difference]) -> Iterable[str]:
    for each in differences:
        place = f" ({each.refusal.span})" if each.refusal.span.text else ""
        yield f"not all {each.template}: {each.refusal.reason}{place}"
