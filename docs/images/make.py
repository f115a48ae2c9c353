"""Makes the pictures of the README, each for light and for dark screens: `python docs/images/make.py`.

They show the model `gate.ta` that stands in the README. The page about sequence charts has one of a capture, too. A
test checks that the drawn ones are up to date. The report is photographed by Chromium, where that is installed.
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
from tachk.xrce.report.sequence_chart import chart_of_capture
from tachk.xrce.transmissions import read_transmissions

FOLDER = Path(__file__).resolve().parent
README = FOLDER.parents[1] / "README.md"
CAPTURE = FOLDER.parents[1] / "tests/data/captures/starved_heartbeat.pcap"
MODEL = "gate.ta"

WIDTH, HEIGHT = 900, 1040
"""Of the picture of a report, in pixels."""

_DARK = re.compile(r"\n@media \(prefers-color-scheme:dark\)\{\n((?:[^}\n]*\}\n)*)\}")
_PAPER = re.compile(r"\.paper\{fill:#[0-9a-f]+\}\n")


def themes(svg: str) -> dict[str, str]:
    """A picture as it is on light and on dark screens, without its background: the page around it has one."""
    return {
        "light": _PAPER.sub(".paper{fill:none}\n", _DARK.sub("", svg)),
        "dark": _PAPER.sub(".paper{fill:none}\n", _DARK.sub(r"\n\1", svg)),
    }


def model_text() -> str:
    """The model in the README."""
    block = re.search(rf"```ta {MODEL}\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert block is not None
    return block[1]


def automaton() -> str:
    return tachk.draw(tachk.loads(model_text()), "Barrier").svg


def chart() -> str:
    """The run in which a train crosses while the barrier closes."""
    run = run_to_json(tachk.loads(model_text()).verify().record)
    return draw_chart(lay_out(chart_of_run(steps_of_result(run, run["results"][0])))).svg


def chart_of_a_capture() -> str:
    """A lost message that no HEARTBEAT names for a long time. Its file is dark where the reader prefers that."""
    recording = read_transmissions(CAPTURE, ())
    return draw_chart(lay_out(chart_of_capture(recording, CAPTURE.name))).svg


def drawn() -> dict[str, str]:
    """The texts of the SVG files by their names."""
    of_the_readme = {
        f"{name}_{theme}.svg": text
        for name, svg in (("gate_automaton", automaton()), ("gate_run", chart()))
        for theme, text in themes(svg).items()
    }
    return {**of_the_readme, "../charts.svg": chart_of_a_capture()}


def photograph(chromium: str) -> None:
    """Writes pictures of the report about the model."""
    with TemporaryDirectory() as folder:
        Path(folder, MODEL).write_text(model_text(), encoding="utf-8")
        command = [sys.executable, "-m", "tachk", "report", MODEL, "-o", "gate.html"]
        subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, check=False)
        for theme, scheme in (("light", 1), ("dark", 0)):
            options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
            options += [f"--user-data-dir={folder}/profile", "--virtual-time-budget=8000"]
            options += [f"--window-size={WIDTH},{HEIGHT}", f"--blink-settings=preferredColorScheme={scheme}"]
            target = f"--screenshot={FOLDER / f'gate_report_{theme}.png'}"
            subprocess.run(
                [chromium, *options, target, Path(folder, "gate.html").as_uri()], capture_output=True, check=True
            )


def main() -> None:
    for name, text in drawn().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        sys.exit("The pictures of the report stay as they are: there is no Chromium here.")
    photograph(chromium)


if __name__ == "__main__":
    main()
