"""Certificates as files: sets of symbolic states, written and read block by block. docs/certificates.md has the format.

A file proves nothing by itself, and its checker need not trust this module: a set that is read wrongly
is still only accepted if it is closed.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Iterator, Mapping
from enum import StrEnum
from itertools import pairwise
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.meaning.dbm import INFINITY, Zone, constrain_all, universe
from tachk.meaning.judge.transpositions import SymmetryGroup
from tachk.meaning.judge.trap import Trap
from tachk.model.run import DiscreteState, Transition

Numbers = NDArray[np.int64]

MAGIC = b"tachk certificate 4\n"
_FORMER = b"tachk certificate 3\n"
"""Without traps; otherwise the same."""
_LARGEST_HEADER = 1 << 24
_LARGEST_BLOCK = 1 << 28


@dataclass(frozen=True, slots=True)
class Objection:
    """The reason why a set of symbolic states is not a proof.

    Attributes:
        discrete: the discrete state of the element that is wrong; None if the initial state is missing.
        zone: the number of its zone among those of the discrete state.
        transition: that leads out of the set, if one does.
    """

    reason: str
    discrete: DiscreteState | None = None
    zone: int = 0
    transition: Transition | None = None


class MalformedCertificateError(Exception):
    """The file is not a certificate, or only a part of one; ``str()`` says what is wrong."""


class ProofKind(StrEnum):
    """The statement that a certificate proves."""

    UNREACHABLE = "unreachable"
    """No reachable state satisfies the target of the query."""
    INEVITABLE = "inevitable"
    """No run avoids what the query wants to be met, from where it asks for it."""


@dataclass(frozen=True, slots=True)
class CertificateHeader:
    """The subject of a certificate.

    Attributes:
        name, query: of the property; the query is its text.
        model: the SHA-256 of the network as JSON.
        constants: the constants of the model that may be set from outside.
        width: how many numbers a discrete state has: the location of each process, then the content of each slot.
        clocks: the names of the clocks; number 0 is the reference clock, which is always 0, and has no name here.
        groups: what can be exchanged: a state stands for all that exchanges make of it.
        traps: sets of states that no run leaves; states in them from which the goal is out of reach may be missing.
    """

    kind: ProofKind
    name: str
    query: str
    model: str
    constants: Mapping[str, int]
    width: int
    clocks: tuple[str, ...]
    groups: tuple[SymmetryGroup, ...] = ()
    traps: tuple[Trap, ...] = ()


@dataclass(frozen=True, slots=True)
class StateBlock:
    """Symbolic states, grouped by discrete state.

    Attributes:
        discretes: a row for each group.
        zones: how many zones each group has.
        ranks: the rank of each zone. It is 0 for what covers all reachable states; else each action leads to zones of
            smaller ranks.
        constraints: how many constraints each zone has; with those that no clock is negative they define it.
        places: of each constraint on ``x_i - x_j`` the number ``i * (clocks + 1) + j``.
        bounds: of each constraint the raw bound, as in `tachk.meaning.dbm`.
    """

    discretes: Numbers
    zones: Numbers
    ranks: Numbers
    constraints: Numbers
    places: Numbers
    bounds: Numbers


@dataclass(frozen=True, slots=True)
class Columns:
    """A block as it is written: what a discrete state shares with the one before it is not repeated, nor is a zone
    that many discrete states have.

    Attributes:
        changes: of each group how many numbers of its discrete state differ from those of the group before it; the
            first one is compared with zeros.
        positions, differences: which numbers these are, and by how much.
        zones, ranks: as in `StateBlock`.
        shapes: for each zone its number among the zones that are listed in this block and those before it.
        constraints, places, bounds: as in `StateBlock`, but of the zones that this block lists.
    """

    changes: Numbers
    positions: Numbers
    differences: Numbers
    zones: Numbers
    ranks: Numbers
    shapes: Numbers
    constraints: Numbers
    places: Numbers
    bounds: Numbers

    def discretes(self, width: int) -> NDArray[np.int32]:
        """The discrete states as rows of so many numbers. Differences that are too large are read as others."""
        rows = np.zeros((len(self.zones), width), np.int32)
        rows[np.repeat(np.arange(len(rows)), self.changes), self.positions] = self.differences.astype(np.int32)
        return np.cumsum(rows, axis=0, dtype=np.int32, out=rows)

    def matrices(self, dimension: int) -> Numbers:
        """The bounds that the file gives for each zone, in the form of `tachk.meaning.dbm`, without tightening."""
        matrices = np.full((len(self.constraints), dimension * dimension), INFINITY)
        np.minimum.at(matrices, (np.repeat(np.arange(len(matrices)), self.constraints), self.places), self.bounds)
        return matrices.reshape(-1, dimension, dimension)


class Shapes:
    """The zones that have been listed so far, each once."""

    def __init__(self) -> None:
        self._numbers: dict[tuple[bytes, bytes], int] = {}
        self.constraints = self.places = self.bounds = np.zeros(0, np.int64)

    def columns(self, block: StateBlock) -> Columns:
        """A block as it is written after those before it."""
        changes = np.diff(block.discretes, axis=0, prepend=0)
        groups, positions = np.nonzero(changes)
        first = starts(block.constraints)
        shapes, new = [], []
        for zone, (start, end) in enumerate(pairwise(first.tolist())):
            name = block.places[start:end].tobytes(), block.bounds[start:end].tobytes()
            if name not in self._numbers:
                new.append(zone)
            shapes.append(self._numbers.setdefault(name, len(self._numbers)))
        chosen = ragged(first, np.array(new, np.int64))
        return Columns(
            np.bincount(groups, minlength=len(block.zones)),
            positions,
            changes[groups, positions],
            block.zones,
            block.ranks,
            np.array(shapes, np.int64),
            block.constraints[new],
            block.places[chosen],
            block.bounds[chosen],
        )

    def block(self, columns: Columns, width: int) -> StateBlock:
        """The inverse of `columns`."""
        self.constraints = np.concatenate((self.constraints, columns.constraints))
        self.places = np.concatenate((self.places, columns.places))
        self.bounds = np.concatenate((self.bounds, columns.bounds))
        chosen = ragged(starts(self.constraints), columns.shapes)
        return StateBlock(
            columns.discretes(width).astype(np.int64),
            columns.zones,
            columns.ranks,
            self.constraints[columns.shapes],
            self.places[chosen],
            self.bounds[chosen],
        )


def starts(lengths: Numbers) -> Numbers:
    """The positions at which pieces of these lengths begin in their concatenation, and the end of the last one."""
    return np.concatenate((np.zeros(1, np.int64), np.cumsum(lengths)))


def ragged(first: Numbers, pieces: Numbers) -> Numbers:
    """The places of some pieces, one behind the other; ``first`` as by `starts`."""
    lengths = first[pieces + 1] - first[pieces]
    return np.repeat(first[pieces] - starts(lengths)[:-1], lengths) + np.arange(lengths.sum())


# ---- writing --------------------------------------------------------------------------------------------------------


class CertificateWriter:
    """Writes certificates one behind the other."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        stream.write(MAGIC)

    def write(self, header: CertificateHeader, blocks: Iterable[StateBlock]) -> None:
        self.write_columns(header, map(Shapes().columns, blocks))

    def write_columns(self, header: CertificateHeader, blocks: Iterable[Columns]) -> None:
        text = json.dumps(
            {
                "kind": header.kind.value,
                "name": header.name,
                "query": header.query,
                "model": header.model,
                "constants": dict(header.constants),
                "width": header.width,
                "clocks": list(header.clocks),
                "groups": [group.to_json() for group in header.groups],
                "traps": [trap.to_json() for trap in header.traps],
            },
            ensure_ascii=False,
        ).encode()
        self._stream.write(encoded(np.array([len(text)])) + text)
        groups = zones = 0
        for columns in blocks:
            data = zlib.compress(packed(columns, header.kind is not ProofKind.UNREACHABLE), 9)
            self._stream.write(encoded(np.array([len(data)])) + data)
            groups += len(columns.zones)
            zones += len(columns.shapes)
        self._stream.write(encoded(np.array([0, groups, zones])))


def packed(columns: Columns, ranked: bool) -> bytes:
    """A block before it is compressed, as numbers of variable length. Ranks are left out if all are 0."""
    listed = columns.changes, columns.positions, columns.shapes, columns.constraints, columns.places
    return encoded(
        np.concatenate(
            (
                np.array([len(column) for column in listed]),
                columns.changes,
                columns.positions,
                _folded(columns.differences),
                columns.zones,
                *((columns.ranks,) if ranked else ()),
                columns.shapes,
                columns.constraints,
                columns.places,
                _folded(columns.bounds),
            )
        )
    )


def encoded(numbers: Numbers) -> bytes:
    """Numbers from 0 on in base 128, the lowest digit first; all but the last digit of each have 128 added."""
    values = numbers.astype(np.uint64)
    digits = np.ones(len(values), np.int64)
    for length in range(1, 10):
        digits += values >= np.uint64(1 << 7 * length)
    ends = np.cumsum(digits)
    out = np.zeros(int(ends[-1]) if len(ends) else 0, np.uint8)
    for digit in range(int(digits.max(initial=0))):
        has = digits > digit
        value = (values[has] >> np.uint64(7 * digit)) & np.uint64(127)
        more = np.where(digits[has] > digit + 1, np.uint64(128), np.uint64(0))
        out[(ends - digits)[has] + digit] = value | more
    return out.tobytes()


def _folded(numbers: Numbers) -> Numbers:
    """0, -1, 1, -2, ... as 0, 1, 2, 3, ..."""
    return (numbers << 1) ^ (numbers >> 63)


# ---- reading --------------------------------------------------------------------------------------------------------


class CertificateReader:
    """One certificate of a file. Its blocks are read when they are used, and not kept."""

    def __init__(self, stream: BinaryIO, has_traps: bool = True) -> None:
        """Reads the header and looks where the blocks are; the stream is then behind the certificate.

        Raises MalformedCertificateError.
        """
        self._stream = stream
        self.header = _header(_take(stream, _number(stream), _LARGEST_HEADER), has_traps)
        self._places: list[tuple[int, int]] = []
        while length := _number(stream):
            self._places.append((stream.tell(), length))
            stream.seek(length, 1)
        self.groups, self.zones = _number(stream), _number(stream)

    def _columns(self, number: int) -> Columns:
        start, length = self._places[number]
        self._stream.seek(start)
        decompressor = zlib.decompressobj()
        try:
            data = decompressor.decompress(_take(self._stream, length, _LARGEST_BLOCK), _LARGEST_BLOCK)
        except zlib.error as error:
            raise MalformedCertificateError(f"block {number} is damaged: {error}") from None
        if not decompressor.eof or decompressor.unused_data:
            raise MalformedCertificateError(f"block {number} is damaged")
        return _unpacked(decoded(data), self.header)

    def columns(self) -> Iterator[Columns]:
        """The blocks as they are written, one after the other.

        Raises MalformedCertificateError, also where the numbers of states are not those that the end shows.
        """
        groups = zones = shapes = 0
        for number in range(len(self._places)):
            columns = self._columns(number)
            groups, zones = groups + len(columns.zones), zones + len(columns.shapes)
            shapes += len(columns.constraints)
            if (columns.shapes >= shapes).any():
                raise MalformedCertificateError("it names a zone that it has not listed")
            yield columns
        if (groups, zones) != (self.groups, self.zones):
            raise MalformedCertificateError(f"it has {zones} zones, but its end says {self.zones}")

    def blocks(self) -> Iterator[StateBlock]:
        """Raises MalformedCertificateError as `columns` does."""
        shapes = Shapes()
        for columns in self.columns():
            yield shapes.block(columns, self.header.width)


def read_certificates(stream: BinaryIO) -> list[CertificateReader]:
    """The certificates of a file. Raises MalformedCertificateError."""
    begin = stream.read(len(MAGIC))
    if begin not in (MAGIC, _FORMER):
        raise MalformedCertificateError("it does not begin like a certificate of this version of tachk")
    size = stream.seek(0, 2)
    stream.seek(len(MAGIC))
    found: list[CertificateReader] = []
    while stream.tell() < size:
        found.append(CertificateReader(stream, begin == MAGIC))
    return found


def decoded(data: bytes) -> Numbers:
    """The inverse of `encoded`. Raises MalformedCertificateError."""
    digits = np.frombuffer(data, np.uint8)
    last = np.flatnonzero(digits < 128)
    if len(digits) and (not len(last) or last[-1] != len(digits) - 1):
        raise MalformedCertificateError("a number is cut off")
    first = np.concatenate(([0], last[:-1] + 1)) if len(last) else last
    lengths = last - first + 1
    if (lengths > 9).any():
        raise MalformedCertificateError("a number is too large")
    exponents = np.arange(len(digits)) - np.repeat(first, lengths)
    values = (digits & 127).astype(np.int64) << (7 * exponents)
    return np.add.reduceat(values, first) if len(first) else values


def _unpacked(numbers: Numbers, header: CertificateHeader) -> Columns:
    if len(numbers) < 5:
        raise MalformedCertificateError("a block is too short")
    groups, changed, zones, shapes, constraints = (int(n) for n in numbers[:5])
    ranked = 0 if header.kind is ProofKind.UNREACHABLE else zones
    sizes = (groups, changed, changed, groups, ranked, zones, shapes, constraints, constraints)
    if sum(sizes) != len(numbers) - 5:
        raise MalformedCertificateError("a block has another length than its beginning says")
    changes, positions, differences, of_groups, ranks, of_zones, of_shapes, places, bounds = np.split(
        numbers[5:], np.cumsum(sizes)[:-1]
    )
    if (changes.sum(), of_groups.sum(), of_shapes.sum()) != (changed, zones, constraints):
        raise MalformedCertificateError("the numbers of zones or constraints in a block do not add up")
    if (positions >= header.width).any():
        raise MalformedCertificateError("a discrete state has too many numbers")
    clocks = len(header.clocks) + 1
    if (places >= clocks * clocks).any():
        raise MalformedCertificateError("a constraint is about a clock that does not exist")
    if not ranked:
        ranks = np.zeros(zones, np.int64)
    differences, bounds = _unfolded(differences), _unfolded(bounds)
    return Columns(changes, positions, differences, of_groups, ranks, of_zones, of_shapes, places, bounds)


def _unfolded(numbers: Numbers) -> Numbers:
    return (numbers >> 1) ^ -(numbers & 1)


def _header(text: bytes, has_traps: bool) -> CertificateHeader:
    try:
        given: dict[str, Any] = json.loads(text)
        return CertificateHeader(
            ProofKind(given["kind"]),
            str(given["name"]),
            str(given["query"]),
            str(given["model"]),
            {str(name): int(value) for name, value in given["constants"].items()},
            int(given["width"]),
            tuple(map(str, given["clocks"])),
            tuple(map(SymmetryGroup.from_json, given["groups"])),
            tuple(map(Trap.from_json, given["traps"] if has_traps else ())),
        )
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise MalformedCertificateError(f"its header cannot be read: {error}") from None


def _number(stream: BinaryIO) -> int:
    value = shift = 0
    while True:
        digit = _take(stream, 1, 1)[0]
        value += (digit & 127) << shift
        shift += 7
        if digit < 128:
            return value
        if shift > 56:
            raise MalformedCertificateError("a number is too large")


def _take(stream: BinaryIO, length: int, limit: int) -> bytes:
    data = stream.read(length) if length <= limit else b""
    if len(data) < length:
        raise MalformedCertificateError("it ends too early")
    return data


def zone_at(certificate: CertificateReader, discrete: DiscreteState, number: int) -> Zone:
    """The zone of that number of a discrete state. Raises LookupError."""
    dimension = len(certificate.header.clocks) + 1
    for block in certificate.blocks():
        for row in np.flatnonzero((block.discretes == discrete.locations + discrete.values).all(axis=1)):
            zone, first = int(block.zones[:row].sum()) + number, starts(block.constraints)
            mine = slice(first[zone], first[zone + 1])
            left, right = np.divmod(block.places[mine], dimension)
            constraints = zip(left.tolist(), right.tolist(), block.bounds[mine].tolist(), strict=True)
            found = constrain_all(universe(dimension), constraints)
            if found is not None:
                return found
    raise LookupError("the certificate has no such state")
