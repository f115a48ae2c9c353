"""`tachk report`: write a page that one can hand on."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import limited
from tachk.base.records import dataclass
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.engine.options import Limits

if TYPE_CHECKING:
    from tachk.report.page.content import Answers, Part


@click.command(name="report")
@click.argument(
    "inputs",
    metavar="[MODEL [QUERY]...] [RESULT.json|PICTURE.svg|TEXT.md]...",
    nargs=-1,
    required=True,
    help="A model file and queries about it; results of tachk verify, sweep, simulate and monitor that were written "
    "with --format json; pictures that tachk has drawn; texts in Markdown. All are shown in the order given.",
)
@click.option(
    "properties",
    "--property",
    metavar="NAME",
    multiple=True,
    help="Check only this property; several can be given.",
)
@options.definitions
@click.option("title", "--title", metavar="TEXT", help="The title; without it the name of the first file.")
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.written_file,
    default=Path("report.html"),
    show_default=True,
    help="The page.",
)
@options.max_states()
@options.max_memory
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Write one HTML file with verdicts, runs and pictures, which needs no other file and no network.

    MODEL is checked. The page has every answer with the run behind it, as a chart, in words, and to step through with
    the automata beside it, and what is needed to repeat it. Exit status: as of `tachk verify`.
    """

    (request,) = distributed(given, ReportArguments)
    options.finish(lambda: run_report_page(request, seconds))


@dataclass(frozen=True, slots=True)
class ReportArguments:
    """Arguments of `tachk report`.

    Attributes:
        inputs: result files, pictures, a model, and queries about it.
        title: of the page.
        max_memory: such as ``2G``.
    """

    inputs: tuple[str, ...]
    output: Path
    properties: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()
    title: str | None = None
    states: int | None = None
    max_memory: str | None = None

    @property
    def files(self) -> tuple[str, ...]:
        """Results, pictures and texts."""
        return tuple(text for text in self.inputs if _is_file(text))

    @property
    def model_and_queries(self) -> tuple[str, ...]:
        """The model, if there is one, and the queries about it."""
        return tuple(text for text in self.inputs if not _is_file(text))


_OTHERS = (".csv", ".parquet", ".jsonl", ".vcd", ".run", ".pcap", ".pcapng", ".png", ".pdf", ".html")
"""Endings of files that would else be read as a model."""


def _is_file(text: str) -> bool:
    return Path(text).suffix.lower() in (".json", ".svg", ".md")


def run_report_page(request: ReportArguments, seconds: float | None) -> ExitStatus:
    """Checks the model, reads the results, and writes the page."""
    from tachk.report.page.content import Page
    from tachk.report.page.html import page_to_html

    if (request.properties or request.definitions) and not request.model_and_queries:
        raise UsageError("-D and --property are about a model, and none is named", "name a model, too")
    for text in request.model_and_queries:
        if Path(text).suffix.lower() in _OTHERS:
            raise UsageError(f"cannot show {text}: expected a JSON result, .svg or .md", "tachk plot draws a trace")
    parts: list[Part] = []
    for text in (text for text in request.inputs if text not in request.model_and_queries[1:]):
        number = len(parts)
        parts += _read(Path(text), number) if _is_file(text) else [_verified(request, seconds, number)]
    page = Page(request.title or Path(request.inputs[0]).stem, parts, [*_facts(request)])
    write_whole(request.output, page_to_html(page))
    print(f"written: {request.output}")
    return _status([part.run for part in page.answers])


def _read(path: Path, number: int) -> Iterator[Part]:
    """The parts of the page that are in a file; ``number`` is that of the first."""
    from tachk.report.page.answers import answers_part
    from tachk.report.page.content import Chapter, Text
    from tachk.report.page.results import chapter_of, read_result, runs_of_verify

    if path.suffix.lower() == ".svg":
        yield Chapter("", pictures=((path.name, _svg(path)),))
        return
    if path.suffix.lower() == ".md":
        yield Text(_text(path))
        return
    document = read_result(path)
    runs = runs_of_verify(document, path)
    for place, run in enumerate(runs):
        try:
            yield answers_part(run, number + place, {})
        except (KeyError, TypeError, ValueError, AttributeError):
            raise UsageError(
                f"{path} is not a result of this version of tachk verify", "tachk verify MODEL --format json writes one"
            ) from None
    if not runs:
        yield chapter_of(document, path)


def _verified(request: ReportArguments, seconds: float | None, number: int) -> Answers:
    """The answers about the model."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions, parse_size
    from tachk.report.page.answers import answers_of

    path, *queries = request.model_and_queries
    memory = None if request.max_memory is None else parse_size(request.max_memory)
    with limited(seconds):
        with limited(memory=memory):
            model = api.load(path, **parse_definitions(request.definitions))
        print_diagnostics((*model.refusals, *model.warnings))
        limits = Limits(states=request.states, seconds=seconds, memory_bytes=memory)
        record = model.verify(*queries, property=request.properties, limits=limits).record
    return answers_of(record, number)


def _status(runs: Sequence[Mapping[str, Any]]) -> ExitStatus:
    """As `tachk verify` ends."""
    from tachk.verify.verdict import Answer

    results = [result for run in runs for result in run["results"]]
    if any(result["met"] is False for result in results):
        return ExitStatus.NOT_AS_EXPECTED
    open_ = any(result["answer"] == Answer.UNKNOWN.value for result in results)
    not_checked = [query for run in runs for query in run["not_checked"]]
    unsupported = any(run["errors"] for run in runs) or any(query["errors"] for query in not_checked)
    nothing = bool(not_checked) and not results
    return ExitStatus.UNKNOWN if open_ or unsupported or nothing else ExitStatus.AS_EXPECTED


def _facts(request: ReportArguments) -> Iterator[tuple[str, str]]:
    """The facts that are needed to make the page again: command, checksums of files, versions."""
    options = [part for text in request.definitions for part in ("-D", text)]
    options += [part for name in request.properties for part in ("--property", name)]
    yield "command", shlex.join(["tachk", "report", *request.inputs, *options, "-o", str(request.output)])
    for path in (*request.model_and_queries[:1], *request.files):
        yield f"SHA-256 of {path}", sha256(Path(path).read_bytes()).hexdigest()
    yield "tachk", tachk.__version__
    yield "Python", sys.version.split()[0]


def _svg(path: Path) -> str:
    text = _text(path)
    if "<svg" not in text:
        raise UsageError(f"{path} is not an SVG picture", "-o NAME.svg lets tachk draw one")
    return text


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path} cannot be read: {error}") from None
