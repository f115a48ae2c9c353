"""The exit statuses of `tachk` and their meaning."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum


class ExitStatus(IntEnum):
    """1 is used by `diff` alone, as by all programs of that name: it is also what an uncaught Python exception gives,
    and a build server must distinguish them."""

    AS_EXPECTED = 0
    """every expectation is met; without an expectation: the query holds"""
    DIFFERENT = 1
    """`diff`: the models differ"""
    BAD_INPUT = 2
    """a model, a query or an option is wrong"""
    UNSUPPORTED = 3
    """the model is legal but uses a feature that the requested analysis cannot decide"""
    NOT_AS_EXPECTED = 10
    """some expectation is not met; for `fmt --check`: some file is not in canonical form"""
    UNKNOWN = 20
    """nothing worse than an unknown answer: a limit was hit"""
    INTERNAL_ERROR = 70
    """a defect of tachk"""
    INTERRUPTED = 130
    """Ctrl-C: the program ends by the signal, so that a shell ends its loop"""
    PIPE_CLOSED = 141
    """the pipe of the output is closed: the program ends by the signal, as others do"""


_GRAVITY = (
    ExitStatus.INTERRUPTED,
    ExitStatus.PIPE_CLOSED,
    ExitStatus.INTERNAL_ERROR,
    ExitStatus.BAD_INPUT,
    ExitStatus.NOT_AS_EXPECTED,
    ExitStatus.UNSUPPORTED,
    ExitStatus.DIFFERENT,
    ExitStatus.UNKNOWN,
)
"""The gravest status first. A known violation comes before an unknown answer: with an unsupported query it is 10."""


def worst(statuses: Iterable[ExitStatus]) -> ExitStatus:
    """The status of a command that did several things."""
    present = set(statuses)
    return next((status for status in _GRAVITY if status in present), ExitStatus.AS_EXPECTED)
