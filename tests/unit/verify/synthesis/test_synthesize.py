"""What is asked, what is refused, what limits leave, and what evidence there is."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk import Answer, InputError, Limits, Options, UnsupportedError, UsageError, loads
from tachk.formats.network_json.digest import digest
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.certificate import read_certificates
from tachk.meaning.judge.replay import replay
from tachk.verify.certificates import Checker, check_proof
from tachk.verify.synthesis import cells
from tachk.verify.synthesis.bounds_of_parameters import NoBound, ParameterBound
from tachk.verify.synthesis.cells import proof_again, proof_of
from tachk.verify.synthesis.parameters import VariedConstant, parameters_from
from tachk.verify.synthesis.region import CellEvidence

MODEL = """
const int A = 1;
const int B = 1;
const bool ON = true;
chan c;
process P() {
    clock x;
    init location s { invariant x <= A; to t { guard x >= B && ON; } }
    location t;
}
system P;
property never : A[] not P.t;
property ever : E<> P.t;
property quick : F[0, B] P.t;
property eventually : A<> P.t;
"""


def test_ranges_are_read() -> None:
    assert parameters_from(["A=1..5, B=-3..9:4", "C=7"]) == (
        VariedConstant("A", 1, 5),
        VariedConstant("B", -3, 9, 4),
        VariedConstant("C", 7, 7),
    )
    assert list(VariedConstant("B", -3, 9, 4).values) == [-3, 1, 5, 9]


@pytest.mark.parametrize(
    "text", ["A", "A=", "A=1-5", "A=1..", "A=5..1", "A=1..5:0", "A=1..2,A=1..2", "A=0..2000000", ""]
)
def test_other_ranges_are_rejected(text: str) -> None:
    with pytest.raises(UsageError):
        parameters_from([text])


def test_unknown_names_are_rejected() -> None:
    model = loads(MODEL)
    with pytest.raises(UsageError):
        model.synthesize(over="Z=1..2", property="never")
    with pytest.raises(UsageError):
        model.synthesize(over="A=1..2", property="nothing")
    with pytest.raises(UsageError):
        model.synthesize(over="A=1..2")
    with pytest.raises(InputError):
        model.synthesize("A[] P.u", over="A=1..2")


def test_queries_and_answers_of_all_kinds() -> None:
    model = loads(MODEL)
    assert model.synthesize("A[] not P.t", over="A=1..4,B=1..4").inequalities == "A < B"
    assert model.synthesize(property="ever", over="A=1..4,B=1..4").inequalities == "B <= A"
    failing = model.synthesize(property="never", over="A=1..4,B=1..4", answer=Answer.FAILS)
    assert failing.inequalities == "B <= A"
    assert len(failing.region.holding) == 10
    assert model.synthesize(property="ever", over="ON=0..1").region.holding == ((1,),)


def test_what_happens_eventually_is_tried_value_by_value() -> None:
    model = loads(MODEL)
    found = model.synthesize(property="eventually", over="A=1..3,B=1..3")
    assert [cell.answer for cell in found.region.cells] == [
        model_answer(A=a, B=b) for a in range(1, 4) for b in range(1, 4)
    ]
    assert found.region.searched == 9
    assert "explored" in found.to_text(every_corner=True)


def model_answer(**values: int) -> Answer:
    return loads(MODEL, **values).verify(property="eventually")[0].answer


def test_a_bound_of_a_formula_is_tried_value_by_value() -> None:
    region = loads(MODEL).synthesize(property="quick", over="A=1..3,B=1..3").region
    assert region.bounds[0] is ParameterBound.UPPER
    assert isinstance(region.bounds[1], NoBound)
    assert region.searched + sum(cell.evidence is not CellEvidence.SEARCH for cell in region.cells) == 9


def test_a_query_that_cannot_be_decided_is_rejected_once() -> None:
    text = MODEL.replace("chan c;", "urgent chan c;").replace("&& ON; }", "&& ON; sync c!; }")
    text = text.replace("system P;", "process Q() { init location s { to s { sync c?; } } }\nsystem P, Q;")
    with pytest.raises(UnsupportedError):
        loads(text).synthesize(property="never", over="A=1..2")


def test_values_that_make_the_model_wrong_are_unknown() -> None:
    region = loads(MODEL).synthesize(property="never", over="A=-2..2,B=1..2").region
    assert [cell.values[0] for cell in region.unknown] == [-2, -2, -1, -1]
    assert "initial state" in region.unknown[0].reason
    with pytest.raises(InputError):
        loads(MODEL).synthesize(property="never", over="A=-3..-1")


def test_limits_leave_cells_unknown() -> None:
    region = loads(MODEL).synthesize(property="never", over="A=1..3,B=1..3", limits=Limits(depth=0)).region
    assert any(cell.reason == "depth limit" for cell in region.unknown)
    none = loads(MODEL).synthesize(property="never", over="A=1..3,B=1..3", limits=Limits(seconds=0)).region
    assert {cell.reason for cell in none.cells} == {"time limit"}


def test_ctrl_c_keeps_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def interrupted(*arguments: object, **named: object) -> object:
        asked.append(arguments)
        if len(asked) == 4:
            raise KeyboardInterrupt
        return answers(*arguments, **named)  # type: ignore[arg-type]

    answers = cells.answers
    monkeypatch.setattr(cells, "answers", interrupted)
    region = loads(MODEL).synthesize(property="never", over="A=1..3,B=1..3", infer=False, reuse=False).region
    assert region.interrupted
    assert len(asked) == 4
    assert sum(cell.evidence is CellEvidence.SEARCH for cell in region.cells) == 3
    assert {cell.reason for cell in region.unknown} == {"interrupted"}


def test_a_run_is_used_again_at_other_times() -> None:
    model = loads(MODEL)
    region = model.synthesize(property="ever", over="A=1..4,B=1..4", infer=False).region
    again = [cell for cell in region.cells if cell.evidence is CellEvidence.RUN]
    assert len(again) == 9
    for cell in again:
        assert cell.verdict is not None
        assert cell.verdict.trace is not None
        replay(prepare(loads(MODEL, A=cell.values[0], B=cell.values[1]).network), cell.verdict.trace)
        assert cell.verdict.trace.steps[0].delay == cell.values[1]
    alone = model.synthesize(property="ever", over="A=1..4,B=1..4", infer=False, reuse=False).region
    assert [cell.answer for cell in alone.cells] == [cell.answer for cell in region.cells]
    assert alone.searched == 16


def test_a_run_of_a_formula_is_used_again_with_its_observer() -> None:
    region = loads(MODEL).synthesize("F[0, 2] P.t", over="A=3..6,B=3..6", infer=False).region
    assert {cell.answer for cell in region.cells} == {Answer.FAILS}
    assert sum(cell.evidence is CellEvidence.RUN for cell in region.cells) >= 10


def test_a_run_is_not_used_where_its_edges_do_not_exist() -> None:
    text = """
    const int N = 1;
    int[0, 9] n = 0;
    process P() { init location s { to t { select i : int[0, N]; guard i >= 2; assign n = i; } } location t; }
    system P;
    property ever : E<> P.t;
    """
    region = loads(text).synthesize(property="ever", over="N=0..5").region
    assert [cell.answer is Answer.HOLDS for cell in region.cells] == [False, False, True, True, True, True]
    region = loads(text.replace("int[0, N]", "int[0, 5 - N]")).synthesize(property="ever", over="N=0..5").region
    assert [cell.answer is Answer.HOLDS for cell in region.cells] == [True, True, True, True, False, False]


def test_a_certificate_is_used_again_and_both_checkers_accept_it(tmp_path: Path) -> None:
    found = loads(MODEL).synthesize(property="never", over="A=1..4,B=1..6", infer=False, certify=True)
    again = [cell for cell in found.region.cells if cell.evidence is CellEvidence.CERTIFICATE]
    assert len(again) >= 3
    plain = loads(MODEL).synthesize(property="never", over="A=1..4,B=1..6", infer=False)
    assert [cell.answer for cell in found.region.cells] == [cell.answer for cell in plain.region.cells]
    paths = found.certificates(tmp_path / "proofs")
    assert [path.name for path in paths] == [f"A={a},B={a + 1}.cert" for a in range(1, 5)]
    for path, corner in zip(paths, (c for c in found.corners if c.answer is Answer.HOLDS), strict=True):
        model = loads(MODEL, A=corner.values[0], B=corner.values[1])
        with path.open("rb") as stream:
            (certificate,) = read_certificates(stream)
            assert certificate.header.model == digest(model.network)
            for checker in Checker:
                assert check_proof(model.network, model.properties[0], certificate, checker) is None


def test_a_certificate_that_does_not_hold_here_is_not_used() -> None:
    model, other = loads(MODEL, A=1, B=4), loads(MODEL, A=5, B=4)
    proof = proof_of(model.network, model.verify(property="never")[0], Options(), Limits())
    assert proof is not None
    assert proof_again(model.network, model.properties[0], proof) is not None
    assert proof_again(other.network, other.properties[0], proof) is None
    larger = loads(MODEL.replace("clock x;", "clock x, y;"), A=1, B=4)
    assert proof_again(larger.network, larger.properties[0], proof) is None


def test_corners_have_evidence_of_their_own() -> None:
    region = loads(MODEL).synthesize(property="never", over="A=1..9,B=1..9").region
    assert region.searched < 30
    corners = {cell.values: cell for cell in region.corners}
    assert set(corners) == {(a, a) for a in range(1, 10)} | {(a, a + 1) for a in range(1, 9)}
    for (a, b), cell in corners.items():
        assert cell.verdict is not None
        assert (cell.verdict.trace is not None) is (a >= b)
