"""Findings about infinitely many actions in finite time (`tachk.analysis.recurrent_edges` says which edges do that)."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Sequence

from tachk.analysis.edge_steps import EdgeStep
from tachk.analysis.fold import Known
from tachk.analysis.recurrent_edges import steps_but, suspicious
from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.model.network import Network, Process
from tachk.model.run import Transition


def zeno_findings(network: Network, known: Known, never: Collection[tuple[int, int]]) -> tuple[Diagnostic, ...]:
    """A cycle of each template that may be taken for ever in finite time. None where there is certainly no such run.

    Args:
        never: edges that are known never to be taken.
    """
    left = suspicious(steps_but(network, known, never))
    findings = []
    named: set[str] = set()
    for number, process in enumerate(network.processes):
        own = [step for step in sorted(left, key=lambda step: step.number) if step.process == number]
        if not own or process.template in named or all(step.channels and not step.sends for step in own):
            continue
        named.add(process.template)
        cycle = _shortest_cycle(own)
        edges = [step.number for step in cycle]
        findings.append(_finding(process, edges, f"`{process.name}` may go round"))
    return tuple(findings)


def zeno_finding(network: Network, loop: Sequence[Transition]) -> Diagnostic:
    """Told of the process that decides the first transition of a loop that is taken for ever in finite time."""
    number = loop[0].participants[0].process
    edges = [p.edge for transition in loop for p in transition.participants if p.process == number]
    process = network.processes[number]
    return _finding(process, edges, f"`{process.name}` goes round")


def _finding(process: Process, edges: Sequence[int], what: str) -> Diagnostic:
    taken = [process.edges[edge] for edge in edges]
    names = [process.locations[edge.source].name for edge in taken]
    spans = [edge.spans[0] for edge in taken]
    return Diagnostic(
        "W0607",
        f"{what} `{' -> '.join([*names, names[0]])}` without end in finite time",
        spans[0],
        "let a clock be reset in the cycle and compared there with at least 1, if time is to pass",
        tuple(Label(span, "then this") for span in dict.fromkeys(spans[1:]) if span != spans[0]),
    )


def _shortest_cycle(steps: list[EdgeStep]) -> list[EdgeStep]:
    """A shortest cycle through one of the edges, each of which lies on one."""
    best: list[EdgeStep] = []
    for first in steps:
        ways: dict[int, list[EdgeStep]] = {first.target: [first]}
        waiting = deque([first.target])
        while waiting and first.source not in ways:
            here = waiting.popleft()
            for step in steps:
                if step.source == here and step.target not in ways:
                    ways[step.target] = [*ways[here], step]
                    waiting.append(step.target)
        way = ways.get(first.source, [])
        if way and (not best or len(way) < len(best)):
            best = way
    return best
