"""The file from which the library of a unit knows its network: 64-bit numbers, which `src/core/fmi/resource_file.cpp`
reads."""

from __future__ import annotations

import hashlib
import struct

from tachk.base.records import dataclass
from tachk.engine.chances_image import chances_image
from tachk.engine.program_image import encode
from tachk.simulation.fmi.unit import CoSimulationUnit

NAME = "network.bin"
_MAGIC = int.from_bytes(b"tachk.1\n", "little")


@dataclass(frozen=True, slots=True)
class ResourceFile:
    """Attributes:
    token: what the description names, so that both stay together.
    """

    content: bytes
    token: str


def resource_file(unit: CoSimulationUnit) -> ResourceFile:
    """The file of a unit."""
    variables = [number for each in unit.variables for number in (each.role, each.kind, each.number, each.target)]
    numbers = [unit.second.denominator, unit.second.numerator, unit.nudge]
    for sequence in (variables, encode(unit.program, ()), list(chances_image(unit.chances))):
        numbers += (len(sequence), *sequence)
    body = struct.pack(f"<{len(numbers)}q", *numbers)
    fingerprint = hashlib.sha256(body).digest()[:16]
    words = struct.unpack(">2q", fingerprint)
    return ResourceFile(struct.pack("<3q", _MAGIC, *words) + body, fingerprint.hex())
