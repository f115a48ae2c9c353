"""modelDescription.xml: what a master reads of a unit before it loads it."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import tachk
from tachk.fmi.unit import Kind, Role, Unit, Variable


class Version(StrEnum):
    """Of the standard."""

    TWO = "2"
    THREE = "3"


def description(unit: Unit, token: str, version: Version) -> bytes:
    """The description of a unit in a version of FMI."""
    match version:
        case Version.TWO:
            root = _version_2(unit, token)
        case Version.THREE:
            root = _version_3(unit, token)
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode").encode() + b"\n"


def type_names(variables: Sequence[Variable]) -> dict[tuple[str, ...], str]:
    """The names of the enumerations, each named after the first variable that has it."""
    names: dict[tuple[str, ...], str] = {}
    for variable in variables:
        if variable.kind is Kind.ENUMERATION:
            names.setdefault(variable.labels, f"values of {variable.name}")
    return names


def _root(unit: Unit, version: str, token: dict[str, str]) -> Element:
    return Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": unit.name,
            **token,
            "generationTool": f"tachk {tachk.__version__}",
            "variableNamingConvention": "flat",
        },
    )


def _seconds(root: Element) -> None:
    unit = SubElement(SubElement(root, "UnitDefinitions"), "Unit", {"name": "s"})
    SubElement(unit, "BaseUnit", {"s": "1"})


def _log_categories(root: Element) -> None:
    SubElement(SubElement(root, "LogCategories"), "Category", {"name": "error", "description": "what went wrong"})


def _value(variable: Variable) -> dict[str, str]:
    """What the two versions call the same."""
    result = {}
    if variable.bounds is not None:
        result = {"min": str(variable.bounds[0]), "max": str(variable.bounds[1])}
    if variable.start is not None:
        start = str(bool(variable.start)).lower() if variable.kind is Kind.TRUTH else str(variable.start)
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
        case Role.INPUT | Role.HEARS:
            return "input"


def _variability(role: Role) -> str:
    match role:
        case Role.TIME:
            return "continuous"
        case Role.SEED | Role.RUN | Role.POLICY:
            return "fixed"
        case Role.TRANSITIONS | Role.OBSERVED | Role.SENDS | Role.INPUT | Role.HEARS:
            return "discrete"


# ---- version 3 ------------------------------------------------------------------------------------------------------

_TAGS_3 = {
    Kind.REAL: "Float64",
    Kind.INTEGER: "Int32",
    Kind.TRUTH: "Boolean",
    Kind.ENUMERATION: "Enumeration",
    Kind.NATURAL: "UInt64",
    Kind.CLOCK: "Clock",
}


def _version_3(unit: Unit, token: str) -> Element:
    root = _root(unit, "3.0", {"instantiationToken": token})
    SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": unit.name,
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "canHandleVariableCommunicationStepSize": "true",
            "hasEventMode": "true",
        },
    )
    _seconds(root)
    types = type_names(unit.variables)
    definitions = SubElement(root, "TypeDefinitions")
    for labels, name in types.items():
        definition = SubElement(definitions, "EnumerationType", {"name": name})
        for number, label in enumerate(labels):
            SubElement(definition, "Item", {"name": label, "value": str(number)})
    _log_categories(root)
    SubElement(root, "DefaultExperiment", {"startTime": "0"})
    variables = SubElement(root, "ModelVariables")
    structure = SubElement(root, "ModelStructure")
    calculated = []
    for reference, variable in enumerate(unit.variables):
        attributes = {
            "name": variable.name,
            "valueReference": str(reference),
            "causality": _causality(variable.role),
            "variability": _variability(variable.role),
        }
        match variable.kind:
            case Kind.REAL:
                attributes |= {"unit": "s"} if variable.role is Role.TIME else {}
            case Kind.ENUMERATION:
                attributes["declaredType"] = types[variable.labels]
            case Kind.CLOCK:
                attributes["intervalVariability"] = "triggered"
            case Kind.INTEGER | Kind.TRUTH | Kind.NATURAL:
                pass
        SubElement(variables, _TAGS_3[variable.kind], attributes | _value(variable))
        if _causality(variable.role) == "output":
            SubElement(structure, "Output", {"valueReference": str(reference)})
            calculated.append(reference)
    for reference in calculated:
        SubElement(structure, "InitialUnknown", {"valueReference": str(reference)})
    return root


# ---- version 2 ------------------------------------------------------------------------------------------------------

_TAGS_2 = {
    Kind.REAL: "Real",
    Kind.INTEGER: "Integer",
    Kind.TRUTH: "Boolean",
    Kind.ENUMERATION: "Enumeration",
    Kind.NATURAL: "Integer",
    Kind.CLOCK: "Integer",
}


def _version_2(unit: Unit, token: str) -> Element:
    root = _root(unit, "2.0", {"guid": token})
    SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": unit.name,
            "canHandleVariableCommunicationStepSize": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
        },
    )
    _seconds(root)
    types = type_names(unit.variables)
    definitions = SubElement(root, "TypeDefinitions")
    for labels, name in types.items():
        definition = SubElement(SubElement(definitions, "SimpleType", {"name": name}), "Enumeration")
        for number, label in enumerate(labels):
            SubElement(definition, "Item", {"name": label, "value": str(number)})
    _log_categories(root)
    SubElement(root, "DefaultExperiment", {"startTime": "0"})
    variables = SubElement(root, "ModelVariables")
    structure = SubElement(root, "ModelStructure")
    outputs = []
    for reference, variable in enumerate(unit.variables):
        scalar = SubElement(
            variables,
            "ScalarVariable",
            {
                "name": variable.name,
                "valueReference": str(reference),
                "causality": _causality(variable.role),
                "variability": _variability(variable.role),
            },
        )
        attributes = {"unit": "s"} if variable.role is Role.TIME else {}
        if variable.kind is Kind.ENUMERATION:
            attributes["declaredType"] = types[variable.labels]
        if variable.kind is Kind.NATURAL:
            attributes["min"] = "0"
        SubElement(scalar, _TAGS_2[variable.kind], attributes | _value(variable))
        outputs += [reference + 1] if _causality(variable.role) == "output" else []
    for element in ("Outputs", "InitialUnknowns"):
        if outputs:
            unknowns = SubElement(structure, element)
            for index in outputs:
                SubElement(unknowns, "Unknown", {"index": str(index)})
    return root
