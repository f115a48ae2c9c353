"""How short may the waiting time of Fischer's protocol be? A sweep over a constant, as a table.

python examples/sweep.py
"""

from __future__ import annotations

from pathlib import Path

import tachk

MODEL = Path(__file__).resolve().parents[1] / "models/classics/fischer.ta"


def main() -> None:
    """Prints one line for each waiting time."""
    print("waiting time   mutual exclusion   states")
    for wait in range(8, 13):
        report = tachk.load(MODEL, N=3, WRITE=10, WAIT=wait).verify(property="mutual_exclusion")
        verdict = report["mutual_exclusion"]
        print(f"{wait:12}   {verdict.answer.value:16}   {verdict.statistics.states_stored:6}")


if __name__ == "__main__":
    main()
