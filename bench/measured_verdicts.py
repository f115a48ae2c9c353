"""What models with measured settings say, and what the captures show that they were measured in.

    python bench/measured_verdicts.py FOLDER [--only PREFIX] [--model MODEL] [--seconds 120]

For each FILE.pcap of the folder: the settings of `tachk xrce measure`, and for each of the seven properties what `tachk
monitor` says of the capture and `tachk verify` of the model. It contradicts the capture where a property that the
capture violates holds in the model; `open` is what the capture ends too early for.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from pathlib import Path

import tachk
from tachk.engine.options import Limits, Options, SearchOrder

ROOT = Path(__file__).resolve().parents[1]
SEVEN = ("ECFS", "ECRA", "NIWS", "RMIO", "RMIO2", "TMRK", "FARS")


def verdicts(capture: Path, model: str, seconds: float) -> tuple[dict[str, int], dict[str, str]]:
    """Settings that the model has, and its answers."""
    constants = {name for name, _ in tachk.load(model).network.constants}
    measured = tachk.measure(capture).definitions(1)
    settings = {name: value for name, value in measured.items() if name in constants}
    loaded = tachk.load(model, **settings)
    return settings, {name: answer(loaded, name, seconds) for name in SEVEN}


def answer(model: tachk.Model, name: str, seconds: float) -> str:
    """Violations are looked for depth first, for an eighth of the time; then all states, breadth first."""
    for options, part in ((Options(order=SearchOrder.DFS), 0.125), (Options(), 0.875)):
        limits = Limits(seconds=part * seconds)
        verdict = model.verify(property=name, options=options, limits=limits, trace=False)[name]
        if verdict.answer is not tachk.Answer.UNKNOWN:
            break
    return str(verdict.answer)


def compared(answer: str, truth: str) -> str:
    """``agree``, ``possible`` where the model allows more than this capture shows, ``CONTRADICT``, ``open``, ``?``."""
    if answer == "unknown":
        return "?"
    if truth == "true":
        return "agree" if answer == "holds" else "possible"
    if truth == "false":
        return "CONTRADICT" if answer == "holds" else "agree"
    return "open: holds" if answer == "holds" else "agree"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--model", default=str(ROOT / "models/micro_xrce_dds/client_3_0.ta"))
    parser.add_argument("--seconds", type=float, default=120)
    asked = parser.parse_args()
    counted: Counter[str] = Counter()
    for capture in sorted(asked.folder.glob(f"{asked.only}*.pcap")):
        begin = time.monotonic()
        shown = {v.name: v.truth.word for v in tachk.monitor(ROOT / "queries/micro_xrce_dds.ta", capture)}
        settings, answers = verdicts(capture, asked.model, asked.seconds)
        print(f"{capture.stem}: {' '.join(f'{name}={value}' for name, value in settings.items())}")
        for name, answer in answers.items():
            found = compared(answer, shown.get(name, "undetermined"))
            counted[found] += 1
            if found != "agree" or answer == "fails":
                print(f"    {name}: the model says {answer}, the capture {shown.get(name)}: {found}")
        print(f"    {time.monotonic() - begin:.1f} s", flush=True)
    print(", ".join(f"{count} {word}" for word, count in counted.most_common()))


if __name__ == "__main__":
    main()
