"""What a start costs: CPU time of whole processes that do next to nothing.

    python bench/start.py
    python bench/start.py --repeat 25 --source /path/to/another/checkout/src

CPU seconds are user and system time by wait4, the least of several runs: what others do on the machine only adds to it.
The first run of each, which does not count, writes the byte code of the modules.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from processes import finished

SOURCE = Path(__file__).resolve().parents[1] / "src"

TRAINS = SOURCE.parent / "models" / "classics" / "train_gate.ta"

MODEL = """process P() { clock x; init location a { to b { guard x >= 1; } } location b; }
system P;
property reached : E<> P.b;
"""


def cpu_seconds(arguments: list[str], source: Path) -> float:
    """User and system time of Python with these arguments."""
    return finished([sys.executable, *arguments], source).cpu_seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=15, help="how often each is run")
    parser.add_argument("--source", type=Path, default=SOURCE, help="the folder that holds the package")
    options = parser.parse_args()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "tiny.ta"
        model.write_text(MODEL, encoding="utf-8")
        programs = {
            "python": ["-c", "pass"],
            "import tachk": ["-c", "import tachk"],
            "tachk.load": ["-c", "import tachk; tachk.load"],
            "tachk --version": ["-m", "tachk", "--version"],
            "tachk --help": ["-m", "tachk", "--help"],
            "tachk check": ["-m", "tachk", "check", str(model)],
            "tachk verify": ["-m", "tachk", "verify", str(model)],
            "three trains": ["-m", "tachk", "verify", str(TRAINS), "-D", "N=3"],
        }
        for name, arguments in programs.items():
            cpu_seconds(arguments, options.source)
            best = min(cpu_seconds(arguments, options.source) for _ in range(options.repeat))
            print(f"{name:<16} {best:.3f} s")


if __name__ == "__main__":
    main()
