"""The certificates of `tachk verify`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from tachk.base.job import unhurried
from tachk.base.whole_files import whole_bytes
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain
from tachk.engine.options import Limits, Options
from tachk.formats.network_json.digest import digest
from tachk.meaning.judge.certificate import CertificateWriter
from tachk.model.network import Network
from tachk.model.quantity import bytes_
from tachk.verify.certificates import find_proof, is_provable, widened_proof
from tachk.verify.verdict import Verdict


def write_certificates(
    path: Path, network: Network, verdicts: Sequence[Verdict], options: Options, limits: Limits
) -> ExitStatus:
    """Writes a certificate for each verdict that has one, and reports on standard error what has been written.

    UNKNOWN if a limit keeps one from being made. Ctrl-C leaves the file as it was: raises KeyboardInterrupt.
    """
    names, status = written_certificates(path, network, verdicts, options, limits)
    nothing = "no proof: only A[], A<> and --> that hold have one, and E<> and E[] that fail"
    content = f"proofs of {', '.join(names)}" if names else nothing
    print(f"{path}: {content} ({bytes_(path.stat().st_size)})", file=sys.stderr)
    return status


def written_certificates(
    path: Path, network: Network, verdicts: Sequence[Verdict], options: Options, limits: Limits
) -> tuple[list[str], ExitStatus]:
    """The same with no report but on what could not be written. Returns the names of the queries, and the status."""
    statuses = [ExitStatus.AS_EXPECTED]
    with unhurried():
        provable = [verdict for verdict in verdicts if is_provable(verdict)]
        model = digest(network)
    names = []
    with whole_bytes(path) as file:
        writer = CertificateWriter(file)
        for verdict in provable:
            proof = find_proof(network, model, verdict.query, options, limits)
            if isinstance(proof, str):
                complain(f"no certificate for {verdict.query.name}: {proof}")
                statuses.append(ExitStatus.UNKNOWN)
                continue
            proof = widened_proof(network, verdict.query, proof, verdict.statistics.states_stored)
            writer.write(proof.header, proof.blocks())
            names.append(verdict.query.name)
    return names, worst(statuses)
