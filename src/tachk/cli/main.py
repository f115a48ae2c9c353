"""The commands and their options. Imports nothing heavy: `tachk --version` must not wait for z3."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import tachk
from tachk.cli.guard import guarded

app = typer.Typer(
    name="tachk",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Search(StrEnum):
    bfs = "bfs"
    dfs = "dfs"
    rdfs = "rdfs"


class Trace(StrEnum):
    some = "some"
    shortest = "shortest"
    none = "none"


class Format(StrEnum):
    text = "text"
    json = "json"
    junit = "junit"
    verifyta = "verifyta"


class MonitorFormat(StrEnum):
    text = "text"
    json = "json"
    junit = "junit"


class Ending(StrEnum):
    undetermined = "undetermined"
    weak = "weak"
    strong = "strong"


class Interpolation(StrEnum):
    constant = "constant"
    linear = "linear"


class ExportFormat(StrEnum):
    xta = "xta"
    xml = "xml"
    q = "q"
    tchecker = "tchecker"
    dot = "dot"
    json = "json"


class Uppaal(StrEnum):
    uppaal_4_1 = "uppaal-4.1"
    uppaal_5_0 = "uppaal-5.0"


class Extrapolation(StrEnum):
    lu = "lu"
    max = "max"
    none = "none"


Definitions = Annotated[
    list[str] | None,
    typer.Option("-D", "--define", metavar="NAME=EXPR", help="Give a global constant of the model another value."),
]


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"tachk {tachk.__version__}")
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Model checking of networks of timed automata.

    Exit status: 0 everything as expected, 10 something is not, 20 nothing worse than unknown, 2 bad input or usage,
    3 unsupported feature, 70 defect of tachk.
    """


@app.command()
def verify(
    arguments: Annotated[
        list[str], typer.Argument(metavar="MODEL|QUERY", help="Model files, and queries to check on each.")
    ],
    query_files: Annotated[
        list[Path] | None, typer.Option("-q", "--queries", metavar="FILE", help="Check the queries of a file.")
    ] = None,
    definitions: Definitions = None,
    properties: Annotated[
        list[str] | None, typer.Option("--property", metavar="NAME", help="Check this property of the model.")
    ] = None,
    search: Annotated[Search, typer.Option(help="Which state is explored next.")] = Search.bfs,
    seed: Annotated[int, typer.Option(metavar="N", help="For --search rdfs.")] = 1,
    trace: Annotated[
        Trace | None,
        typer.Option(help="Which run to give as evidence; without this option only unexpected answers get one."),
    ] = None,
    format: Annotated[Format, typer.Option(help="Form of the report.")] = Format.text,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Write the report to a file.")
    ] = None,
    max_states: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Give up a search beyond so many stored states.")
    ] = None,
    max_seconds: Annotated[
        float | None, typer.Option(metavar="SECONDS", min=0, help="Give up after this time.")
    ] = None,
    max_memory: Annotated[
        str | None, typer.Option(metavar="SIZE", help="Give up a search beyond this size, such as 2G.")
    ] = None,
    max_depth: Annotated[
        int | None, typer.Option(metavar="N", min=0, help="Explore only so many transitions deep.")
    ] = None,
    extrapolation: Annotated[Extrapolation, typer.Option(help="The abstraction of zones.")] = Extrapolation.lu,
    every_trace: Annotated[
        bool, typer.Option("--all-traces", help="Tell also the runs behind answers that are as expected.")
    ] = False,
    clocks: Annotated[bool, typer.Option("--clocks", help="Print the clocks after each step of a run.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print no report; the exit status tells.")] = False,
) -> None:
    """Check the properties of models, or the given queries.

    Without a query, a query file or --property, every property that a model states is checked.
    """
    from tachk.cli.verify import VerifyRequest, run_verify

    request = VerifyRequest(
        arguments=tuple(arguments),
        query_files=tuple(query_files or ()),
        definitions=tuple(definitions or ()),
        properties=tuple(properties or ()),
        search=search.value,
        seed=seed,
        trace=(trace or Trace.some).value,
        format=format.value,
        output=output,
        max_states=max_states,
        max_seconds=max_seconds,
        max_memory=max_memory,
        max_depth=max_depth,
        extrapolation=extrapolation.value,
        every_trace=every_trace or trace is not None,
        clocks=clocks,
        quiet=quiet,
    )
    raise typer.Exit(guarded(lambda: run_verify(request)))


@app.command()
def check(
    models: Annotated[list[str], typer.Argument(metavar="MODEL...", help="Model files.")],
    definitions: Definitions = None,
    version: Annotated[
        Uppaal | None, typer.Option("--for", help="Report what this version of UPPAAL would refuse or do otherwise.")
    ] = None,
) -> None:
    """Read models and report every mistake and warning, without checking a property."""
    from tachk.cli.check import run_check

    wanted = None if version is None else version.value
    raise typer.Exit(guarded(lambda: run_check(tuple(models), tuple(definitions or ()), wanted)))


@app.command()
def fmt(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Model files in text form.")],
    check_only: Annotated[bool, typer.Option("--check", help="Change nothing; fail if a file would change.")] = False,
    to_stdout: Annotated[bool, typer.Option("--stdout", help="Print the result instead of changing the file.")] = False,
) -> None:
    """Rewrite models in canonical form."""
    from tachk.cli.fmt import run_fmt

    raise typer.Exit(guarded(lambda: run_fmt(tuple(files), check_only, to_stdout)))


@app.command()
def convert(
    source: Annotated[str, typer.Argument(metavar="IN", help="A model, or a file of queries.")],
    output: Annotated[Path, typer.Argument(metavar="OUT", help="Its ending says the format; - prints tachk's own.")],
    query_files: Annotated[
        list[Path] | None, typer.Option("-q", "--queries", metavar="FILE", help="Take these queries into a .ta file.")
    ] = None,
    fix: Annotated[bool, typer.Option("--fix", help="Replace names that some version of UPPAAL refuses.")] = False,
) -> None:
    """Write a model in another form: .ta, .xta, .xml, .q, .tck, .dot or .json.

    Formats but .ta are written in full: imports are followed, and what tachk adds to UPPAAL's language is expanded.
    """
    from tachk.cli.convert import run_convert

    raise typer.Exit(guarded(lambda: run_convert(source, output, tuple(query_files or ()), fix)))


@app.command()
def export(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A model file.")],
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE", help="Where to write it.")] = None,
    format: Annotated[
        ExportFormat | None, typer.Option(help="The format; without it, what the ending of FILE says.")
    ] = None,
    definitions: Definitions = None,
    explain: Annotated[bool, typer.Option("--explain", help="Print what is written differently, and where.")] = False,
    keep_names: Annotated[
        bool, typer.Option("--keep-names", help="Keep names that some version of UPPAAL refuses.")
    ] = False,
    observers: Annotated[
        bool,
        typer.Option(
            "--observers/--no-observers",
            help="Temporal properties become automata beside the model; without, comments.",
        ),
    ] = True,
) -> None:
    """Write a model for UPPAAL, TChecker, Graphviz or other programs, with its queries beside it."""
    from tachk.cli.export import run_export

    name = None if format is None else format.value
    raise typer.Exit(
        guarded(lambda: run_export(model, output, name, tuple(definitions or ()), explain, keep_names, observers))
    )


@app.command()
def diff(
    before: Annotated[str, typer.Argument(metavar="A", help="A model.")],
    after: Annotated[str, typer.Argument(metavar="B", help="The same model, changed.")],
) -> None:
    """Tell what is different in the behaviour of two models; layout, comments and most order do not count.

    Exit status: 0 nothing, 1 something.
    """
    from tachk.cli.diff import run_diff

    raise typer.Exit(guarded(lambda: run_diff(before, after)))


@app.command()
def draw(
    model: Annotated[str, typer.Argument(metavar="MODEL", help="A model file.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR|FILE.svg", help="A folder, or one file for all templates.")
    ] = Path(),
    template: Annotated[str | None, typer.Option(metavar="NAME", help="Draw this template only.")] = None,
) -> None:
    """Draw the templates of a model as SVG, with the picture that a UPPAAL file has or an automatic one."""
    from tachk.cli.draw import run_draw

    raise typer.Exit(guarded(lambda: run_draw(model, output, template)))


FormulaArgument = Annotated[
    str, typer.Argument(metavar="FORMULA|FILE", help="A formula, a sentence, a file of them (.stl), or a model.")
]
TimeColumn = Annotated[
    str | None, typer.Option("--time", metavar="NAME", help="The time column, if it is not time, t or timestamp.")
]
TimeUnit = Annotated[
    str | None, typer.Option("--unit", metavar="UNIT", help="Of the times, if the trace does not say it: ms, s, ...")
]
Names = Annotated[list[str] | None, typer.Option("--property", metavar="NAME", help="Take this formula of the file.")]


Between = Annotated[
    Interpolation, typer.Option("--interpolation", help="Between rows numbers are held, or move in straight lines.")
]


@app.command()
def monitor(
    formula: FormulaArgument,
    trace: Annotated[
        str, typer.Argument(metavar="TRACE", help="A CSV, Parquet or VCD file; - reads CSV rows as they come.")
    ],
    time: TimeColumn = None,
    unit: TimeUnit = None,
    end: Annotated[
        Ending, typer.Option(help="What is pending at the end counts as: undetermined, satisfied (weak), violated.")
    ] = Ending.undetermined,
    properties: Names = None,
    robustness: Annotated[
        bool, typer.Option("--robustness/--no-robustness", help="Compute how far verdicts are from changing.")
    ] = True,
    time_robustness: Annotated[
        bool, typer.Option("--time-robustness", help="Compute by how much time signals may be shifted, too.")
    ] = False,
    interpolation: Between = Interpolation.constant,
    online: Annotated[bool, typer.Option("--online", help="Judge row by row, with bounded memory.")] = False,
    follow: Annotated[bool, typer.Option("--follow", help="Wait for further rows at the end of the file.")] = False,
    decimals: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=0,
            max=15,
            help="Row by row: the decimals of times and bounds; by default as many as make nanoseconds, at most 9.",
            show_default=False,
        ),
    ] = None,
    format: Annotated[MonitorFormat, typer.Option(help="Form of the report.")] = MonitorFormat.text,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Write the report to a file.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print no report; the exit status tells.")] = False,
) -> None:
    """Judge a recorded trace by formulas, sentences or the properties of a model.

    Exit status: 0 all are true, 10 some are false, 20 nothing worse than undetermined, 2 bad input.
    """
    from tachk.cli.monitor import run_monitor
    from tachk.cli.monitor_request import MonitorRequest

    request = MonitorRequest(
        formula,
        trace,
        time,
        unit,
        end.value,
        tuple(properties or ()),
        robustness,
        online,
        follow,
        decimals,
        format.value,
        output,
        quiet,
        interpolation.value,
        time_robustness,
    )
    raise typer.Exit(guarded(lambda: run_monitor(request)))


@app.command()
def plot(
    formula: FormulaArgument,
    trace: Annotated[str, typer.Argument(metavar="TRACE", help="A CSV, Parquet or VCD file.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="An .svg, .png or .pdf file.")],
    time: TimeColumn = None,
    unit: TimeUnit = None,
    properties: Names = None,
    begin: Annotated[float | None, typer.Option("--from", metavar="TIME", help="Draw from here.")] = None,
    end: Annotated[float | None, typer.Option("--to", metavar="TIME", help="Draw up to here.")] = None,
    interpolation: Between = Interpolation.constant,
) -> None:
    """Draw a trace with what formulas and their parts are worth on it, and where they are violated."""
    from tachk.cli.plot import run_plot

    names = tuple(properties or ())
    raise typer.Exit(
        guarded(lambda: run_plot(formula, trace, output, time, unit, names, begin, end, interpolation.value))
    )


@app.command()
def explain(
    what: Annotated[
        str,
        typer.Argument(
            metavar="CODE|FORMULA|FILE",
            help="The code of a message, such as E0214; a formula or sentence; or a file that states some.",
        ),
    ],
) -> None:
    """Explain a message, or what a property written as a formula or a sentence says.

    Of a message: what it means, an example, how to mend it. Of a property: its formula in canonical form, how far it
    looks ahead, and whether all its intervals begin at 0.
    """
    from tachk.cli.explain import run_explain

    raise typer.Exit(guarded(lambda: run_explain(what)))


@app.command()
def sentences(
    words: Annotated[
        list[str] | None, typer.Argument(metavar="WORD...", help="Only patterns with these words.")
    ] = None,
) -> None:
    """List the sentences in which properties can be written, each with its formula and its meaning."""
    from tachk.cli.sentences import run_sentences

    raise typer.Exit(guarded(lambda: run_sentences(tuple(words or ()))))


def run() -> None:
    """The console script."""
    app()
