"""Exchanges in certificates: each condition of the proof that they map the model onto itself, and what they are for."""

from __future__ import annotations

import json
from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.engine.options import Limits
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.automorphism import Automorphisms
from tachk.meaning.judge.certificate import CertificateHeader, MalformedCertificateError
from tachk.meaning.judge.transpositions import MalformedGroupError, SymmetryGroup
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.verify.certificates import Checker, check_proof
from tests.unit.meaning.judge.proofs import MODELS, PLAIN, judged, proved, written
from tests.unit.meaning.judge.test_certificates import blocks_without

pytestmark = pytest.mark.drawn

LARGE: list[tuple[str, str, dict[str, int | bool], int]] = [
    ("fischer.ta", "mutual_exclusion", {"N": 20}, 460),
    ("train_gate.ta", "one_at_a_time", {"N": 10}, 100),
    ("train_gate.ta", "no_deadlock", {"N": 10}, 100),
    ("csma_cd_any_order.ta", "collision_noticed", {"N": 10}, 1_000),
    ("dining_philosophers.ta", "neighbours", {"N": 9}, 3_000),
    ("critical_region.ta", "exclusive", {"N": 6, "CAREFUL": True, "IN_TURN": False}, 2_000),
]


@pytest.mark.parametrize(("model", "name", "constants", "most"), LARGE)
def test_many_interchangeable_processes(model: str, name: str, constants: dict[str, int | bool], most: int) -> None:
    loaded = tachk.load(MODELS / "classics" / model, **constants)
    (query,) = (query for query in loaded.properties if query.name == name)
    proof = proved(loaded.network, query)
    assert proof.header.groups and proof.zones <= most
    assert judged(loaded.network, query, written(proof)) is None


def fischer(**constants: int) -> tuple[Network, Query]:
    loaded = tachk.load(MODELS / "classics" / "fischer.ta", **{"N": 3, **constants})
    return loaded.network, loaded.properties[0]


def test_every_element_is_needed() -> None:
    network, query = fischer()
    proof = proved(network, query)
    assert proof.header.groups
    for group in range(proof.states):
        assert judged(network, query, written(proof, blocks_without(proof, group))) is not None


def test_transpositions_prove_nothing_of_another_model() -> None:
    network, query = fischer()
    certificate = written(proved(network, query))
    wrong, _ = fischer(WAIT=9)
    found = judged(wrong, query, certificate)
    assert found is not None and found.reason == "a successor is not in the set"


def test_transpositions_that_a_query_distinguishes_prove_nothing_about_it() -> None:
    loaded = tachk.load(MODELS / "classics" / "fischer.ta", N=3)
    mutual_exclusion, enter, *_ = loaded.properties
    found = judged(loaded.network, enter, written(proved(loaded.network, mutual_exclusion)))
    told = "what it exchanges is not interchangeable: the query distinguishes them"
    assert found is not None and found.reason == told


def test_a_search_without_transpositions_makes_a_certificate_without() -> None:
    network, query = fischer()
    plain = proved(network, query, PLAIN)
    assert not plain.header.groups and plain.zones > 2 * proved(network, query).zones


TURNS = """
int[0, 3] turn = 1;
process P(const int[1, 3] me) {
    init location idle { to busy { guard turn == me; } }
    location busy { to idle { assign turn = me == 3 ? 1 : me + 1; } }
}
system P;
property alone : A[] forall (i : int[1, 3]) forall (j : int[1, 3]) P(i).busy && P(j).busy imply i == j;
"""


def test_a_ring_whose_place_0_begins() -> None:
    loaded = tachk.loads(TURNS)
    (query,) = loaded.properties
    proof = proved(loaded.network, query)
    assert judged(loaded.network, query, written(proof)) is None
    (ring,) = proof.header.groups or (None,)
    if ring is not None:
        all_ = written(replace(proof, header=replace(proof.header, groups=(replace(ring, cyclic=False),))))
        found = judged(loaded.network, query, all_)
        assert found is not None and found.reason.startswith("what it exchanges is not interchangeable")


# ---- the conditions -------------------------------------------------------------------------------------------------

MODEL = """
int[0, 2] owner = 0;
int[0, 9] a = 0, b = 0;
clock z;
const int sizes[3] = {{5, {sizes}}};
meta int[0, 9] ma = {meta}, mb = 0;
chan ca, cb;
{channels}
broadcast chan all;
process A() {{
    clock x;
    init location M {{
        invariant x <= 5;
        to M {{ guard owner == 0 && a < 3 && x >= 1; sync ca!; assign owner = 1, a = a + 1, ma = a, x = sizes[1]; }}
        to N {{ sync ua!; }}
        {of_a}
    }}
    location N {{ to M {{ guard owner == 1; assign owner = 0, x = 0; }} }}
}}
process B() {{
    clock x;
    init location M {{
        invariant x <= {invariant};
        to {target} {{
            guard owner == {free} && b < {least} && {clock} >= 1;
            sync {channel}!;
            assign owner = {name}, b = b + 1, mb = b, {reset} = sizes[2];
        }}
        to N {{ sync ub!; }}
        {of_b}
    }}
    {kind} location N {{ to M {{ guard owner == 2; assign owner = 0, x = 0; }} {more} }}
}}
process C() {{
    init location M {{ to M {{ sync ca?; }} to M {{ sync cb?; }} to M {{ sync ua?; }} to M {{ sync ub?; }}
        to M {{ sync all!; }} {of_c} }}
}}
system {system};
"""
AS_A = {
    "sizes": "4, 4",
    "meta": "0",
    "channels": "chan ua, ub;",
    "of_a": "",
    "invariant": "5",
    "target": "M",
    "free": "0",
    "least": "3",
    "clock": "x",
    "channel": "cb",
    "name": "2",
    "reset": "x",
    "of_b": "",
    "kind": "",
    "more": "",
    "of_c": "",
    "system": "A, C, B",
}

WITHIN = "A and B differ in an edge from "
DIFFERENT = {
    "nothing": ({}, None),
    "an invariant": ({"invariant": "4"}, "A and B differ in the location M"),
    "a target": ({"target": "N"}, WITHIN + "M"),
    "a condition": ({"free": "1"}, WITHIN + "M"),
    "a bound of a variable": ({"least": "4"}, WITHIN + "M"),
    "a clock that is compared": ({"clock": "z"}, WITHIN + "M"),
    "a channel": ({"channel": "ca"}, WITHIN + "M"),
    "a name": ({"name": "1"}, WITHIN + "M"),
    "a clock that is set": ({"reset": "z"}, WITHIN + "M"),
    "an urgent location": ({"kind": "urgent"}, "A and B differ in the location N"),
    "a committed location": ({"kind": "committed"}, "A and B differ in the location N"),
    "an edge more": ({"more": "to N { }"}, "B and A differ in an edge from N"),
    "an edge twice": ({"more": "to M { guard owner == 2; assign owner = 0, x = 0; }"}, None),
    "an edge that is never possible": (
        {"more": "to M { guard owner > 2; } to N { guard owner == 0; sync cb?; }"},
        None,
    ),
    "a constant": ({"sizes": "4, 3"}, WITHIN + "M"),
    "what a variable begins with in each transition": ({"meta": "3"}, "mb begins with another value"),
    "an urgent channel": ({"channels": "chan ua; urgent chan ub;"}, "channels have different types or priorities"),
    "a broadcast": ({"channels": "chan ua; broadcast chan ub;"}, "channels have different types or priorities"),
    "a priority of a channel": (
        {"channels": "chan ua, ub; chan priority ua < default;"},
        "channels have different types or priorities",
    ),
    "a priority": ({"system": "A, C < B"}, "A and B have different locations or priorities"),
    "a rate": ({"kind": "", "more": "invariant x' == 0;"}, "A and B differ in the location N"),
    "another process": ({"of_c": "to M { guard owner == 1; assign owner = 0; }"}, "C and C differ in an edge from M"),
    "an error": (
        {"of_a": "to M { guard 1 / (owner - 1) > 0; }", "of_b": "to M { guard 1 / owner > 0; }"},
        WITHIN + "M",
    ),
    "the order of receivers": (
        {"of_a": "to M { sync all?; assign owner = 1; }", "of_b": "to M { sync all?; assign owner = 2; }"},
        "the order of the receivers of a broadcast matters",
    ),
    "what a receiver reads of another one": (
        {"of_a": "to M { sync all?; assign a = b; }", "of_b": "to M { sync all?; assign b = a; }"},
        "the order of the receivers of a broadcast matters",
    ),
    "a clock that two receivers set": (
        {"of_a": "to M { sync all?; assign z = a; }", "of_b": "to M { sync all?; assign z = b; }"},
        "the order of the receivers of a broadcast matters",
    ),
    "a clock that gets the value of their own one": (
        {"of_a": "to M { assign x = x + 2; }", "of_b": "to M { assign x = x + 2; }"},
        None,
    ),
    "a clock that gets the value of the same one": (
        {"of_a": "to M { assign x = z; }", "of_b": "to M { assign x = z; }"},
        None,
    ),
    "a clock that gets the value of another one": (
        {"of_a": "to M { assign x = x + 1; }", "of_b": "to M { assign x = z + 1; }"},
        WITHIN + "M",
    ),
    "a clock that gets another value of it": (
        {"of_a": "to M { assign x = z + 1; }", "of_b": "to M { assign x = z + 2; }"},
        WITHIN + "M",
    ),
    "a clock that one receiver sets and another one reads": (
        {
            "channels": "chan ua, ub; clock y;",
            "of_a": "to M { sync all?; assign y = z, z = 0; }",
            "of_b": "to M { sync all?; assign y = z, z = 0; }",
        },
        "the order of the receivers of a broadcast matters",
    ),
    "an order of receivers that does not matter": (
        {
            "of_a": "to M { sync all?; assign owner = 0, a = 0; }",
            "of_b": "to M { sync all?; assign owner = 0, b = 0; }",
        },
        None,
    ),
    "an invariant that may be an error": (
        {"of_c": "} location N { invariant 1 / owner > 0;"},
        "an invariant or a rate may be a run-time error",
    ),
}


def text_of(changes: dict[str, str]) -> str:
    return MODEL.format(**{**AS_A, **changes})


def group_of(
    model: PreparedNetwork, members: tuple[str, ...], named: str = "", names: tuple[int, ...] = ()
) -> SymmetryGroup:
    """A group by the names of what belongs to its members, and of what may hold names of them."""
    processes, layout = [process.name for process in model.network.processes], model.layout
    numbers = {name: len(processes) + slot for slot, name in enumerate(layout.names)}
    numbers |= {name: number for number, name in enumerate(processes)}
    clocks = {layout.names[slot]: 1 + number for number, slot in enumerate(layout.clock_slots)}
    channels = {layout.names[slot]: number for number, slot in enumerate(layout.channel_slots)}
    own = [member.split() for member in members]
    return SymmetryGroup(
        tuple(tuple(numbers[name] for name in each if name not in {*clocks, *channels}) for each in own),
        tuple(tuple(clocks[name] for name in each if name in clocks) for each in own),
        tuple(tuple(channels[name] for name in each if name in channels) for each in own),
        tuple((numbers[name], 0) for name in named.split()),
        (names,) if names else (),
    )


BOTH = ("A a ma A.x ca ua", "B b mb B.x cb ub")


def objection(changes: dict[str, str], members: tuple[str, ...] = BOTH, named: str = "owner") -> str | None:
    model = prepare(tachk.loads(text_of(changes)).network)
    return Automorphisms(model, []).objection(group_of(model, members, named, (1, 2)))


@pytest.mark.parametrize("what", DIFFERENT)
def test_what_distinguishes_processes_is_found(what: str) -> None:
    changes, reason = DIFFERENT[what]
    assert objection(changes) == reason


@pytest.mark.parametrize("gone", ["a", "ma", "A.x", "ca", "ua", "A"])
def test_all_that_belongs_to_a_member_must_move_with_it(gone: str) -> None:
    other = {"a": "b", "ma": "mb", "A.x": "B.x", "ca": "cb", "ua": "ub", "A": "B"}[gone]
    members = tuple(" ".join(n for n in own.split() if n not in (gone, other)) for own in BOTH)
    assert objection({}, members) is not None


def test_edges_may_receive_corresponding_channels_only() -> None:
    """Which ones an edge may hear decides where its guard is asked, which may be an error."""
    receives = {"of_a": "to M { sync d[1]?; }", "of_b": "to M { sync d[a - a + 2]?; }"}
    sends = "to M { select k : int[0, 2]; sync d[k]!; }"
    text = text_of({"channels": "chan ua, ub, d[3];", **receives, "of_c": sends})
    members = BOTH[0] + " d[1]", BOTH[1] + " d[2]"
    for index, reason in (("a - a + 2", WITHIN + "M"), ("2", None)):
        model = prepare(tachk.loads(text.replace("a - a + 2", index)).network)
        assert Automorphisms(model, []).objection(group_of(model, members, "owner", (1, 2))) == reason


def test_names_must_move_with_their_members() -> None:
    assert objection({}, named="") is not None


def test_slots_that_are_exchanged_have_the_same_range() -> None:
    text = text_of({}).replace("int[0, 9] a = 0, b = 0;", "int[0, 9] a = 0; int[0, 8] b = 0;")
    model = prepare(tachk.loads(text).network)
    assert (
        Automorphisms(model, []).objection(group_of(model, BOTH, "owner", (1, 2)))
        == "the range of b distinguishes them"
    )


def test_what_nothing_writes_must_have_the_images_of_its_values() -> None:
    for values, reason in (("0, 7, 7", None), ("0, 7, 8", "the values of c[2] distinguish them")):
        model = prepare(tachk.loads(text_of({}).replace("clock z;", f"clock z; int c[3] = {{{values}}};")).network)
        members = BOTH[0] + " c[1]", BOTH[1] + " c[2]"
        assert Automorphisms(model, []).objection(group_of(model, members, "owner", (1, 2))) == reason


def test_a_range_must_hold_the_names_of_all_or_of_none() -> None:
    text = text_of({}).replace("int[0, 2] owner", "int[0, 2] owner; int[0, 1] last")
    model = prepare(tachk.loads(text.replace("ma = a,", "ma = a, last = 1,")).network)
    found = Automorphisms(model, []).objection(group_of(model, BOTH, "owner last", (1, 2)))
    assert found == "the range of last distinguishes them"


def test_what_is_requested_must_not_distinguish_them() -> None:
    loaded = tachk.loads(text_of({}))
    model = prepare(loaded.network)
    asked = {
        "E<> A.N": "the query distinguishes them",
        "E<> A.N && B.N": None,
        "E<> A.N || B.N && A.M": "the query distinguishes them",
        "E<> owner == 1": "the query distinguishes them",
        "E<> owner > 0": None,
        "E<> A.x > 3 && B.x > 3": None,
        "E<> A.x > 3 && B.x > 2": "the query distinguishes them",
        "E<> a + b > 3": None,
        "E<> a > b": "the query distinguishes them",
        "E<> deadlock && A.M == B.M": None,
        "E<> 1 / a > 0 && 1 / b > 0": "the condition of the query may be a run-time error",
    }
    for text, reason in asked.items():
        (verdict,) = loaded.verify(text, limits=Limits(states=1))
        assert verdict.query.target is not None
        found = Automorphisms(model, [verdict.query.target]).objection(group_of(model, BOTH, "owner", (1, 2)))
        assert found == reason, text


MANY = """
int[0, 100] who = 0, number = 0, count = 0;
process P(const int[1, 3] me) {{
    init location M {{ to M {{ guard who < {least} && who != me; assign {update}; }} to N {{ assign who = me; }} }}
    location N;
}}
system P;
"""


@pytest.mark.parametrize(
    ("least", "update", "reason"),
    [
        ("1", "who = me", None),
        ("2", "who = me", "P(1) and P(2) differ in an edge from M"),
        ("50", "who = me", None),
        ("50", "number = who", "a name is copied to what holds other names, or none"),
        ("50", "number = count", None),
        ("50", "number = (count + who) % 101", "P(1) and P(2) differ in an edge from M"),
        ("50", "count = who > 60 ? 1 : 0", None),
        ("50", "count = who == 2 ? 1 : 0", "P(1) and P(2) differ in an edge from M"),
    ],
)
def test_names_in_a_large_range(least: str, update: str, reason: str | None) -> None:
    model = prepare(tachk.loads(MANY.format(least=least, update=update)).network)
    members = tuple(f"P({me})" for me in (1, 2, 3))
    assert Automorphisms(model, []).objection(group_of(model, members, "who", (1, 2, 3))) == reason


def test_groups_that_describe_no_transpositions_are_malformed() -> None:
    model = prepare(tachk.loads(text_of({})).network)
    group = group_of(model, BOTH, "owner", (1, 2))
    width = len(model.network.processes) + len(model.layout.initial)
    clock = len(model.network.processes) + model.layout.clock_slots[0]
    wrong = [
        replace(group, slots=(group.slots[0], group.slots[0])),
        replace(group, slots=(group.slots[0], group.slots[1][:-1])),
        replace(group, slots=group.slots[:1]),
        replace(group, slots=(), clocks=(), channels=(), tables=()),
        replace(group, tables=((1, 1),)),
        replace(group, tables=((1, 2, 3),)),
        replace(group, names=((group.names[0][0], 1),)),
        replace(group, names=((0, 0), (1, 0))),
        replace(group, names=((group.slots[0][1], 0),)),
        replace(group, slots=((0, width), (1, width + 1))),
        replace(group, slots=((0, clock), (1, clock + 1))),
        replace(group, slots=((0, group.slots[1][1]), (group.slots[0][1], 1))),
        replace(group, clocks=((0,), (1,))),
        replace(group, channels=((0,), (99,))),
    ]
    for each in wrong:
        with pytest.raises(MalformedGroupError):
            Automorphisms(model, []).objection(each)


def test_states_in_which_a_constant_has_another_value_are_rejected() -> None:
    """The proof is about states in which what nothing writes has its initial value."""
    loaded = tachk.loads(
        "int[0, 1] never = 0; process P(const int[0, 2] me) {"
        "init location M { to M { guard never == 1 && me == 0; } to N { } } location N; } system P;"
        "property p : E<> P(0).N && P(1).N && P(2).N && never == 1;"
    )
    (query,) = loaded.properties
    proof = proved(loaded.network, query)
    assert proof.header.groups
    (block,) = proof.blocks()
    discretes = block.discretes.copy()
    discretes[0, 3] = 1
    changed = written(proof, iter([replace(block, discretes=discretes)]))
    for checker in Checker:
        with pytest.raises(MalformedCertificateError):
            check_proof(loaded.network, query, changed, checker)


# ---- mutations ------------------------------------------------------------------------------------------------------


def mutated(header: CertificateHeader, random: Random) -> CertificateHeader:
    """The header with one number in its groups changed."""
    groups = json.loads(json.dumps([group.to_json() for group in header.groups]))

    def places(node: object) -> list[tuple[list[int], int]]:
        found: list[tuple[list[int], int]] = []
        for inner in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
            found += places(inner)
        if isinstance(node, list):
            found += [(node, number) for number, inner in enumerate(node) if type(inner) is int]
        return found

    where, number = random.choice(places(groups))
    where[number] = max(where[number] + random.choice((-2, -1, 1, 2)), 0)
    return replace(header, groups=tuple(map(SymmetryGroup.from_json, groups)))


def test_no_mutation_of_transpositions_proves_what_is_wrong() -> None:
    """Fischer's protocol that waits too little, by certificates of the right one in which the bound was changed."""
    random = Random(1)
    network, query = fischer()
    wrong, _ = fischer(WAIT=9)
    proof = proved(network, query)
    accepted = refused = 0
    for _ in range(60):
        certificate = written(replace(proof, header=mutated(proof.header, random)))
        try:
            found = judged(network, query, certificate)
            accepted, refused = accepted + (found is None), refused + (found is not None)
            assert judged(wrong, query, certificate) is not None
        except MalformedCertificateError:
            refused += 1
    assert refused > 40


@pytest.mark.parametrize(
    "wrong",
    [
        {"slots": [[0.5]]},
        {"slots": [[True]]},
        {"slots": 3},
        {"tables": None},
        {"names": [[1]]},
        {"clocks": [[1 << 40]]},
    ],
)
def test_what_is_no_group_is_a_damaged_header(wrong: dict[str, object]) -> None:
    network, query = fischer()
    (group,) = proved(network, query).header.groups
    read = json.loads(json.dumps(group.to_json()))
    assert SymmetryGroup.from_json(read) == group
    with pytest.raises((TypeError, ValueError)):
        SymmetryGroup.from_json({**read, **wrong})
