"""The JSON schemas of what calls of tools give, and what is wrong with a call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tachk.api.tools.answer import answer_schema
from tachk.api.tools.inputs import CONSTANTS_SCHEMA, MODEL_SCHEMA
from tachk.api.tools.limits import ToolLimits, limit_schemas
from tachk.base.seeds import DEFAULT_SEED
from tachk.engine.options import LARGEST_SEED
from tachk.engine.simulation.policy import Policy
from tachk.formats.written_reports import first_violation

_MOST_RUNS, _MOST_SHOWN, _MOST_STEPS = 100_000, 20, 1_000

_TEXT: dict[str, Any] = {"type": "string", "minLength": 1}
_SEED: dict[str, Any] = {
    "type": "integer",
    "minimum": 0,
    "maximum": LARGEST_SEED,
    "default": DEFAULT_SEED,
    "description": "The same seed gives the same runs.",
}


def _texts(description: str) -> dict[str, Any]:
    return {"type": "array", "items": _TEXT, "default": [], "description": description}


_MODEL: dict[str, Any] = {"model": MODEL_SCHEMA, "constants": CONSTANTS_SCHEMA}

CHECK: dict[str, Any] = {
    **_MODEL,
    "deep": {"type": "boolean", "default": False, "description": "Explore the states, too."},
}

VERIFY: dict[str, Any] = {
    **_MODEL,
    "queries": _texts("Queries or sentences to check; none: the properties of the model."),
    "properties": _texts("Names of properties of the model to check."),
    "runs": {
        "enum": ["unexpected", "all", "none"],
        "default": "unexpected",
        "description": "Which answers come with their run, step by step.",
    },
    "certificates": {
        "enum": ["auto", "always", "never"],
        "default": "auto",
        "description": "Whether answers that no run can show get a certificate that is checked. auto: where the search "
        "was small.",
    },
}

EXPLAIN: dict[str, Any] = {
    "what": {
        **_TEXT,
        "description": "A code such as E0214, a formula such as G (p -> F[0, 5 s] q), a sentence, or the path of a "
        "file of formulas or a model.",
    },
}

SIMULATE: dict[str, Any] = {
    **_MODEL,
    "runs": {"type": "integer", "minimum": 1, "maximum": _MOST_RUNS, "default": 100},
    "until": {
        "type": ["number", "string"],
        "default": 100,
        "description": "Their length: time units of the model, or a duration such as '3 min'.",
    },
    "formula": {**_TEXT, "description": "A formula, a sentence or a file of them that judges each run."},
    "policy": {
        "enum": [policy.value for policy in Policy],
        "default": Policy.STOCHASTIC.value,
        "description": "How long a process waits before it acts.",
    },
    "faults": _texts("Faults of the model to inject, such as lost=0.01."),
    "seed": _SEED,
    "show": {
        "type": "integer",
        "minimum": 0,
        "maximum": _MOST_SHOWN,
        "default": 1,
        "description": "Of so many runs the steps are shown; with a formula, of runs that violate it.",
    },
}

STEP: dict[str, Any] = {
    **_MODEL,
    "run": {
        "type": "string",
        "default": "",
        "description": "A line for each step: its time, or + and the time since the step before, then what moves, such "
        "as '0 P: a -> b'. A line with a time only lets time pass.",
    },
    "random_steps": {
        "type": "integer",
        "minimum": 0,
        "maximum": _MOST_STEPS,
        "default": 0,
        "description": "Take so many random steps behind the run.",
    },
    "seed": _SEED,
}

MONITOR: dict[str, Any] = {
    "formula": {**_TEXT, "description": "A formula, a sentence, or the path of a file of them (.stl) or of a model."},
    "trace": {**_TEXT, "description": "The path of a recorded trace, or the text of a CSV with a header line."},
    "time": {**_TEXT, "description": "The name of the time column, where it is not time, t or timestamp."},
    "unit": {**_TEXT, "description": "Of the times, such as ms, where the trace does not say it."},
    "constants": {
        "type": "object",
        "additionalProperties": {"type": ["number", "string"]},
        "default": {},
        "description": "Values for names in bounds and conditions.",
    },
    "end": {
        "enum": ["undetermined", "weak", "strong"],
        "default": "undetermined",
        "description": "What counts where the trace ends too early to decide: weak as satisfied, strong as violated.",
    },
    "select": _texts("The names of the formulas to judge; none: all."),
    "all_violations": {"type": "boolean", "default": False, "description": "List every violation, not the first."},
}

CONFORM: dict[str, Any] = {
    **_MODEL,
    "recording": {**_TEXT, "description": "The path of a recording, or the text of a CSV with columns time,event,..."},
    "tolerance": {**_TEXT, "description": "How exact recorded times are, such as 5ms; auto finds the least that fits."},
    "late": {
        "type": ["string", "object"],
        "additionalProperties": False,
        "properties": {"input": _TEXT, "output": _TEXT},
        "description": "How much later than it happens an output may be recorded, and how much later than recorded an "
        'input may happen: such as 20ms, or {"input": "1ms", "output": "20ms"}.',
    },
    "unit": {**_TEXT, "description": "Of the recorded times, where the file does not say it."},
    "ports": {
        "type": "array",
        "items": {"type": "integer", "minimum": 1, "maximum": 65535},
        "default": [],
        "description": "Of Agents, where the recording is a capture of packets.",
    },
    "explain": {
        "enum": ["none", "short", "full"],
        "default": "short",
        "description": "How much to explain about a recording that does not conform.",
    },
}

_NULLABLE = {"type": ["string", "null"]}
EXPLAINED = answer_schema(
    {
        "oneOf": [
            {
                "type": "object",
                "additionalProperties": False,
                "required": ["kind", "code", "title", "why", "wrong", "right"],
                "properties": {
                    "kind": {"const": "message"},
                    "code": {"type": "string"},
                    "title": {"type": "string"},
                    "why": {"type": "string"},
                    "wrong": {"type": "string", "description": "An example; empty where a text cannot show it."},
                    "right": {"type": "string", "description": "The same, mended."},
                },
            },
            {
                "type": "object",
                "additionalProperties": False,
                "required": ["kind", "formulas"],
                "properties": {
                    "kind": {"const": "formulas"},
                    "formulas": {
                        "type": "array",
                        "items": {
                            "type": "object",
                            "additionalProperties": False,
                            "required": ["name", "formula", "sentence", "columns", "horizon", "observer"],
                            "properties": {
                                "name": {"type": "string"},
                                "formula": {"type": "string", "description": "In canonical form."},
                                "sentence": _NULLABLE,
                                "columns": {"type": "array", "items": {"type": "string"}},
                                "horizon": {"type": "string", "description": "How far it looks ahead."},
                                "observer": _NULLABLE,
                            },
                        },
                    },
                },
            },
        ]
    },
    {},
)
"""The schema of answers of `explain`."""


def argument_schema(properties: Mapping[str, Any], required: tuple[str, ...], ceilings: ToolLimits) -> dict[str, Any]:
    """The schema of the arguments of a tool, with the limits that every call can name."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "type": "object",
        "additionalProperties": False,
        "required": list(required),
        "properties": {**properties, **limit_schemas(ceilings)},
    }


def wrong_argument(schema: Mapping[str, Any], arguments: Mapping[str, Any]) -> str:
    """What is wrong with the arguments of a call; empty where nothing is."""
    return first_violation(schema, arguments)
