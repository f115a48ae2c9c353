"""`tachk report`."""

from __future__ import annotations

import shlex
import sys
from hashlib import sha256
from pathlib import Path
from time import monotonic

import tachk
from tachk import api
from tachk.cli.arguments import parse_definitions, parse_size
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.diagnostics.diagnostic import UsageError
from tachk.engines.options import Limits
from tachk.records import dataclass
from tachk.report.page.content import page_of
from tachk.report.page.html import page_to_html
from tachk.time_limit import time_limit


@dataclass(frozen=True, slots=True)
class Reported:
    """What is asked, as it was typed.

    Attributes:
        pictures: SVG files that go onto the page.
        title: of the page.
        max_memory: such as ``2G``.
    """

    model: str
    output: Path
    queries: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()
    pictures: tuple[Path, ...] = ()
    title: str | None = None
    states: int | None = None
    max_memory: str | None = None


def run_report_page(asked: Reported, seconds: float | None) -> ExitStatus:
    """Checks the model and writes the page."""
    started = monotonic()
    pictures = [(path.name, _svg(path)) for path in asked.pictures]
    memory = None if asked.max_memory is None else parse_size(asked.max_memory)
    with time_limit(seconds):
        model = api.load(asked.model, **parse_definitions(asked.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    limits = Limits(states=asked.states, seconds=seconds, memory_bytes=memory).after(monotonic() - started)
    report = model.verify(*asked.queries, property=asked.properties, limits=limits)
    facts = [("command", _command(asked)), *_versions(asked.model)]
    page = page_of(model.loaded, report.record, asked.title or Path(asked.model).stem, facts, pictures)
    asked.output.write_text(page_to_html(page), encoding="utf-8")
    met = report.met
    if met is None:
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED if met else ExitStatus.NOT_AS_EXPECTED


def _svg(path: Path) -> str:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: {error}", "--picture takes SVG files") from None
    if "<svg" not in text:
        raise UsageError(f"{path} is no SVG picture", "-o NAME.svg lets tachk draw one")
    return text


def _command(asked: Reported) -> str:
    options = [part for text in asked.definitions for part in ("-D", text)]
    options += [part for name in asked.properties for part in ("--property", name)]
    return shlex.join(["tachk", "verify", asked.model, *asked.queries, *options])


def _versions(path: str) -> list[tuple[str, str]]:
    return [
        ("SHA-256 of the model file", sha256(Path(path).read_bytes()).hexdigest()),
        ("tachk", tachk.__version__),
        ("Python", sys.version.split()[0]),
    ]
