"""modelDescription.xml: what a master reads of a unit before it loads it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import tachk
from tachk.simulation.fmi.unit import CoSimulationUnit, FmiType, Role, UnitVariable


class FmiVersion(StrEnum):
    """The versions of the standard."""

    TWO = "2"
    THREE = "3"


def description(unit: CoSimulationUnit, token: str, version: FmiVersion) -> bytes:
    """The description of a unit in a version of FMI."""
    match version:
        case FmiVersion.TWO:
            root = _version_2(unit, token)
        case FmiVersion.THREE:
            root = _version_3(unit, token)
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode").encode() + b"\n"


def type_names(variables: Sequence[UnitVariable]) -> dict[tuple[str, ...], str]:
    """The names of the enumerations, each named after the first variable that has it."""
    names: dict[tuple[str, ...], str] = {}
    for variable in variables:
        if variable.kind is FmiType.ENUMERATION:
            names.setdefault(variable.labels, f"values of {variable.name}")
    return names


def _head(
    unit: CoSimulationUnit,
    version: str,
    token: dict[str, str],
    abilities: Sequence[str],
    enumeration: Callable[[Element, str], Element],
) -> Element:
    """The part before the variables.

    Args:
        abilities: what the unit can, as this version calls it.
        enumeration: adds an enumeration with a name; gives the element for its values.
    """
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": unit.name,
            **token,
            "generationTool": f"tachk {tachk.__version__}",
            "variableNamingConvention": "flat",
        },
    )
    SubElement(root, "CoSimulation", {"modelIdentifier": unit.name, **dict.fromkeys(abilities, "true")})
    seconds = SubElement(SubElement(root, "UnitDefinitions"), "Unit", {"name": "s"})
    SubElement(seconds, "BaseUnit", {"s": "1"})
    definitions = SubElement(root, "TypeDefinitions")
    for labels, name in type_names(unit.variables).items():
        values = enumeration(definitions, name)
        for number, label in enumerate(labels):
            SubElement(values, "Item", {"name": label, "value": str(number)})
    SubElement(SubElement(root, "LogCategories"), "Category", {"name": "error", "description": "what went wrong"})
    SubElement(root, "DefaultExperiment", {"startTime": "0"})
    return root


def _declared(reference: int, variable: UnitVariable) -> dict[str, str]:
    """The attributes of a variable that both versions have."""
    return {
        "name": variable.name,
        "valueReference": str(reference),
        "causality": _causality(variable.role),
        "variability": _variability(variable.role),
    }


def _value(variable: UnitVariable) -> dict[str, str]:
    """The common part of the two versions."""
    result = {}
    if variable.bounds is not None:
        result = {"min": str(variable.bounds[0]), "max": str(variable.bounds[1])}
    if variable.start is not None:
        start = str(bool(variable.start)).lower() if variable.kind is FmiType.TRUTH else str(variable.start)
        result["start"] = start
    return result


def _causality(role: Role) -> str:
    match role:
        case Role.TIME:
            return "independent"
        case Role.SEED | Role.RUN | Role.POLICY:
            return "parameter"
        case Role.TRANSITIONS | Role.OBSERVED | Role.SENDS:
            return "output"
        case Role.INPUT | Role.RECEIVES:
            return "input"


def _variability(role: Role) -> str:
    match role:
        case Role.TIME:
            return "continuous"
        case Role.SEED | Role.RUN | Role.POLICY:
            return "fixed"
        case Role.TRANSITIONS | Role.OBSERVED | Role.SENDS | Role.INPUT | Role.RECEIVES:
            return "discrete"


def _outputs(unit: CoSimulationUnit) -> list[int]:
    return [n for n, variable in enumerate(unit.variables) if _causality(variable.role) == "output"]


# ---- version 3 ------------------------------------------------------------------------------------------------------

_TAGS_3 = {
    FmiType.REAL: "Float64",
    FmiType.INTEGER: "Int32",
    FmiType.TRUTH: "Boolean",
    FmiType.ENUMERATION: "Enumeration",
    FmiType.NATURAL: "UInt64",
    FmiType.CLOCK: "Clock",
}


def _version_3(unit: CoSimulationUnit, token: str) -> Element:
    abilities = (
        "canGetAndSetFMUState",
        "canSerializeFMUState",
        "canHandleVariableCommunicationStepSize",
        "hasEventMode",
    )
    root = _head(
        unit,
        "3.0",
        {"instantiationToken": token},
        abilities,
        lambda definitions, name: SubElement(definitions, "EnumerationType", {"name": name}),
    )
    types = type_names(unit.variables)
    variables = SubElement(root, "ModelVariables")
    structure = SubElement(root, "ModelStructure")
    for reference, variable in enumerate(unit.variables):
        attributes = _declared(reference, variable)
        match variable.kind:
            case FmiType.REAL:
                attributes |= {"unit": "s"} if variable.role is Role.TIME else {}
            case FmiType.ENUMERATION:
                attributes["declaredType"] = types[variable.labels]
            case FmiType.CLOCK:
                attributes["intervalVariability"] = "triggered"
            case FmiType.INTEGER | FmiType.TRUTH | FmiType.NATURAL:
                pass
        SubElement(variables, _TAGS_3[variable.kind], attributes | _value(variable))
    for element in ("Output", "InitialUnknown"):
        for reference in _outputs(unit):
            SubElement(structure, element, {"valueReference": str(reference)})
    return root


# ---- version 2 ------------------------------------------------------------------------------------------------------

_TAGS_2 = {
    FmiType.REAL: "Real",
    FmiType.INTEGER: "Integer",
    FmiType.TRUTH: "Boolean",
    FmiType.ENUMERATION: "Enumeration",
    FmiType.NATURAL: "Integer",
    FmiType.CLOCK: "Integer",
}


def _version_2(unit: CoSimulationUnit, token: str) -> Element:
    abilities = ("canHandleVariableCommunicationStepSize", "canGetAndSetFMUstate", "canSerializeFMUstate")
    root = _head(
        unit,
        "2.0",
        {"guid": token},
        abilities,
        lambda definitions, name: SubElement(SubElement(definitions, "SimpleType", {"name": name}), "Enumeration"),
    )
    types = type_names(unit.variables)
    variables = SubElement(root, "ModelVariables")
    structure = SubElement(root, "ModelStructure")
    for reference, variable in enumerate(unit.variables):
        scalar = SubElement(variables, "ScalarVariable", _declared(reference, variable))
        attributes = {"unit": "s"} if variable.role is Role.TIME else {}
        if variable.kind is FmiType.ENUMERATION:
            attributes["declaredType"] = types[variable.labels]
        if variable.kind is FmiType.NATURAL:
            attributes["min"] = "0"
        SubElement(scalar, _TAGS_2[variable.kind], attributes | _value(variable))
    outputs = _outputs(unit)
    for element in ("Outputs", "InitialUnknowns") if outputs else ():
        unknowns = SubElement(structure, element)
        for reference in outputs:
            SubElement(unknowns, "Unknown", {"index": str(reference + 1)})
    return root
