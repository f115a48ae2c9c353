"""Each operator with a variant that holds and one that does not, after the examples in UPPAAL's documentation.

The ideas are theirs, the models ours; the verdicts are those stored in query-semantics.xml of docs.uppaal.org.
"""

from __future__ import annotations

import pytest

from tachk.api import model as api
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.model.run import Ending
from tachk.verify.verdict import Verdict

BRANCHES = """
process Traveller() {
    init location Home { to North; to South; }
    location North { to Lake; to Wood; }
    location South { to Beach; to Port; }
    location Lake;
    location Wood;
    location Beach;
    location Port;
    location Nowhere { to Home; }
}
system Traveller;
"""

IN_TIME = """
process Traveller() {
    clock x;
    bool arrived = false;
    init location Home { invariant x <= 10; to North; to South; }
    location North { invariant x <= 10; to Lake { assign arrived = true; } to Wood { assign arrived = true; } }
    location South { invariant x <= 10; to Beach { assign arrived = true; } to Port { assign arrived = true; } }
    location Lake;
    location Wood;
    location Beach;
    location Port;
}
system Traveller;
"""

REPAIR = """
process Machine() {
    clock x;
    init location Works { to Broken { assign x = 0; } }
    location Broken { invariant x <= 20; to Mended { guard x >= 10; assign x = 0; } }
    location Mended { to Works; }
}
system Machine;
"""

PATCH = """
process Machine() {
    clock x;
    bool known = false;
    init location Works { to Broken { assign x = 0; } }
    location Broken {
        invariant x <= 20;
        to Mended { guard x >= 10; assign x = 0; }
        to Patched { guard known; assign x = 0; }
    }
    location Patched { invariant x <= 20; to Broken { guard x >= 10; assign x = 0; } }
    location Mended { invariant x <= 20; to Works { guard x >= 10; assign known = true; } }
}
system Machine;
"""


def verdict(model: str, query: str) -> Verdict:
    loaded = load_model(Source("m.ta", f"{model}property asked : {query};"))
    (found,) = api.Model(loaded, "m.ta").verify().record.verdicts
    return found


@pytest.mark.parametrize(
    ("model", "query", "holds", "ending"),
    [
        (BRANCHES, "E<> Traveller.Beach", True, Ending.OPEN),
        (BRANCHES, "E<> Traveller.Nowhere", False, None),
        (BRANCHES, "E[] Traveller.Home", True, Ending.IDLE),
        (BRANCHES, "E[] Traveller.Home || Traveller.South || Traveller.Beach", True, Ending.IDLE),
        (BRANCHES, "E[] Traveller.South", False, None),
        (IN_TIME, "A<> Traveller.arrived", True, None),
        (BRANCHES, "A<> Traveller.Beach", False, Ending.IDLE),
        (BRANCHES, "A[] !Traveller.Nowhere", True, None),
        (BRANCHES, "A[] !Traveller.Home", False, Ending.OPEN),
        (REPAIR, "Machine.Broken --> Machine.Mended", True, None),
        (PATCH, "Machine.Broken --> Machine.Mended", False, Ending.PERIODIC),
    ],
)
def test_an_operator_as_its_documentation_has_it(model: str, query: str, holds: bool, ending: Ending | None) -> None:
    found = verdict(model, query)
    assert found.answer.value == ("holds" if holds else "fails")
    assert (None if found.trace is None else found.trace.ending) is ending


def test_the_workaround_that_is_taken_again_and_again_is_reported_as_a_loop() -> None:
    run = verdict(PATCH, "Machine.Broken --> Machine.Mended").trace
    assert run is not None and run.loop_start is not None
    names = ("Works", "Broken", "Patched", "Mended")
    visited = [names[state.discrete.locations[0]] for state in run.states]
    assert set(visited[run.loop_start :]) == {"Broken", "Patched"}
    assert "Mended" in visited[: run.loop_start]


def test_without_traces_the_answers_are_the_same() -> None:
    loaded = load_model(Source("m.ta", f"{PATCH}property asked : Machine.Broken --> Machine.Mended;"))
    (found,) = api.Model(loaded, "m.ta").verify(trace=False).record.verdicts
    assert found.answer.value == "fails" and found.trace is None


@pytest.mark.parametrize(
    ("location", "ending"),
    [
        ("init location A { invariant x' == 0; }", Ending.IDLE),
        ("init location A { invariant x' == 0 && y <= 3; }", Ending.STUCK),
        ("init location A { invariant x' == 0 && y <= 3; to A { guard y >= 1; assign y = 0; } }", Ending.PERIODIC),
    ],
)
def test_where_clocks_stop_a_run_that_the_judge_accepts_is_beyond_doubt(location: str, ending: Ending) -> None:
    model = f"clock x, y; process P() {{ {location} location B; }} system P; "
    found = verdict(model, "A<> P.B || x > 0")
    assert found.answer.value == "fails" and found.exact
    assert found.trace is not None and found.trace.ending is ending
