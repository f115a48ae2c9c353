"""The mutants of a system."""

from __future__ import annotations

import tachk
from tachk.report.covering.mutants import mutant_text
from tachk.simulation.testing.mutants import system_mutants
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.suite import covering_suite

REFUSED = """
broadcast chan go, done, inner;

process Lamp() {
    clock x, z;

    init location Off {
        to On { sync go?; assign x = 0; }
        to Shut { sync go?; }
        to Old { sync go?; assign z = 901; }
    }

    location On {
        invariant x <= 50;
        to Off { guard x >= 20; sync done!; }
        to Open { guard x >= 10; sync inner!; }
    }

    location Shut {
        invariant z < 0;
    }

    location Old {
        invariant z <= 900;
    }

    location Open {
    }
}

process Lid() {
    clock z;

    init location Closed {
        to Shut { sync inner?; }
        to Closed { guard z >= 900; assign z = 0; }
    }

    location Shut {
        invariant z < 0;
    }
}

process Finger() {
    clock y;

    init location Waiting {
        to Waiting { guard y >= 300; sync go!; assign y = 0; }
    }
}

system Lamp, Lid, Finger;

recording {
    replaces Finger;
    visible go as go();
    visible done as done();
    tolerance 1;
}
"""


def test_an_edge_that_an_invariant_blocks_may_be_taken_in_a_mutant() -> None:
    """No run takes these edges; where they lead elsewhere, set no clock or are missing, a test can tell."""
    model = tachk.loads(REFUSED)
    assert model.loaded.recording is not None
    never = {place for place, _ in covering_suite(model.network, Coverage.EDGES).impossible}
    mutants = [
        mutant
        for mutant in system_mutants(model.network, model.loaded.recording, 3)
        if (mutant.process, mutant.edge) in never and mutant.operator.value != "sends nothing"
    ]
    found = {mutant_text(model.network, each): each.same_untaken for each in mutants if not each.detail.startswith("x")}
    assert found == {
        "Lamp: Off -> Shut: other target (Old)": False,
        "Lamp: Off -> Shut: other target (Open)": False,
        "Lamp: Off -> Shut: edge missing": False,
        "Lamp: Off -> Old: other target (Open)": False,
        "Lamp: Off -> Old: other target (Off)": False,
        "Lamp: Off -> Old: clocks not set": False,
        "Lamp: Off -> Old: edge missing": False,
        "Lamp: On -> Open: guard negated": False,
        "Lamp: On -> Open: other target (Off)": True,
        "Lamp: On -> Open: other target (On)": True,
        "Lamp: On -> Open: edge missing": True,
        "Lid: Closed -> Shut: other target (Closed)": False,
        "Lid: Closed -> Shut: edge missing": False,
    }
