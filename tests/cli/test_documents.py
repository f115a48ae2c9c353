"""Runs the documents of this folder: Markdown in which commands stand with their output and exit status.

A fenced block with a file name after its language (```` ```ta lamp.ta ````) writes that file into the document's own
folder. A ``console`` block holds commands (``$ tachk ...``), each followed by its standard output and standard error
as one text and, unless the status is 0, by a line ``[exit N]``. ``...`` stands for any text in a line, or, alone on a
line, for any number of lines.

The README and the pages of docs are such documents too. They show what really happens in the checkout, so there
measured times and sizes may differ. The tutorial brings the files that it speaks of.
"""

from __future__ import annotations

import doctest
import io
import re
import shlex
from collections.abc import Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from tachk.cli.main import app

pytestmark = pytest.mark.drawn

HERE = Path(__file__).parent
CHECKOUT = HERE.parents[1]
MEASURED = re.compile(r"\d[\d.]* (ms|s|min|B|kB|MB|GB)\b")
FENCE = re.compile(r"^```(\w*) ?([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Command:
    line: int
    arguments: list[str]
    output: str
    status: int


def read_document(path: Path) -> tuple[dict[str, str], list[Command]]:
    text = path.read_text(encoding="utf-8")
    files: dict[str, str] = {}
    commands: list[Command] = []
    for fence in FENCE.finditer(text):
        language, name, body = fence.groups()
        if language == "console":
            commands += read_commands(body, text[: fence.start(3)].count("\n"))
        elif name:
            files[name] = body
    return files, commands


def read_commands(body: str, lines_before: int) -> Iterator[Command]:
    for match in re.finditer(r"^\$ tachk ?(.*)\n((?:(?!\$ ).*\n)*)", body, re.MULTILINE):
        output, status = match[2], 0
        ending = re.search(r"^\[exit (\d+)\]\n\Z", output, re.MULTILINE)
        if ending:
            output, status = output[: ending.start()], int(ending[1])
        line = lines_before + body[: match.start()].count("\n") + 1
        yield Command(line, shlex.split(match[1]), output, status)


def pattern(expected: str) -> str:
    lines = []
    for line in expected.splitlines():
        if line.strip() == "...":
            lines.append(r"(?:.*\n)*?")
        else:
            lines.append(".*?".join(re.escape(part.rstrip("\n")) for part in line.rstrip().split("...")) + r"[ ]*\n")
    return "".join(lines)


def run(arguments: list[str]) -> tuple[str, int]:
    out = io.StringIO()
    with redirect_stdout(out), redirect_stderr(out), pytest.raises(SystemExit) as end:
        app(arguments, prog_name="tachk")
    code = end.value.code
    return out.getvalue(), 0 if code is None else int(code)


def check_in_page(path: Path, command: Command) -> None:
    """Whether a command does what the page says; measured times and sizes may differ."""
    output, status = run(command.arguments)
    check(path, replace(command, output=without_measurements(command.output)), without_measurements(output), status)


def check(path: Path, command: Command, output: str, status: int) -> None:
    place = f"{path.name}:{command.line}"
    assert status == command.status, f"{place}: exit status {status}, output:\n{output}"
    message = f"{place}: expected\n{command.output}\nbut the output is\n{output}"
    assert re.fullmatch(pattern(command.output), output), message


PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    "docs/llms.txt",
    *(str(page.relative_to(CHECKOUT)) for page in sorted((CHECKOUT / "docs").rglob("*.md"))),
)
TUTORIAL = "docs/tutorial.md"
IN_ORDER = (TUTORIAL, "docs/tutorials/from_uppaal.md", "docs/tutorials/log.md", "docs/tutorials/notebook.md")
"""Pages whose files, commands and Python go in the order of the page, in an empty folder."""

ELSEWHERE = ("docs/own_program.md",)
"""Pages with a test module of their own."""


def showing(brings_files: bool) -> list[str]:
    """The pages with commands, but for `IN_ORDER` and `ELSEWHERE`, that bring their files, or that do not."""
    pages = []
    for name in PAGES:
        files, commands = read_document(CHECKOUT / name)
        if commands and name not in (*IN_ORDER, *ELSEWHERE) and bool(files) is brings_files:
            pages.append(name)
    return pages


@pytest.mark.parametrize("path", sorted(HERE.glob("*.md")), ids=lambda path: path.stem)
def test_document(path: Path, tmp_path: Path) -> None:
    commands = written_out(path, tmp_path)
    with chdir(tmp_path):
        for command in commands:
            check(path, command, *run(command.arguments))


@pytest.mark.parametrize("name", showing(brings_files=True))
def test_pages_that_bring_their_files(name: str, tmp_path: Path) -> None:
    commands = written_out(CHECKOUT / name, tmp_path)
    with chdir(tmp_path):
        for command in commands:
            check_in_page(CHECKOUT / name, command)


def written_out(path: Path, folder: Path) -> list[Command]:
    """Writes the files of a document into a folder; its commands."""
    files, commands = read_document(path)
    assert commands, "the document has no command"
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return commands


@pytest.mark.parametrize("name", showing(brings_files=False))
def test_pages_that_show_commands_in_the_checkout(name: str) -> None:
    readme = CHECKOUT / name
    _, commands = read_document(readme)
    shown = re.findall(r"^\$ tachk", readme.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(commands) == len(shown), "every command stands in a fence of the language console"
    with chdir(CHECKOUT):
        for command in commands:
            check_in_page(readme, command)


@pytest.mark.parametrize("name", IN_ORDER)
def test_tutorials_go_as_they_say(name: str, tmp_path: Path) -> None:
    """Files are written and commands and Python run in the order of the page."""
    page = CHECKOUT / name
    text = page.read_text(encoding="utf-8")
    names: dict[str, object] = {}
    done = []
    with chdir(tmp_path):
        for fence in FENCE.finditer(text):
            language, file, body = fence.groups()
            line = text[: fence.start(3)].count("\n")
            if file:
                Path(file).write_text(body, encoding="utf-8")
            elif language == "console":
                for command in read_commands(body, line):
                    check_in_page(page, command)
                    done.append(command.arguments[0])
            elif language == "pycon":
                run_examples(page.name, body, line, names)
                done.append("python")
        pictures = {path.name for path in tmp_path.glob("*.svg")}
    assert done
    if name == TUTORIAL:
        assert {"check", "verify", "monitor", "plot", "python"} <= {*done}
        assert pictures == {"monday.svg"}


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_to_files_and_headings(name: str) -> None:
    page = CHECKOUT / name
    for link in re.findall(r"\]\((?!\w+://)([^)\s]+)\)", page.read_text(encoding="utf-8")):
        path, _, heading = link.partition("#")
        target = (page.parent / path) if path else page
        assert target.exists(), link
        if heading:
            headings = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            assert heading in {re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-") for text in headings}, link


GIVEN = {
    "docs/tour.md": "",
    "docs/monitoring.md": """
import pandas, tachk
events = [(0.5, {"request": True, "answer": False}), (7.25, {"request": False, "answer": True})]
frame = pandas.read_csv("examples/cooling/vessel.csv", comment="#", header=0)
""",
    "docs/pictures.md": "",
    "docs/uppaal.md": """
import pathlib, tachk
pathlib.Path("model.xml").write_text(tachk.export(tachk.load("models/classics/fischer.ta"), "xml"), encoding="utf-8")
""",
}
"""What the examples of a page take for granted."""


@pytest.mark.parametrize("name", GIVEN)
def test_examples_in_python_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder in ("models", "examples"):
        (tmp_path / folder).symlink_to(CHECKOUT / folder)
    (tmp_path / "plant.stl").symlink_to(CHECKOUT / "examples/cooling/vessel.stl")
    (tmp_path / "train_gate.ta").symlink_to(CHECKOUT / "models/classics/train_gate.ta")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(GIVEN[name], names)
    text = (CHECKOUT / name).read_text(encoding="utf-8")
    blocks = [fence for fence in FENCE.finditer(text) if fence[1] == "python"]
    assert blocks
    for fence in blocks:
        line = text[: fence.start(3)].count("\n")
        exec(compile("\n" * line + fence[3], name, "exec"), names)


@pytest.mark.parametrize("name", ["docs/python.md", "docs/agents.md"])
def test_pages_with_python_go_as_they_say(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CHECKOUT)
    text = (CHECKOUT / name).read_text(encoding="utf-8")
    names: dict[str, object] = {}
    for fence in FENCE.finditer(text):
        assert fence[1] in {"pycon", "json"}
        if fence[1] == "pycon":
            run_examples(name, fence[3], text[: fence.start(3)].count("\n"), names)


def run_examples(name: str, body: str, line: int, names: dict[str, object]) -> None:
    """Runs what a person types at Python's prompt; later examples see the names of earlier ones."""
    examples = doctest.DocTestParser().get_doctest(body, {}, name, name, line)
    examples.globs = names
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    results = runner.run(examples, out=said.append, clear_globs=False)
    assert results.attempted
    assert results.failed == 0, "".join(said)


def without_measurements(text: str) -> str:
    return re.sub(" {2,}", "  ", MEASURED.sub(r"# \1", text))


def test_pattern_is_strict_where_there_are_no_dots() -> None:
    assert re.fullmatch(pattern("a\nb c\n"), "a\nb c\n")
    assert not re.fullmatch(pattern("a\nb c\n"), "a\nb  c\n")
    assert not re.fullmatch(pattern("a\n"), "a\nb\n")
    assert re.fullmatch(pattern("a\n...\nz ... s\n"), "a\nb\nc\nz 3 ms s\n")
