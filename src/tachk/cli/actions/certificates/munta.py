"""The proofs of `tachk verify` for Munta."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tachk.base.whole_files import write_whole
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain
from tachk.engine.options import Limits, Options
from tachk.model.network import Network
from tachk.model.quantity import bytes_
from tachk.verify.certificates import is_provable
from tachk.verify.munta_proof import munta_proof
from tachk.verify.verdict import Verdict


def write_munta_proofs(
    folder: Path, network: Network, verdicts: Sequence[Verdict], options: Options, limits: Limits
) -> ExitStatus:
    """Writes NAME.muntax, NAME.renaming and NAME.muntac for each verdict that says that something is never reached, and
    tells on standard error what has been written and what the proof is weaker in.

    UNKNOWN if there is an answer without a run, and without a proof that Munta takes. Raises UnsupportedError.
    """
    started = time.monotonic()
    statuses = [ExitStatus.AS_EXPECTED]
    folder.mkdir(parents=True, exist_ok=True)
    asked = [verdict.query for verdict in verdicts if is_provable(verdict)]
    for query in asked:
        if query.target is None:
            complain(f"no proof for Munta of {query.name}: for Munta, runs never end and never wait for ever")
            statuses.append(ExitStatus.UNKNOWN)
            continue
        proof = munta_proof(network, query, options, limits.after(time.monotonic() - started))
        if isinstance(proof, str):
            complain(f"no proof for Munta of {query.name}: {proof}")
            statuses.append(ExitStatus.UNKNOWN)
            continue
        for weakening in proof.weakenings:
            print(f"{weakening.span}: for Munta, {weakening.text}: the proof covers more runs", file=sys.stderr)
        model, renaming, certificate = (
            folder / f"{query.name}.{ending}" for ending in ("muntax", "renaming", "muntac")
        )
        write_whole(model, proof.model)
        write_whole(renaming, proof.renaming)
        write_whole(certificate, proof.certificate)
        deadlock = " -dc" if proof.asks_deadlock else ""
        told = f"{proof.zones} zones of {proof.states} discrete states, {bytes_(len(proof.certificate))}"
        print(f"{query.name}: {told}", file=sys.stderr)
        print(f"  muntac{deadlock} -m {model} -r {renaming} -c {certificate}", file=sys.stderr)
    if not asked:
        print(f"{folder}: no proof, for no answer is of a kind that Munta can confirm", file=sys.stderr)
    return worst(statuses)
