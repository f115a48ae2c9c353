"""Mutated models are loaded, or refused with diagnostics that can be told: never anything else."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.diagnostics.explanation import all_explanations
from tachk.base.diagnostics.render import render
from tachk.base.resources import data_root
from tachk.base.span import Source
from tachk.formats.loading.load import load_model

MUTANTS = 250

WORDS = """
process location to guard sync assign init urgent committed branchpoint { } ( ) [ ] ; , : = == ! ? -> A[] E<> --> forall
sum property signal const int struct typedef state trans system < <= => chan priority default expect if else time_unit
clock meta void return for while do scalar[3] int[0,3] x n P 0 1 -1 2147483647 x' deadlock select F[0,5] U rise( . true
AG [] <> template assert spawn ++ += ** sup: Pr[<=10]
"""


def seeds() -> list[str]:
    texts = [path.read_text(encoding="utf-8") for path in sorted((data_root() / "models" / "classics").glob("*.ta"))]
    for path in sorted((Path(__file__).parents[1] / "diagnostics").glob("*.md")):
        texts += re.findall(r"^```ta\n(.*?)^```$", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return texts + [
        text for explanation in all_explanations().values() for text in (explanation.bad, explanation.good) if text
    ]


def mutate(text: str, random: Random) -> str:
    words = WORDS.split()
    tokens = re.findall(r"\w+|\s+|[^\w\s]", text)
    for _ in range(random.choice((1, 1, 2, 4))):
        place = random.randrange(len(tokens) + 1)
        end = place + random.choice((0, 0, 1, 2, 8))
        copied = random.randrange(len(tokens) + 1)
        new = random.choice(([], [f" {random.choice(words)} "], tokens[copied : copied + 3]))
        tokens[place:end] = new
    return "".join(tokens)


@pytest.mark.parametrize("seed", range(2))
def test_mutated_models_are_loaded_or_rejected(seed: int, tmp_path: Path) -> None:
    random, originals = Random(seed), seeds()
    for _ in range(MUTANTS):
        source = Source(str(tmp_path / "m.ta"), mutate(random.choice(originals), random))
        try:
            loaded = load_model(source)
        except InputError as error:
            found = error.diagnostics
            assert found
        except UsageError:
            continue
        else:
            found = (*loaded.refusals, *loaded.warnings)
        assert all(render(diagnostic) for diagnostic in found)
