"""What is not simulated is named; searches do not mind."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError, UsageError
from tachk.cli.main import app
from tachk.simulation.columns import all_columns, chosen_columns
from tachk.simulation.fmi.unit import closed_unit
from tachk.simulation.runs import Runs


def _code(text: str) -> str:
    with pytest.raises(UnsupportedError) as caught:
        Runs(tachk.loads(text).network, ())
    return caught.value.diagnostic.code


def test_a_rate_that_cannot_be_computed_is_rejected_by_simulation_only() -> None:
    text = """
        double z = 1.5;
        process P() { init location A { exponential_rate z; to B; } location B; }
        system P;
        property p : E<> P.B;
    """
    assert _code(text) == "E0722"
    assert tachk.loads(text).verify()["p"].answer is tachk.Answer.HOLDS


def test_a_weight_that_is_no_number_is_rejected() -> None:
    assert (
        _code(
            """
            process P() {
                clock x;
                init location A { to way; }
                branchpoint way { to A { probability x; } to A; }
            }
            system P;
            """
        )
        == "E0722"
    )


def test_check_warns_of_such_rates_and_weights(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "m.ta"
    path.write_text(
        """
        double z = 1.5;
        int a[2];
        process P(const int[0, 1] me) {
            clock x;
            init location A { exponential_rate a; to way; }
            location B { exponential_rate z; to A; }
            branchpoint way { to A { probability a; } to B { probability x; } to B { probability 2; } }
        }
        system P;
        """
    )
    assert app.main(["check", str(path)], standalone_mode=False) == 0
    assert capsys.readouterr().err.count("warning[W0722]") == 2


def test_priorities_are_rejected_in_units_only() -> None:
    text = "process P() { init location A { to A; } } process Q() { init location A; } system P < Q;"
    Runs(tachk.loads(text).network, ())
    with pytest.raises(UnsupportedError) as caught:
        closed_unit(tachk.loads(text).network, "unit")
    assert caught.value.diagnostic.code == "E0723"


def test_clock_guards_on_urgent_channels_are_rejected() -> None:
    text = """
        urgent broadcast chan c;
        process P() { clock x; init location A { to A { guard x > 2; sync c!; } } }
        system P;
    """
    assert _code(text) == "E0721"


def test_columns_are_signals_locations_and_variables() -> None:
    network = tachk.loads(
        """
        int[0, 3] n; const int K = 2; bool b; int[0, 1] a[2]; meta int m; clock x;
        signal many = n > K;
        process P() { int[0, 5] k; init location A { to B; } location B; }
        process Q() { init location A; }
        system P, Q;
        """
    ).network
    assert [column.name for column in all_columns(network)] == ["many", "P", "Q", "n", "b", "a[0]", "a[1]", "P.k"]
    assert [column.truth for column in chosen_columns(network, ["P.B", "n"])] == [True, False]
    with pytest.raises(UsageError):
        chosen_columns(network, ["P.C"])


ENDS = """
broadcast chan go;
process P() { clock x; init location A { invariant x <= 5; to B { sync go?; } OWN } location B; }
process Q() { init location C { RATE to D { sync go!; } } location D; }
system P, Q;
"""


@pytest.mark.parametrize(
    ("rate", "own", "warnings"),
    [
        ("exponential_rate 1 : 10;", "", 1),
        ("", "", 0),
        ("exponential_rate 1 : 10;", "to B { guard x >= 5; }", 0),
    ],
)
def test_check_warns_of_an_end_that_nobody_has_drawn(
    rate: str, own: str, warnings: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "m.ta"
    path.write_text(ENDS.replace("RATE", rate).replace("OWN", own))
    assert app.main(["check", str(path)], standalone_mode=False) == 0
    assert capsys.readouterr().err.count("warning[W0724]") == warnings
