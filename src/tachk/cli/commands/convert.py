"""`tachk convert`: write a model in another form, as a unit for co-simulation (FMU), or for another program."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import InputError, TachkError, UsageError
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.formats.catalogue import EXPORT_FORMATS, SUFFIXES, export_model, format_of
from tachk.formats.exported import Writing
from tachk.syntax.source_files import read_source

if TYPE_CHECKING:
    from tachk.formats.plain.plain_model import PlainRewriting
    from tachk.syntax import ast


_TEXT, _UNIT = "ta", "fmu"
"""Formats of their own: tachk's language, which keeps imports and comments, and a unit for co-simulation."""

_ENDINGS = (".ta", *SUFFIXES, ".fmu")
_HELP = f"""Write a model in another format: {", ".join(_ENDINGS[:-1])} or {_ENDINGS[-1]}.

A .ta file keeps imports. The other formats contain the imported files, and what tachk adds to UPPAAL's language is
written out in full; queries stand in a file beside the model where its format has no place for them. An .fmu file is a
unit for co-simulation by the standard FMI.
"""


@dataclass(frozen=True, slots=True)
class ConvertArguments:
    """Arguments of `tachk convert`.

    Attributes:
        source: a model, or a file of queries.
        output: the file to write; None: standard output.
        form: the format; None: the one that the ending of the output means, or tachk's language.
        query_files: queries that become properties of a .ta file.
        fix: names that some version of UPPAAL refuses are replaced; None: if the model is tachk's text and is to be
            another program's.
        force: files with other contents are overwritten.
        explain: tell what is written differently, and where.
        observers: temporal properties are written as automata.
        fmi: the version of a unit.
        processes: the names of those that are in a unit, with commas between; None: all.
    """

    source: str
    output: Path | None = None
    form: str | None = None
    query_files: tuple[Path, ...] = ()
    definitions: tuple[str, ...] = ()
    fix: bool | None = None
    force: bool = False
    explain: bool = False
    observers: bool | None = None
    fmi: str | None = None
    processes: str | None = None

    @property
    def format(self) -> str:
        """Raises UsageError where the ending of the output means none."""
        if self.form is not None:
            return self.form
        if self.output is None:
            return _TEXT
        known = {".ta": _TEXT, ".fmu": _UNIT}.get(self.output.suffix.lower())
        return known or format_of(self.output, (".ta", ".fmu"))


@click.command(name="convert", help=_HELP)
@click.argument("source", metavar="IN", type=click.Path(), help="A model, or a file of queries.")
@click.argument(
    "out",
    metavar="[OUT]",
    type=options.type_of_file,
    required=False,
    help="The file to write; its ending is the format. Without it, or with -, tachk prints the model.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="The same as OUT.")
@click.option(
    "form",
    "--format",
    type=click.Choice([_TEXT, *EXPORT_FORMATS, _UNIT]),
    help="The format, where the ending of OUT does not say it; without OUT ta.",
)
@options.definitions
@options.query_files("Add the queries of this file to a .ta file.")
@click.option(
    "--fix/--keep-names",
    default=None,
    help="Replace or keep names that some version of UPPAAL refuses. Without this option they are replaced when a .ta "
    "file becomes a file for another program.",
)
@click.option("--force", is_flag=True, help="Overwrite files with other contents, also those that you have edited.")
@click.option("--explain", is_flag=True, help="Print what is written differently than in the model, and where.")
@click.option(
    "--observers/--no-observers",
    default=None,
    help="Write temporal properties as observer automata (default), or as comments.",
)
@click.option("--fmi", type=click.Choice(["2", "3"]), help="The version of FMI of a unit; 3 by default.")
@click.option("--processes", metavar="NAMES", help="Of a unit: only these processes or templates, with commas between.")
@options.max_seconds()
def command(out: Path | None, output: Path | None, seconds: float | None, **given: Any) -> None:
    if out is not None and output is not None:
        raise click.UsageError(f"{out} and -o {output} both name the file to write: give one.")
    output = output if out is None else out
    arguments = ConvertArguments(output=None if output is None or str(output) == "-" else output, **given)
    options.finish(lambda: run_convert(arguments), seconds)


def run_convert(arguments: ConvertArguments) -> ExitStatus:
    """Writes a file in another form.

    To tachk's own language nothing but the text is read, so an incomplete model can be converted too, for `git diff`
    and the like. Files that say something else already are overwritten only by ``force``: they may have been edited.
    """
    form, source, output = arguments.format, arguments.source, arguments.output
    _check_options(arguments, form)
    if form == _UNIT:
        return _write_unit(arguments)
    steps: Sequence[PlainRewriting] = ()
    if source.endswith(".q"):
        files = _convert_queries(Path(source), output)
    elif form == _TEXT:
        files = _convert_to_text(Path(source), output or Path("-"), arguments.query_files, bool(arguments.fix))
    else:
        files, steps = _exported(arguments, form)
    if output is None:
        sys.stdout.write(next(iter(files.values())))
    else:
        _keep_edited(files, arguments.force)
        for path, text in files.items():
            write_whole(path, text)
        print(f"written: {', '.join(map(str, files))}")
    if arguments.explain:
        _explain(steps)
    elif arguments.fix:
        _report([step for step in steps if step.kind == "name"])
    return ExitStatus.AS_EXPECTED


def _check_options(arguments: ConvertArguments, form: str) -> None:
    """Raises UsageError for an option that means nothing for this format."""
    for_units = {"--fmi": arguments.fmi, "--processes": arguments.processes}
    for_programs = {
        "-D": arguments.definitions or None,
        "--explain": arguments.explain or None,
        "--observers, --no-observers": arguments.observers,
    }
    if form != _UNIT:
        given = [name for name, value in for_units.items() if value is not None]
        if given:
            raise UsageError(f"{given[0]} goes with --format fmu")
    if form in (_TEXT, _UNIT):
        given = [name for name, value in for_programs.items() if value is not None and (form == _TEXT or name != "-D")]
        if given:
            where = "a .ta file is the model as it is written" if form == _TEXT else "a unit has the model as it is"
            raise UsageError(f"{given[0]} is for files of other programs: {where}")
    if form == _UNIT and arguments.fix is not None:
        raise UsageError("--fix and --keep-names are for files of other programs: a unit has the model as it is")
    if form != _TEXT and arguments.query_files:
        raise UsageError("-q goes with a .ta file as output", "convert to .ta first, then to the other format")


def _exported(arguments: ConvertArguments, form: str) -> tuple[dict[Path, str], Sequence[PlainRewriting]]:
    """The files of a model in another format, and what is written differently there."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions

    constants = parse_definitions(arguments.definitions)
    model = api.load(arguments.source, **constants)
    print_diagnostics(model.warnings)
    fix = arguments.source.lower().endswith(".ta") if arguments.fix is None else arguments.fix
    writing = Writing(tuple(constants), fix, arguments.observers is not False)
    exported = export_model(model.loaded, form, writing)
    output = arguments.output or Path("-")
    queries = {output.with_suffix(".q"): exported.queries} if exported.queries else {}
    return {output: exported.text} | queries, exported.steps


def _explain(steps: Sequence[PlainRewriting]) -> None:
    """Prints each construct that was written differently, with its place, then the number of each kind."""
    _report(steps)
    counts = Counter(step.kind for step in steps)
    summary = ", ".join(f"{kind} {count}" for kind, count in counts.items()) or "nothing was written differently"
    print(f"expanded: {summary}", file=sys.stderr)


_NAMES = re.compile(r"(?:\([^)]*\)|[^,()])+")
"""Parts between commas, but not those in parentheses: `Link(0, 1),Client`."""


def _write_unit(arguments: ConvertArguments) -> ExitStatus:
    """Writes a model as a unit for co-simulation."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions
    from tachk.simulation.fmi.archive import write_unit
    from tachk.simulation.fmi.description import FmiVersion
    from tachk.simulation.fmi.unit import closed_unit, open_unit

    if arguments.output is None:
        raise UsageError("a unit is a file of its own", "name it with -o FILE.fmu")
    source = api.load(arguments.source, **parse_definitions(arguments.definitions))
    print_diagnostics((*source.refusals, *source.warnings))
    version, name = FmiVersion(arguments.fmi or "3"), Path(arguments.source).stem
    if arguments.processes is None:
        unit = closed_unit(source.network, name)
    else:
        names = [part.strip() for part in _NAMES.findall(arguments.processes)]
        unit = open_unit(source.network, names, name, clocks=version is FmiVersion.THREE)
    write_unit(unit, version, arguments.output)
    print(f"written: {arguments.output}, FMI {version.value}.0, {len(unit.variables)} variables")
    return ExitStatus.AS_EXPECTED


def _keep_edited(files: Mapping[Path, str], force: bool) -> None:
    """Raises UsageError if a file exists that does not hold what is to be written."""
    for path, text in files.items():
        if not force and path.is_file() and path.read_text(encoding="utf-8", errors="replace") != text:
            raise UsageError(f"{path} exists with other contents; a user may have edited it", "--force overwrites it")


def _convert_to_text(source: Path, output: Path, query_files: tuple[Path, ...], fix: bool) -> dict[Path, str]:
    from tachk.formats.layout_json import layout_path, layout_to_json
    from tachk.formats.loading.model_files import read_model
    from tachk.formats.plain.expansion import document_repairs
    from tachk.formats.uppaal.query_reader import comment_of, without_properties
    from tachk.syntax import ast
    from tachk.syntax.printing.printer import print_document

    read = read_model(read_source(source))
    print_diagnostics(read.warnings)
    document, layout = read.document, read.layout
    aside = [*read.headings, *(_aside(query.span, query.text, query.comment) for query in read.broken)]
    wrong = set() if layout is None else _wrong_queries(source)
    if layout is not None and wrong:
        comments = {query.name: query.comment for query in layout.queries}
        layout = without_properties(layout, document, wrong)
        items: list[ast.Item] = []
        for item in document.items:
            if isinstance(item, ast.PropertyDeclaration) and item.name.name in wrong:
                said = comments.get(item.name.name)
                aside.append(_aside(item.span, item.formula.span.text, comment_of(item) if said is None else said))
            else:
                items.append(item)
        document = replace(document, items=tuple(items))
    properties = [item for path in query_files for item in _properties(path, document.span)]
    if properties:
        document = replace(document, items=(*document.items, *properties))
    if fix:
        document, steps = document_repairs(document)
        _report(steps)
    document = replace(document, comments=tuple(sorted((*document.comments, *aside), key=lambda c: c.span.start)))
    return {output: print_document(document)} | (
        {} if layout is None else {layout_path(output): layout_to_json(layout)}
    )


def _aside(place: Span, formula: str, comment: str) -> ast.Comment:
    from tachk.formats.uppaal.query_asides import wrong_query
    from tachk.syntax import ast

    return ast.Comment(place, wrong_query(formula, comment), True)


def _wrong_queries(source: Path) -> set[str]:
    """The names of the readable queries of an XML file that are wrong, as far as its model can be loaded."""
    from tachk.formats.loading.load import load_model
    from tachk.syntax import ast

    try:
        loaded = load_model(source)
    except TachkError:
        return set()
    named = {item.name.name for item in loaded.items if isinstance(item, ast.PropertyDeclaration)}
    return {query.name for query in loaded.unchecked if query.is_wrong and query.name in named}


def _report(steps: Iterable[PlainRewriting]) -> None:
    for step in steps:
        print(step, file=sys.stderr)


def _properties(path: Path, at: Span) -> list[ast.PropertyDeclaration]:
    """The queries of a file as properties named after it."""
    from tachk.syntax import ast
    from tachk.syntax.parsing.parser import has_errors
    from tachk.syntax.query_files import parse_queries

    source = read_source(path)
    entries, diagnostics = parse_queries(source)
    if has_errors(diagnostics):
        raise InputError(diagnostics)
    return [
        ast.PropertyDeclaration(
            entry.span,
            ast.Identifier(at, f"q{number}"),
            " ".join(entry.comment.replace('"', "'").split()),
            entry.formula,
            entry.expectation,
        )
        for number, entry in enumerate(entries, 1)
    ]


def _convert_queries(source: Path, output: Path | None) -> dict[Path, str]:
    from tachk.formats.plain.plain_model import PlainQuery
    from tachk.formats.uppaal.query_file import print_queries
    from tachk.syntax.parsing.parser import has_errors
    from tachk.syntax.query_files import parse_queries

    if output is not None and output.suffix.lower() != ".q":
        raise UsageError(
            f"{source} is a file of queries", "give it with -q beside a model, or convert it to another .q"
        )
    entries, diagnostics = parse_queries(read_source(source))
    if has_errors(diagnostics):
        raise InputError(diagnostics)
    return {output or Path("-"): print_queries([PlainQuery("", e.formula, e.comment, e.expectation) for e in entries])}
