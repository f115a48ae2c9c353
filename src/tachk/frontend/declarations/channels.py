"""The uses of channels: values passed over them, senders and receivers."""

from __future__ import annotations

from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.frontend.context import Context
from tachk.frontend.expressions.typing import describe, is_integral, same_shape
from tachk.model.expressions import INT, Expression, Index, Reference, Variable, VariableKind
from tachk.model.types import ArrayType, ChannelType, RecordType, ScalarType, Type, element_type
from tachk.model.variable_layout import default_values


@dataclass(slots=True)
class ChannelUse:
    """Attributes:
    senders, receivers: the place of the first edge of either kind.
    enabled_sender, enabled_receiver: the place of the first one that no constant switches off.
    plain_sender: the place of the first ``c!`` without a value.
    value: the hidden variable that carries the values.
    value_receiver: the place of the first ``c?x``.
    """

    senders: Span | None = None
    receivers: Span | None = None
    enabled_sender: Span | None = None
    enabled_receiver: Span | None = None
    plain_sender: Span | None = None
    value: Variable | None = None
    value_receiver: Span | None = None


@dataclass(slots=True)
class ChannelTable:
    """The uses of each channel variable.

    Attributes:
        taken: the global names, with which the hidden variables must not collide.
    """

    taken: set[str]
    uses: dict[Variable, ChannelUse] = field(default_factory=dict)

    def hidden_variables(self) -> tuple[Variable, ...]:
        return tuple(use.value for use in self.uses.values() if use.value is not None)

    def note(
        self, channel: Expression, direction: Direction, span: Span, with_value: bool, is_off: bool = False
    ) -> None:
        """Records one synchronisation.

        Args:
            is_off: whether a constant switches the edge off.
        """
        variable = channel_variable(channel)
        if variable is None:
            return
        use = self.uses.setdefault(variable, ChannelUse())
        if direction is Direction.SEND:
            use.senders = use.senders or span
            use.enabled_sender = use.enabled_sender or (None if is_off else span)
            if not with_value:
                use.plain_sender = use.plain_sender or span
        else:
            use.receivers = use.receivers or span
            use.enabled_receiver = use.enabled_receiver or (None if is_off else span)
            if with_value:
                use.value_receiver = use.value_receiver or span

    def value_place(self, channel: Expression, type_: Type, span: Span, context: Context) -> Expression | None:
        """The place that carries a value of the given type over a channel: a hidden variable, ``c_value`` where that
        name is free, indexed as the channel is."""
        from tachk.syntax.rewrite import fresh_name

        variable = channel_variable(channel)
        if variable is None:
            context.error("E0402", span, "values can only be passed over a channel that is named directly")
            return None
        payload: Type = INT if is_integral(type_) else type_
        if not isinstance(payload, ScalarType | RecordType) and not is_integral(payload):
            context.error(
                "E0402", span, f"a {describe(type_)} cannot be passed over a channel", "pass an integer or a struct"
            )
            return None
        use = self.uses.setdefault(variable, ChannelUse())
        if use.value is None:
            name = fresh_name(f"{variable.name}_value", self.taken)
            self.taken.add(name)
            hidden = _with_leaf(variable.type, payload)
            use.value = Variable(
                name,
                hidden,
                VariableKind.GLOBAL,
                default_values(hidden),
                declared_meta=True,
                span=variable.span,
                carries=variable,
            )
        place = _same_path(channel, use.value)
        if not same_shape(place.type, payload):
            context.error(
                "E0402",
                span,
                f"`{variable.name}` carries {describe(place.type)} elsewhere, here {describe(type_)}",
            )
            return None
        return place

    def check_values(self, context: Context) -> None:
        """Reports channels over which a value is expected that some sender does not give."""
        for variable, use in self.uses.items():
            if use.value_receiver is not None and use.plain_sender is not None:
                context.error(
                    "E0402",
                    use.plain_sender,
                    f"a receiver expects a value over `{variable.name}`, but this sender gives none",
                    f"write `{variable.name}!value`",
                )

    def check_partners(self, context: Context, recorded: frozenset[str] = frozenset()) -> None:
        """Warns about channels that are only sent or only received, but for those on which a recording takes part.

        Edges that a constant switches off are no reason for a warning.
        """
        for variable, use in self.uses.items():
            if variable.name in recorded:
                continue
            element = element_type(variable.type)
            if use.senders is None and use.enabled_receiver is not None:
                context.findings.add(
                    "W0401",
                    use.enabled_receiver,
                    f"nothing sends on channel `{variable.name}`: this edge is never taken",
                    f"add an edge with `sync {variable.name}!`, or remove the channel",
                )
            if use.receivers is None and use.enabled_sender is not None:
                if isinstance(element, ChannelType) and element.broadcast:
                    continue
                context.findings.add(
                    "W0402",
                    use.enabled_sender,
                    f"nothing receives on channel `{variable.name}`: this edge is never taken",
                    f"add an edge with `sync {variable.name}?`, or declare the channel `broadcast`",
                )


def channel_variable(channel: Expression) -> Variable | None:
    """The variable of a channel that is named directly or by index."""
    while isinstance(channel, Index):
        channel = channel.base
    return channel.variable if isinstance(channel, Reference) else None


def _with_leaf(type_: Type, leaf: Type) -> Type:
    if isinstance(type_, ArrayType):
        return ArrayType(_with_leaf(type_.element, leaf), type_.index)
    return leaf


def _same_path(channel: Expression, value: Variable) -> Expression:
    if isinstance(channel, Index):
        base = _same_path(channel.base, value)
        assert isinstance(base.type, ArrayType)
        return Index(base, channel.index, base.type.element, channel.span)
    return Reference(value, channel.span)
