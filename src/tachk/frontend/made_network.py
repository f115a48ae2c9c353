"""Networks that were made in Python, not from text: the names that queries about them may use."""

from __future__ import annotations

from tachk.frontend.context import Context
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.scope import LocationSymbol, ProcessSymbol, Scope, Symbol, ValueSymbol
from tachk.model.expressions import Reference, Variable
from tachk.model.network import Network
from tachk.syntax import ast


def scope_of(network: Network) -> Scope:
    """The names of a network: global variables, ``P.location``, ``P.variable``."""
    scope = Scope(None, "the network", {each.name: _value(each) for each in network.variables})
    for number, process in enumerate(network.processes):
        inside: dict[str, Symbol] = {each.name: LocationSymbol(index) for index, each in enumerate(process.locations)}
        inside |= {each.name.removeprefix(f"{process.name}."): _value(each) for each in process.variables}
        scope.symbols[process.name] = ProcessSymbol(number, Scope(scope, process.name, inside))
    return scope


def _value(variable: Variable) -> Symbol:
    return ValueSymbol(Reference(variable), True, "variable")


def made_model(network: Network, document: ast.Document) -> LoadedModel:
    """A network as a model without properties.

    Args:
        document: how the network would be written; empty where it cannot be.
    """
    return LoadedModel(network, (), (), (), document, document.items, scope_of(network), Context(DiagnosticCollector()))
