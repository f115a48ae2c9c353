"""Constructs that a version of UPPAAL refuses in a model, or treats otherwise than tachk does.

The rules come from UPPAAL's documentation and from its open parser UTAP 2.1.1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.base.words import QueryKind
from tachk.engine.compiler.features import stopwatches, urgent_clock_guards
from tachk.formats.plain.declaration_forms import (
    constant_fields,
    is_variable_text,
    lacks_return,
    texts_in_structs,
)
from tachk.formats.plain.expansion import expand_document
from tachk.formats.plain.free_names import DECLARED_5, QUERY_WORDS, WORDS_4_1, WORDS_5, declared_names
from tachk.formats.uppaal.condition_types import condition_findings
from tachk.formats.uppaal.limits import rejects_deadlock
from tachk.formats.uppaal.query_asides import is_set_aside
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.frontend.expressions.builtin_names import BUILTIN_CONSTANTS, BUILTIN_TYPES
from tachk.frontend.loaded import LoadedModel
from tachk.model.clock_sums import clock_copies
from tachk.model.expressions import Deadlock, Expression
from tachk.model.floating import contains_double
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.traversal import process_expressions, walk
from tachk.model.types import ArrayType, ClockType
from tachk.syntax import ast
from tachk.syntax.parsing.strict import additions
from tachk.syntax.rewrite import names_in
from tachk.syntax.walk import nodes_of_kind

_MEND = "let a function with an integer or boolean result compute it"
_REASON = "where channels or processes have priorities, or a receiver of a broadcast has a clock in its guard"


def query_findings(model: LoadedModel, version: str) -> Iterator[Diagnostic]:
    """One error for each query that the version refuses; it does not see those that an export made comments."""
    never = rejects_deadlock(expand_document(ast.Document(model.document.span, model.items)))
    for query in model.queries:
        if is_set_aside(query.span):
            continue
        number = _floating_part(_expressions(query))
        if number is not None:
            message = f"{version} takes no floating point numbers in queries that are checked symbolically"
            yield Diagnostic("E0815", message, number.span, _MEND)
        deadlock = next((n for e in _expressions(query) for n in walk(e) if isinstance(n, Deadlock)), None)
        if deadlock is None:
            continue
        if query.kind not in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY):
            message = f"{version} takes `deadlock` in E<> and A[] only, not in {query.kind.value}"
            yield Diagnostic("E0815", message, deadlock.span)
        elif never:
            yield Diagnostic("E0815", f"{version} does not check `deadlock` {_REASON}; tachk does", deadlock.span)


def floating_findings(network: Network, version: str) -> Iterator[Diagnostic]:
    """One warning for each process in whose guards or updates the version would not check floating point numbers."""
    for process in network.processes:
        number = _floating_part(process_expressions(process))
        if number is not None:
            message = f"{version} answers no symbolic query where guards or updates use floating point numbers"
            yield Diagnostic("W0501", message, number.span, _MEND)


def _floating_part(expressions: Iterable[Expression]) -> Expression | None:
    """The first part of expressions that is, or computes with, a floating point number; what the functions that they
    call do inside is their own matter."""
    return next((node for each in expressions for node in walk(each) if contains_double(node.type)), None)


def _expressions(query: Query) -> tuple[Expression, ...]:
    return query.operands if query.predicate is None else (query.predicate, *query.operands)


def open_constants(items: Iterable[ast.Item], version: str) -> Iterator[Diagnostic]:
    """One error for each place that needs a known value and uses a parameter that is none."""
    for item in items:
        match item:
            case ast.Template(parameters=parameters, declarations=declarations):
                unknown = _unknown(parameters)
                for declaration in declarations:
                    if isinstance(declaration, ast.VariableDeclaration):
                        for declarator in declaration.declarators:
                            needs = (declaration.type, declarator.dimensions, declarator.initialiser)
                            yield from _found(needs, unknown, "a declaration needs", version)
                    elif isinstance(declaration, ast.TypedefDeclaration):
                        yield from _found(declaration.type, unknown, "a type needs", version)
            case ast.Instantiation(parameters=parameters, arguments=arguments):
                # A reference may be handed on to a parameter that is one itself, which the template decides.
                handed_on = {name: p for name, p in _unknown(parameters).items() if not p.reference}
                yield from _found(arguments, handed_on, "an argument needs", version)
            case _:
                pass


def _unknown(parameters: Iterable[ast.Parameter]) -> dict[str, ast.Parameter]:
    return {p.name.name: p for p in parameters if p.reference or "const" not in p.type.prefixes}


def _found(node: object, unknown: dict[str, ast.Parameter], what: str, version: str) -> Iterator[Diagnostic]:
    for name, span in names_in(node).items():
        if name in unknown:
            parameter = unknown[name]
            mend = f"declare the parameter `const`{' and without `&`' if parameter.reference else ''}"
            message = f"{what} a value that {version} knows when it reads the model, and the parameter `{name}` is none"
            yield Diagnostic("E0817", message, span, mend)


_INSTEAD = {
    BinaryOperator.XOR: "compare two boolean values with `!=`",
    BinaryOperator.POWER: "multiply, or write a function",
}
"""The replacement of an operator that a version does not know."""
_ADDED = (
    ast.ImportDeclaration,
    ast.TimeUnitDeclaration,
    ast.SignalDeclaration,
    ast.PropertyDeclaration,
    ast.ExpectationDeclaration,
    ast.HideDeclaration,
    ast.RecordingDeclaration,
)
"""The words that UPPAAL knows in no place."""


def portability(model: LoadedModel, version: UppaalVersion) -> tuple[Diagnostic, ...]:
    """Everything that the version would refuse (errors) or treat otherwise (warnings), in the order of the text."""
    found = [
        *_additions(model, version),
        *_order_of_sections(model.items, version),
        *_names(model, version),
        *_newer(model.items, version),
        *_types(model.items, version),
        *_forms(model.items, version),
        *condition_findings(model.items, version.full_name),
        *open_constants(model.items, version.full_name),
        *_written_names(model, version),
        *query_findings(model, version.full_name),
        *_other_treatment(model, version),
    ]
    unique = {(d.code, d.span.start, d.message): d for d in found}
    return tuple(sorted(unique.values(), key=lambda d: (d.span.source.name, d.span.start, d.code)))


def _additions(model: LoadedModel, version: UppaalVersion) -> Iterator[Diagnostic]:
    document = ast.Document(model.document.span, (*model.document.items, *model.items))
    if model.layout is not None:
        return  # properties are how a query of XML is held
    for found in additions(document):
        what = found.message.removesuffix(" is not part of XTA")
        mend = f"`tachk convert` {_WRITTEN[what]}"
        yield Diagnostic("E0810", f"{what}: {version.full_name} does not know it", found.span, mend)


_WRITTEN = {
    "the import of a file": "writes what the file declares in its place",
    "'time_unit'": "writes it as a comment",
    "a signal": "writes it out where a property names it",
    "a property": "writes it as a query, its name and expectation beside it",
    "an expectation": "writes it beside the queries it is about",
    "'hide'": "leaves it out, which changes no behaviour",
    "'recording'": "leaves it out, which changes no behaviour",
    "a location block": "writes the edges below `trans`",
    "a synchronisation with a value": "writes a variable that carries the value",
}
"""The treatment of each addition by the export."""


_BELOW = (ast.SystemLine, ast.ProgressDeclaration, ast.GanttDeclaration)
"""The ends of a text, in this order."""


def _order_of_sections(items: Sequence[ast.Item], version: UppaalVersion) -> Iterator[Diagnostic]:
    """Constructs after something that comes later in UPPAAL's order; additions of tachk aside."""
    reached = -1
    for item in items:
        if isinstance(item, _BELOW):
            place = _BELOW.index(type(item))
            in_order = place >= reached
            reached = max(place, reached)
        else:
            in_order = reached < 0 or isinstance(item, _ADDED)
        if not in_order:
            yield Diagnostic(
                "E0822",
                f"{version.full_name} does not read this below the system line",
                item.span,
                "write it above `system`, as `tachk convert` does",
            )


def _names(model: LoadedModel, version: UppaalVersion) -> Iterator[Diagnostic]:
    mend = "`tachk convert --fix` renames it everywhere"
    reserved = WORDS_4_1 if version is UppaalVersion.UPPAAL_4_1 else WORDS_5
    properties = [item.formula for item in model.items if isinstance(item, ast.PropertyDeclaration)]
    queried = names_in(tuple(properties))
    declared = declared_names(tuple(item for item in model.items if not isinstance(item, ast.PropertyDeclaration)))
    for name, identifier in declared.items():
        if name in reserved:
            yield Diagnostic("E0811", f"`{name}` is a word of {version.full_name}", identifier.span, mend)
        elif version is UppaalVersion.UPPAAL_5_0 and name in DECLARED_5:
            yield Diagnostic("E0811", f"`{name}` is declared by {version.full_name} itself", identifier.span, mend)
        elif name in QUERY_WORDS and name in queried:
            message = f"`{name}` is a word of {version.full_name} in queries"
            yield Diagnostic("E0811", message, identifier.span, mend)
    if version is UppaalVersion.UPPAAL_4_1:
        for name, span in names_in(model.items).items():
            if name not in declared and (name in BUILTIN_TYPES or name in BUILTIN_CONSTANTS):
                yield Diagnostic(
                    "E0812", f"`{name}` is not declared in {version.full_name}", span, "`tachk convert` writes it out"
                )


def _newer(items: Sequence[ast.Item], version: UppaalVersion) -> Iterator[Diagnostic]:
    """The constructs that the version does not know yet."""
    for expression in nodes_of_kind(items, ast.BinaryExpression):
        if not version.knows(expression.operator):
            instead = _INSTEAD.get(expression.operator)
            yield _too_new(f"`{expression.operator}`", expression.span, version, instead)
    if version is not UppaalVersion.UPPAAL_4_1:
        return
    for node in nodes_of_kind(items, ast.AssertStatement, ast.ForeignImport):
        match node:
            case ast.AssertStatement(span):
                yield _too_new("`assert`", span, version, "leave it out, or test it in a query")
            case ast.ForeignImport(span=span):
                yield _too_new("functions of foreign libraries", span, version, None)
            case _:
                pass


def _too_new(what: str, span: Span, version: UppaalVersion, mend: str | None) -> Diagnostic:
    return Diagnostic("E0813", f"{version.full_name} does not know {what}", span, mend)


def _types(items: Sequence[ast.Item], version: UppaalVersion) -> Iterator[Diagnostic]:
    for type_ in nodes_of_kind(items, ast.TypeExpression):
        if len(type_.prefixes) > 1 and type_.prefixes != ("urgent", "broadcast"):
            written = " ".join(type_.prefixes)
            yield Diagnostic(
                "E0814",
                f"{version.full_name} does not read `{written}`",
                type_.span,
                "`tachk convert` writes it as it must be",
            )
    everywhere = _type_names(items)
    for item in items:
        names: tuple[ast.Identifier, ...]
        if isinstance(item, ast.Template):
            visible = everywhere | _type_names(item.declarations)
            places = (*(l.name for l in item.locations), *(b.name for b in item.branchpoints))
            names = (item.name, *(parameter.name for parameter in item.parameters), *places)
        elif isinstance(item, ast.Instantiation):
            visible, names = everywhere, (item.name,)
        else:
            continue
        for name in names:
            if name.name in visible:
                yield Diagnostic(
                    "E0816",
                    f"`{name.name}` is a type, which {version.full_name} does not take here",
                    name.span,
                    "rename one",
                )


def _forms(items: Sequence[ast.Item], version: UppaalVersion) -> Iterator[Diagnostic]:
    """Functions, texts, fields and locations in a form that the version refuses."""
    for function in nodes_of_kind(items, ast.FunctionDeclaration):
        if lacks_return(function):
            message = f"{version.full_name} wants a `return` as the last statement of `{function.name.name}`"
            yield Diagnostic("E0824", message, function.name.span, "`tachk convert` adds one")
    fields = {id(type_) for type_ in texts_in_structs(items)}
    for type_ in nodes_of_kind(items, ast.TypeExpression):
        if id(type_) in fields:
            message = f"{version.full_name} has no texts in structs"
            yield Diagnostic("E0825", message, type_.span, "declare it as `const string` outside of the struct")
        elif is_variable_text(type_):
            message = f"{version.full_name} has texts as constants only"
            yield Diagnostic("E0825", message, type_.span, "write `const string`")
    for type_ in constant_fields(items):
        if id(type_) not in fields:
            message = f"{version.full_name} has no constant fields"
            yield Diagnostic("E0827", message, type_.span, "`tachk convert` writes it without `const`")
    for location in nodes_of_kind(items, ast.LocationDeclaration):
        if location.urgent and location.committed:
            message = f"{version.full_name} refuses a location that is both committed and urgent"
            help_ = "`tachk convert` writes committed alone: time does not pass there either"
            yield Diagnostic("E0826", message, location.name.span, help_)


def _type_names(items: Iterable[object]) -> frozenset[str]:
    return frozenset(
        declarator.name.name
        for item in items
        if isinstance(item, ast.TypedefDeclaration)
        for declarator in item.declarators
    )


def _written_names(model: LoadedModel, version: UppaalVersion) -> Iterator[Diagnostic]:
    """The names in a XML file that were put right when it was read."""
    pictures = model.layout.templates if model.layout is not None else {}
    for template in (item for item in model.items if isinstance(item, ast.Template)):
        nodes = pictures[template.name.name].nodes if template.name.name in pictures else {}
        for location in template.locations:
            written = nodes[location.name.name].written_name if location.name.name in nodes else None
            if written:
                yield Diagnostic(
                    "E0819",
                    f"{version.full_name} refuses a second location `{written}`, or a name that is not an identifier",
                    location.name.span,
                    f"it is called `{location.name.name}` here; `tachk convert` writes it so",
                )


def _other_treatment(model: LoadedModel, version: UppaalVersion) -> Iterator[Diagnostic]:
    for use in stopwatches(model.network):
        yield _otherwise(
            use.span, f"with stopped clocks {version.full_name} may answer that a property may be satisfied", None
        )
    for use in urgent_clock_guards(model.network):
        verb = "refuses" if version is UppaalVersion.UPPAAL_4_1 else "warns about"
        yield _otherwise(
            use.span,
            f"{version.full_name} {verb} a clock guard on an urgent channel",
            "wait for the clock in a location of its own",
        )
    for copy in clock_copies(model.network):
        yield _otherwise(copy.span, f"{version.full_name} copies clocks in statistical checking only", None)
    yield from floating_findings(model.network, version.full_name)
    for template in (item for item in model.items if isinstance(item, ast.Template)):
        for location in template.locations:
            if location.invariant is not None:
                yield from _invariant(location.invariant, version, model)
    if model.document.legacy:
        yield _otherwise(
            model.document.span,
            f"{version.full_name} reads this text only as UPPAAL 3.x",
            "`tachk convert` writes it in today's syntax",
        )


def _invariant(invariant: ast.Expression, version: UppaalVersion, model: LoadedModel) -> Iterator[Diagnostic]:
    clocks = {v.name.rpartition(".")[2] for v in model.network.all_variables() if _is_clock(v.type)}
    for node in nodes_of_kind(invariant, ast.BinaryExpression):
        if node.operator not in (BinaryOperator.LESS, BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL):
            continue
        left, right = _is_named(node.left, clocks), _is_named(node.right, clocks)
        if left == right:
            continue
        upper = (node.operator == BinaryOperator.LESS) == left
        if not upper:
            yield _otherwise(
                node.span,
                f"the documentation of {version.full_name} wants upper bounds in invariants, this is a lower one",
                "put it into the guards of the edges that lead here",
            )
        elif node.operator != BinaryOperator.GREATER_EQUAL and version is UppaalVersion.UPPAAL_5_0:
            yield _otherwise(node.span, f"{version.full_name} warns about a strict bound in an invariant", None)


def _is_named(expression: ast.Expression, names: set[str]) -> bool:
    while isinstance(expression, ast.IndexExpression | ast.MemberExpression):
        expression = expression.base
    return isinstance(expression, ast.NameExpression) and expression.name in names


def _is_clock(type_: object) -> bool:
    while isinstance(type_, ArrayType):
        type_ = type_.element
    return isinstance(type_, ClockType)


def _otherwise(span: Span, message: str, mend: str | None) -> Diagnostic:
    return Diagnostic("W0501", message, span, mend)
