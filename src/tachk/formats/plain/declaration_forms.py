"""Functions, texts and fields in the form that UPPAAL reads.

UPPAAL looks at the last statement of a function that has a result: it must be a ``return``, a block or ``do`` that ends
with one, or an ``if`` with one on both sides. tachk also takes what follows from loops that never end. Texts are
constants in UPPAAL; tachk also takes variables, which it does not check. Structs have neither texts nor constant fields
there. Source: ``Statement::returns``, ``ExpressionBuilder::type_string``, ``StatementBuilder::struct_field`` and
``TypeChecker::checkType`` of UTAP 2.1.1.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.records import replace
from tachk.formats.plain.plain_model import PlainModel, PlainRewriting
from tachk.syntax import ast
from tachk.syntax.rewrite import fresh_name, names_in, rewrite
from tachk.syntax.walk import nodes_of_kind


def with_plain_declarations(plain: PlainModel) -> PlainModel:
    """The model with a last ``return`` in every function that needs one, with constant texts, and fields that are no
    constants.

    Raises:
        UnsupportedError: a text is assigned, or is a field or a named type (E0801).
    """
    forms = _DeclarationForms((*plain.declarations, *plain.templates))
    declarations, templates = rewrite((plain.declarations, plain.templates), forms.form)
    fields = {id(type_) for type_ in texts_in_structs((declarations, templates))}
    for type_ in nodes_of_kind((declarations, templates), ast.TypeExpression):
        if is_variable_text(type_) or id(type_) in fields:
            message = "UPPAAL has texts as constants only"
            help_ = "write `const string` outside of structs, or leave the declaration and its assignments out"
            raise UnsupportedError(Diagnostic("E0801", message, type_.span, help_))
    return replace(plain, declarations=declarations, templates=templates, steps=(*plain.steps, *forms.steps))


def lacks_return(function: ast.FunctionDeclaration) -> bool:
    """True if UPPAAL finds no ``return`` at the end of a function that has a result."""
    void = isinstance(function.result.base, ast.BuiltinType) and function.result.base.name == "void"
    return not void and not _returns(function.body)


def is_variable_text(type_: ast.TypeExpression) -> bool:
    """True if a type is ``string`` without ``const``."""
    return _is_text(type_) and "const" not in type_.prefixes


def texts_in_structs(nodes: Iterable[object]) -> Iterator[ast.TypeExpression]:
    """The types of fields that are texts, constant or not."""
    for struct in nodes_of_kind(nodes, ast.StructType):
        for field in struct.fields:
            if isinstance(field.type, ast.TypeExpression) and _is_text(field.type):
                yield field.type


def constant_fields(nodes: Iterable[object]) -> Iterator[ast.TypeExpression]:
    """The types of fields that are declared as constants."""
    for struct in nodes_of_kind(nodes, ast.StructType):
        for field in struct.fields:
            if isinstance(field.type, ast.TypeExpression) and "const" in field.type.prefixes:
                yield field.type


def _is_text(type_: ast.TypeExpression) -> bool:
    return isinstance(type_.base, ast.BuiltinType) and type_.base.name == "string"


def _returns(statement: ast.Statement) -> bool:
    match statement:
        case ast.ReturnStatement():
            return True
        case ast.BlockStatement(statements=statements):
            return not statements or _returns(statements[-1])
        case ast.IfStatement(then=then, otherwise=otherwise):
            return otherwise is not None and _returns(then) and _returns(otherwise)
        case ast.DoStatement(body=body):
            return _returns(body)
        case _:
            return False


class _DeclarationForms:
    """Brings declarations into the form, and notes the steps."""

    def __init__(self, nodes: tuple[Any, ...]) -> None:
        self.steps: list[PlainRewriting] = []
        self.used = set(names_in(nodes))
        self.assigned = _assigned(nodes)
        # UPPAAL has no constant fields.
        self.fields = {id(field) for struct in nodes_of_kind(nodes, ast.StructType) for field in struct.fields}

    def form(self, node: Any) -> Any:
        match node:
            case ast.StructType():
                return replace(node, fields=tuple(map(self.field, node.fields)))
            case ast.FunctionDeclaration() if lacks_return(node):
                return self.with_return(node)
            case ast.VariableDeclaration(type=ast.TypeExpression() as type_) if is_variable_text(type_):
                return self.constant(node, type_)
            case ast.Parameter(type=type_, reference=False, name=name) if is_variable_text(type_):
                return node if name.name in self.assigned else replace(node, type=_constant(type_))
            case _:
                return node

    def field(self, field: ast.VariableDeclaration) -> ast.VariableDeclaration:
        """The field without `const`."""
        if not (isinstance(field.type, ast.TypeExpression) and "const" in field.type.prefixes):
            return field
        names = ", ".join(f"`{declarator.name.name}`" for declarator in field.declarators)
        self.steps.append(
            PlainRewriting("field", field.span, f"{names} without `const`: a struct has no constant fields")
        )
        prefixes = tuple(prefix for prefix in field.type.prefixes if prefix != "const")
        return replace(field, type=replace(field.type, prefixes=prefixes))

    def with_return(self, function: ast.FunctionDeclaration) -> ast.FunctionDeclaration:
        """The function with a last block that returns a value of its type and is never reached."""
        span, name = function.body.span, fresh_name("unreached", self.used)
        declarator = ast.Declarator(span, ast.Identifier(span, name))
        last = ast.BlockStatement(
            span,
            (ast.VariableDeclaration(span, function.result, (declarator,)),),
            (ast.ReturnStatement(span, ast.NameExpression(span, name)),),
        )
        text = f"`{function.name.name}` ends with a `return`, which is never reached"
        self.steps.append(PlainRewriting("return", function.name.span, text))
        return replace(function, body=replace(function.body, statements=(*function.body.statements, last)))

    def constant(self, node: ast.VariableDeclaration, type_: ast.TypeExpression) -> ast.VariableDeclaration:
        names = [each.name.name for each in node.declarators]
        is_variable = any(name in self.assigned for name in names) or any(each.dimensions for each in node.declarators)
        if is_variable or id(node) in self.fields:
            return node
        empty = ast.StringLiteral(node.span, "")
        declarators = tuple(
            each if each.initialiser is not None else replace(each, initialiser=empty) for each in node.declarators
        )
        listed = ", ".join(f"`{name}`" for name in names)
        self.steps.append(PlainRewriting("text", node.span, f"{listed} made constant: nothing assigns a text"))
        return replace(node, type=_constant(type_), declarators=declarators)


def _constant(type_: ast.TypeExpression) -> ast.TypeExpression:
    return replace(type_, prefixes=("const",))


def _assigned(nodes: tuple[Any, ...]) -> Collection[str]:
    """The names of all places that are assigned anywhere."""
    found = set()
    for node in nodes_of_kind(nodes, ast.AssignmentExpression):
        place = node.target
        while isinstance(place, ast.IndexExpression | ast.MemberExpression):
            place = place.base
        if isinstance(place, ast.NameExpression):
            found.add(place.name)
    return found
