"""Makes the pictures of the README, each for light and for dark screens: `python docs/images/make.py`.

A test checks that the drawn ones are up to date. The report is photographed by Chromium, where that is installed.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import tachk
from tachk.report.drawing.sequence.layout import lay_out
from tachk.report.drawing.sequence.sequence_svg import draw_chart
from tachk.report.json_report import run_to_json
from tachk.report.sequence.of_run import chart_of_run
from tachk.report.sequence.run_steps import steps_of_result

FOLDER = Path(__file__).resolve().parent
MODEL = FOLDER.parents[1] / "models" / "classics" / "fischer.ta"
CONSTANTS = {"WAIT": 9, "N": 2}
"""With these two processes meet in their critical sections."""

WIDTH, HEIGHT = 900, 1010
"""Of the picture of a report, in pixels."""

_DARK = re.compile(r"\n@media \(prefers-color-scheme:dark\)\{\n((?:[^}\n]*\}\n)*)\}")
_PAPER = re.compile(r"\.paper\{fill:#[0-9a-f]+\}\n")


def themes(svg: str) -> dict[str, str]:
    """A picture as it is on light and on dark screens, without its background: the page around it has one."""
    return {
        "light": _PAPER.sub(".paper{fill:none}\n", _DARK.sub("", svg)),
        "dark": _PAPER.sub(".paper{fill:none}\n", _DARK.sub(r"\n\1", svg)),
    }


def automaton() -> str:
    return tachk.draw(MODEL, "P").svg


def chart() -> str:
    """The run in which two processes are in their critical sections."""
    record = tachk.load(MODEL, **CONSTANTS).verify(property="mutual_exclusion").record
    run = run_to_json(record)
    return draw_chart(lay_out(chart_of_run(steps_of_result(run, run["results"][0])))).svg


def drawn() -> dict[str, str]:
    """The texts of the SVG files by their names."""
    return {
        f"{name}_{theme}.svg": text
        for name, svg in (("fischer_automaton", automaton()), ("fischer_run", chart()))
        for theme, text in themes(svg).items()
    }


def photograph(chromium: str) -> None:
    """Writes pictures of the report about the model."""
    with TemporaryDirectory() as folder:
        page = Path(folder, "fischer.html")
        constants = [part for name, value in CONSTANTS.items() for part in ("-D", f"{name}={value}")]
        command = [sys.executable, "-m", "tachk", "report", MODEL.name, *constants, "-o", str(page)]
        subprocess.run(command, cwd=MODEL.parent, stdout=subprocess.DEVNULL, check=False)
        for theme, scheme in (("light", 1), ("dark", 0)):
            options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
            options += [f"--user-data-dir={folder}/profile", "--virtual-time-budget=8000"]
            options += [f"--window-size={WIDTH},{HEIGHT}", f"--blink-settings=preferredColorScheme={scheme}"]
            target = f"--screenshot={FOLDER / f'report_{theme}.png'}"
            subprocess.run([chromium, *options, target, page.as_uri()], capture_output=True, check=True)


def main() -> None:
    for name, text in drawn().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        sys.exit("The pictures of the report stay as they are: there is no Chromium here.")
    photograph(chromium)


if __name__ == "__main__":
    main()
