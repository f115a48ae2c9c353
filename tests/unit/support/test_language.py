"""Random networks go where plain ones do not."""

from __future__ import annotations

from random import Random

from tachk.analysis.failures import edge_can_fail
from tachk.analysis.fold import known_values
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits
from tachk.model.expressions import BOOL, Assign, Call, Conditional, Constant, Field, Index
from tachk.model.network import Network
from tachk.model.traversal import process_expressions, walk
from tachk.model.types import ChannelType, ClockType
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

SAFE = Shape(language=True, processes=2, locations=3, clocks=2, constant=3)
FAULTY = Shape(language=True, faults=1.0, processes=2, locations=3, clocks=2, constant=3)


def kinds(network: Network) -> set[str]:
    found = set()
    for expression in (e for process in network.processes for e in process_expressions(process)):
        for node in walk(expression):
            match node:
                case Call():
                    found.add("call")
                case Field():
                    found.add("field")
                case Conditional(_, then) if isinstance(then, Assign) and isinstance(then.type, ClockType):
                    found.add("one clock or another")
                case Index(_, index) if not isinstance(index, Constant):
                    found.add("channel" if isinstance(node.type, ChannelType) else "index")
    return found


def test_the_parts_of_the_language_occur() -> None:
    found = [kinds(random_case(Random(seed), SAFE).network) for seed in seeds(range(40))]
    for kind in ("call", "field", "one clock or another", "channel", "index"):
        assert enough(sum(kind in here for here in found) >= 8), kind


def faults(shape: Shape) -> int:
    """In how many of 60 networks the engine meets a run-time error; where it does, one was to be expected."""
    met = 0
    for seed in seeds(range(60)):
        network = random_case(Random(seed), shape).network
        try:
            program, goals = lower(network, [Constant(0, BOOL)])
        except UnsupportedError:  # a bound that fails for certain has no range
            continue
        if zone.explore(program, goals, limits=Limits(states=5000)).fault is not None:
            met += 1
            known = known_values(network, [])
            assert any(edge_can_fail(edge, known) for process in network.processes for edge in process.edges), seed
    return met


def test_nothing_fails_unless_it_may() -> None:
    assert faults(SAFE) == 0
    assert enough(faults(FAULTY) >= 20)
