"""Contracts between modules that import-linter cannot state, and the cost of starting."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

from tachk.syntax.parsing import tables
from tests.support.sources import tree_of

SOURCES = Path(__file__).parents[2] / "src/tachk"
HEAVY = {
    "_core",
    "analysis",
    "engine.compiler",
    "engine.outcome",
    "frontend",
    "meaning",
    "model",
    "recordings.traces.trace",
    "syntax",
}


def imported_modules(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found.add(node.module or "")
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    return found


def test_few_modules_open_the_door_to_the_core() -> None:
    users = {str(p.relative_to(SOURCES)) for p in SOURCES.rglob("*.py") if "tachk._core" in imported_modules(p)}
    assert users == {
        "xrce/bridge/part.py",
        "simulation/fmi/unit_run.py",
        "simulation/testing/modelled_system.py",
        "engine/state_estimate.py",
        "engine/portfolio.py",
        "engine/taking_turns.py",
        "engine/simulated_runs.py",
        "engine/closed_set.py",
        "engine/core_search.py",
        "engine/cover.py",
        "engine/edge_paths.py",
        "engine/exact/exact_run.py",
        "engine/liveness.py",
        "engine/local_times.py",
        "engine/measuring.py",
        "engine/simulation/simulator.py",
        "engine/simulation/splitting.py",
        "engine/simulation/trials.py",
        "engine/traps.py",
        "engine/zone.py",
        "base/job.py",
        "recordings/traces/core_monitor.py",
        "recordings/traces/linear_monitor.py",
        "recordings/traces/logs/json_table.py",
        "recordings/traces/monitor_group.py",
        "recordings/traces/online_monitor.py",
        "recordings/traces/trace.py",
        "recordings/traces/trace_arrays.py",
        "recordings/traces/trace_csv.py",
    }


LIBRARIES = {"z3", "pandas", "numpy", "networkx", "lark", "jinja2", "rich.table"}


@pytest.mark.parametrize("argument", ["--version", "--help"])
def test_start_loads_nothing_heavy(argument: str) -> None:
    loaded = modules_after(argument)
    assert not loaded & (LIBRARIES | {"fractions"})
    assert not loaded & {f"tachk.{name}" for name in HEAVY}
    assert not any(name.startswith("tachk.cli.commands.") for name in loaded)


def test_options_and_help_of_commands_load_nothing_heavy() -> None:
    program = (
        "import json, sys\nfrom tachk.cli import main\n"
        "for name in main.COMMANDS: main.load_command(name)\n"
        "print(json.dumps([*sys.modules]))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = set(json.loads(done.stdout))
    assert not loaded & LIBRARIES
    assert not loaded & {"tachk._core", "tachk.frontend", "tachk.meaning", "tachk.model.network", "tachk.syntax.ast"}


def test_importing_tachk_is_light() -> None:
    program = "import sys, tachk; print('lark' in sys.modules, 'click' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "False False\n"


MODEL = """process P() { clock x; init location a { to b { guard x >= 1; } } location b; }
system P;
property p : E<> P.b;
"""

UNUSED = {
    "difflib",
    "hashlib",
    "html",
    "jinja2",
    "jsonschema",
    "referencing",
    "lark",
    "matplotlib",
    "networkx",
    "numpy",
    "pandas",
    "tempfile",
    "typer",
    "vcd",
    "xml.etree.ElementTree",
    "z3",
    *(f"tachk.{name}" for name in ("formats.catalogue", "logic", "recordings")),
    *(f"tachk.report.{name}" for name in ("html_report", "json_report", "junit_report", "signal_plot")),
    *(f"tachk.verify.{name}" for name in ("deadlines", "semantic_lint", "extremes", "liveness", "observed_liveness")),
    *(f"tachk.engine.{name}" for name in ("liveness", "smt", "simulation", "symmetry.detection", "symmetry.tables")),
    "tachk.cli.disagreement",
    "tachk.frontend.queries.observer_processes",
    "tachk.recordings.monitors.compiler",
    "tachk.syntax.sentences.parser",
    "tachk.formats.tchecker.reader",
    "tachk.formats.uppaal.reader",
}
"""Of no use to a model in text form whose property is neither a formula nor a sentence."""


@pytest.fixture
def with_tables() -> None:
    """The tables of the grammar are in the cache: without, lark has to compute them."""
    tables.grammar()


def modules_after(*arguments: str) -> set[str]:
    """What is loaded when a command line has been carried out."""
    program = (
        "import json, sys\n"
        "from tachk.cli.main import app\n"
        "try:\n"
        "    app(sys.argv[1:])\n"
        "except SystemExit as end:\n"
        "    assert end.code == 0\n"
        "print(json.dumps(sorted(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.usefixtures("with_tables")
def test_check_loads_no_engine(tmp_path: Path) -> None:
    model = tmp_path / "m.ta"
    model.write_text(MODEL, encoding="utf-8")
    loaded = modules_after("check", str(model))
    assert not loaded & {"rich", "tomllib", "tachk._core", "tachk.engine.zone", "tachk.engine.compiler.lower"}


@pytest.mark.usefixtures("with_tables")
def test_verify_loads_only_what_the_model_needs(tmp_path: Path) -> None:
    model = tmp_path / "m.ta"
    model.write_text(MODEL, encoding="utf-8")
    loaded = modules_after("verify", str(model))
    assert "tachk.engine.zone" in loaded
    assert not loaded & UNUSED


SLOW = {
    *("ast", "click", "dataclasses", "datetime", "dis", "gettext", "inspect", "locale", "pathlib", "pickle"),
    *("platform", "subprocess", "tokenize", "traceback", "urllib.parse"),
    *(f"tachk.cli.{name}" for name in ("commands.verify", "main", "options")),
    *(f"tachk.engine.{name}" for name in ("guided_search", "local_times", "simulated_runs", "exact.exact_run")),
    *(f"tachk.engine.symmetry.{name}" for name in ("abstract_values", "alone", "detection", "terms")),
    *(f"tachk.base.{name}" for name in ("frames", "notebook", "time_units", "whole_files")),
    *(f"tachk.frontend.{name}" for name in ("declarations.functions", "hybrid_clocks", "recordings")),
    *(f"tachk.syntax.{name}" for name in ("picture_layout", "printing.expression_printer")),
    *(f"tachk.syntax.parsing.{name}" for name in ("messages", "old_precedence", "situation", "strict")),
    "tachk.frontend.templates.switched_off",
    *(f"tachk.transform.{name}" for name in ("guided",)),
    *(f"tachk.verify.{name}" for name in ("along_path", "time_optimal")),
}
"""Of no use either to a small model whose query has few states, given with plain options."""


@pytest.mark.usefixtures("with_tables")
@pytest.mark.parametrize("query", ["E<> P.b", "A[] P.x >= 0", "A[] not P.b"])
def test_a_plain_start_loads_nothing_slow(tmp_path: Path, query: str) -> None:
    model = tmp_path / "m.ta"
    model.write_text(MODEL, encoding="utf-8")
    program = (
        "import sys\nbefore = set(sys.modules)\n"
        "from tachk.cli.start import run\n"
        "try:\n    run()\nexcept SystemExit as end:\n    assert end.code in (0, 10)\n"
        "print('\\n', *sorted(set(sys.modules) - before))"
    )
    words = ["verify", str(model), query, "--format", "json"]
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert "tachk.engine.zone" in loaded
    assert sorted(loaded & (UNUSED | SLOW)) == ["tachk.report.json_report"]


@pytest.mark.usefixtures("with_tables")
def test_a_run_that_is_drawn_and_judged_loads_no_library() -> None:
    loaded = modules_after("verify", str(SOURCES.parents[1] / "bench/models/gates.ta"), "-D", "N=10")
    assert {"tachk.engine.simulated_runs", "tachk.engine.exact.exact_run"} <= loaded
    assert not loaded & {"numpy", "pandas", "z3", "networkx"}


@pytest.mark.usefixtures("with_tables")
@pytest.mark.parametrize("form", ["text", "json", "junit", "verifyta"])
def test_reports_load_statistics_only_where_a_model_has_them(tmp_path: Path, form: str) -> None:
    model = tmp_path / "m.ta"
    model.write_text(MODEL, encoding="utf-8")
    loaded = modules_after("verify", str(model), "--format", form, "-o", str(tmp_path / "report"))
    assert not loaded & {
        "numpy",
        "statistics",
        "tachk.engine.simulation",
        "tachk.simulation.statistics",
        "tachk.report.statistics",
    }


@pytest.mark.usefixtures("with_tables")
def test_monitoring_a_table_loads_no_other_reader(tmp_path: Path) -> None:
    table = tmp_path / "t.csv"
    table.write_text("t,x\n0,1\n1,2\n", encoding="utf-8")
    loaded = modules_after("monitor", "G (x < 9)", str(table))
    readers = {
        f"tachk.recordings.traces.{name}"
        for name in ("trace_parquet", "trace_vcd", "logs.messages", "logs.trace_jsonl")
    }
    assert "tachk.recordings.traces.trace_csv" in loaded
    assert not loaded & {
        *readers,
        "tachk.recordings.traces.logs.trace_jsonl",
        "tachk.recordings.traces.logs.trace_hdf5",
    }
    assert not loaded & {"gzip", "tachk.xrce", "tachk.engine.zone"}


def test_one_module_knows_lark() -> None:
    users = {
        str(path.relative_to(SOURCES))
        for path in SOURCES.rglob("*.py")
        if any(name.split(".")[0] == "lark" for name in imported_modules(path))
    }
    assert users == {"syntax/parsing/compile_grammar.py"}


def test_a_page_of_answers_loads_no_library_of_plots(tmp_path: Path) -> None:
    """It would take more memory than most pages."""
    model = tmp_path / "m.ta"
    model.write_text("process P() { init location a { to b {} } location b; } system P; property q: E<> P.b;")
    code = (
        "import sys\nfrom tachk.cli.main import run\n"
        f"sys.argv = ['tachk', 'report', {str(model)!r}, '-o', {str(tmp_path / 'page.html')!r}]\n"
        "try:\n    run()\nexcept SystemExit:\n    pass\nassert 'matplotlib' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "</html>" in (tmp_path / "page.html").read_text(encoding="utf-8")
