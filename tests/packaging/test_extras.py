"""Every command where no extra is installed: it works, or names the extra that it needs."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

import pytest

from tachk.base.optional_packages import OPTIONAL_PACKAGES
from tachk.cli.main import COMMANDS

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]

MODEL = """process P() {
    clock x;
    init location a { invariant x <= 3; to b { guard x >= 1; assign x = 0; } }
    location b { to a { guard x >= 2; assign x = 0; } }
}
system P;
property reached : E<> P.b;
property bounded : A[] P.x <= 3 || P.b;
"""
CAPTURE = str(ROOT / "tests/data/captures/full_window.pcap")
DIMMER = str(ROOT / "examples/dimmer/dimmer.ta")
PRESSED = str(ROOT / "examples/dimmer/pressed.csv")
VESSEL = (str(ROOT / "examples/cooling/vessel.stl"), str(ROOT / "examples/cooling/vessel.csv"))

LINES = {
    "verify": ("verify", "m.ta", "--certificate", "m.cert"),
    "certify": ("certify", "m.ta", "m.cert"),
    "synthesize": ("synthesize", "n.ta", "E<> P.b", "--over", "N=0..4"),
    "sweep": ("sweep", "n.ta", "-D", "N=0..4", "--property", "reached", "--format", "json", "-o", "sweep.json"),
    "time": ("time", "m.ta", "--from", "P.a", "--to", "P.b"),
    "requirements": ("requirements", "r.stl"),
    "verifyta": ("verifyta", "m.ta", "q.q"),
    "simulate": ("simulate", "m.ta", "--until", "20", "-o", "runs.csv"),
    "estimate": ("estimate", "m.ta", "Pr[<=5](<> P.b)"),
    "replay": ("replay", "m.ta", "m.run"),
    "step": ("step", "m.ta"),
    "monitor": ("monitor", *VESSEL, "--property", "cooling"),
    "conform": ("conform", DIMMER, PRESSED),
    "test": ("test", DIMMER, "--simulate", DIMMER),
    "tests": ("tests", DIMMER, "-o", "suite"),
    "monitor --find": ("monitor", "G (valve -> F[0, T s] !valve)", VESSEL[1], "--find", "T=0..300"),
    "xrce decode": ("xrce", "decode", CAPTURE),
    "xrce measure": ("xrce", "measure", CAPTURE),
    "chart": ("chart", CAPTURE, "-o", "chart.svg", "--to", "1 s"),
    "xrce proxy": (
        "xrce",
        "proxy",
        "--rule",
        "drop the 2nd WRITE_DATA",
        "--show",
        "--listen",
        "127.0.0.1:9999",
        "--to",
        "127.0.0.1:1",
    ),
    "xrce bridge": ("xrce", "bridge", "m.ta", "--process", "P", "--listen", "0"),
    "check": ("check", "m.ta", "--deep"),
    "fmt": ("fmt", "m.ta"),
    "convert": ("convert", "m.ta", "-o", "m.xml"),
    "diff": ("diff", "m.ta", "m.ta"),
    "draw": ("draw", "m.ta", "-o", "m.svg"),
    "report": ("report", "m.ta", "sweep.json", "-o", "page.html"),
    "models": ("models",),
    "explain": ("explain", "E0101"),
    "completion": ("completion", "bash"),
    "serve": ("serve", "--stop", "--socket", "none.sock"),
}
"""A command line for each command, in the order in which they run: some read what others write."""

STATUS = {"xrce bridge": 2, "monitor": 10}
"""The model of this test has no messages for the bridge; the trace violates the formula. All others end with 0."""

NEED_AN_EXTRA = {
    "plot": [
        ("plot", *VESSEL, "-o", "trace.svg"),
        ("sweep", "n.ta", "-D", "N=0..4", "--property", "reached", "--heat-map", "map.svg"),
        ("synthesize", "n.ta", "E<> P.b", "--over", "N=0..4", "--plot", "region.svg"),
        ("estimate", "m.ta", "Pr[<=5](<> P.b)", "--plot", "estimate.svg"),
        ("draw", "m.ta", "-o", "m.png"),
        ("chart", CAPTURE, "-o", "chart.png"),
    ],
    "parquet": [
        ("simulate", "m.ta", "--until", "20", "-o", "runs.parquet"),
        ("monitor", "G true", "log.parquet"),
        ("xrce", "decode", CAPTURE, "--signals", "signals.parquet"),
    ],
    "mcap": [("monitor", "G true", "log.mcap"), ("monitor", "G true", "bag")],
    "hdf5": [("monitor", "G true", "log.h5")],
    "mdf": [("monitor", "G true", "log.mf4")],
    "mcp": [("mcp",)],
    "distributed": [("sweep", "n.ta", "-D", "N=0..4", "--dask", "tcp://127.0.0.1:1", "--property", "reached")],
}
"""Command lines that need an extra."""


def modules_of(requirements: Iterable[str]) -> set[str]:
    """The importable names of distributions and of what they need."""
    named: dict[str, set[str]] = {}
    for module, distributions in metadata.packages_distributions().items():
        for distribution in distributions:
            named.setdefault(_normal(distribution), set()).add(module)
    waiting, seen = [_normal(re.split(r"[^\w.-]", text, maxsplit=1)[0]) for text in requirements], set()
    while waiting:
        distribution = waiting.pop()
        if distribution in seen:
            continue
        seen.add(distribution)
        try:
            needed = metadata.requires(distribution) or []
        except metadata.PackageNotFoundError:  # for other machines
            continue
        waiting += [_normal(re.split(r"[^\w.-]", text, maxsplit=1)[0]) for text in needed if "extra ==" not in text]
    return set().union(*(named.get(distribution, set()) for distribution in seen))


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "m.ta").write_text(MODEL, encoding="utf-8")
    constant = "const int N = 2;\n" + MODEL.replace("x >= 1", "x >= N")
    (tmp_path / "n.ta").write_text(constant, encoding="utf-8")
    (tmp_path / "q.q").write_text("E<> P.b\n", encoding="utf-8")
    (tmp_path / "r.stl").write_text("first: G (p -> F[0, 5] q)\nsecond: G (r -> F[0, 3] q)\n", encoding="utf-8")
    (tmp_path / "m.run").write_text("1 P: a -> b\n", encoding="utf-8")
    for name in ("log.parquet", "log.mcap", "log.h5", "log.mf4"):
        (tmp_path / name).write_bytes(b"PAR1")
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag/metadata.yaml").write_text("rosbag2_bagfile_information: {}\n", encoding="utf-8")
    return tmp_path


def outcomes(folder: Path, lines: list[tuple[str, ...]], without: frozenset[str] = frozenset()) -> list[list[object]]:
    allowed = modules_of(PROJECT["dependencies"]) - without
    program = [sys.executable, str(Path(__file__).with_name("without_extras.py")), ",".join(sorted(allowed))]
    ended = subprocess.run(program, input=json.dumps(lines), capture_output=True, text=True, cwd=folder, timeout=300)
    assert ended.returncode == 0, ended.stderr
    found: list[list[object]] = json.loads(ended.stdout)
    return found


def test_every_command_works_or_names_an_extra(folder: Path) -> None:
    needing = [line for lines in NEED_AN_EXTRA.values() for line in lines]
    assert {*LINES, *(line[0] for line in needing)} >= set(COMMANDS)
    found = outcomes(folder, [*LINES.values(), *needing])
    for name, (status, said) in zip(LINES, found, strict=False):
        assert status == STATUS.get(name, 0), (name, said)
    for line, (status, said) in zip(needing, found[len(LINES) :], strict=True):
        extra = next(name for name, lines in NEED_AN_EXTRA.items() if line in lines)
        assert status == 3, (line, said)
        assert f'pip install "tachk[{extra}]"' in str(said), (line, said)
        assert "Traceback" not in str(said)


def test_all_but_the_second_engine_works_without_z3(folder: Path) -> None:
    engine = ("verify", "m.ta", "--engine", "smt")
    lines = {name: line for name, line in LINES.items() if name != "requirements"}
    *found, refused = outcomes(folder, [*lines.values(), engine], frozenset({"z3"}))
    for name, (status, said) in zip(lines, found, strict=True):
        assert status == STATUS.get(name, 0), (name, said)
    assert refused[0] == 3
    assert "pip install z3-solver" in str(refused[1])


def test_each_extra_is_named_by_a_package_that_it_brings() -> None:
    named = {match[1] for _, command in OPTIONAL_PACKAGES.values() if (match := re.search(r"tachk\[(\w+)\]", command))}
    assert named == set(EXTRAS) - {"all"}


def test_the_extra_all_is_all_others() -> None:
    (every,) = EXTRAS["all"]
    assert every == f"tachk[{','.join(sorted(set(EXTRAS) - {'all'}))}]"
