"""Families of networks: where instances come from, what is asked of them, and how other programs are asked the same."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from bench import shapes, tarzan_files
from bench.processes import finished, tachk

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True, slots=True)
class Instance:
    """One network and one question.

    Attributes:
        ours: what follows `tachk verify`.
        network: the same network for TChecker; None if it has no words for it.
        labels: what TChecker looks for; None: it goes through all states, as tachk does where the answer needs it.
        regions: the same network for TARZAN, a folder; None if it has no words for it.
        goals: what TARZAN looks for, as its driver takes it.
    """

    ours: tuple[str, ...]
    network: Path | None = None
    labels: str | None = None
    regions: Path | None = None
    goals: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class OurFamily:
    """A network that this project writes.

    Attributes:
        source: the path of a model, or a function that writes one of a size.
        asked: the property.
        sizes: those of a run that names none, from the smallest up.
        constant: the one that gives the size of a model; empty if it has one size.
        peers: the property whose locations other programs look for, where it is not `asked`. If it is ALL, they go
            through all states, which is right where the answer needs all of them.
    """

    source: str | Callable[[int], str]
    asked: str
    sizes: tuple[int, ...]
    constant: str = "N"
    peers: str = ""

    def instance(self, size: int, folder: Path, *, exported: bool) -> Instance:
        if isinstance(self.source, str):
            model = str(ROOT / self.source)
            definitions = ("-D", f"{self.constant}={size}") if self.constant else ()
        else:
            model = str(folder / f"{self.source.__name__}_{size}.ta")
            Path(model).write_text(self.source(size), encoding="utf-8")
            definitions = ()
        ours = (model, *definitions, "--property", self.asked)
        if not exported:
            return Instance(ours)
        network = folder / f"{Path(model).stem}_{size}_{self.asked}.tck"
        export = tachk("convert", model, *definitions, "-o", str(network))
        finished(export, statuses=(0, 2, 3), told=False)  # or TChecker has no words for something
        if not network.exists():
            return Instance(ours)
        labels = None
        if self.peers != ALL:
            words = network.read_text(encoding="utf-8")
            asked = self.peers or self.asked
            told = re.search(rf"^# {asked}: .*\n# +(?:holds|fails) if TChecker reaches -l (\S+)$", words, re.MULTILINE)
            if told is None:
                return Instance(ours)
            labels = told.group(1)
        return _with_regions(ours, network, labels, folder)


@dataclass(frozen=True, slots=True)
class TheirFamily:
    """A generator of TChecker's examples; all programs read what it writes.

    Attributes:
        script: its file name.
        arguments: with `{size}` where the size goes.
        labels: what is looked for; None: nothing, all states are gone through.
        sizes: those of a run that names none, from the smallest up.
    """

    script: str
    arguments: str
    labels: str | None
    sizes: tuple[int, ...]

    def instance(self, size: int, folder: Path, examples: Path) -> Instance:
        network = folder / f"{Path(self.script).stem}_{size}.tck"
        arguments = shlex.split(self.arguments.format(size=size))
        network.write_text(finished(["bash", str(examples / self.script), *arguments]).output, encoding="utf-8")
        asked = "E<> false" if self.labels is None else "E<> " + self.labels.replace(",", " && ")
        return Instance((str(network), asked), network, self.labels)


def _with_regions(ours: tuple[str, ...], network: Path, labels: str | None, folder: Path) -> Instance:
    regions = folder / f"{network.stem}_regions"
    goals = tarzan_files.written(network, labels, regions)
    return Instance(ours, network, labels, regions if goals is not None else None, goals or ())


ALL = "all states"

OWN = {
    "csma_cd": OurFamily("models/classics/csma_cd.ta", "collision_noticed", (8, 12, 18, 26, 40), peers=ALL),
    "fddi": OurFamily("models/classics/fddi.ta", "one_sender", (8, 14, 30, 50, 80), peers=ALL),
    "dining": OurFamily("models/classics/dining_philosophers.ta", "neighbours", (5, 7, 9, 10, 11, 13)),
    "critical_region": OurFamily("models/classics/critical_region.ta", "exclusive", (3, 4, 6, 9, 12)),
    "brp": OurFamily("models/classics/brp.ta", "no_failure", (8, 64, 200, 600)),
    "client_3_0": OurFamily("models/micro_xrce_dds/client_3_0.ta", "ECFS", (0, 1, 2), "LOSSES"),
    "publication": OurFamily("models/micro_xrce_dds/publication.ta", "RMIO", (0, 1, 2), "LOSSES"),
    "gates": OurFamily("bench/models/gates.ta", "opens", (6, 8, 10, 16)),
    "switches": OurFamily("bench/models/switches.ta", "together", (8, 12, 16)),
    "independent": OurFamily("bench/models/independent.ta", "all_done", (12, 25, 50, 100, 200)),
}
"""Models of this project."""

UPPAAL = {
    "fischer": OurFamily("models/classics/fischer.ta", "mutual_exclusion", (6, 8, 10, 20, 40, 70)),
    "train_gate": OurFamily("models/classics/train_gate.ta", "one_at_a_time", (4, 6, 9, 13, 18)),
    "bridge": OurFamily("bench/models/uppaal/bridge.ta", "not_sooner", (4, 5, 6, 7, 8, 9), peers=ALL),
    "doors": OurFamily("bench/models/uppaal/doors.ta", "one_open", (2, 3, 4, 6, 10, 20, 40)),
    "newspaper": OurFamily("bench/models/uppaal/newspaper.ta", "nothing", (2, 3, 4, 5), peers=ALL),
}
"""Networks in the shape of demos of UPPAAL."""

_MODELS = "bench/models/tarzan"
_EVEN = (2, 4, 6, 8, 10, 12, 14, 16)
_FOURS = (4, 8, 12, 16, 20)

TARZAN = {
    "tz_and_or": OurFamily(shapes.and_or, "nothing", (1,), peers=ALL),
    "tz_boolean": OurFamily(f"{_MODELS}/boolean.ta", "together", _EVEN, peers="all_up"),
    "tz_csma_cd": OurFamily(shapes.csma_cd, "one_of_seven", (20, 22, 25, 30, 50)),
    "tz_ex_sith": OurFamily(f"{_MODELS}/ex_sith.ta", "bad", (1,), ""),
    "tz_fischer": OurFamily(f"{_MODELS}/fischer.ta", "both", (2, 3, 4, 5, 6)),
    "tz_flower": OurFamily("bench/models/flower.ta", "together", _EVEN),
    "tz_gates": OurFamily(shapes.gates, "opens", _EVEN),
    "tz_latch": OurFamily(f"{_MODELS}/latch.ta", "follows", (1,), ""),
    "tz_lynch": OurFamily(f"{_MODELS}/lynch.ta", "both", (2, 3, 4)),
    "tz_maler": OurFamily(f"{_MODELS}/maler.ta", "finished", (1,), ""),
    "tz_medical": OurFamily(f"{_MODELS}/medical_workflow.ta", "all_done", (10, 20, 30, 40, 50, 60, 70, 80, 90, 100)),
    "tz_mpeg2": OurFamily(shapes.mpeg2, "all_out", _FOURS),
    "tz_pagerank": OurFamily(shapes.pagerank, "last", (1, 100)),
    "tz_rcp": OurFamily(f"{_MODELS}/rcp.ta", "decided", (1,), ""),
    "tz_ring": OurFamily("bench/models/ring.ta", "together", _EVEN),
    "tz_simple": OurFamily(f"{_MODELS}/simple.ta", "nothing", (7, 100, 1000), peers=ALL),
    "tz_soldiers": OurFamily(f"{_MODELS}/soldiers.ta", "escape", (1,), ""),
    "tz_sr_latch": OurFamily(shapes.sr_latch, "falls", (1,)),
    "tz_trains": OurFamily(f"{_MODELS}/trains.ta", "raised", _FOURS),
    "tz_vikings": OurFamily(f"{_MODELS}/vikings.ta", "all_safe", _FOURS),
}
"""The 82 networks of TARZAN's benchmark, 20 families, by generators of our own."""

TCHECKER = {
    "tck_ad94": TheirFamily("ad94.sh", "", "green", (1,)),
    "tck_ad94_mid": TheirFamily("ad94_mid.sh", "", "green", (1,)),
    "tck_corsso": TheirFamily("corsso.sh", "{size}", None, (2, 3, 4, 5)),
    "tck_critical_region": TheirFamily("critical-region.sh", "{size}", None, (3, 4, 5)),
    "tck_critical_region_async": TheirFamily("critical-region-async.sh", "{size}", "error1", (3, 7, 15, 30, 65)),
    "tck_csmacd": TheirFamily("csmacd.sh", "{size}", None, (6, 8, 10, 12, 14)),
    "tck_dining": TheirFamily("dining-philosophers.sh", "{size}", "eating1,eating2", (5, 7, 9, 10, 11, 13)),
    "tck_fddi": TheirFamily("fddi.sh", "{size}", None, (8, 14, 20, 30, 50)),
    "tck_fire_alarm": TheirFamily("fire-alarm.sh", "{size}", None, (8, 12, 16, 18, 24)),
    "tck_fischer": TheirFamily("fischer.sh", "{size}", "cs1,cs2", (6, 8, 10, 20, 40)),
    "tck_fischer_async": TheirFamily("fischer-async.sh", "{size}", "cs1,cs2", (6, 8, 10, 20, 30)),
    "tck_fischer_concurrent": TheirFamily("fischer-async-concurrent.sh", "{size}", "cs1,cs2", (4, 6, 8, 10, 11)),
    "tck_gps": TheirFamily("gps-mc.sh", "{size} {size} 100 150", "error", (4, 6, 8, 10, 14)),
    "tck_job_shop": TheirFamily("job-shop.sh", "{size} {size} 6 1 7", "scheduled", (4, 5, 6, 7)),
    "tck_leader": TheirFamily("leader-election.sh", "{size} 4", "error", (5, 10, 20, 40, 65)),
    "tck_leader_async": TheirFamily("leader-election-async.sh", "{size} 4", "error", (5, 10, 20, 40, 65)),
    "tck_parallel": TheirFamily("parallel.sh", "{size}", None, (6, 10, 14, 19)),
    "tck_parallel_b": TheirFamily("parallel-b.sh", "{size}", None, (5, 8, 11, 20, 40)),
    "tck_parallel_c": TheirFamily("parallel-c.sh", "{size}", None, (5, 8, 11, 14, 30)),
    "tck_train_gate": TheirFamily("train_gate.sh", "{size}", "cross1,cross2", (3, 4, 5, 6, 7)),
}
"""What the scripts in the folder of TChecker's examples write."""

OURS = OWN | UPPAAL | TARZAN
GROUPS: dict[str, dict[str, OurFamily] | dict[str, TheirFamily]] = {
    "Models of this project": OWN,
    "Demos of UPPAAL": UPPAAL,
    "TARZAN's benchmark": TARZAN,
    "TChecker's examples": TCHECKER,
}
"""Titles and families, as a page shows them."""
