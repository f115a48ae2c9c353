"""The file of a unit: an archive with its description, its network and the library that runs it."""

from __future__ import annotations

import platform
import sys
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import whole_file
from tachk.simulation.fmi.description import FmiVersion, description
from tachk.simulation.fmi.resource_file import NAME, resource_file
from tachk.simulation.fmi.unit import CoSimulationUnit

_LIBRARY = "libtachk_unit"
_SUFFIXES = {"linux": ".so", "darwin": ".dylib"}
_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_TIME = (1980, 1, 1, 0, 0, 0)
"""The time of every member, so that the same model gives the same file."""


def write_unit(unit: CoSimulationUnit, version: FmiVersion, path: Path) -> None:
    """Writes the archive of a unit for machines like this one. Raises UsageError where there is no library for it."""
    library = unit_library()
    made = resource_file(unit)
    binary = f"binaries/{_platform(version)}/{unit.name}{library.suffix}"
    with whole_file(path) as part, ZipFile(part, "w") as archive:
        for name, content in (
            ("modelDescription.xml", description(unit, made.token, version)),
            (f"resources/{NAME}", made.content),
            (binary, library.read_bytes()),
        ):
            member = ZipInfo(name, _TIME)
            member.compress_type = ZIP_DEFLATED
            member.external_attr = 0o644 << 16
            archive.writestr(member, content)


def unit_library() -> Path:
    """The library that every unit contains. Raises UsageError if it has not been built."""
    path = Path(__file__).resolve().parents[2] / f"{_LIBRARY}{_suffix()}"
    if not path.is_file():
        raise UsageError(f"{path} is missing: units cannot be made", "install tachk again")
    return path


def _suffix() -> str:
    return _SUFFIXES.get(sys.platform, ".so")


def _platform(version: FmiVersion) -> str:
    """The name of the folder of the library."""
    machine = _MACHINES.get(platform.machine().lower(), platform.machine().lower())
    match version:
        case FmiVersion.TWO:
            system = {"linux": "linux", "darwin": "darwin"}.get(sys.platform, sys.platform)
            return f"{system}64" if machine == "x86_64" or system == "darwin" else f"{machine}-{system}"
        case FmiVersion.THREE:
            return f"{machine}-{'darwin' if sys.platform == 'darwin' else 'linux'}"
