"""Values that UPPAAL wants to know when it reads a model, and that tachk knows only once parameters have values.

For UPPAAL a parameter is such a value if it is declared `const` and passed by value, as its open parser decides.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.syntax import ast
from tachk.syntax.rewrite import names_in


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
