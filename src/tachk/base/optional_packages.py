"""The packages that tachk works without, what needs each, and how it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from tachk.base.diagnostics.diagnostic import UsageError

_TACHK = 'pip install "tachk[{}]"'

OPTIONAL_PACKAGES = {
    "matplotlib": ("plots need it", _TACHK.format("plot")),
    "resvg_py": ("PNG pictures need it", _TACHK.format("plot")),
    "pandas": ("data frames need it", _TACHK.format("data")),
    "pyarrow": ("Parquet files need it", _TACHK.format("parquet")),
    "mcap": ("MCAP files need it", _TACHK.format("mcap")),
    "mcap_protobuf": ("protocol buffers in MCAP files need it", _TACHK.format("mcap")),
    "rosbags": ("ROS bags and ROS messages need it", _TACHK.format("mcap")),
    "asammdf": ("MDF files need it", _TACHK.format("mdf")),
    "h5py": ("HDF5 files need it", _TACHK.format("hdf5")),
    "distributed": ("sweeps on a Dask cluster need it", _TACHK.format("distributed")),
    "anywidget": ("widgets of notebooks need it", _TACHK.format("notebook")),
    "mcp": ("the MCP server needs it", _TACHK.format("mcp")),
    "mcp_types": ("the MCP server needs it", _TACHK.format("mcp")),
    "anyio": ("the MCP server needs it", _TACHK.format("mcp")),
    "zstandard": ("files compressed by Zstandard need it", "pip install zstandard"),
    "z3": (
        "`--engine smt`, proofs about requirements and exact times of runs with stopped clocks need it",
        "pip install z3-solver",
    ),
}
"""By the name that Python imports: what needs the package, and the command that installs it."""


class MissingPackageError(UsageError):
    """A package that tachk works without is not installed. The help is the command that installs it."""


@contextmanager
def optional_packages() -> Iterator[None]:
    """Imports in this context may fail with a message that names the extra.

    Raises:
        MissingPackageError: one of `OPTIONAL_PACKAGES` is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        missing = missing_package(error)
        if missing is None:
            raise
        raise missing from None


def require(package: str) -> None:
    """Looks for a package that is needed later, without loading it.

    Raises:
        MissingPackageError: it is not installed.
    """
    with optional_packages():
        if find_spec(package) is None:
            raise ModuleNotFoundError(f"No module named {package!r}", name=package)


def missing_package(error: ModuleNotFoundError) -> MissingPackageError | None:
    """The message about an import that failed; None where that is no matter of an extra."""
    package = (error.name or "").partition(".")[0]
    if package not in OPTIONAL_PACKAGES:
        return None
    use, command = OPTIONAL_PACKAGES[package]
    return MissingPackageError(f"{package} is not installed; {use}", command)
