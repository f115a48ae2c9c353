"""What code cannot say about clocks, whose values lie in zones."""

from __future__ import annotations

from tachk.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.diagnostics.span import Span
from tachk.model.expressions import Expression
from tachk.model.types import ChannelType, ClockType, Type, leaves


def _contains_clocks(type_: Type) -> bool:
    return any(isinstance(leaf, ClockType | ChannelType) for _, leaf in leaves(type_))


def refuse_clock_cells(expression: Expression) -> None:
    """Raises UnsupportedError for a copy of a value that contains clocks."""
    if _contains_clocks(expression.type):
        raise UnsupportedError(
            Diagnostic(
                "E0702",
                "an array or record that contains clocks cannot be copied",
                expression.span,
                "assign its integer cells one by one, or pass it by reference",
            )
        )


def clock_comparison_unsupported(span: Span) -> UnsupportedError:
    """A clock is compared where only integers can be evaluated."""
    return UnsupportedError(
        Diagnostic(
            "E0703",
            "a clock is compared inside an expression that must be a number",
            span,
            "compare clocks only in guards, invariants and queries, joined by &&, ||, imply, not or forall",
        )
    )
