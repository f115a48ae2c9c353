"""Certificates that have been tampered with, before both checkers: `python -m bench.tampered_certificates N SEED`.

Each is a certificate of a random network, of a random model with interchangeable processes, of one in which much is
lost or of Fischer's protocol in which one to three bounds, discrete states, ranks, elements, numbers of what is
interchangeable or traps have been changed, exchanged or left out. It is offered for what it proved, and for something
false about the same network (a state that can be reached, or an obligation that some run does not meet) or, of
Fischer's protocol, about the variant that is wrong. Whatever is false must be rejected. What is accepted for something
true is confirmed by a third reading, the symbolic semantics of single states: it is still a proof, and a short search
from what is left out finds nothing. Exit status 1 if anything false is accepted, the checkers differ, or the third
reading does not confirm.
"""

from __future__ import annotations

import io
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, islice, permutations, product
from random import Random

import numpy as np

import tachk
from tachk.base.resources import data_root
from tachk.base.words import QueryKind
from tachk.engine.options import Limits
from tachk.meaning import dbm
from tachk.meaning.dbm import Zone
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.certificate import (
    CertificateHeader,
    CertificateReader,
    CertificateWriter,
    MalformedCertificateError,
    ProofKind,
    StateBlock,
    read_certificates,
    starts,
)
from tachk.meaning.judge.transpositions import SymmetryGroup, group_element
from tachk.meaning.judge.trap import FOR_EVER, Trap
from tachk.meaning.symbolic import Situation, elapse, fire, initial_situation, intersections, situation, where
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.model.run import DiscreteState
from tachk.verify.certificates import Checker, Proof, check_proof, find_proof, is_provable
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support.missed_moments import random_missed_moments
from tests.support.symmetric.cases import random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.cycles import random_ring_case
from tests.support.symmetric.registers import random_register_case

SHAPES = (
    Shape(),
    Shape(clocks=2, deadlocks=False),
    Shape(priorities=True, clocks=2),
    Shape(diagonals=True, exact=0.3, clocks=2),
    Shape(language=True, faults=0.1, clocks=2),
)
_LIMITS = Limits(states=1_000)
_LARGEST = 60
_OF_EACH = 5
_LEFT_OUT = 200
"""So many states are explored from what is left out."""


@dataclass
class Element:
    """A symbolic state of a certificate; `told`: the places and bounds of its constraints."""

    discrete: list[int]
    rank: int
    told: list[tuple[int, int]]


@dataclass(frozen=True)
class Claim:
    """A certificate, what it proves of a network, and what is false: of the same network, or of another one."""

    network: Network
    query: Query
    proof: Proof
    false: tuple[tuple[Network, Query], ...]


def main(arguments: list[str]) -> int:
    count, seed = int(arguments[0]), int(arguments[1])
    told: Counter[str] = Counter()
    offered: Counter[str] = Counter()
    started = time.process_time()
    wrong = 0
    for claim in _claims(seed):
        random = Random(f"{seed}/{sum(told.values())}")
        for _ in range(_OF_EACH):
            if sum(told.values()) == count:
                break
            for problem in _judge(claim, random, told, offered):
                wrong += 1
                print(f"after {sum(told.values())}: {claim.query.kind.value} {claim.query.text}: {problem}", flush=True)
        if sum(told.values()) == count:
            break
    for answer, times in sorted(told.items()):
        print(f"{times:8} {answer}")
    for answer, times in sorted(offered.items()):
        print(f"{times:8} {answer}, offered for something false")
    print(f"{sum(told.values())} certificates, {wrong} problems, {time.process_time() - started:.0f} s of CPU")
    return 1 if wrong else 0


def _claims(seed: int) -> Iterator[Claim]:
    path = data_root() / "models/classics/fischer.ta"
    for number in range(sys.maxsize):
        if number % 4 == 2:
            yield from _claims_of(_interchangeable(Random(seed + number)))
            continue
        if number % 4 == 3:
            moments = random_missed_moments(Random(seed + number))
            model = tachk.loads(moments.text)
            yield from _claims_of((model.network, list(model.verify(*moments.queries, limits=_LIMITS, trace=False))))
            continue
        if number % 4 == 0:
            right, wrong = (tachk.load(path, N=2 + number // 4 % 3, **constants) for constants in ({}, {"WAIT": 9}))
            queries = right.properties[:1]
            networks = ((wrong.network, queries[0]),)
            found = find_proof(right.network, "digest", queries[0])
            if isinstance(found, Proof):
                yield Claim(right.network, queries[0], found, networks)
            continue
        case = random_case(Random(seed + number), SHAPES[number % len(SHAPES)])
        first, second, *_ = case.predicates
        asked = [Query(f"q{n}", QueryKind.POSSIBLY, predicate) for n, predicate in enumerate(case.predicates)]
        asked += [
            Query("met", QueryKind.EVENTUALLY, first),
            Query("kept", QueryKind.POTENTIALLY_ALWAYS, second),
            Query("answered", QueryKind.LEADS_TO, first, (second,)),
        ]
        verdicts = [verify(case.network, [query], limits=_LIMITS, trace=False)[0] for query in asked]
        yield from _claims_of((case.network, verdicts))


def _claims_of(found: tuple[Network, list[tachk.Verdict]]) -> Iterator[Claim]:
    network, verdicts = found
    for verdict in verdicts:
        proof = find_proof(network, "digest", verdict.query, limits=_LIMITS) if is_provable(verdict) else ""
        if isinstance(proof, Proof) and 0 < proof.zones <= _LARGEST:
            yield Claim(network, verdict.query, proof, _false(network, verdict.query, verdicts))


def _interchangeable(random: Random) -> tuple[Network, list[tachk.Verdict]]:
    case = random.choice((random_symmetric_case, random_ring_case, random_controller_case, random_register_case))(
        random
    )
    model = tachk.loads(case.text)
    return model.network, list(model.verify(*case.queries, limits=_LIMITS, trace=False))


def _false(network: Network, query: Query, verdicts: list[tachk.Verdict]) -> tuple[tuple[Network, Query], ...]:
    """Claims of the same kind of which the opposite has been found."""
    return tuple(
        (network, other.query)
        for other in verdicts
        if (other.query.target is None) is (query.target is None)
        and other.answer is not Answer.UNKNOWN
        and not is_provable(other)
    )


def _judge(claim: Claim, random: Random, told: Counter[str], offered: Counter[str]) -> Iterator[str]:
    data = _tampered(claim.proof, random)
    answer = _answer(claim.network, claim.query, data)
    told[answer] += 1
    if answer.startswith("the checkers differ"):
        yield answer
    if answer == "accepted, still a proof" and claim.query.target is not None:
        (certificate,) = read_certificates(io.BytesIO(data))
        if not _is_closed(claim.network, claim.query, certificate):
            yield "accepted, and the third reading says that it is no proof"
    for network, query in claim.false:
        other = _answer(network, query, data)
        offered[other] += 1
        if other.startswith(("accepted", "the checkers differ")):
            yield f"offered for {query.name} {query.kind.value}: {other}"


def _tampered(proof: Proof, random: Random) -> bytes:
    elements = _elements(proof)
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        _change(elements, random, proof.header.kind)
    elements.sort(key=lambda element: (element.discrete, element.rank > 0))
    stream = io.BytesIO()
    header = (
        proof.header if random.random() < 0.7 else _with_other_groups(_with_other_traps(proof.header, random), random)
    )
    CertificateWriter(stream).write(header, [_block(elements, proof.header.width)] if elements else [])
    return stream.getvalue()


def _with_other_traps(header: CertificateHeader, random: Random) -> CertificateHeader:
    """A number of a trap changed, or something of what lies outside of it left out, or a trap left out."""
    if not header.traps:
        return header
    traps = list(header.traps)
    number = random.randrange(len(traps))
    slot, clock, outside = traps[number].slot, traps[number].clock, [*map(list, traps[number].outside)]
    match random.randrange(5):
        case 0:
            del traps[number]
            return replace(header, traps=tuple(traps))
        case 1:
            slot = max(slot + random.choice((-1, 1)), 0)
        case 2:
            clock = max(clock + random.choice((-1, 1)), 0)
        case 3 if outside:
            del outside[random.randrange(len(outside))]
        case _:
            part = random.choice(outside or [[0, 0, 0]])
            place = random.randrange(3)
            part[place] = max(part[place] + random.choice((-1, 1)), 0)
    traps[number] = Trap(slot, clock, tuple((value, first, min(last, FOR_EVER)) for value, first, last in outside))
    return replace(header, traps=tuple(traps))


def _with_other_groups(header: CertificateHeader, random: Random) -> CertificateHeader:
    """A number of what is interchangeable changed, or something of it left out."""
    if not header.groups:
        return header
    groups = [group.to_json() for group in header.groups]
    told = random.choice(groups)
    name = random.choice(("slots", "clocks", "channels", "names", "tables", "cyclic"))
    if name == "cyclic":
        told[name] = not told[name]
        return replace(header, groups=tuple(map(SymmetryGroup.from_json, groups)))
    part = [list(own) for own in told[name]]
    filled = [own for own in part if own]
    if filled and random.random() < 0.5:
        own = random.choice(filled)
        place = random.randrange(len(own))
        own[place] = max(own[place] + random.choice((-2, -1, 1, 2)), 0)
    elif filled and name == "names":
        part.pop(random.randrange(len(part)))
    elif filled and name != "tables":
        place = random.randrange(len(part[0]))
        part = [own[:place] + own[place + 1 :] for own in part]
    else:
        random.shuffle(part)
    told[name] = part
    return replace(header, groups=tuple(map(SymmetryGroup.from_json, groups)))


def _everything(elements: list[Element], groups: Sequence[SymmetryGroup], dimension: int) -> Iterator[Element]:
    """All that exchanges make of elements."""
    arrangements = [
        [[(m + turn) % g.size for m in range(g.size)] for turn in range(g.size)]
        if g.cyclic
        else permutations(range(g.size))
        for g in groups
    ]
    for chosen in product(*arrangements):
        exchanges = [group_element(group, places) for group, places in zip(groups, chosen, strict=True)]
        for element in elements:
            for each in exchanges:
                discrete = list(element.discrete)
                for slot, value in enumerate(element.discrete):
                    discrete[each.slot(slot)] = each.value(slot, value)
                told = [(divmod(place, dimension), bound) for place, bound in element.told]
                moved = [(each.clock(i) * dimension + each.clock(j), bound) for (i, j), bound in told]
                element = Element(discrete, element.rank, moved)
            yield element


def _elements(certificate: Proof | CertificateReader) -> list[Element]:
    found = []
    for block in certificate.blocks():
        first = starts(block.constraints).tolist()
        told = list(zip(block.places.tolist(), block.bounds.tolist(), strict=True))
        discretes = np.repeat(block.discretes, block.zones, axis=0).tolist()
        for discrete, rank, start, end in zip(discretes, block.ranks.tolist(), first, first[1:], strict=False):
            found.append(Element(discrete, rank, told[start:end]))
    return found


def _block(elements: list[Element], width: int) -> StateBlock:
    groups = [list(group) for _, group in groupby(elements, lambda element: (element.discrete, element.rank > 0))]
    told = [constraint for element in elements for constraint in element.told]
    return StateBlock(
        np.array([group[0].discrete for group in groups], np.int64).reshape(len(groups), width),
        np.array([len(group) for group in groups], np.int64),
        np.array([element.rank for element in elements], np.int64),
        np.array([len(element.told) for element in elements], np.int64),
        np.array([place for place, _ in told], np.int64),
        np.array([bound for _, bound in told], np.int64),
    )


def _change(elements: list[Element], random: Random, kind: ProofKind) -> None:
    """A change of a bound, a number of a discrete state, a rank, or of what there is."""
    if not elements:
        return
    element = random.choice(elements)
    change = random.choice((-2, -1, 1, 2, random.randint(-20, 20)))
    match random.randrange(10 if kind is ProofKind.INEVITABLE else 8):
        case 0 | 1 | 2 if element.told:
            number = random.randrange(len(element.told))
            place, bound = element.told[number]
            element.told[number] = (place, bound + change)
        case 3 if element.told:
            del element.told[random.randrange(len(element.told))]
        case 4 if element.told:
            other = random.choice(elements)
            element.told, other.told = other.told, element.told
        case 5 if element.told and (others := random.choice(elements).told):
            element.told[random.randrange(len(element.told))] = random.choice(others)
        case 6:
            elements.remove(element)
        case 8 | 9:
            element.rank = max(element.rank + change, 0)
        case _:
            number = random.randrange(len(element.discrete))
            element.discrete[number] = max(element.discrete[number] + (1 if change > 0 else -1), 0)


def _answer(network: Network, query: Query, data: bytes) -> str:
    said = []
    for checker in Checker:
        try:
            (certificate,) = read_certificates(io.BytesIO(data))
            said.append("rejected" if check_proof(network, query, certificate, checker) else "accepted, still a proof")
        except (MalformedCertificateError, ValueError, OverflowError):
            said.append("unreadable")
    accepted = [each.startswith("accepted") for each in said]
    return said[0] if accepted[0] is accepted[1] else f"the checkers differ: {said}"


def _is_closed(network: Network, query: Query, certificate: CertificateReader) -> bool:
    """Whether the set is a proof, by the semantics of one symbolic state after the other."""
    model = prepare(network)
    dimension = len(certificate.header.clocks) + 1
    processes = len(network.processes)
    zones: dict[DiscreteState, list[Zone]] = defaultdict(list)
    for element in _everything(_elements(certificate), certificate.header.groups, dimension):
        discrete = DiscreteState(tuple(element.discrete[:processes]), tuple(element.discrete[processes:]))
        told = [(*divmod(place, dimension), bound) for place, bound in element.told]
        found = dbm.constrain_all(dbm.universe(dimension), told)
        zones[discrete] += [] if found is None else [found]

    left_out: list[tuple[DiscreteState, dbm.Federation]] = []

    def contains(discrete: DiscreteState, reached: dbm.Federation) -> bool:
        left = dbm.subtract_all(reached, zones.get(discrete, []))
        if left:
            left_out.append((discrete, left))
        return not left or bool(certificate.header.traps)

    here, start = initial_situation(model)
    assert query.target is not None
    if not contains(here.discrete, start):
        return False
    for discrete, held in zones.items():
        here, inside, is_bad = _looked_up(model, query.target, discrete, held)
        if is_bad:
            return False
        for move in here.moves:
            reached = fire(here, inside, move)
            if not reached:
                continue
            if move.target is None:
                return False
            there = situation(model, move.target)
            if not contains(move.target, elapse(there, reached)):
                return False
    return not _is_met_later(model, query, left_out)


def _looked_up(
    model: PreparedNetwork, target: Expression, discrete: DiscreteState, held: dbm.Federation
) -> tuple[Situation, dbm.Federation, bool]:
    """A discrete state, the part of its zones within the invariants, and whether the target or an error is in it."""
    here = situation(model, discrete)
    inside = [] if here.invariant is None else intersections(held, [here.invariant])
    bad = [*where(model, here, target), *(zone for fault in here.faults for zone in fault.domain)]
    return here, inside, bool(intersections(bad, inside))


def _is_met_later(model: PreparedNetwork, query: Query, pending: list[tuple[DiscreteState, dbm.Federation]]) -> bool:
    """Whether a short search from symbolic states finds what the query asks for, or a run-time error."""
    assert query.target is not None
    seen: dict[DiscreteState, list[Zone]] = defaultdict(list)
    for discrete, held in islice(iter(lambda: pending.pop(0) if pending else None, None), _LEFT_OUT):
        here, inside, is_bad = _looked_up(model, query.target, discrete, held)
        if is_bad:
            return True
        for move in here.moves:
            moved = fire(here, inside, move)
            if not moved:
                continue
            if move.target is None:
                return True
            new = dbm.subtract_all(elapse(situation(model, move.target), moved), seen[move.target])
            if new:
                seen[move.target] += new
                pending.append((move.target, new))
    return False


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
