"""Certificates in memory, and what both checkers say of them."""

from __future__ import annotations

import io
from collections.abc import Iterator

from tachk.base.resources import data_root
from tachk.engine.options import Options
from tachk.meaning.judge.certificate import (
    CertificateReader,
    CertificateWriter,
    Objection,
    StateBlock,
    read_certificates,
)
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.verify.certificates import Checker, Proof, check_proof, find_proof

MODELS = data_root() / "models"


PLAIN = Options().off("symmetry")
"""A certificate tells all states then, not one for all that exchanges make of it."""


def proved(network: Network, query: Query, options: Options = Options()) -> Proof:
    proof = find_proof(network, "digest", query, options)
    assert isinstance(proof, Proof), proof
    return proof


def written(proof: Proof, blocks: Iterator[StateBlock] | None = None) -> CertificateReader:
    stream = io.BytesIO()
    CertificateWriter(stream).write(proof.header, proof.blocks() if blocks is None else blocks)
    stream.seek(0)
    (certificate,) = read_certificates(stream)
    return certificate


def judged(network: Network, query: Query, certificate: CertificateReader) -> Objection | None:
    """What the two checkers say, which is the same but for the words about run-time errors."""
    by_python, natively = (check_proof(network, query, certificate, checker) for checker in Checker)
    assert (by_python is None) == (natively is None), (by_python, natively)
    if by_python is not None and natively is not None:
        assert by_python.discrete == natively.discrete
    return by_python
