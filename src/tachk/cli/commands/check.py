"""`tachk check`: report every mistake in models."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import click

from tachk.base.diagnostics.diagnostic import InputError, Severity
from tachk.base.job import StoppedError, limited
from tachk.base.records import replace
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain, print_diagnostics, without_result
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.report.check_report import CHECK_FORMATS

if TYPE_CHECKING:
    from tachk.report.check_report import Checked


@click.command(name="check")
@click.argument("models", metavar="MODEL...", nargs=-1, required=True, type=click.Path(), help="Model files.")
@options.definitions
@click.option(
    "version",
    "--for",
    type=options.Choice(UppaalVersion),
    help="Also report what this version of UPPAAL would refuse or treat differently.",
)
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", *CHECK_FORMATS)),
    default="text",
    show_default=True,
    help="Form of the report: text for people, json for programs, sarif for code scanning, github for annotations.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.written_file, help="Write the report to a file.")
@click.option(
    "--sarif", metavar="FILE", type=options.written_file, help="Also write the findings as SARIF, for code hosts."
)
@click.option(
    "deep",
    "--deep",
    is_flag=True,
    help="Explore the states of each model, and warn of what no run reaches, time-locks, Zeno loops, unused names.",
)
@options.max_seconds("Stop reading or exploring a model after this time, with exit status 20.")
@click.option("strict_xta", "--strict-xta", is_flag=True, help="Refuse what tachk adds to the language of UPPAAL.")
def command(**given: Any) -> None:
    """Read models and report every mistake and warning, without checking a property."""

    options.finish(lambda: run_check(**given))


def run_check(
    models: tuple[str, ...],
    definitions: tuple[str, ...],
    version: UppaalVersion | None = None,
    form: str = "text",
    output: Path | None = None,
    strict_xta: bool = False,
    seconds: float | None = None,
    deep: bool = False,
    sarif: Path | None = None,
) -> ExitStatus:
    """Reads every model and reports its mistakes and warnings.

    Args:
        version: of UPPAAL; report also what it would refuse or treat otherwise.
        form: ``text`` for people, one line about each model that has no error, the rest on standard error; or one of
            `CHECK_FORMATS`, with everything in one report.
        output: the file of the report, standard output without.
        strict_xta: refuse what tachk adds to the language of UPPAAL.
        seconds: of each model; one that takes longer is left, and the status is UNKNOWN if it is no worse.
        deep: explore the states of each model, and tell what no run does; see `tachk.verify.semantic_lint`.
        sarif: a file for the findings as SARIF, beside the report.
    """
    from tachk.cli.arguments import parse_definitions

    constants = parse_definitions(definitions)
    checks: list[Checked] = []
    with destination(output) as out, destination(sarif, quiet=True) as beside:
        assert out is not None
        for path in models:
            checks.append(_within(seconds, path, constants, version, strict_xta, deep))
            if form == "text":
                _report(checks[-1], version, len(models) > 1, out)
            if _is_interrupted(checks[-1]):
                break
        if form != "text":
            out.write(CHECK_FORMATS[form](checks))
        if beside is not None:
            beside.write(CHECK_FORMATS["sarif"](checks))
    return worst(_status(check) for check in checks)


def _is_interrupted(check: Checked) -> bool:
    from tachk.engine.outcome import INTERRUPTED

    return check.deep is not None and check.deep.reason == INTERRUPTED


def _within(
    seconds: float | None,
    path: str,
    constants: dict[str, str],
    version: UppaalVersion | None,
    strict_xta: bool,
    deep: bool,
) -> Checked:
    from tachk.api.checking import check_model
    from tachk.report.check_report import Checked

    try:
        with limited(seconds):
            check, model = check_model(path, constants, version, strict_xta)
            if not deep or model is None:
                return check
            try:
                return replace(check, deep=model.check(), network=model.network)
            except InputError as error:
                return replace(check, findings=(*error.diagnostics, *check.findings), size=None)
    except StoppedError as error:
        return Checked(path, complaint=without_result(error), out_of_time=True)


def _report(check: Checked, version: UppaalVersion | None, named: bool, out: TextIO) -> None:
    """The report for people: a line for each model that can be used, and the findings on standard error."""
    print_diagnostics(check.findings)
    if check.deep is not None:
        print_diagnostics(check.deep.findings)
    if check.complaint is not None:
        complain(f"{check.model}: {check.complaint}" if named else check.complaint, check.help)
    size = check.size
    if size is None:
        return
    findings = (*check.findings, *(check.deep.findings if check.deep is not None else ()))
    warnings = sum(found.severity is not Severity.ERROR for found in findings)
    counts = (
        (size.processes, "process", "processes"),
        (size.locations, "location", "locations"),
        (size.edges, "edge", "edges"),
        (size.properties, "property", "properties"),
        (warnings, "warning", "warnings"),
    )
    print(f"{check.model}: " + ", ".join(f"{n} {one if n == 1 else many}" for n, one, many in counts), file=out)
    if version is not None and check.portability is not None:
        print_diagnostics(check.portability)
        rejected = sum(found.severity is Severity.ERROR for found in check.portability)
        otherwise = len(check.portability) - rejected
        print(f"{check.model}: {version.full_name} would refuse {rejected}, treat otherwise {otherwise}", file=out)
    if check.deep is not None and check.network is not None:
        from tachk.report.deep_report import print_deep_check

        print_deep_check(check.network, check.deep, out)


def _status(check: Checked) -> ExitStatus:
    if check.out_of_time:
        return ExitStatus.UNKNOWN
    errors = [found for found in check.findings if found.severity is Severity.ERROR]
    if check.complaint is not None or any(not found.is_unsupported for found in errors):
        return ExitStatus.BAD_INPUT
    if errors:
        return ExitStatus.UNSUPPORTED
    if any(found.severity is Severity.ERROR for found in check.portability or ()):
        return ExitStatus.NOT_AS_EXPECTED
    if _is_interrupted(check):
        return ExitStatus.INTERRUPTED
    if check.deep is not None and not check.deep.decided:
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED
