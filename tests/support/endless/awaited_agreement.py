"""Formulas without deadline on random networks: the engine against the oracle."""

from __future__ import annotations

import re
from random import Random

from tachk.base.records import dataclass
from tachk.base.span import NOWHERE, Source
from tachk.engine.options import Limits
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.made_network import scope_of
from tachk.frontend.queries.observer_processes import elaborate_temporal
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.syntax import ast
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.rewrite import rewrite, substitute
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support.endless.awaited_oracle import FORMS, violated
from tests.support.formulas import FLAGS
from tests.support.observer_agreement import random_atom

SHAPES = (
    Shape(processes=2, locations=3, clocks=1, constant=2, deadlocks=False, hurried=0.4),
    Shape(processes=2, locations=3, clocks=2, constant=2, deadlocks=False, hurried=0.3),
    Shape(processes=2, locations=4, clocks=1, constant=1, deadlocks=False, hurried=0.6, exact=0.5),
    Shape(processes=3, locations=2, clocks=1, constant=1, deadlocks=False, hurried=0.5),
    Shape(processes=2, locations=4, clocks=1, constant=2, deadlocks=False, hurried=0.2, committed=False),
)
"""With committed and urgent locations, dead ends and time-locks in them, and loops that take no time."""

_REGIONS, _STATES = 600, 20_000


@dataclass(frozen=True, slots=True)
class ComparedFormula:
    """``expected``: whether the oracle says that the formula is violated; ``committed``: whether the network has
    committed locations."""

    seed: int
    form: str
    expected: bool
    answer: Answer
    committed: bool

    @property
    def agrees(self) -> bool:
        return self.answer is (Answer.FAILS if self.expected else Answer.HOLDS)


def compare_awaited(seed: int, forms: tuple[str, ...] = FORMS) -> list[ComparedFormula]:
    """The pairs of a random network with formulas, as far as limits allow an answer."""
    random = Random(seed)
    network = random_case(random, SHAPES[seed % len(SHAPES)]).network
    committed = any(location.committed for process in network.processes for location in process.locations)
    found = []
    for form in forms:
        atoms = {name: random_atom(random, network) for name in FLAGS}
        query, conditions = elaborated(network, form, atoms)
        try:
            expected = violated(network, form, *conditions, states=_REGIONS)
        except EvaluationFault:
            continue
        if expected is None:
            continue
        (verdict,) = verify(network, [query], limits=Limits(states=_STATES))
        if verdict.answer is not Answer.UNKNOWN:
            found.append(ComparedFormula(seed, form, expected, verdict.answer, committed))
    return found


def elaborated(
    network: Network, form: str, atoms: dict[str, ast.Expression]
) -> tuple[Query, tuple[Expression, Expression, Expression]]:
    """The query of a formula over a, b and c, and the conditions that these stand for."""
    text = "".join({"a": FLAGS[0], "b": FLAGS[1], "c": FLAGS[2]}.get(part, part) for part in _words(form))
    formula, _ = parse_formula(Source("f", text))
    assert formula is not None
    named = rewrite(formula, lambda node: substitute(node, atoms) if isinstance(node, ast.NameExpression) else node)
    context = Context(DiagnosticCollector())
    scope = scope_of(network)
    query = elaborate_temporal(ast.TemporalFormula(NOWHERE, named), "q", scope, context, "", None)
    a, b, c = (condition(atoms[name], scope, context) for name in FLAGS)
    assert query is not None and a is not None and b is not None and c is not None
    return query, (a, b, c)


def _words(form: str) -> list[str]:
    """A formula cut into names and what stands between them."""
    return re.findall(r"[a-z]+|[^a-z]+", form)
