"""Traps in certificates: each condition of the proof that no run leaves them, and what may be left out for them."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tachk
from tachk.engine.options import Options
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.certificate import CertificateWriter, MalformedCertificateError, read_certificates
from tachk.meaning.judge.trap import FOR_EVER, Trap, common, complement, times_of, union
from tachk.meaning.judge.trap_proof import TrapProof
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.verify.certificates import Checker, Proof, check_proof, find_proof
from tests.support.certificates_with_traps import blocks_without, claimed
from tests.unit.meaning.judge.proofs import judged, proved, written

TWO = """
clock g; int[0, 3] n; chan s;
process P() {
    clock x;
    init location a { to b { guard x <= 1; } to c { guard g > 5 && x > 5; } }
    location b { invariant x <= 4; to c { guard x >= 2; assign x = 0; } to d { guard x < 2; sync s?; assign n = 3; } }
    location c { to c { assign x = 0; } }
    location d;
}
process Q() {
    init location e { to f { guard g >= 2 && n < 3; assign n = n + 1; } }
    location f { to e { sync s!; assign g = 0; } }
}
system P, Q;
"""
P, Q, N = 0, 1, 3  # numbers of the discrete state: locations, then the slots of g, n, s, P.x
G, X = 1, 2  # clocks
LEADS_OUT = "what it says that no run leaves is not so: an edge, or time, leads out of it"
MISSING = "a successor is not in the set"
START = "the initial state is not in the set"


ALL = (0, FOR_EVER)


def anywhere(slot: int, *values: int) -> Trap:
    """Outside of it the slot has one of these values."""
    return Trap(slot, 0, tuple((value, *ALL) for value in values))


def proof_of(query: str = "E<> P.c", text: str = TWO) -> TrapProof:
    loaded = tachk.loads(f"{text} property q : {query};")
    target = loaded.properties[0].target
    assert target is not None
    return TrapProof(prepare(loaded.network), target)


@pytest.mark.parametrize(
    "trap",
    [
        Trap(P, X, ((0, 0, 2), (1, 0, 8))),
        Trap(P, X, ((0, 0, 2), (1, 9, FOR_EVER))),  # beyond its invariant
        Trap(P, X, ((0, 0, 3),)),  # with more than that may reach
        Trap(P, X, ((0, *ALL), (1, 4, 8), (1, 0, 3))),
        Trap(P, X, ()),
        anywhere(P, 0, 1),
        anywhere(P),
        anywhere(Q),
        anywhere(N, 0),
        anywhere(N, 0, 1),
    ],
)
def test_what_no_run_leaves(trap: Trap) -> None:
    assert proof_of().objection_to(trap) is None


EDGE, LATER, OWNER = "an edge leads out of it", "an edge, or time, leads out of it", "another process sets the clock"


@pytest.mark.parametrize(
    ("trap", "reason"),
    [
        (anywhere(P, 2), LATER),
        (anywhere(P, 0, 2), LATER),
        (Trap(P, X, ((0, 4, FOR_EVER),)), LATER),  # by waiting
        (Trap(P, X, ((0, *ALL), (1, 4, 8))), LATER),
        (Trap(P, X, ((0, 0, 1), (1, 0, 8))), LATER),  # the edge is possible at 1
        (Trap(P, X, ((0, 0, 2), (1, 0, 8), (2, 0, 0))), LATER),  # by setting the clock in c
        (Trap(P, G, ((0, *ALL),)), OWNER),
        (anywhere(Q, 1), LATER),
        (anywhere(N, 3), EDGE),
        (anywhere(N, 0, 2), EDGE),
        (Trap(N, X, ((0, *ALL),)), "a clock goes with a process"),
        (Trap(N, 0, ((0, 0, 4),)), "it has times and no clock"),
        (anywhere(N, 4), "it has other values than the slot"),
        (anywhere(P, 4), "it has other values than the slot"),
        (anywhere(99, 0), "there is no such slot or clock"),
        (Trap(P, 9, ()), "there is no such slot or clock"),
    ],
)
def test_what_some_run_leaves_is_no_trap(trap: Trap, reason: str) -> None:
    assert proof_of().objection_to(trap) == reason


def test_the_guard_of_a_receiver_says_nothing_of_its_update() -> None:
    """The sender sets n before the receiver copies it."""
    text = """
    int[0, 3] n = 1; chan s;
    process P() { init location a { to a { sync s!; assign n = 0; } } }
    process Q() { init location a { to a { guard n >= 1; sync s?; assign n = n == 0 ? 3 : 1; } } }
    system P, Q;
    """
    assert proof_of("E<> n == 3", text).objection_to(anywhere(2, 3)) == EDGE


def test_no_time_passes_in_an_urgent_location() -> None:
    trap = Trap(P, X, ((0, 1, FOR_EVER), (1, *ALL)))
    assert proof_of(text=TWO.replace("x <= 1;", "x >= 1;")).objection_to(trap) == LATER
    urgent = TWO.replace("init location a", "init urgent location a").replace("x <= 1;", "x >= 1;")
    assert proof_of(text=urgent).objection_to(trap) is None


@pytest.mark.parametrize(
    ("query", "trap", "is_out_of_reach"),
    [
        ("E<> P.b && P.x >= 2", Trap(P, X, ((1, 4, FOR_EVER),)), True),
        ("E<> P.b && P.x > 1", Trap(P, X, ((1, 4, FOR_EVER),)), False),
        ("E<> P.b && P.x >= 2 && Q.f", Trap(P, X, ((1, 4, FOR_EVER),)), True),
        ("E<> P.b && P.x >= 2 || Q.f", Trap(P, X, ((1, 4, FOR_EVER),)), False),
        ("E<> P.b && (P.x >= 3 || n == 1 && P.x >= 2)", Trap(P, X, ((1, 4, FOR_EVER),)), True),
        ("E<> !(P.a || P.x < 2 || P.c || P.d)", Trap(P, X, ((1, 4, FOR_EVER),)), True),
        ("E<> P.b", anywhere(P, 1), True),
        ("E<> P.b", anywhere(P, 0), False),
        ("E<> n == 2", anywhere(N, 2), True),
        ("E<> n >= 2", anywhere(N, 2), False),
        ("E<> n >= 2 && n < 3", anywhere(N, 2), True),
        ("E<> g > 3", anywhere(N), False),
        ("E<> deadlock && n == 2", anywhere(N, 2), True),
        ("E<> deadlock", anywhere(N, 2), False),
        ("E<> 1 / (n - 1) == 1 && P.b", anywhere(P, 1), False),
    ],
)
def test_where_the_goal_is_out_of_reach(query: str, trap: Trap, is_out_of_reach: bool) -> None:
    proof = proof_of(query)
    assert (proof.objection is None and proof.clauses([trap]) == ((0,),)) is is_out_of_reach


def test_each_disjunct_and_each_process_that_may_fail_has_a_clause() -> None:
    traps = [anywhere(P, 2), anywhere(N, 1), Trap(Q, 0, ((0, *ALL),)), anywhere(Q, 1)]
    assert proof_of("E<> P.c && n == 1 || n == 1 && Q.f").clauses(traps) == ((0, 1), (1, 3))
    failing = TWO.replace("guard g >= 2 && n < 3;", "guard g >= 2;")
    assert proof_of("E<> P.c && n == 1", failing).clauses(traps) == ((0, 1), (2,))
    assert proof_of("E<> P.c && n == 1", failing).clauses(traps[:2]) == ()
    dividing = TWO.replace("location f {", "location f { invariant 2 / n >= 0;")
    assert proof_of("E<> P.c && n == 1", dividing).clauses(traps) == ()
    assert proof_of("E<> P.c && n == 1", dividing).clauses([*traps, anywhere(Q, 0, 1)]) == ((0, 1, 4), (4,))


# ---- certificates ---------------------------------------------------------------------------------------------------


def reason(query: str, *traps: Trap, text: str = TWO) -> str | None:
    """What the checkers say to a certificate that leaves out all that is in some trap."""
    loaded = tachk.loads(f"{text} property q : {query};")
    certificate = claimed(loaded.network, loaded.properties[0], traps)
    assert not isinstance(certificate, str), certificate
    found = judged(loaded.network, loaded.properties[0], certificate)
    return found and found.reason


MOMENT = Trap(P, X, ((0, 0, 2), (1, 0, FOR_EVER)))


def test_what_is_left_out() -> None:
    assert reason("E<> P.b && P.x > 4", MOMENT) is None
    assert reason("E<> P.b && P.x > 4 || P.b && P.x > 7 && n == 2", MOMENT) is None
    missing = "a successor is not in the set"
    assert reason("E<> P.c && P.x < 1", MOMENT) == missing
    assert reason("E<> P.b && P.x > 4 || P.c && n == 3 && P.x > 9", MOMENT) == missing
    late = reason("E<> P.b && P.x > 4", Trap(P, X, ((1, *ALL),)))
    assert late is not None and late.startswith("what it says that no run leaves")


def test_each_clause_counts() -> None:
    """In the first trap one disjunct is out of reach, but the other one only in the second trap."""
    loaded = tachk.loads(f"{TWO} property q : E<> P.b && P.x > 4 || n == 0 && g > 2 && g < 2;")
    traps = [MOMENT, anywhere(N, 0)]
    both, one = (claimed(loaded.network, loaded.properties[0], traps, each) for each in (((0,), (1,)), ((0,),)))
    assert not isinstance(both, str) and not isinstance(one, str)
    assert judged(loaded.network, loaded.properties[0], both) is None
    found = judged(loaded.network, loaded.properties[0], one)
    assert found is not None and found.reason == "a successor is not in the set"


def test_an_error_behind_what_is_left_out() -> None:
    """Q comes to f without end, which raises n each time."""
    failing = TWO.replace("guard g >= 2 && n < 3;", "guard g >= 2;").replace("to e { sync s!;", "to e {")
    assert reason("E<> P.b && P.x > 4", MOMENT, text=TWO) is None
    loaded = tachk.loads(f"{failing} property q : E<> P.b && P.x > 4;")
    assert isinstance(find_proof(loaded.network, "", loaded.properties[0]), str)
    certificate = claimed(loaded.network, loaded.properties[0], [MOMENT, anywhere(Q, 1), anywhere(N, 0)])
    assert isinstance(certificate, str) or judged(loaded.network, loaded.properties[0], certificate) is not None


def moments() -> tuple[Network, Query, Proof]:
    loaded = tachk.loads(f"{TWO} property q : E<> P.b && P.x < 2 && Q.f && g > 3;")
    return loaded.network, loaded.properties[0], proved(loaded.network, loaded.properties[0])


def test_a_proof_carries_the_traps_that_it_needs() -> None:
    network, query, proof = moments()
    assert proof.header.traps
    assert judged(network, query, written(proof)) is None
    without = replace(proof, header=replace(proof.header, traps=()))
    found = judged(network, query, written(without))
    assert found is not None and found.reason == "a successor is not in the set"
    needed = [judged(network, query, written(proof, blocks_without(proof, n))) for n in range(proof.states)]
    assert None not in needed
    whole = proved(network, query, Options().off("pruning"))
    assert not whole.header.traps and whole.zones > proof.zones


def test_a_zone_that_is_empty_is_not_read_even_if_nothing_needs_it() -> None:
    network, query, proof = moments()
    (columns,) = proof.columns()
    clocks = len(proof.header.clocks) + 1
    for places, bounds in (([clocks, 1], [3, -9]), ([clocks + 1], [-1])):  # x <= 1 and x >= 5; x - x <= -1
        wrong = replace(
            columns,
            constraints=np.append(columns.constraints, len(places)),
            places=np.append(columns.places, places),
            bounds=np.append(columns.bounds, bounds),
        )
        stream = io.BytesIO()
        CertificateWriter(stream).write_columns(proof.header, [wrong])
        stream.seek(0)
        (certificate,) = read_certificates(stream)
        for checker in Checker:
            with pytest.raises(MalformedCertificateError, match="a zone is empty"):
                check_proof(network, query, certificate, checker)


def test_files_of_the_version_before_have_no_traps() -> None:
    network, query, proof = moments()
    for each, is_proof in ((proof, False), (proved(network, query, Options().off("pruning")), True)):
        stream = io.BytesIO()
        CertificateWriter(stream).write(each.header, each.blocks())
        former = stream.getvalue().replace(b"tachk certificate 4", b"tachk certificate 3", 1)
        (certificate,) = read_certificates(io.BytesIO(former))
        assert certificate.header.traps == ()
        assert (judged(network, query, certificate) is None) is is_proof


@pytest.mark.parametrize(
    "wrong",
    [
        {"slot": -1, "clock": 0, "outside": []},
        {"slot": 0, "clock": 0.5, "outside": []},
        {"slot": 0, "clock": 0, "outside": [[0, 3, 2]]},
        {"slot": 0, "clock": 0, "outside": [[0, -1, None]]},
        {"slot": 0, "clock": 0, "outside": [[0, None, None]]},
        {"slot": 0, "clock": 0, "outside": [[0, 0]]},
        {"slot": 0, "clock": 0, "outside": [[0, 0, 1 << 50]]},
        {"slot": 0, "clock": 0},
    ],
)
def test_what_no_file_says(wrong: dict[str, Any]) -> None:
    with pytest.raises((ValueError, KeyError, TypeError)):
        Trap.from_json(wrong)


def test_traps_are_read_as_they_are_written() -> None:
    for trap in (MOMENT, anywhere(N, 0, 3), Trap(P, X, ())):
        assert Trap.from_json(trap.to_json()) == trap


def test_what_all_runs_meet_has_no_traps() -> None:
    loaded = tachk.loads(f"{TWO} property q : A<> P.x > 1 || g > 0;")
    (query,) = loaded.properties
    proof = proved(loaded.network, query)
    wrong = written(replace(proof, header=replace(proof.header, traps=(MOMENT,))))
    for checker in Checker:
        with pytest.raises(MalformedCertificateError, match="only in proofs that something is not reached"):
            check_proof(loaded.network, query, wrong, checker)


def test_points_of_time() -> None:
    assert times_of([[(1, 0, 9), (0, 1, -4)], [(1, 0, 0)], [(2, 0, 3)]], 1) == ((0, FOR_EVER),)
    assert times_of([[(1, 0, 9), (0, 1, -4)]], 1) == ((5, 8),)
    assert times_of([], 0) == ()
    assert complement(((2, 3), (5, FOR_EVER))) == ((0, 1), (4, 4))
    assert complement(()) == ((0, FOR_EVER),)
    assert common(((0, 4), (7, 9)), ((3, 7),)) == ((3, 4), (7, 7))
    assert union([((4, 6),), ((0, 3), (9, 9))]) == ((0, 6), (9, 9))
