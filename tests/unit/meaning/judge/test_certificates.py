"""Certificates: what the search claims is confirmed by both checkers, and what is not closed is rejected by both."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from random import Random

import jsonschema
import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.words import QueryKind
from tachk.cli.commands.certify import CertifyArguments, run_certify
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting, RunReporting
from tachk.cli.verification import VerifyArguments, run_verify
from tachk.engine.options import Limits, Options
from tachk.meaning.judge.certificate import (
    CertificateWriter,
    Columns,
    MalformedCertificateError,
    Shapes,
    StateBlock,
    decoded,
    encoded,
    read_certificates,
)
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.report.certificate_report import Judgement, judgement_lines, judgements_to_json
from tachk.verify import certificates
from tachk.verify.certificates import Checker, Proof, check_proof, find_proof, is_provable, widened_proof
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support.seeds import seeds
from tests.unit.meaning.judge.proofs import MODELS, PLAIN, judged, proved, written

pytestmark = pytest.mark.drawn

WHOLE = Options().off("pruning")
"""A certificate lists all reachable states then."""

SCHEMA = Path(__file__).parents[4] / "docs" / "schema" / "certify.schema.json"


def tightened(random: Random, proof: Proof) -> Iterator[StateBlock]:
    """The blocks with some of the constraints a bit tighter."""
    for block in proof.blocks():
        changes = np.array([random.choice([0, 0, 0, 1, 2]) for _ in block.bounds], np.int64)
        yield replace(block, bounds=block.bounds - changes)


SHAPES = [
    Shape(),
    Shape(priorities=True, clocks=2),
    Shape(copies=0.5, clocks=2),
    Shape(stopwatches=True, clocks=2),
    Shape(diagonals=True, exact=0.3, clocks=2),
    Shape(language=True, faults=0.3, clocks=2),
    Shape(copies=0.5, stopwatches=True, clocks=2),
]


@pytest.mark.parametrize("seed", seeds(range(35)))
def test_random_networks(seed: int) -> None:
    case = random_case(Random(seed), SHAPES[seed % len(SHAPES)])
    for number, predicate in enumerate(case.predicates):
        query = Query(f"q{number}", QueryKind.POSSIBLY, predicate)
        (verdict,) = verify(case.network, [query], limits=Limits(states=5_000), trace=False)
        proof = find_proof(case.network, "digest", query, limits=Limits(states=5_000))
        assert isinstance(proof, Proof) is (verdict.answer is Answer.FAILS)
        if isinstance(proof, Proof) and proof.zones <= 150:
            assert judged(case.network, query, written(proof)) is None
            with suppress(MalformedCertificateError):  # of an empty zone
                judged(case.network, query, written(proof, tightened(Random(seed), proof)))


LIVE_SHAPES = [
    Shape(),
    Shape(priorities=True, clocks=2),
    Shape(stopwatches=True, deadlocks=False, clocks=2),
    Shape(language=True, faults=0.3, clocks=2),
    Shape(copies=0.5, processes=2, locations=3),
    Shape(processes=2, locations=3),
    Shape(copies=0.5, stopwatches=True, deadlocks=False, clocks=2),
]


@pytest.mark.parametrize("seed", seeds(range(21)))
def test_what_each_run_meets_in_random_networks(seed: int) -> None:
    case = random_case(Random(seed), LIVE_SHAPES[seed % len(LIVE_SHAPES)])
    first, second, _ = case.predicates
    for query in (
        Query("met", QueryKind.EVENTUALLY, first),
        Query("kept", QueryKind.POTENTIALLY_ALWAYS, second),
        Query("answered", QueryKind.LEADS_TO, first, (second,)),
    ):
        (verdict,) = verify(case.network, [query], limits=Limits(states=1_000), trace=False)
        proof = find_proof(case.network, "digest", query, limits=Limits(states=1_000))
        if isinstance(proof, Proof):
            assert is_provable(verdict)
            if proof.zones <= 100:
                assert judged(case.network, query, written(proof)) is None
        else:
            assert not is_provable(verdict) or "limit" in proof


def test_updates_come_one_after_the_other_where_an_action_of_higher_priority_is_possible() -> None:
    loaded = tachk.loads(
        """clock x, y; broadcast chan low, high; chan priority low < high;
        process P() { init location A { to C { sync high!; assign x = 0, y = x; } } location C { invariant y <= 2; } }
        process Q() { init location A { to B { sync low!; } } location B {} }
        p = P(); q = Q(); system p, q;
        property first : A[] !(p.A && q.B);"""
    )
    (query,) = loaded.properties
    assert judged(loaded.network, query, written(proved(loaded.network, query))) is None


COUNTER = """
clock x; int[0, 3] n;
process Counter() {
    init location count {
        invariant x <= 2;
        to count { guard x >= 1 && n < 3; assign n = n + 1, x = 0; }
        to done { guard n == 3; }
    }
    location done { invariant x <= 9; to done { guard x >= 9; assign x = 0; } }
}
system Counter;
property met : A<> Counter.done;
property answered : n == 1 --> Counter.done;
property kept : E[] Counter.count expect fails;
"""


def counter(name: str, model: str = COUNTER) -> tuple[Network, Query]:
    loaded = tachk.loads(model)
    (query,) = (query for query in loaded.properties if query.name == name)
    return loaded.network, query


@pytest.mark.parametrize(("name", "proves"), [("met", "holds"), ("answered", "holds"), ("kept", "fails")])
def test_what_each_run_meets(name: str, proves: str) -> None:
    network, query = counter(name)
    certificate = written(proved(network, query))
    assert judged(network, query, certificate) is None
    assert Judgement(network, query, certificate, Checker.PYTHON, "", None, 0.0).proved == proves


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("n = n + 1, x = 0", "n = n == 1 ? 1 : n + 1, x = 0", "a successor is not in the set"),  # counts for ever
        ("invariant x <= 2;", "", "time can pass for ever, and the goal is not met"),
        ("guard n == 3", "guard n == 3 && x < 0", "nothing can happen any more in some state, and the goal is not met"),
    ],
)
@pytest.mark.parametrize("name", ["met", "answered", "kept"])
def test_ranks_prove_nothing_where_a_run_goes_on_without_the_goal(name: str, old: str, new: str, reason: str) -> None:
    """The certificate of a model that meets the goal, without any constraint, offered for one that need not."""
    network, query = counter(name)
    proof = proved(network, query)
    (block,) = proof.blocks()
    none = np.zeros(0, np.int64)
    wide = replace(block, constraints=np.zeros_like(block.constraints), places=none, bounds=none)
    certificate = written(proof, iter([wide]))
    assert judged(network, query, certificate) is None
    wrong, same = counter(name, COUNTER.replace(old, new))
    assert isinstance(find_proof(wrong, "digest", same), str)
    found = judged(wrong, same, certificate)
    assert found is not None and found.reason == reason


@pytest.mark.parametrize("name", ["met", "answered"])
def test_a_rank_must_not_grow(name: str) -> None:
    network, query = counter(name)
    proof = proved(network, query)
    (block,) = proof.blocks()
    same = replace(block, ranks=np.minimum(block.ranks, 1))
    found = judged(network, query, written(proof, iter([same])))
    assert found is not None and found.reason == "a successor is not in the set"
    turned = replace(block, ranks=np.where(block.ranks > 0, block.ranks.max() + 1 - block.ranks, 0))
    assert judged(network, query, written(proof, iter([turned]))) is not None


TIMED = """
clock x, y;
process P() {
    init location a { invariant x <= 5; to b { guard x >= 3; assign x = 0; } }
    location b { invariant x <= 4; to a { guard x >= 4; assign x = 0; } to c { guard x >= 2; } }
    location c { invariant y <= 20; }
}
system P;
property dwells : A<> P.b && x >= 2;
property passes : A<> y >= 1 && y < 2;
property answered : P.a && x > 3 --> P.b && x >= 1 && x < 2;
property ends : P.c --> deadlock;
property goes_on : P.a --> !deadlock && P.b;
property kept : E[] x < 3 expect fails;
"""


@pytest.mark.parametrize("name", ["dwells", "passes", "answered", "ends", "goes_on", "kept"])
def test_what_each_run_meets_may_be_one_of_clocks_or_deadlock(name: str) -> None:
    network, query = counter(name, TIMED)
    assert judged(network, query, written(proved(network, query))) is None


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("dwells", "guard x >= 2", "guard x >= 1"),  # b can be left before
        ("dwells", "invariant x <= 4;", "invariant x < 2;"),  # and time stops before
        (
            "passes",
            "system P;",
            "process Q() { init location r { to s { assign y = 2; } } location s { } } system P, Q;",
        ),
        ("answered", "guard x >= 3;", "guard x >= 2;"),
        ("answered", "guard x >= 2", "guard x >= 0"),
        ("ends", "invariant y <= 20;", "invariant y <= 20; to c { guard y == 20; assign y = 0; }"),
        ("goes_on", "to c { guard x >= 2; }", "to c { guard x >= 2; } to b { guard x >= 3; assign x = 1; }"),
        ("kept", "guard x >= 3; assign x = 0;", "guard x >= 2; assign x = 0;"),
    ],
)
def test_ranks_about_clocks_prove_nothing_about_another_model(name: str, old: str, new: str) -> None:
    """Both checkers say what the search says of the changed model: a proof of the first one shows nothing where it is
    not one of the second."""
    network, query = counter(name, TIMED)
    proof = proved(network, query)
    assert old in TIMED
    changed_network, same = counter(name, TIMED.replace(old, new))
    (verdict,) = verify(changed_network, [same], trace=False)
    if len(changed_network.processes) == len(network.processes):
        assert (judged(changed_network, same, written(proof)) is None) <= is_provable(verdict)
    else:
        assert isinstance(find_proof(changed_network, "digest", same), str) is not is_provable(verdict)


BEHIND = """
clock y;
process P() {
    init location a { invariant y <= 1; to b { } }
    location b { }
}
system P;
property met : A<> P.b && y >= 1 && y < 2;
"""


def test_a_run_may_pass_the_goal_by() -> None:
    """What is reached lies before the goal, in it and behind it; only what lies before is in the set."""
    network, query = counter("met", BEHIND)
    proof = proved(network, query)
    (block,) = proof.blocks()
    at_a, at_b = (int(np.flatnonzero(block.discretes[:, 0] == location)[0]) for location in (0, 1))
    assert block.zones.tolist() == [1, 1]
    first = np.concatenate(([0], np.cumsum(block.constraints)))
    of_b = slice(first[at_b], first[at_b + 1])
    counts = block.constraints.copy()
    counts[at_a] = 0
    wide = replace(block, constraints=counts, places=block.places[of_b], bounds=block.bounds[of_b])
    certificate = written(proof, iter([wide]))
    assert judged(network, query, certificate) is None
    late, same = counter("met", BEHIND.replace("y <= 1", "y <= 3"))
    found = judged(late, same, certificate)
    assert found is not None and found.reason == "a successor is not in the set"


HURRIED = """
urgent chan u;
process T(const int[0, 2] me) {
    clock x;
    init location a { to b { sync u?; } }
    location b { to c { guard x == 2; } }
    location c { }
}
process S() { init location idle { to idle { sync u!; } } }
A = T(0); B = T(1); C = T(2); s = S();
system A, B, C, s;
property unhurried : E<> (A.c || B.c || C.c) && (A.a || B.a || C.a);
"""


def test_time_stands_still_in_states_that_exchanges_lead_into_the_set() -> None:
    """The set has one of the states in which one process has moved; an urgent channel stops time in each of them."""
    loaded = tachk.loads(HURRIED)
    query = loaded.properties[0]
    proof = proved(loaded.network, query)
    assert proof.header.groups
    assert judged(loaded.network, query, written(proof)) is None


def fischer(**constants: int) -> tuple[Network, Query]:
    loaded = tachk.load(MODELS / "classics" / "fischer.ta", **{"N": 2, **constants})
    return loaded.network, loaded.properties[0]


def blocks_without(proof: Proof, group: int) -> Iterator[StateBlock]:
    """The blocks without the group of that number; each group has one zone."""
    (block,) = proof.blocks()
    assert (block.zones == 1).all()
    first = np.concatenate(([0], np.cumsum(block.constraints)))
    kept = np.arange(len(block.zones)) != group
    of_kept = np.r_[0 : first[group], first[group + 1] : first[-1]]
    yield StateBlock(
        block.discretes[kept],
        block.zones[kept],
        block.ranks[kept],
        block.constraints[kept],
        block.places[of_kept],
        block.bounds[of_kept],
    )


def test_every_element_is_needed() -> None:
    network, query = fischer()
    proof = proved(network, query, PLAIN)
    for group in range(proof.states):
        found = judged(network, query, written(proof, blocks_without(proof, group)))
        assert found is not None
    missing = judged(network, query, written(proof, blocks_without(proof, 0)))
    assert missing is not None and missing.reason == "the initial state is not in the set"


@pytest.mark.parametrize("change", [-1, -2])
def test_a_bound_may_not_be_tighter_not_even_strict(change: int) -> None:
    network, query = fischer()
    proof = proved(network, query, PLAIN)
    (block,) = proof.blocks()
    assert len(block.bounds) == 4
    for number in range(len(block.bounds)):
        bounds = block.bounds.copy()
        bounds[number] += change
        assert judged(network, query, written(proof, iter([replace(block, bounds=bounds)]))) is not None


def test_a_set_that_meets_the_predicate_is_rejected() -> None:
    """Closed sets there are for any model; they prove nothing if the bad states are in them."""
    network, query = fischer(WAIT=9)
    never = replace(query, predicate=query.predicate, kind=QueryKind.POSSIBLY, name="never")
    assert isinstance(find_proof(network, "digest", query), str)
    assert isinstance(find_proof(network, "digest", never), str)


def test_a_closed_set_proves_nothing_about_a_state_that_is_in_it() -> None:
    loaded = tachk.load(MODELS / "classics" / "fischer.ta", N=2)
    mutual_exclusion, enter, *_ = loaded.properties
    certificate = written(proved(loaded.network, mutual_exclusion, PLAIN))
    found = judged(loaded.network, enter, certificate)
    assert found is not None and found.reason == "some state of the zone is one that must not be reached"


def test_a_discrete_state_without_zones_covers_nothing() -> None:
    """Not even where the zones of the state told after it would."""
    network, query = fischer()
    proof = proved(network, query)
    (block,) = proof.blocks()
    assert (block.zones == 1).all()
    for group in range(1, proof.states):
        (less,) = blocks_without(proof, group)
        zones = np.insert(less.zones, group, 0)
        emptied = replace(less, discretes=block.discretes, zones=zones)
        assert judged(network, query, written(proof, iter([emptied]))) is not None


FAR = """
int[0, 1000] n;
process P() { init location a { to a { guard n < 512; assign n = n + 256; } } }
system P;
property few : A[] n <= 512;
"""


def test_values_that_take_more_than_a_byte() -> None:
    network, query = counter("few", FAR)
    proof = proved(network, query, WHOLE)
    assert proof.states == 3
    for group in range(3):
        assert judged(network, query, written(proof, blocks_without(proof, group))) is not None


TOLD = """
clock x;
broadcast chan tell;
process Sender() {
    init location a { invariant x <= 5; to b { sync tell!; assign x = 0; } }
    location b { }
}
process Receiver() {
    init location deaf { to heard { guard x >= 3; sync tell?; } }
    location heard { }
}
system Sender, Receiver;
property soon : A[] Sender.a imply x <= 5;
"""


def test_a_receiver_of_a_broadcast_under_a_clock_guard_may_also_stay_out() -> None:
    network, query = counter("soon", TOLD)
    proof = proved(network, query, WHOLE)
    assert proof.states == 3
    for group in range(3):
        assert judged(network, query, written(proof, blocks_without(proof, group))) is not None


STUCK = """
clock x;
process P() {
    init location a { invariant x <= 5; to b { guard x <= 3; } }
    location b { invariant x <= 9; to a { guard x >= 7; assign x = 0; } }
}
system P;
property bounded : A[] x <= 9;
property goes_on : A[] !deadlock;
"""


@pytest.mark.parametrize(("guard", "is_stuck"), [("guard x <= 3;", True), ("guard x >= 3;", False), ("", False)])
def test_a_state_is_stuck_where_nothing_is_possible_later(guard: str, is_stuck: bool) -> None:
    loaded = tachk.loads(STUCK.replace("guard x <= 3;", guard))
    bounded, goes_on = loaded.properties
    certificate = written(proved(loaded.network, bounded, WHOLE))
    assert judged(loaded.network, bounded, certificate) is None
    assert (judged(loaded.network, goes_on, certificate) is not None) is is_stuck


LATER = """
clock x;
process P() {
    init location a { invariant x <= 5; to a { guard x >= 5; assign x = 0; } }
}
system P;
property bounded : A[] x <= 5;
property early : E<> !deadlock && x < 5;
"""


def test_what_becomes_possible_in_another_zone_counts_for_deadlock() -> None:
    """A zone that ends just before the only transition is possible."""
    loaded = tachk.loads(LATER)
    bounded, early = loaded.properties
    proof = proved(loaded.network, bounded)
    (block,) = proof.blocks()
    parts = replace(
        block,
        zones=np.array([2]),
        ranks=np.array([0, 0]),
        constraints=np.array([1, 2]),
        places=np.array([2, 2, 1]),
        bounds=np.array([10, 11, -9]),
    )
    certificate = written(proof, iter([parts]))
    assert judged(loaded.network, bounded, certificate) is None
    assert judged(loaded.network, early, certificate) is not None


def test_where_the_goal_is_requested_there_must_be_ranks() -> None:
    """The part of the certificate that covers all reachable states is closed, and does not prove that they lead on."""
    network, query = counter("answered")
    proof = proved(network, query)
    (block,) = proof.blocks()
    groups = int((block.ranks == 0).sum())
    assert (block.zones == 1).all() and not block.ranks[:groups].any()
    kept = int(block.constraints[:groups].sum())
    reachable = StateBlock(
        block.discretes[:groups],
        block.zones[:groups],
        block.ranks[:groups],
        block.constraints[:groups],
        block.places[:kept],
        block.bounds[:kept],
    )
    found = judged(network, query, written(proof, iter([reachable])))
    assert found is not None and found.reason == "it is not shown that the goal is met from here"


def changed(random: Random, proof: Proof) -> Iterator[Columns]:
    """The blocks with one number changed."""
    blocks = list(map(Shapes().columns, proof.blocks()))
    block = blocks[number := random.randrange(len(blocks))]
    fields = ["positions", "differences", "shapes", "bounds", "bounds", "bounds", "places", "constraints", "zones"]
    field = random.choice(fields)
    column = getattr(block, field).copy()
    if column.size:
        column[random.randrange(column.size)] += random.choice([-2, -1, 1, 2, random.randint(-20, 20)])
    blocks[number] = replace(block, **{field: column})
    return iter(blocks)


def mutated(random: Random, proof: Proof) -> bytes:
    """A damaged file: a changed number of the set, or a changed byte, or an end that is missing."""
    stream = io.BytesIO()
    if random.random() < 0.8:
        CertificateWriter(stream).write_columns(proof.header, changed(random, proof))
    else:
        CertificateWriter(stream).write(proof.header, proof.blocks())
    data = bytearray(stream.getvalue())
    if random.random() < 0.2:
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    if random.random() < 0.05:
        del data[random.randrange(len(data)) :]
    return bytes(data)


def test_no_mutation_proves_what_is_wrong() -> None:
    """400 mutated certificates of Fischer's protocol, judged as if they were about the protocol that is wrong."""
    network, query = fischer()
    wrong, _ = fischer(WAIT=9)
    proof = proved(network, query)
    random = Random(1)
    readable = 0
    for _ in range(400):
        try:
            (certificate,) = read_certificates(io.BytesIO(mutated(random, proof)))
            assert check_proof(wrong, query, certificate, Checker.NATIVE) is not None
            readable += 1
        except (MalformedCertificateError, ValueError, OverflowError):
            continue
    assert readable > 120


def test_both_checkers_judge_mutations_alike() -> None:
    network, query = fischer()
    proof = proved(network, query)
    random = Random(2)
    accepted = rejected = 0
    for _ in range(60):
        try:
            (certificate,) = read_certificates(io.BytesIO(mutated(random, proof)))
            verdict = judged(network, query, certificate)
        except (MalformedCertificateError, ValueError, OverflowError):
            continue
        accepted, rejected = accepted + (verdict is None), rejected + (verdict is not None)
    assert accepted and rejected


def test_a_zone_is_written_once_however_many_states_have_it() -> None:
    network, query = fischer(N=4)
    proof = proved(network, query, PLAIN)
    told = list(map(Shapes().columns, proof.blocks()))
    assert sum(len(columns.constraints) for columns in told) * 4 < proof.zones
    for block, read in zip(proof.blocks(), written(proof).blocks(), strict=True):
        for field in ("discretes", "zones", "ranks", "constraints", "places", "bounds"):
            assert (getattr(block, field) == getattr(read, field)).all()


SLICES = """
clock slice, pace;
process Application() {
    init location running {
        invariant slice <= 1;
        to running { guard slice >= 1 && pace < 300; assign slice = 0; }
        to writing { guard slice >= 1 && pace >= 300; }
    }
    location writing { }
}
system Application;
property paced : A[] Application.writing imply pace >= 300;
"""


def test_one_zone_for_each_discrete_state_however_often_it_grows() -> None:
    """Where a long time is cut into slices, the search for the answer stores a zone for each of them."""
    network, query = counter("paced", SLICES)
    (verdict,) = verify(network, [query], trace=False)
    proof = proved(network, query, WHOLE)
    assert verdict.statistics.states_stored > 300 and proof.zones == proof.states == 2
    assert judged(network, query, written(proof)) is None


def test_a_proof_with_ranks_can_do_without_some_constraints_too() -> None:
    """A clock that nobody reads, and one that tells where the goal is."""
    network, query = counter("met", COUNTED)
    proof = proved(network, query)
    wide = widened_proof(network, query, proof, 0)
    before, after = (sum(len(columns.constraints) for columns in one.columns()) for one in (proof, wide))
    assert before > 40 and after < before
    assert judged(network, query, written(wide)) is None


COUNTED = """
clock x, y; int[0, 60] n;
process P() {
    init location a {
        invariant x <= 2;
        to a { guard x >= 1 && n < 60; assign n = n + 1, x = 0; }
        to b { guard n == 60; }
    }
    location b { }
}
system P;
property met : A<> P.b || y > 1000;
"""


def test_numbers_of_any_length() -> None:
    numbers = np.array([0, 1, 127, 128, 300, 2**14, 2**35 - 1, 2**62], np.int64)
    assert (decoded(encoded(numbers)) == numbers).all()
    assert len(decoded(b"")) == 0
    for damaged in (b"\x80", b"\xff" * 10 + b"\x01"):
        with pytest.raises(MalformedCertificateError):
            decoded(damaged)


def test_a_file_may_hold_several_certificates(tmp_path: Path) -> None:
    network, query = fischer()
    proof = proved(network, query)
    path = tmp_path / "two.cert"
    with path.open("wb") as file:
        writer = CertificateWriter(file)
        writer.write(proof.header, proof.blocks())
        writer.write(replace(proof.header, name="again"), proof.blocks())
    with path.open("rb") as file:
        found = read_certificates(file)
        assert [certificate.header.name for certificate in found] == ["mutual_exclusion", "again"]
        assert all(check_proof(network, query, certificate, Checker.NATIVE) is None for certificate in found)


def test_the_report_names_the_element_that_is_wrong() -> None:
    """What JSON and text say of a certificate that lacks an element."""
    network, query = fischer()
    proof = proved(network, query)
    certificate = written(proof, blocks_without(proof, proof.states - 1))
    found = judged(network, query, certificate)
    assert found is not None
    judgement = Judgement(network, query, certificate, Checker.NATIVE, found.reason, found, 0.25)
    told = judgements_to_json("fischer.ta", "fischer.cert", "python", [judgement])
    (entry,) = told["certificates"]
    assert entry["accepted"] is False and entry["reason"] == "a successor is not in the set"
    assert set(entry["state"]["locations"]) == {"P(1)", "P(2)"} and "→" in entry["transition"]
    lines = list(judgement_lines([judgement]))
    assert lines[1] == "    rejected by the native checker: a successor is not in the set" and len(lines) == 4
    if SCHEMA.is_file():
        jsonschema.validate(told, json.loads(SCHEMA.read_text(encoding="utf-8")))


@pytest.mark.parametrize("asked", list(Checker))
def test_json_says_who_judges_each_certificate(asked: Checker, tmp_path: Path) -> None:
    model, proofs, report = tmp_path / "counter.ta", tmp_path / "counter.cert", tmp_path / "report.json"
    model.write_text(COUNTER + "property few : A[] n <= 3;", encoding="utf-8")
    run_verify(VerifyArguments((str(model),), certificate=proofs), reporting=RunReporting(quiet=True))
    run_certify(CertifyArguments(str(model), proofs, (), asked.value), Reporting("json", report))
    told = json.loads(report.read_text(encoding="utf-8"))
    judges = {entry["property"]: entry["checker"] for entry in told["certificates"]}
    assert judges == dict.fromkeys(("met", "answered", "kept", "few"), asked.value)
    if SCHEMA.is_file():
        jsonschema.validate(told, json.loads(SCHEMA.read_text(encoding="utf-8")))


def test_a_proof_with_ranks_is_checked_when_it_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """With ranks that a search has mixed up."""
    network, query = counter("answered")
    right = proved(network, query)
    (block,) = right.blocks()
    wrong = replace(right.cover, blocks=lambda: iter([replace(block, ranks=np.minimum(block.ranks, 1))]))
    monkeypatch.setattr(certificates, "find_descent", lambda *_: wrong)
    with pytest.raises(InternalError, match="a successor is not in the set"):
        find_proof(network, "digest", query)


def test_a_certificate_is_about_the_model_and_the_query_in_its_header(tmp_path: Path) -> None:
    model, path = str(MODELS / "classics" / "fischer.ta"), str(tmp_path / "fischer.cert")
    status = run_verify(
        VerifyArguments((model,), definitions=("N=2",), properties=("mutual_exclusion",), certificate=Path(path)),
        reporting=RunReporting(quiet=True),
    )
    assert status is ExitStatus.AS_EXPECTED
    for definitions, expected in [(("N=2",), 0), (("N=2", "WAIT=11"), 10), (("N=3",), 10)]:
        arguments = CertifyArguments(model, Path(path), definitions, "native")
        assert run_certify(arguments, Reporting(quiet=True)) == expected


@pytest.mark.parametrize(
    "query",
    [
        "E<> deadlock && n == 1",
        "E<> n == 1 && deadlock",
        "A[] not deadlock || owner == 0 || n == 0",
        "E<> deadlock && false",
    ],
)
def test_deadlock_may_stand_beside_what_is_known_before(query: str) -> None:
    loaded = tachk.loads(
        f"""typedef int[1,3] id_t; int[0,3] owner = 0; int[0,1] n = 0;
        process P(const id_t me) {{ init location A {{ to B {{ assign owner = me; }} }} location B; }}
        system P;
        property q : {query};"""
    )
    (asked,) = loaded.properties
    proof = proved(loaded.network, asked)
    assert judged(loaded.network, asked, written(proof)) is None
