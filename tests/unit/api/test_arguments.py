"""Arguments of the wrong type are told in words, by every public function."""

from __future__ import annotations

from collections.abc import Callable
from math import nan
from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.simulation.statistics.deciding import Errors
from tachk.simulation.statistics.estimate import Settings
from tachk.simulation.statistics.rare import Splitting

MODEL = tachk.loads(
    "const int C = 3; int n; clock x; process P() { init location A { to B { guard x >= C; assign n = 1; } } "
    "location B; } system P;"
)
ASK: Any = MODEL
TACHK: Any = tachk


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ASK.verify(3), "`queries` is 3, but it must be a text"),
        (lambda: ASK.verify(["E<> P.B", None]), "`queries` is None, but it must be a text"),
        (lambda: ASK.verify(property=[3]), "`property` is [3], but it must be a text or a list of texts"),
        (lambda: ASK.verify(query_files="a.q"), "`query_files` is 'a.q', but it must be a list"),
        (lambda: ASK.verify(limits=3), "`limits` is 3, but it must be `tachk.Limits(...)` or None"),
        (lambda: ASK.estimate(3), "`queries` is 3, but it must be a text"),
        (lambda: ASK.estimate("Pr[<=9](<> P.B)", runs="9"), "`runs` is '9', but it must be a whole number or None"),
        (lambda: ASK.time(["P.A"], "P.B"), "`start` is ['P.A'], but it must be a text or None"),
        (lambda: ASK.synthesize(3, over="C=1..3"), "`query` is 3, but it must be a text"),
        (lambda: ASK.sweep("E<> P.B", over="C=1..3", part=3), "`part` is 3, but it must be a tuple"),
        (lambda: TACHK.Limits(seconds="x"), "`seconds` is 'x', but it must be a number or None"),
        (lambda: TACHK.Limits(states=2.5), "`states` is 2.5, but it must be a whole number or None"),
        (lambda: TACHK.Limits(seconds=nan), "`seconds` is nan, but it must be a number or None"),
        (lambda: TACHK.Limits(seconds_each=nan), "`seconds_each` is nan, but it must be a number or None"),
        (lambda: ASK.estimate("Pr[<=9](<> P.B)", confidence=nan), "`confidence` is nan, but it must be a number"),
        (lambda: ASK.estimate("Pr[<=9](<> P.B)", epsilon=nan), "`epsilon` is nan, but it must be a number"),
        (lambda: ASK.sweep("E<> P.B", over="C=1..3", seconds=nan), "`seconds` is nan, but it must be a number or None"),
        (lambda: ASK.sweep("E<> P.B", over="C=1..3", until=nan), "`until` is nan, but it must be a text or a number"),
        (lambda: TACHK.simulate(MODEL, until=nan), "`until` is nan, but it must be"),
        (lambda: Settings(confidence=nan), "`confidence` is nan, but it must be a number"),
        (lambda: Settings(confidence=1.0), "`confidence` is 1.0, but it must lie between 0 and 1"),
        (lambda: Settings(half_width=nan), "`half_width` is nan, but it must be a number"),
        (lambda: Errors(alpha=nan), "`alpha` is nan, but it must be a number"),
        (lambda: Errors(beta=0), "`beta` is 0, but it must lie between 0 and 1"),
        (lambda: Errors(delta=nan), "`delta` is nan, but it must be a number"),
        (lambda: Splitting(relative=nan), "`relative` is nan, but it must be a number"),
        (
            lambda: TACHK.monitor("F x > 1", {"time": [0, 1], "x": [0, 2]}).plot(begin=nan),
            "`begin` is nan, but it must",
        ),
        (lambda: TACHK.Options(processes="x"), "`processes` is 'x', but it must be a whole number"),
        (lambda: TACHK.Options(engine="x"), "`engine` is 'x', but it must be one of zone, smt, both"),
        (lambda: TACHK.Options(order=3), "`order` is 3, but it must be one of auto, bfs"),
        (lambda: ASK.verify(""), "'' is not a query"),
        (lambda: ASK.verify("E<> P.B", "// nothing"), "'// nothing' is not a query"),
        (lambda: TACHK.load(3), "`path` is 3, but it must be a text or a path"),
        (lambda: TACHK.simulate(MODEL, record="n"), "`record` is 'n', but it must be a list of texts"),
        (lambda: TACHK.replay(3, "a.run"), "`model` is 3, but it must be a model of `tachk.load`"),
        (lambda: TACHK.replay("m.ta", "a.run"), "there is no file m.ta"),
        (lambda: TACHK.monitor("F x > 1", "a.csv", ports=3), "`ports` is 3, but it must be a list of whole numbers"),
        (lambda: TACHK.mine("F[0,C] x > 1", 3, over={"C": (0, 9)}), "`traces` is 3, but it must be"),
        (lambda: TACHK.mine("F[0,C] x > 1", {"x": [1]}, over={"C": (0, 9)}), "`traces` is {'x': [1]}, but it must be"),
        (lambda: TACHK.mine("F[0,C] x > 1", [], over={"C": 3}), "over: C = 3 is not a least and a greatest value"),
        (lambda: TACHK.mine("F[0,C] x > 1", [], over="C=3"), "over: C=3: expected NAME=LOW..HIGH"),
        (lambda: TACHK.mine("F[0,C] x > 1", [], over={"C": range(0, 9, 2)}), "over: C = range(0, 9, 2) is not a least"),
    ],
)
def test_the_wrong_type(call: Callable[[], object], message: str) -> None:
    with pytest.raises(tachk.UsageError) as caught:
        call()
    assert str(caught.value).startswith(message)


def test_lists_of_queries() -> None:
    asked = ["E<> P.B", "A[] n < 2"]
    assert [verdict.answer for verdict in ASK.verify(asked)] == [verdict.answer for verdict in MODEL.verify(*asked)]
    assert len(ASK.verify(asked[0], asked)) == 3
    assert len(ASK.estimate(["Pr[<=9](<> P.B)"], runs=10)) == 1


@pytest.mark.parametrize(
    "over", [{"C": (0, 10)}, {"C": range(11)}, {"C": "0..10"}, "C=0..10", ["C=0..10"], {"C": [0, 10]}]
)
def test_ranges_of_a_parameter_that_is_mined(over: Any, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("time,x\n0,1\n5,2\n9,2\n")
    for traces in (str(log), log, [log]):
        assert tachk.mine("F[0,C] x > 1", traces, over).value == 5


def test_what_python_says_stays() -> None:
    with pytest.raises(TypeError, match="unexpected keyword argument 'querie'"):
        ASK.verify(querie="E<> P.B")
    with pytest.raises(TypeError, match="missing 1 required"):
        TACHK.load()


def test_values_of_enumerations_and_single_names_will_do_as_options() -> None:
    options = TACHK.Options(engine="smt", order="bfs", without="symmetry")
    assert options.engine is tachk.Engine.SMT
    assert options.order is tachk.SearchOrder.BFS
    assert options.without == {"symmetry"}
    assert [verdict.strategy for verdict in ASK.verify("A[] n < 2", options=TACHK.Options(engine="smt"))] == ["smt"]


def test_reports_have_no_truth_value_that_would_always_be_true() -> None:
    with pytest.raises(TypeError, match=r"report\.met"):
        bool(ASK.verify("A[] n < 1"))
    with pytest.raises(TypeError, match=r"report\.truth"):
        bool(TACHK.monitor("F x > 1", {"time": [0, 1], "x": [0, 0]}))


def test_results_are_short_and_name_what_they_have() -> None:
    (verdict,) = MODEL.verify("E<> P.B")
    assert verdict.name == "q1"
    run = MODEL.verify("E<> P.B").run("q1")
    assert [repr(each) for each in run.steps] == ["<Step after 3: P: A → B>"]
    assert [repr(each) for each in run.states] == ["<State at 0: P.A>", "<State at 3: P.B>"]
    drawn = TACHK.simulate(MODEL, until=9)[0]
    with pytest.raises(KeyError, match=r"'p'; there are .*'P'"):
        drawn["p"]
    asked = ["Pr[<=9](<> P.B)", "Pr[<=9](<> P.B) >= 0.5", "E[<=9;50](max: n)", "simulate[<=9;2]{n}"]
    found = [repr(each) for each in MODEL.estimate(*asked)]
    assert [text.split(":")[0] for text in found] == ["<Estimated q1", "<Decided q2", "<Mean q3", "<DrawnRuns q4"]
    assert max(map(len, found)) < 60
