"""Events as they are typed: ``P.location``, ``n == 3``, a signal, ``channel[1]!``, ``channel?``."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.records import replace
from tachk.base.span import Source
from tachk.base.words import Direction
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition, expression
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.scope import Scope
from tachk.model.event import BecomesTrue, Event, Fires
from tachk.model.expressions import Expression
from tachk.model.traversal import asks_deadlock, clock_in
from tachk.model.types import ArrayType, ChannelType
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_expression, parse_synchronisation


def read_event(loaded: LoadedModel, text: str, option: str, settled: bool = False) -> Event:
    """The event that a text names in a model.

    Args:
        option: what messages call the text.
        settled: a condition does not count where a process is in a committed location.

    Raises:
        InputError: with every diagnostic that was found.
    """
    findings = DiagnosticCollector()
    context = replace(loaded.context, findings=findings, in_query=True)
    event = _event(Source(option, text), loaded.scope, context)
    if event is None or findings.has_errors:
        raise InputError(findings.sorted())
    return replace(event, settled=settled) if isinstance(event, BecomesTrue) else event


def _event(source: Source, scope: Scope, context: Context) -> Event | None:
    stripped = source.text.rstrip()
    if stripped.endswith(("!", "?")):
        label, diagnostics = parse_synchronisation(source)
        context.findings.extend(diagnostics)
        if label is None:
            return None
        return _firing(label.channel, label.direction or Direction.SEND, scope, context)
    node, diagnostics = parse_expression(source)
    context.findings.extend(diagnostics)
    if node is None:
        return None
    value = expression(node, scope, context)
    if value is not None and _is_channel(value):
        return _firing(node, Direction.SEND, scope, context)
    checked = condition(node, scope, context)
    if checked is None or not context.require_pure(checked, "an event"):
        return None
    clock = clock_in(checked)
    if clock is not None:
        help_ = "name a condition on locations and variables, or a channel"
        context.error("E0731", clock.span, "an event cannot look at a clock", help_)
        return None
    if asks_deadlock(checked):
        context.error("E0501", node.span, "`deadlock` is not an event", "name a location in which the model stops")
        return None
    return BecomesTrue(checked)


def _firing(node: ast.Expression, direction: Direction, scope: Scope, context: Context) -> Event | None:
    channel = expression(node, scope, context)
    if channel is None:
        return None
    if not _is_channel(channel):
        context.error("E0301", node.span, "this is not a channel", "without `!` or `?` it may be a condition")
        return None
    return Fires(channel, direction)


def _is_channel(value: Expression) -> bool:
    leaf = value.type
    while isinstance(leaf, ArrayType):
        leaf = leaf.element
    return isinstance(leaf, ChannelType)
