"""Large networks whose answers are known: ``python -m bench.tiled_agreement COUNT SEED [STATES]``.

The networks are made of 8 to 13 pieces (`tests.support.tiled_networks`). About each two questions are asked, the first
one also with one strategy or reduction switched off; they take turns. A search stores at most so many STATES (500,000).
Prints the answers by the strategy that gave them, how many states the searches stored, and every disagreement with its
seed. Exit status 1 after a disagreement. Ctrl-C ends it with what is known so far.
"""

from __future__ import annotations

import sys
from collections import Counter
from random import Random

import tachk
from tests.support.reductions.verdict_agreement import BY_DEFAULT, TOGETHER
from tests.support.tiled_networks import random_goal, random_tiled_network

WAYS = {"default": BY_DEFAULT, **{name: options for name, options in TOGETHER.items() if name != "shortest"}}


def main(arguments: list[str]) -> int:
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    count, first, states = *map(int, arguments[:2]), int(arguments[2]) if len(arguments) == 3 else 500_000
    limits = tachk.Limits(states=states, seconds=60)
    decided: Counter[tuple[str, str]] = Counter()
    unknown: Counter[str] = Counter()
    stored: list[int] = []
    wrong = 0
    try:
        for seed in range(first, first + count):
            random = Random(seed)
            network = random_tiled_network(random, random.randint(8, 13), random.randint(1, 2), 5, 10)
            model = tachk.loads(network.text)
            other = list(WAYS)[1 + seed % (len(WAYS) - 1)]
            for number, goal in enumerate((random_goal(random, network), random_goal(random, network))):
                reached = network.reached(goal)
                for way in ("default", other)[: 2 - number]:
                    (verdict,) = model.verify(
                        network.query(goal), options=WAYS[way], limits=limits, trace=False
                    ).record.verdicts
                    stored.append(verdict.statistics.states_stored)
                    if verdict.answer is tachk.Answer.UNKNOWN:
                        unknown[verdict.reason] += 1
                    elif (verdict.answer is tachk.Answer.HOLDS) != reached:
                        wrong += 1
                        print(f"seed {seed}, {way}: {verdict.answer.value} is wrong: {network.query(goal)}", flush=True)
                    else:
                        decided[verdict.answer.value, verdict.strategy] += 1
    except KeyboardInterrupt:
        pass
    stored.sort()
    for (answer, strategy), times in sorted(decided.items()):
        print(f"{answer:8}{strategy:16}{times:8,}")
    for reason, times in sorted(unknown.items()):
        print(f"unknown {reason:16}{times:8,}")
    above = {size: sum(each >= size for each in stored) for size in (10**3, 10**4, 10**5)}
    print(f"{len(stored):,} searches stored {sum(stored):,} states, the largest {stored[-1] if stored else 0:,};")
    print("of them with at least " + ", ".join(f"{size:,} states: {times:,}" for size, times in above.items()))
    print(f"{wrong} disagreements")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
