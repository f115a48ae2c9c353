"""Families of networks: where each instance comes from, what is asked of it, and how TChecker is asked the same."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from bench.processes import finished, tachk

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True, slots=True)
class Instance:
    """One network and one question.

    Attributes:
        ours: what follows `tachk verify`.
        network: the same network for TChecker; None if it has no words for it.
        labels: what TChecker looks for; None: it goes through all states, as tachk does where the answer needs it.
    """

    ours: tuple[str, ...]
    network: Path | None
    labels: str | None


@dataclass(frozen=True, slots=True)
class OurFamily:
    """A model of this project in which a constant gives the size.

    Attributes:
        model: its path.
        constant: the one that gives the size.
        asked: the property.
        sizes: those of a run that names none, from the smallest up.
    """

    model: str
    constant: str
    asked: str
    sizes: tuple[int, ...]

    def instance(self, size: int, folder: Path, *, exported: bool) -> Instance:
        model = str(ROOT / self.model)
        definition = f"{self.constant}={size}"
        ours = (model, "-D", definition, "--property", self.asked)
        if not exported:
            return Instance(ours, None, None)
        network = folder / f"{Path(self.model).stem}_{size}.tck"
        export = tachk("convert", model, "-D", definition, "-o", str(network))
        finished(export, statuses=(0, 2, 3), told=False)  # or TChecker has no words for something
        if not network.exists():
            return Instance(ours, None, None)
        words = network.read_text(encoding="utf-8")
        told = re.search(rf"^# {self.asked}: .*\n# +(?:holds|fails) if TChecker reaches -l (\S+)$", words, re.MULTILINE)
        return Instance(ours, network, told and told.group(1))


@dataclass(frozen=True, slots=True)
class TheirFamily:
    """A generator of TChecker's examples; both programs read what it writes.

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


OURS = {
    "fischer": OurFamily("models/classics/fischer.ta", "N", "mutual_exclusion", (7, 8, 9, 10)),
    "csma_cd": OurFamily("models/classics/csma_cd.ta", "N", "collision_noticed", (8, 9, 10, 11)),
    "train_gate": OurFamily("models/classics/train_gate.ta", "N", "one_at_a_time", (6, 7, 8)),
    "fddi": OurFamily("models/classics/fddi.ta", "N", "one_sender", (8, 14, 30, 50)),
    "dining": OurFamily("models/classics/dining_philosophers.ta", "N", "neighbours", (5, 6, 7)),
    "critical_region": OurFamily("models/classics/critical_region.ta", "N", "exclusive", (3, 4, 5)),
    "brp": OurFamily("models/classics/brp.ta", "N", "no_failure", (8, 16)),
    "client_3_0": OurFamily("models/micro_xrce_dds/client_3_0.ta", "LOSSES", "ECFS", (0, 1)),
    "publication": OurFamily("models/micro_xrce_dds/publication.ta", "LOSSES", "RMIO", (0, 1)),
    # Guards that hold at single moments, in the shapes of TARZAN's benchmark: one run decides.
    "gates": OurFamily("bench/models/gates.ta", "N", "opens", (6, 8, 10, 16)),
    "flower": OurFamily("bench/models/flower.ta", "N", "together", (6, 8, 10, 12)),
    "ring": OurFamily("bench/models/ring.ta", "N", "together", (6, 8, 10, 12)),
    "switches": OurFamily("bench/models/switches.ta", "N", "together", (8, 12, 16)),
    "independent": OurFamily("bench/models/independent.ta", "N", "all_done", (12, 25, 50, 100, 200)),
}
"""By name, for tables and for the command line."""

THEIRS = {
    "tck_fischer": TheirFamily("fischer.sh", "{size}", "cs1,cs2", (8, 9, 10)),
    "tck_fischer_async": TheirFamily("fischer-async.sh", "{size}", "cs1,cs2", (7, 8, 9)),
    "tck_fischer_concurrent": TheirFamily("fischer-async-concurrent.sh", "{size}", "cs1,cs2", (4, 5, 6)),
    "tck_csmacd": TheirFamily("csmacd.sh", "{size}", None, (8, 9, 10)),
    "tck_train_gate": TheirFamily("train_gate.sh", "{size}", "cross1,cross2", (3, 4, 5)),
    "tck_critical_region": TheirFamily("critical-region.sh", "{size}", None, (3, 4)),
    "tck_critical_region_async": TheirFamily("critical-region-async.sh", "{size}", "error1", (3, 4)),
    "tck_fddi": TheirFamily("fddi.sh", "{size}", None, (8, 14, 20)),
    "tck_dining": TheirFamily("dining-philosophers.sh", "{size}", "eating1,eating2", (5, 6, 7)),
    "tck_corsso": TheirFamily("corsso.sh", "{size}", None, (2, 3)),
    "tck_parallel": TheirFamily("parallel.sh", "{size}", None, (4, 5, 6)),
    "tck_parallel_b": TheirFamily("parallel-b.sh", "{size}", None, (4, 5, 6)),
    "tck_parallel_c": TheirFamily("parallel-c.sh", "{size}", None, (4, 5, 6)),
    "tck_fire_alarm": TheirFamily("fire-alarm.sh", "{size}", None, (8, 12, 16)),
    "tck_leader": TheirFamily("leader-election.sh", "{size} 4", "error", (5, 6, 7)),
    "tck_job_shop": TheirFamily("job-shop.sh", "{size} {size} 6 1 7", "scheduled", (4, 5)),
    "tck_gps": TheirFamily("gps-mc.sh", "{size} {size} 100 150", "error", (4, 8)),
}
"""Those that need the folder of TChecker's examples."""
