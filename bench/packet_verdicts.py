"""The properties of the reliable stream on recorded captures, against what the logs of relay and applications imply.

    python bench/packet_verdicts.py FOLDER

FOLDER has the captures that tests/data/packet_verdicts.csv names. Prints every difference.
"""

from __future__ import annotations

import csv
import sys
import time
from pathlib import Path

import tachk

ROOT = Path(__file__).resolve().parents[1]


def main(folder: Path) -> None:
    begin = time.process_time()
    judged = different = 0
    for row in csv.DictReader((ROOT / "tests/data/packet_verdicts.csv").read_text(encoding="utf-8").splitlines()):
        name = row["capture"]
        report = tachk.monitor(ROOT / "queries/micro_xrce_dds.ta", folder / f"{name}.pcap")
        for verdict in report:
            if verdict.name in row:
                judged += 1
                if verdict.truth.word != row[verdict.name]:
                    different += 1
                    print(f"{name}: {verdict.name} is {verdict.truth.word}, not {row[verdict.name]}; {row['reason']}")
    print(f"{judged} verdicts, {different} different, {time.process_time() - begin:.1f} s")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
