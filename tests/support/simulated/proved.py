"""Formulas that verification proves, on simulated runs of the same network: false on none."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from tachk.base.records import dataclass
from tachk.base.span import NOWHERE, Source
from tachk.engine.options import Limits
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationEnding, SimulationOptions
from tachk.frontend.context import Context
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.made_network import scope_of
from tachk.frontend.queries.observer_processes import elaborate_temporal
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.recordings.monitors.formulas import NamedFormula, read_formulas
from tachk.recordings.monitors.offline import evaluate_formulas
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace_files import open_trace
from tachk.simulation.columns import columns_for
from tachk.simulation.runs import Runs
from tachk.syntax import ast
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.printing.expression_printer import print_expression
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support.observer_agreement import random_atom

SHAPES = (
    Shape(processes=2, locations=3, clocks=2, constant=3, deadlocks=False, hurried=0.3),
    Shape(processes=2, locations=4, clocks=1, constant=4, deadlocks=False, hurried=0.1),
    Shape(processes=3, locations=3, clocks=2, constant=2, deadlocks=False, exact=0.4),
)

FORMS = (
    "G (a -> b)",
    "a W b",
    "F[0,m] a",
    "G[0,m] !a",
    "a U[0,m] b",
    "G (a -> F[0,m] b)",
    "G (a -> F[0,m) b)",
    "G (rise(!a) -> F[0,m] b)",
    "G (rise(a) -> F(0,m] rise(b))",
    "G (fall(a) -> G[0,m] !b)",
    "G (a -> O[0,m] b)",
    "G (rise(a) -> H[0,m] !b)",
    "G (a -> (a S[0,m] b))",
    "G (change(a) -> F[0,m] b)",
    "G (a -> F[n,m] b)",
    "G F[0,m] a",
    "F a",
    "G F a",
    "F G a",
    "G (a -> F b)",
    "G (a -> (a U b))",
    "G F a -> G F b",
)

_STEPS, _FEW_STEPS, _STATES = 200, 4, 5_000


@dataclass(frozen=True, slots=True)
class JudgedProof:
    """A proved formula on a run."""

    seed: int
    formula: str
    run: int
    ending: SimulationEnding
    truth: Truth


def proved_on_runs(seed: int, runs: int = 6, forms: tuple[str, ...] = FORMS) -> Iterator[JudgedProof]:
    """The verdicts of formulas that are proved for a random network, on runs of it."""
    random = Random(seed)
    network = random_case(random, SHAPES[seed % len(SHAPES)]).network
    formulas: list[NamedFormula] = []
    for form in random.sample(forms, min(4, len(forms))):
        text = formula_over(form, random, network)
        query = _query(text, network)
        if query is None:
            continue
        (verdict,) = verify(network, [query], limits=Limits(states=_STATES))
        if verdict.answer is Answer.HOLDS:
            formulas += read_formulas(text)
    if not formulas:
        return
    columns = columns_for(network, (), (name for formula in formulas for name in formula.columns))
    drawn = Runs(network, columns)
    steps = _FEW_STEPS if seed % 5 == 2 else _STEPS
    drawing = SimulationOptions(seed, random.choice((3, 8, 20)) * TICKS_PER_UNIT, steps=steps)
    for run in drawn.draw(drawing, range(runs), RecordedChanges(observed=True)):
        if run.ending is SimulationEnding.INITIAL:
            continue
        record = evaluate_formulas(formulas, open_trace(drawn.trace(run)), EvaluationOptions(robustness=False))
        for formula, judged in zip(formulas, record.verdicts, strict=True):
            yield JudgedProof(seed, formula.text, run.number, run.ending, judged.truth)


def formula_over(form: str, random: Random, network: Network) -> str:
    """A form of `FORMS` over conditions of a network, and with numbers."""
    low = random.randint(0, 2)
    parts: dict[str, str] = {"n": str(low), "m": str(low + random.randint(1, 3))}
    parts |= {name: f"({print_expression(random_atom(random, network))})" for name in "ab"}
    return "".join(parts.get(letter, letter) if alone else letter for letter, alone in _letters(form))


def _letters(form: str) -> Iterator[tuple[str, bool]]:
    """Each character, and whether it is a name of its own."""
    around = f" {form} "
    for before, letter, after in zip(around, around[1:], around[2:], strict=False):
        yield letter, letter.isalpha() and not before.isalpha() and not after.isalpha()


def _query(text: str, network: Network) -> Query | None:
    formula, _ = parse_formula(Source("f", text))
    assert formula is not None, text
    return elaborate_temporal(
        ast.TemporalFormula(NOWHERE, formula), "q", scope_of(network), Context(DiagnosticCollector()), "", None
    )
