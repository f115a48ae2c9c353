"""From the items of a document to a network and its queries."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from tachk.base.diagnostics.diagnostic import Label
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, field, replace
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.declarations.channels import ChannelTable
from tachk.frontend.declarations.declarations import Declared, declare, set_channel_priorities
from tachk.frontend.dropped_fields import lasting_structs
from tachk.frontend.queries.queries import UncheckedQuery, elaborate_each, elaborate_properties, elaborate_signals
from tachk.frontend.scope import Scope, TemplateSymbol
from tachk.frontend.templates.instances import Instances
from tachk.frontend.templates.templates import warn_unreachable
from tachk.model.expressions import Binary, Constant, Expression
from tachk.model.metas import keep_lasting
from tachk.model.network import Edge, Network, Process
from tachk.model.query import Query
from tachk.model.types import ClockType
from tachk.syntax import ast

if TYPE_CHECKING:
    from tachk.model.recording import RecordingMap

_BELOW = (BinaryOperator.LESS, BinaryOperator.LESS_EQUAL, BinaryOperator.EQUAL)
_ABOVE = (BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL, BinaryOperator.EQUAL)
_STRICT = (BinaryOperator.LESS, BinaryOperator.GREATER)

Bound = tuple[Expression, BinaryOperator, int, Span]
"""A clock, how it compares with a number, and where that is said."""


def warn_of_impossible_edges(network: Network, context: Context) -> None:
    """Warns of edges whose guard contradicts the invariant of their source in every process of the template."""
    contradictions: dict[Span, tuple[str, Bound, Bound] | None] = {}
    for process in network.processes:
        check_job()
        for edge in process.edges:
            found = _contradiction(process, edge)
            if found is None:
                contradictions[edge.spans[0]] = None
            else:
                contradictions.setdefault(edge.spans[0], (process.locations[edge.source].name, *found))
    for contradiction in contradictions.values():
        if contradiction is not None:
            location, demanded, allowed = contradiction
            context.findings.add(
                "W0411",
                demanded[3],
                f"this is never true in `{location}`, because of its invariant: the edge is never taken",
                "change the guard or the invariant",
                (Label(allowed[3], "the invariant"),),
            )


def _contradiction(process: Process, edge: Edge) -> tuple[Bound, Bound] | None:
    """A comparison of the guard and one of the invariant that no value of the clock meets together."""
    invariant = process.locations[edge.source].invariant
    if edge.guard is None or invariant is None:
        return None
    allowed = list(_bounds(invariant))
    return next((pair for one in _bounds(edge.guard) for other in allowed if _exclude(*(pair := (one, other)))), None)


def _bounds(condition: Expression) -> Iterator[Bound]:
    """The comparisons of a clock with a number that a conjunction consists of, among others."""
    match condition:
        case Binary(BinaryOperator.AND, left, right):
            yield from _bounds(left)
            yield from _bounds(right)
        case Binary(operator, left, Constant(value)) if isinstance(left.type, ClockType):
            yield left, operator, value, condition.span
        case Binary(operator, Constant(value), right) if isinstance(right.type, ClockType):
            yield right, operator.mirrored, value, condition.span


def _exclude(one: Bound, other: Bound) -> bool:
    """True if no value of one clock satisfies both."""
    (clock, first, low, _), (same, second, high, _) = one, other
    if clock != same:
        return False
    if first in _ABOVE and second in _BELOW:
        return low > high or (low == high and (first in _STRICT or second in _STRICT))
    if first in _BELOW and second in _ABOVE:
        return low < high or (low == high and (first in _STRICT or second in _STRICT))
    return False


@dataclass(frozen=True, slots=True)
class Elaborated:
    """Attributes:
    network: incomplete where there are errors among the findings.
    scope: the names that queries may use.
    recording: how recordings are held against the network.
    """

    network: Network
    queries: tuple[Query, ...]
    unchecked: tuple[UncheckedQuery, ...]
    scope: Scope = field(repr=False)
    context: Context = field(repr=False)
    recording: RecordingMap | None = None


_Declaration = (
    ast.VariableDeclaration
    | ast.TypedefDeclaration
    | ast.FunctionDeclaration
    | ast.ChannelPriorityDeclaration
    | ast.UpdateHook
    | ast.ForeignImport
)
"""The forms of global declarations."""


def elaborate(
    items: Sequence[ast.Item], whole: Span, overrides: Mapping[str, ast.Expression], context: Context
) -> Elaborated:
    """Elaborates a model.

    Args:
        items: of the document, imports replaced.
        whole: the place of the document, for what is missing.
        overrides: values for global constants.
    """
    if not context.keeps_doubles:
        context.lasting_structs = lasting_structs(items)
    globals_ = Scope(None, "the globals")
    declared = Declared(overrides=overrides)
    declarations = [item for item in items if isinstance(item, _Declaration)]
    globals_.below = frozenset(_declared_names(declarations))
    priorities = declare(declarations, globals_, declared, context)
    default_priority = set_channel_priorities(priorities, globals_, declared, context)
    for item in items:
        if isinstance(item, ast.Template | ast.Instantiation):
            globals_.declare(item.name, TemplateSymbol(item, item.name.span), context.findings)
    for item in items:
        if isinstance(item, ast.Template):
            warn_unreachable(item, context)
    channels = ChannelTable(set(globals_.symbols))
    instances = Instances(globals_, channels, context)
    line = _system_line(items, whole, context)
    if line is not None:
        instances.run_system(line)

    instances.check_unused()
    channels.check_values(context)
    if not context.findings.has_errors:
        channels.check_partners(context, _recorded_channels(items))
    scope = Scope(globals_, "the processes", dict(instances.symbols))
    signals = elaborate_signals((i for i in items if isinstance(i, ast.SignalDeclaration)), scope, context)
    context.time_unit = _time_unit(items, context)
    # Without a system line no process has a name that a property could mention.
    properties = (i for i in items if isinstance(i, ast.PropertyDeclaration) and line is not None)
    queries, unchecked = elaborate_properties(properties, scope, context)
    recording = _recording(items, instances.processes, scope, context)
    network = Network(
        tuple(instances.processes),
        (*declared.variables, *channels.hidden_variables()),
        default_priority,
        tuple(declared.constants),
        signals,
        context.time_unit,
        _hidden(items, instances, context),
    )
    if not context.findings.has_mistakes:
        network = keep_lasting(network)
        _warn_of_lasting(network, context)
    if not context.findings.has_errors:
        warn_of_impossible_edges(network, context)
    return Elaborated(network, queries, unchecked, scope, context, recording)


def _has_recording(items: Iterable[ast.Item]) -> bool:
    return any(isinstance(item, ast.RecordingDeclaration) for item in items)


def _recorded_channels(items: Sequence[ast.Item]) -> frozenset[str]:
    """The channels on which the recording of a model takes part."""
    if not _has_recording(items):
        return frozenset()
    from tachk.frontend.recordings import channels_of  # of no use to most models

    return channels_of(items)


def _recording(
    items: Sequence[ast.Item], processes: Sequence[Process], scope: Scope, context: Context
) -> RecordingMap | None:
    """The recording of a model; None if it has none, or where it is wrong."""
    if not _has_recording(items):
        return None
    from tachk.frontend.recordings import elaborate_recording

    return elaborate_recording(items, processes, scope, context)


def elaborate_each_property(
    items: Sequence[ast.Item], whole: Span, overrides: Mapping[str, ast.Expression], context: Context
) -> Elaborated:
    """As `elaborate`, but a property that is wrong is an unchecked query and harms nothing else."""
    properties = [item for item in items if isinstance(item, ast.PropertyDeclaration)]
    others = [item for item in items if not isinstance(item, ast.PropertyDeclaration)]
    result = elaborate(others, whole, overrides, context)
    queries, unchecked = elaborate_each(properties, result.scope, context)
    return replace(result, queries=queries, unchecked=unchecked)


def _warn_of_lasting(network: Network, context: Context) -> None:
    for span in dict.fromkeys(variable.span for variable in network.all_variables() if variable in network.lasting):
        context.findings.add(
            "W0408",
            span,
            f"the meta variable `{span.text}` may be read before its transition has written it, so the state holds it",
            "drop `meta`, or write the variable first wherever it is used",
        )


def _declared_names(declarations: Iterable[ast.Declaration]) -> Iterator[str]:
    for item in declarations:
        match item:
            case ast.VariableDeclaration() | ast.TypedefDeclaration():
                yield from (declarator.name.name for declarator in item.declarators)
            case ast.FunctionDeclaration():
                yield item.name.name
            case _:
                pass


def _system_line(items: Sequence[ast.Item], whole: Span, context: Context) -> ast.SystemLine | None:
    lines = [item for item in items if isinstance(item, ast.SystemLine)]
    for extra in lines[1:]:
        context.findings.add(
            "E0411", extra.span, "a second system line", "join the two", (Label(lines[0].span, "the first one"),)
        )
    if lines:
        return lines[0]
    end = Span(whole.source, whole.end, whole.end)
    templates = ", ".join(item.name.name for item in items if isinstance(item, ast.Template))
    context.error(
        "E0410",
        end,
        "the system line is missing: nothing says which processes run",
        f"end the file with `system {templates or 'P'};`",
    )
    return None


def _hidden(items: Sequence[ast.Item], instances: Instances, context: Context) -> tuple[str, ...]:
    templates = [item.name.name for item in items if isinstance(item, ast.Template | ast.Instantiation)]
    known = [*templates, *(process.name for process in instances.processes)]
    names = [name for item in items if isinstance(item, ast.HideDeclaration) for name in item.names]
    for name in names:
        if name.name not in known:
            help_ = did_you_mean(name.name, known) or "name a template, or a process of the system line"
            context.error("E0426", name.span, f"there is no template or process `{name.name}` to hide", help_)
    return tuple(dict.fromkeys(name.name for name in names))


def _time_unit(items: Sequence[ast.Item], context: Context) -> str:
    units = [item for item in items if isinstance(item, ast.TimeUnitDeclaration)]
    for other in units[1:]:
        if (other.amount, other.unit) != (units[0].amount, units[0].unit):
            context.findings.add(
                "E0417",
                other.span,
                "a second time unit",
                "the files of one model must agree on one",
                (Label(units[0].span, "the first one"),),
            )
    return f"{units[0].amount} {units[0].unit}" if units else ""
