"""A run of the slice that preserves liveness is carried over: the others move when they must."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk import Answer, Options
from tachk.model.run import Ending

OTHERS = """
process Other(const int[0, {last}] me) {{
    clock y;
    init location a {{ invariant y <= 3 + me % 2; to b {{ guard y >= 1; assign y = 0; }} }}
    location b {{ {rest} to c {{ guard y >= 1; assign y = 0; }} }}
    location c {{
        invariant y <= 3;
        to a {{ guard y >= 1; sync tick?; assign y = 0; }}
        to a {{ guard y >= 1; assign y = 0; }}
    }}
}}
"""
MAIN = {
    Ending.IDLE: "init location here { invariant x <= 9; to there { guard x >= 7; } } location there;",
    Ending.PERIODIC: "init location here { invariant x <= 4; to here { guard x >= 2; sync tick!; assign x = 0; } }",
    Ending.STUCK: "init location here { invariant x < 9; to end { guard x > 6; } } location end { invariant x < 12; }",
}
CARRIED = Options().off("some-states", "any-run")


def loaded(folder: Path, ending: Ending, rest: str = "", others: int = 3) -> tachk.Model:
    file = folder / "model.ta"
    main = f"process Main() {{ clock x; {MAIN[ending]} location never; }}"
    file.write_text(f"broadcast chan tick;\n{main}\n{OTHERS.format(rest=rest, last=others - 1)}\nsystem Main, Other;\n")
    return tachk.load(file)


@pytest.mark.parametrize("query", ["A<> Main.never", "Main.here --> Main.never"])
@pytest.mark.parametrize("ending", MAIN)
def test_a_run_of_the_slice_is_one_of_the_whole_network(ending: Ending, query: str, tmp_path: Path) -> None:
    (verdict,) = loaded(tmp_path, ending).verify(query, options=CARRIED).record.verdicts
    assert (verdict.answer, verdict.strategy) == (Answer.FAILS, "accompanied")
    assert verdict.trace is not None
    assert verdict.trace.ending is ending


def test_those_who_cannot_rest_go_round_while_the_others_are_idle(tmp_path: Path) -> None:
    model = loaded(tmp_path, Ending.IDLE, "invariant y <= 3;", others=1)
    (verdict,) = model.verify("A<> Main.never", options=CARRIED).record.verdicts
    assert (verdict.answer, verdict.strategy) == (Answer.FAILS, "accompanied")
    assert verdict.trace is not None
    assert verdict.trace.ending is Ending.PERIODIC


def test_where_it_is_long_until_all_come_round_a_search_decides(tmp_path: Path) -> None:
    rest = "invariant y <= 5 + 17 * me;"
    model = loaded(tmp_path, Ending.IDLE, rest, others=3)
    (given_up,) = model.verify("A<> Main.never", options=CARRIED).record.verdicts
    (verdict,) = model.verify("A<> Main.never").record.verdicts
    assert given_up.answer is Answer.UNKNOWN
    assert verdict.answer is Answer.FAILS


def test_a_late_trigger_needs_no_states_of_the_others(tmp_path: Path) -> None:
    """A search of the whole network stores more than 2,000,000 states."""
    steps = [f"location l{n} {{ invariant x <= 3; to l{n + 1} {{ guard x >= 1; assign x = 0; }} }}" for n in range(6)]
    text = f"process Main() {{ clock x; init {' '.join(steps)} location l6; location never; }}"
    file = tmp_path / "late.ta"
    file.write_text(f"broadcast chan tick;\n{text}\n{OTHERS.format(rest='', last=7)}\nsystem Main, Other;\n")
    (verdict,) = tachk.load(file).verify("Main.l6 --> Main.never").record.verdicts
    assert (verdict.answer, verdict.strategy) == (Answer.FAILS, "accompanied")
    assert verdict.statistics.states_stored < 20


@pytest.mark.parametrize("without", [(), ("accompanied",), ("sliced",)])
def test_many_others_cost_little_in_each_state(without: tuple[str, ...], tmp_path: Path) -> None:
    """What many others can do next is not put together in all ways."""
    model = loaded(tmp_path, Ending.IDLE, others=18)
    (verdict,) = model.verify("Main.here --> Main.never", options=Options().off(*without)).record.verdicts
    assert verdict.answer is Answer.FAILS
    assert verdict.statistics.states_stored < 20_000
