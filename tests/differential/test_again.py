"""Formulas that only what happens again and again violates, against an oracle without observers and zones."""

from __future__ import annotations

from random import Random

import pytest

from tachk.base.span import NOWHERE, Source
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.made_network import scope_of
from tachk.frontend.queries.observer_processes import elaborate_temporal
from tachk.model.connectives import negation
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.syntax import ast
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.rewrite import rewrite, substitute
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support import Shape, random_case
from tests.support.endless.recurrence_oracle import Answering, answers_for_ever
from tests.support.formulas import FLAGS
from tests.support.observer_agreement import random_atom
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SHAPE = Shape(processes=2, locations=3, clocks=2, constant=2, deadlocks=False, committed=False)
SHAPES = {"plain": SHAPE, "urgent": Shape(processes=3, locations=2, clocks=1, constant=2, committed=False)}
OPTIONS = (Options(), Options(subsumption=False), Options(extrapolation=Extrapolation.MAX, pack_clocks=0))
A, B, C = FLAGS
"""The names of the conditions."""


def asked(form: str, a: Expression, b: Expression, c: Expression) -> Answering:
    """What a run has to do to violate a formula."""
    match form:
        case "F G a":
            return Answering(negation(a))
        case "G (a -> F G b)":
            return Answering(negation(b), after=a)
        case "G F a -> G F b":
            return Answering(a, kept=negation(b))
        case "G (a -> F b) -> F c":
            return Answering(b, needed=a, kept=negation(c), from_start=True)
    raise AssertionError(form)


def elaborated(network: Network, form: str, atoms: dict[str, ast.Expression]) -> tuple[Query, list[Expression]]:
    formula, _ = parse_formula(Source("f", form.replace("a", A).replace("b", B).replace("c", C)))
    assert formula is not None
    named = rewrite(formula, lambda node: substitute(node, atoms) if isinstance(node, ast.NameExpression) else node)
    context = Context(DiagnosticCollector())
    query = elaborate_temporal(ast.TemporalFormula(NOWHERE, named), "q", scope_of(network), context, "", None)
    conditions = [condition(atom, scope_of(network), context) for atom in atoms.values()]
    assert query is not None
    return query, [one for one in conditions if one is not None]


@pytest.mark.parametrize("form", ["F G a", "G (a -> F G b)", "G F a -> G F b", "G (a -> F b) -> F c"])
@pytest.mark.parametrize("shape", SHAPES)
def test_what_happens_again_and_again_is_what_the_oracle_sees(shape: str, form: str) -> None:
    decided = set()
    for seed in seeds(range(SEEDS)):
        random = Random(seed)
        network = random_case(random, SHAPES[shape]).network
        query, conditions = elaborated(network, form, {name: random_atom(random, network) for name in FLAGS})
        try:
            expected = answers_for_ever(network, asked(form, *conditions), 1500)
        except EvaluationFault:
            continue
        if expected is None:
            continue
        options = OPTIONS[seed % len(OPTIONS)]
        (verdict,) = verify(network, [query], options, Limits(states=20_000))
        if verdict.answer is Answer.UNKNOWN:
            continue
        assert (verdict.answer is Answer.FAILS) is expected, f"seed {seed}: {verdict.answer}"
        assert verdict.answer is Answer.HOLDS or verdict.trace is not None
        decided.add(verdict.answer)
    assert enough(len(decided) == 2)


SEEDS = 12
