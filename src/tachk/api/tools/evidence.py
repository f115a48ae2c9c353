"""The evidence of verdicts: runs are replayed by the reference semantics, proofs are checked by the judge."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO

from tachk.api.tools.answer import Evidence, EvidenceKind
from tachk.base.job import StoppedError, current_job
from tachk.base.records import replace
from tachk.engine.options import Limits, Options
from tachk.formats.network_json.digest import digest
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.certificate import CertificateWriter, read_certificates
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.network import Network
from tachk.model.run import Ending, TimedTrace
from tachk.report.record import RunRecord
from tachk.verify.certificates import Checker, Proof, check_proof, find_proof, is_provable
from tachk.verify.verdict import Answer, Verdict

MOST_STATES = 20_000
"""With more states no certificate is made unless a call asks for it: it takes as long as the search, and its check
longer."""
_MOST_ZONES = 3_000
"""Larger proofs are checked by the native checker: the other one would take minutes."""


def evidence_of(record: RunRecord, certificates: str, limits: Limits) -> Iterator[Evidence]:
    """The evidence of each answer.

    Args:
        certificates: ``always``, ``never``, or ``auto``: where the search was small.
        limits: of searches for certificates; the seconds are those of the job. Without time an answer is not judged.
    """
    answers = [verdict for verdict in record.verdicts if verdict.answer is not Answer.UNKNOWN]
    # Runs first: they take no time, and a certificate may take all there is.
    in_order = sorted(answers, key=is_provable)
    shown = {
        verdict.query.name: list(_of_answer(record.network, verdict, certificates, limits)) for verdict in in_order
    }
    for verdict in answers:
        yield from shown[verdict.query.name]
    for found in record.estimates:
        yield Evidence(found.query.name, EvidenceKind.SAMPLES, False, "an estimate from random runs, not a proof")


def _of_answer(network: Network, verdict: Verdict, certificates: str, limits: Limits) -> Iterator[Evidence]:
    if verdict.trace is not None:
        yield _of_run(network, verdict, verdict.trace)
    elif is_provable(verdict):
        yield _of_proof(network, verdict, certificates, limits)
    else:
        yield from _of_values(network, verdict)


def _of_values(network: Network, verdict: Verdict) -> Iterator[Evidence]:
    """Of ``sup`` and its like: a run shows that a value is taken, and nothing that no larger one is."""
    ends = [end for each in verdict.extremes for end in (each.least, each.largest) if end is not None]
    runs = [end.run for end in ends if end.run is not None]
    name = verdict.query.name
    if not runs:
        yield Evidence(name, EvidenceKind.NONE, False, "the answer of the search; it has no run")
    for run in runs:
        found = replayed(network, name, run)
        how = f"{found.how}; that no run goes beyond is the answer of the search alone"
        yield Evidence(name, EvidenceKind.RUN, False, how)


def replayed(network: Network, about: str, run: TimedTrace) -> Evidence:
    """The evidence of a run that the reference semantics executes once more."""
    try:
        replay(prepare(network), run)
    except ReplayError as error:
        return Evidence(about, EvidenceKind.RUN, False, f"the reference semantics rejects the run: {error}")
    except StoppedError as error:
        return Evidence(about, EvidenceKind.RUN, False, f"no time was left to replay the run: {error.reason}")
    steps = f"{len(run.steps)} step{'' if len(run.steps) == 1 else 's'}"
    return Evidence(about, EvidenceKind.RUN, True, f"all {steps} replayed by the reference semantics")


def _of_run(network: Network, verdict: Verdict, run: TimedTrace) -> Evidence:
    """A finite run against a condition ends where the condition says; of other runs the steps are replayed."""
    query = verdict.query
    found = replayed(network, query.name, run)
    goal = query.target if query.observer is None else None
    if not found.checked or goal is None or run.ending is not Ending.OPEN:
        return found
    try:
        replay(prepare(network), run, goal)
    except (ReplayError, StoppedError):
        return found
    state = "the last state violates the property" if verdict.answer is Answer.FAILS else "the last state is a witness"
    return Evidence(query.name, EvidenceKind.RUN, True, f"{found.how}; {state}")


def _of_proof(network: Network, verdict: Verdict, certificates: str, limits: Limits) -> Evidence:
    name, states = verdict.query.name, verdict.statistics.states_stored
    if certificates == "never":
        return Evidence(name, EvidenceKind.NONE, False, "no certificate was requested")
    if certificates == "auto" and states > MOST_STATES:
        how = f"the search stored {states:,} states; certificates='always' makes and checks a certificate"
        return Evidence(name, EvidenceKind.NONE, False, how)
    try:
        left = replace(limits, seconds=current_job().seconds_left)
        proof = find_proof(network, digest(network), verdict.query, Options(), left)
        if isinstance(proof, str):
            return Evidence(name, EvidenceKind.NONE, False, f"no certificate: {proof}")
        return _of_certificate(network, verdict, proof)
    except StoppedError as error:
        return Evidence(name, EvidenceKind.NONE, False, f"no time was left for a certificate: {error.reason}")


def _of_certificate(network: Network, verdict: Verdict, proof: Proof) -> Evidence:
    """The proof is written and read as a file would be, so that the judge sees nothing but the certificate."""
    file = BytesIO()
    CertificateWriter(file).write(proof.header, proof.blocks())
    file.seek(0)
    (certificate,) = read_certificates(file)
    checker = Checker.PYTHON if proof.zones <= _MOST_ZONES else Checker.NATIVE
    objection = check_proof(network, verdict.query, certificate, checker)
    name, size = verdict.query.name, f"certificate of {proof.zones:,} symbolic states"
    if objection is not None:
        return Evidence(name, EvidenceKind.CERTIFICATE, False, f"a {size} was rejected: {objection.reason}")
    judge = "by the reference semantics" if checker is Checker.PYTHON else "by the native checker"
    return Evidence(name, EvidenceKind.CERTIFICATE, True, f"{size} accepted {judge}")
