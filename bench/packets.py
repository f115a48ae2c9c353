"""How long decoding and monitoring a large capture takes beside tshark, and how much memory a live one needs.

    python bench/packets.py CAPTURE [PACKETS]

Repeats CAPTURE, a pcap file, until there are so many packets (10^6), each repetition 100 s later, in a file in the
current directory. Ports are those to which sessions are created. tshark lists the packets if it is installed.
"""

from __future__ import annotations

import os
import resource
import shutil
import struct
import subprocess
import sys
import time
from pathlib import Path

from tachk.api.monitoring import monitor
from tachk.recordings.monitors.online import Monitor
from tachk.xrce.datagrams import datagrams
from tachk.xrce.messages import MessageReader
from tachk.xrce.packets import read_packets
from tachk.xrce.submessages import submessages
from tachk.xrce.traces.arriving import Pipe
from tachk.xrce.traces.live import LivePackets
from tachk.xrce.transmissions import session_ports

QUERIES = Path(__file__).resolve().parents[1] / "queries/micro_xrce_dds.ta"
LIVE = ("ECFS", "ECRA", "NIWS", "RMIO", "RMIO2", "TMRK", "TMRK2", "FARS")


def repeated(capture: Path, packets: int, to: Path) -> None:
    octets = capture.read_bytes()
    records, at = [], 24
    while at < len(octets):
        seconds, fraction, size, original = struct.unpack_from("<IIII", octets, at)
        records.append((seconds, fraction, size, original, octets[at + 16 : at + 16 + size]))
        at += 16 + size
    with to.open("wb") as out:
        out.write(octets[:24])
        for number in range(packets):
            lap, place = divmod(number, len(records))
            seconds, fraction, size, original, packet = records[place]
            out.write(struct.pack("<IIII", seconds + 100 * lap, fraction, size, original) + packet)


def decoded(capture: Path, ports: list[int]) -> int:
    reader = MessageReader(ports)
    with capture.open("rb") as stream:
        return sum(len(submessages(reader.read(datagrams(packets))).kind) for packets in read_packets(stream))


def judged_live(capture: Path, ports: list[int]) -> list[int]:
    """Kilobytes that the process has needed at most, after each tenth of the rows."""
    needed = []
    with capture.open("rb") as stream:
        live = LivePackets("-", Pipe(stream.fileno()), ports, time.monotonic_ns)
        watching = Monitor(QUERIES, unit="s", select=LIVE, packets=live.packets)
        for rows in live.blocks(watching.columns, watching.decimals):
            watching.push(rows.times, rows.columns, rows.decimals)
            needed.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    return needed[:: max(len(needed) // 10, 1)]


def main(capture: Path, packets: int) -> None:
    large = Path(f"{capture.stem}.{packets}.pcap")
    with capture.open("rb") as stream:
        ports = sorted(session_ports(stream))
    repeated(capture, packets, large)
    begin = time.process_time()
    print("live, most kilobytes so far:", judged_live(large, ports), f"{time.process_time() - begin:.1f} s CPU")
    begin = time.process_time()
    print(f"decode: {decoded(large, ports)} submessages, {time.process_time() - begin:.1f} s CPU")
    begin = time.process_time()
    report = monitor(QUERIES, large, ports=ports, robustness=False)
    words = ", ".join(f"{verdict.name} {verdict.truth.word}" for verdict in report)
    judged = time.process_time() - begin
    print(f"decode and monitor: {judged:.1f} s CPU; {words}")
    if shutil.which("tshark"):
        before = os.times()
        subprocess.run(["tshark", "-r", large], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        after = os.times()
        used = after.children_user + after.children_system - before.children_user - before.children_system
        print(f"tshark -r: {used:.1f} s CPU; decoding and monitoring need {judged / used:.2f} of that")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000)
