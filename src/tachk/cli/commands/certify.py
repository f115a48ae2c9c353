"""`tachk certify`: check certificates: proofs of verdicts, without a search."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.records import dataclass
from tachk.base.span import Source
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting
from tachk.report.json_text import json_text

if TYPE_CHECKING:
    from tachk.frontend.loaded import LoadedModel
    from tachk.meaning.judge.certificate import CertificateHeader, CertificateReader
    from tachk.model.network import Network
    from tachk.model.query import Query
    from tachk.report.certificate_report import Judgement
    from tachk.verify.certificates import Checker


@click.command(name="certify")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument(
    "file", metavar="FILE", type=options.type_of_file, help="The certificates that `tachk verify --certificate` wrote."
)
@options.definitions
@click.option(
    "checker",
    "--checker",
    type=click.Choice(["python", "native"]),
    default="python",
    show_default=True,
    help="python: shares no code with the engine. native: C++, for large certificates; it shares the compiled "
    "expressions of the model.",
)
@options.report("text", "json")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Check proofs that `verify --certificate` has written, without a search.

    The exit status is 0 if every certificate of the file is accepted, 10 if one is rejected, and 2 if the file is
    damaged.
    """

    arguments = distributed(given, CertifyArguments, Reporting)
    options.finish(lambda: run_certify(*arguments), seconds)


@dataclass(frozen=True, slots=True)
class CertifyArguments:
    """Arguments of `tachk certify`."""

    model: str
    file: Path
    definitions: tuple[str, ...] = ()
    checker: str = "python"


def run_certify(arguments: CertifyArguments, reporting: Reporting = Reporting()) -> ExitStatus:
    """Checks every certificate of a file. Raises UsageError for a file that is damaged."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions
    from tachk.meaning.judge.certificate import MalformedCertificateError, read_certificates
    from tachk.report.certificate_report import judgement_lines, judgements_to_json
    from tachk.verify.certificates import Checker

    model = api.load(arguments.model, **parse_definitions(arguments.definitions))
    checker = Checker(arguments.checker)
    with arguments.file.open("rb") as stream, destination(reporting.output, reporting.quiet) as out:
        try:
            judgements = list(_judgements(model.loaded, read_certificates(stream), checker))
            if not judgements:
                raise UsageError(f"{arguments.file}: there is no certificate in it")
            if out is not None and reporting.form == "json":
                found = judgements_to_json(arguments.model, str(arguments.file), checker.value, judgements)
                out.write(json_text(found))
            elif out is not None:
                out.writelines(f"{line}\n" for line in judgement_lines(judgements))
        except MalformedCertificateError as error:
            raise UsageError(f"{arguments.file} is not a whole certificate for {arguments.model}: {error}") from error
    return ExitStatus.AS_EXPECTED if all(j.accepted for j in judgements) else ExitStatus.NOT_AS_EXPECTED


def _judgements(model: LoadedModel, certificates: Sequence[CertificateReader], checker: Checker) -> Iterator[Judgement]:
    from tachk.formats.network_json.digest import digest
    from tachk.meaning.discrete import prepare
    from tachk.meaning.initial_state import check_initial_state
    from tachk.report.certificate_report import Judgement
    from tachk.verify.certificates import check_proof

    network = model.network
    check_initial_state(prepare(network))
    own = digest(network)
    for certificate in certificates:
        started = time.monotonic()
        query = _query(model, certificate.header)
        reason, objection, used_checker = _made_for_another(certificate.header, network, own), None, None
        if not reason:
            used_checker = checker
            objection = check_proof(network, query, certificate, checker)
            reason = objection.reason if objection is not None else ""
        yield Judgement(network, query, certificate, used_checker, reason, objection, time.monotonic() - started)


def _made_for_another(header: CertificateHeader, network: Network, own: str) -> str:
    """The reason why a certificate is about another model, from its header; empty if it is about this one."""
    if header.model == own:
        return ""
    constants = dict(network.constants)
    different = [f"{name} = {value}" for name, value in header.constants.items() if constants.get(name, value) != value]
    return f"it was made for another model{', with ' + ', '.join(different) if different else ''}"


def _query(model: LoadedModel, header: CertificateHeader) -> Query:
    """The query that a certificate is about: the property of the model if that has the same text, else what it says."""
    from tachk.meaning.judge.certificate import MalformedCertificateError
    from tachk.verify.questions import Questions, checked

    for query in model.queries:
        if (query.name, query.text) == (header.name, header.query):
            return query
    try:
        return checked(Questions("", typed=(Source("<certificate>", header.query),)).about(model))[0]
    except (InputError, IndexError):
        raise MalformedCertificateError(f"the model has no query {header.query!r}") from None
