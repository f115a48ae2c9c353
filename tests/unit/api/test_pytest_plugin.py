"""The plug-in of pytest, in processes of their own: `docs/pytest.md` is the first test."""

from __future__ import annotations

import re
import tomllib
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

import pytest

import tachk

pytest_plugins = ["pytester"]
pytestmark = pytest.mark.drawn

CHECKOUT = Path(__file__).parents[3]
PAGE = CHECKOUT / "docs/pytest.md"
INSTALLED = any(entry.value == "tachk.api.pytest_plugin" for entry in metadata.entry_points(group="pytest11"))

LAMP = """clock x;
chan press;
process Lamp() {
    init location off { to on { sync press?; assign x = 0; } }
    location on { invariant x <= 5; to off { guard x >= 3; } }
}
process User() { init location idle { to idle { sync press!; } } }
system Lamp, User;
property can_be_on : E<> Lamp.on;
property not_always : A[] Lamp.off expect fails;
property short : A[] Lamp.on imply x <= 4;
property likely : Pr[<=5](<> Lamp.on) >= 0.1;
"""
LONG = """int[0, 9] a[6];
process P() { init location l { to l { select i : int[0, 5]; guard a[i] < 9; assign a[i] = a[i] + 1; } } }
system P;
property far : A[] a[0] + a[1] + a[2] + a[3] + a[4] + a[5] < 55;
"""
FAULT = """int[0, 2] y = 0;
process P() { init location a { to a { assign y = y + 1; } } location never; }
system P;
property in_range : A[] y <= 2;
"""
LIBRARY = "process Missing() { init location a { to a { sync elsewhere!; } } }\n"
WRONG = "process P() { init location a { to b; } }\nsystem P;\nproperty p : A[] P.a;\n"


def run(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    plugin = () if INSTALLED else ("-p", "tachk.api.pytest_plugin")
    return pytester.runpytest_subprocess(*plugin, "-p", "no:cacheprovider", *arguments)


def write(pytester: pytest.Pytester, **texts: str) -> Path:
    """Writes ``models/NAME.ta`` and a test in Python beside the folder."""
    folder = pytester.mkdir("models")
    for name, text in texts.items():
        (folder / f"{name}.ta").write_text(text, encoding="utf-8")
    pytester.makepyfile(test_python="def test_python(): pass")
    return folder


def test_the_distribution_names_the_plugin() -> None:
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["entry-points"]["pytest11"] == {"tachk": "tachk.api.pytest_plugin"}
    assert not any(wanted.startswith("pytest") for wanted in project["dependencies"])


@pytest.mark.skipif(not PAGE.is_file(), reason="needs a checkout")
def test_the_page_shows_what_pytest_prints(pytester: pytest.Pytester) -> None:
    page = PAGE.read_text(encoding="utf-8")
    (model,) = re.findall(r"^```ta models/lamp.ta\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    (shown,) = re.findall(r"^```text\n\$ pytest --tachk models/\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    pytester.mkdir("models").joinpath("lamp.ta").write_text(model, encoding="utf-8")
    result = run(pytester, "--tachk", "models/")
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    expected = [
        re.sub(r"[\d.]+ (ms|kB)", "*", line).replace("...", "*").replace("[", "[[]") for line in shown.splitlines()
    ]
    result.stdout.fnmatch_lines([line.rstrip() + "*" for line in expected])


def test_models_are_tested_beside_what_pytest_finds(pytester: pytest.Pytester) -> None:
    folder = write(pytester, lamp=LAMP, library=LIBRARY)
    text = tachk.export(tachk.loads(LAMP), "xml").replace(">short<", ">It is short<")
    (folder / "lamp.xml").write_text(text, encoding="utf-8")
    (folder / "other.xml").write_text("<other/>", encoding="utf-8")
    (folder / "none.ta").write_text("process P() { init location a { } }\nsystem P;\n", encoding="utf-8")
    listed = run(pytester, "--tachk", "models", "--collect-only", "-q")
    names = ["can_be_on", "not_always", "short", "likely"]
    assert [line for line in listed.outlines if "::" in line] == [
        *(f"models/lamp.ta::{name}" for name in names),
        *(f"models/lamp.xml::{name.replace('short', 'q3')}" for name in names),
        "test_python.py::test_python",
    ]
    result = run(pytester, "--tachk", "models", "-rsf", "-k", "short or not_always")
    result.assert_outcomes(passed=2, failed=2, skipped=2, deselected=5)
    result.stdout.fnmatch_lines_random(
        ["*models/library.ta has no system line*", "*models/none.ta states no property", "FAILED models/lamp.xml::q3 *"]
    )
    assert run(pytester, "models").ret == pytest.ExitCode.NO_TESTS_COLLECTED


def test_one_property_is_tested_without_an_option(pytester: pytest.Pytester) -> None:
    write(pytester, lamp=LAMP)
    run(pytester, "models/lamp.ta::not_always").assert_outcomes(passed=1)
    run(pytester, "models/lamp.ta::not_always", "--tachk", "models").assert_outcomes(passed=1)
    run(pytester, "test_python.py", "--tachk", "models", "-k", "not_always or python").assert_outcomes(
        passed=2, deselected=3
    )


def test_a_setting_names_models(pytester: pytest.Pytester) -> None:
    write(pytester, lamp=LAMP)
    pytester.makeini("[pytest]\ntachk_models = models\n")
    run(pytester).assert_outcomes(passed=4, failed=1)
    run(pytester, "models", "-k", "short").assert_outcomes(failed=1, deselected=3)
    run(pytester, "test_python.py").assert_outcomes(passed=1)


def test_a_wrong_model_is_an_error_with_its_place(pytester: pytest.Pytester) -> None:
    write(pytester, lamp=LAMP, wrong=WRONG)
    result = run(pytester, "--tachk", "models", "--continue-on-collection-errors")
    result.assert_outcomes(passed=4, failed=1, errors=1)
    result.stdout.fnmatch_lines(["models/wrong.ta:1:36: error[[]E0209[]]: *`b`", "*to b;*", "*   ^", "help: *"])
    assert "Traceback" not in result.stdout.str()


def test_a_limit_is_no_answer(pytester: pytest.Pytester) -> None:
    write(pytester, long=LONG)
    result = run(pytester, "--tachk", "models/long.ta", "--tachk-max-seconds", "0.3")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(
        ["unknown: time limit (--tachk-max-seconds 0.3)", "FAILED models/long.ta::far - unknown*"]
    )


def test_what_cannot_be_tested_is_said(pytester: pytest.Pytester) -> None:
    write(pytester, game=LAMP + "property won : control: A[] Lamp.off;\n")
    assert run(pytester, "--tachk", "nowhere").ret == pytest.ExitCode.USAGE_ERROR
    run(pytester, "models/game.ta", "-k", "won").assert_outcomes(skipped=1, deselected=4)
    pytester.mkdir("empty")
    result = run(pytester, "--tachk", "empty")
    result.assert_outcomes(passed=1, warnings=1)
    result.stdout.fnmatch_lines(["*ModelWarning: --tachk empty: no model was collected there*"])


def test_run_time_errors_and_warnings_have_their_places(pytester: pytest.Pytester) -> None:
    write(pytester, fault=FAULT)
    result = run(pytester, "models/fault.ta", "--tachk-max-seconds", "60")
    result.assert_outcomes(failed=1, warnings=1)
    result.stdout.fnmatch_lines(["unknown: run-time error", "models/fault.ta:2:47: error[[]E0761[]]: *"])
    result.stdout.fnmatch_lines(["models/fault.ta:2", "*ModelWarning: models/fault.ta:2:*: warning[[]W0404[]]: *"])


@pytest.mark.skipif(find_spec("xdist") is None, reason="pytest-xdist is not installed")
@pytest.mark.parametrize("how", ["load", "loadfile"])
def test_several_processes_give_the_same_answers(pytester: pytest.Pytester, how: str) -> None:
    write(pytester, lamp=LAMP, again=LAMP)
    result = run(pytester, "--tachk", "models", "-n", "2", "--dist", how)
    result.assert_outcomes(passed=7, failed=2)
    result.stdout.fnmatch_lines_random(["FAILED models/lamp.ta::short - fails, expected: holds"])
