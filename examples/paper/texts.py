"""What the page says between the results, with the numbers of this study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from loss_rates import Estimated

_QUESTION = """
Micro XRCE-DDS is the middleware under micro-ROS: small devices (clients) talk through an Agent to a network
of DDS. Five timed automata say how it works: a publishing client, a subscribing client that sleeps to save
energy, the Agent, and the two objects in the Agent that stand for the clients. A preprint simulates such
automata and judges the simulated signals by seven sentences. This page does the same, and then asks the
sentences of *all* runs.

| sentence | what it says |
|---|---|
| ECFS | every message has been written to DDS within 180 s |
| ECRA | every message has been read by the subscriber within 180 s |
| NIWS | no packet arrives at the sleeping subscriber |
| RMIO, RMIO2 | messages arrive in the order in which they were sent, on both ways |
| TMRK | the Agent hears of every lost message within 20 s |
| FARS | the Agent never has unconfirmed messages for longer than 20 s |

## One run

Ten messages go both ways, and the subscriber sleeps for 50 s. The fifth DATA of the publisher and the third
one to the subscriber are lost. Below are the signals of this run over time, and under them the sentences with
their verdicts.
"""

_SIMULATED = """
## {runs:,} runs

Now each packet is lost with a probability of one in a hundred. {verdict}
"""

_FEW = """
## All runs, LOSSES = {losses}

The same sentences, checked on every run of the same automata: every moment at which something may happen, every
packet that may be lost. No run is missing here. {verdict}
"""

_MORE = """
## All runs, LOSSES = {losses}

The same with one loss more. {verdict} {run}
"""

_RUN = "For each one that fails there is a run that shows it, as a sequence chart and to step through."

_RATES = """
## How long one would have to simulate

{table}

The last column is the number of runs after which one has seen a violation with probability 0.95. {fit}
"""

_REPAIR = """
## What mends it

The subscriber falls asleep when it has sent nothing for LINGER seconds. Below is, for each number of losses
and each value of LINGER, whether NIWS and FARS hold on all runs.
"""


def write(
    folder: Path,
    simulated: Mapping[str, Any],
    verified: Sequence[Mapping[str, str]],
    found: Sequence[Estimated],
    losses: int,
) -> list[Path]:
    """Writes the texts; the files in their order.

    Args:
        simulated: what tachk simulate says.
        verified: the answers by sentences, with one loss less and with all.
        losses: how many these are.
    """
    few, many = verified
    failing = [name for name, answer in many.items() if answer == "fails"]
    texts = [
        _QUESTION,
        _SIMULATED.format(runs=simulated["runs"], verdict=_seen(simulated)),
        _FEW.format(losses=losses - 1, verdict=_said(few)),
        _MORE.format(losses=losses, verdict=_said(many), run=_RUN if failing else ""),
        _RATES.format(table=_table(found), fit=_fit(found)),
        _REPAIR,
    ]
    paths = [folder / f"text_{number}.md" for number in range(1, len(texts) + 1)]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text.lstrip(), encoding="utf-8")
    return paths


def _seen(simulated: Mapping[str, Any]) -> str:
    """What the runs have shown."""
    violated = [formula["name"] for formula in simulated["formulas"] if formula["false"]]
    if violated:
        return f"{', '.join(violated)} are violated on some of them."
    sure = max(formula["probability_of_violation"][1] for formula in simulated["formulas"])
    return (
        "Every sentence is true on each of these runs. One would be content; and yet all that follows is that a "
        f"violation has a probability of less than {sure:.2g}, with a confidence of 0.95."
    )


def _said(answers: Mapping[str, str]) -> str:
    """Answers in a sentence."""
    said = []
    for answer, verb in (("holds", "hold"), ("fails", "fail"), ("unknown", "have no answer")):
        names = [name for name, found in answers.items() if found == answer]
        if len(names) == len(answers):
            return f"All of them {verb}."
        if names:
            said.append(f"{', '.join(names)} {verb}")
    return f"{'; '.join(said)}."


def _table(found: Sequence[Estimated]) -> str:
    lines = ["| loss rate | probability of a violation of NIWS | runs to see one |", "|---:|---|---:|"]
    for each in found:
        seen = f"{each.runs_to_see_one:,.0f}" if each.frequency else "none was seen"
        lines.append(f"| {each.rate:g} | {each.low:.2g} to {each.high:.2g} | {seen} |")
    return "\n".join(lines)


def _fit(found: Sequence[Estimated]) -> str:
    """What the loss rate of one in a hundred would give, if it takes three losses."""
    known = [each for each in found if each.frequency]
    if not known:
        return ""
    factor = sum(each.frequency / each.rate**3 for each in known) / len(known)
    runs = 3 / (factor * 0.01**3)
    return (
        "It takes three losses, so that the probability goes with the third power of the loss rate: at one in a "
        f"hundred it would be about {factor * 0.01**3:.1g}, and one would have to simulate some {runs:,.0f} runs."
    )
