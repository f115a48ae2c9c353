"""The tools that agents call, one row each: what a tool does, what it takes, what it answers."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from typing import Any

from tachk.api.tools.about_models import check, explain, verify
from tachk.api.tools.about_records import conform, monitor
from tachk.api.tools.about_runs import simulate, simulation_schema, step, step_schema
from tachk.api.tools.answer import ToolAnswer, report_schema
from tachk.api.tools.arguments import (
    CHECK,
    CONFORM,
    EXPLAIN,
    EXPLAINED,
    MONITOR,
    SIMULATE,
    STEP,
    VERIFY,
    argument_schema,
    wrong_argument,
)
from tachk.api.tools.limits import DEFAULT_LIMITS, ToolLimits
from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UnsupportedError, UsageError
from tachk.base.diagnostics.render import render
from tachk.base.job import StoppedError
from tachk.base.records import dataclass

_MOST_DIAGNOSTICS = 20


@dataclass(frozen=True, slots=True)
class Tool:
    """A tool.

    Attributes:
        description: for the language model that chooses among tools.
        properties: the JSON schemas of its arguments.
        required: those that a call has to give.
        run: the function that answers a call.
        answers: makes the schema of its answers.
    """

    name: str
    title: str
    description: str
    properties: Mapping[str, Any]
    required: tuple[str, ...]
    run: Callable[[Mapping[str, Any], ToolLimits], ToolAnswer]
    answers: Callable[[], dict[str, Any]]

    def input_schema(self, ceilings: ToolLimits) -> dict[str, Any]:
        return argument_schema(self.properties, self.required, ceilings)


TOOLS = (
    Tool(
        "check",
        "Check a model for mistakes",
        "Read a model of timed automata and report every mistake and warning with file:line:column. Use it after each "
        "change of a model. With deep=true it also explores the states and reports dead code, time-locks, deadlocks "
        "and Zeno loops.",
        CHECK,
        ("model",),
        check,
        partial(report_schema, "check", "model"),
    ),
    Tool(
        "verify",
        "Verify properties of a model",
        "Check the properties that a model states, or the given queries such as 'A[] not deadlock', 'E<> P.done', "
        "'P.a --> P.b', or sentences such as 'Whenever P.a, within 20, P.b must be true.'. Each answer is holds, fails "
        "or unknown, with the run that shows it and whether run or proof was judged.",
        VERIFY,
        ("model",),
        verify,
        partial(report_schema, "verify", "run"),
    ),
    Tool(
        "explain",
        "Explain a message or a formula",
        "Explain the code of a message such as E0214 with a wrong and a right example; or a temporal formula or "
        "English sentence: its formula, the signals it reads, how far it looks ahead.",
        EXPLAIN,
        ("what",),
        explain,
        lambda: EXPLAINED,
    ),
    Tool(
        "simulate",
        "Simulate random runs of a model",
        "Draw random runs: how they end, how many violate a formula with a confidence interval, and the steps of the "
        "first runs. An estimate, not a proof: use verify for a proof.",
        SIMULATE,
        ("model",),
        simulate,
        simulation_schema,
    ),
    Tool(
        "step",
        "Walk through a model step by step",
        "The state after a run, given as lines such as '0 P: a -> b' and '+2.5 c!  P: b -> c & Q: x -> y', and every "
        "transition that can happen next with its delays. Append one of the offered lines to the run and call again. "
        "Without a run it starts at the initial state. Also replays a run by hand: it says why a step cannot be taken.",
        STEP,
        ("model",),
        step,
        step_schema,
    ),
    Tool(
        "monitor",
        "Judge a recorded trace by formulas",
        "Check formulas such as 'G (request -> F[0, 20 ms] reply)' or English sentences on a recorded trace: CSV "
        "(as text or path), Parquet, VCD, MCAP, pcap and others. Says true, false or undetermined, with the trigger, "
        "the deadline and the signal to blame.",
        MONITOR,
        ("formula", "trace"),
        monitor,
        partial(report_schema, "monitor"),
    ),
    Tool(
        "conform",
        "Check a recording against a model",
        "Check whether recorded events (a CSV with columns time,event,... or a packet capture) are a run of a model "
        "that has a `recording { ... }` block. If not, says at which event the recording leaves the model, what the "
        "model allows there, and an edit that would make it conform.",
        CONFORM,
        ("model", "recording"),
        conform,
        partial(report_schema, "conform"),
    ),
)


@cache
def tool_named(name: str) -> Tool | None:
    return next((tool for tool in TOOLS if tool.name == name), None)


def call(name: str, arguments: Mapping[str, Any], ceilings: ToolLimits) -> ToolAnswer:
    """Answers a call. Whatever is wrong with it, or with what it is about, becomes an answer that failed.

    Args:
        ceilings: the largest limits that a call can have.
    """
    tool = tool_named(name)
    if tool is None:
        return ToolAnswer(f"error: there is no tool {name!r}\nhelp: one of {', '.join(each.name for each in TOOLS)}")
    wrong = wrong_argument(tool.input_schema(ceilings), arguments)
    if wrong:
        return ToolAnswer(f"error: {wrong}")
    limits = DEFAULT_LIMITS.within(ceilings).requested(arguments)
    try:
        with limits.in_force():
            return tool.run(arguments, limits)
    except InputError as error:
        return ToolAnswer(_rendered(error.diagnostics))
    except UnsupportedError as error:
        return ToolAnswer(_rendered([error.diagnostic]))
    except UsageError as error:
        return ToolAnswer(f"error: {error.message}" + (f"\nhelp: {error.help}" if error.help else ""))
    except OSError as error:
        return ToolAnswer(f"error: {error.filename}: {error.strerror}" if error.filename else f"error: {error}")
    except StoppedError as error:
        return ToolAnswer(f"error: the {error.reason} was over before there was a result")
    except MemoryError:
        return ToolAnswer("error: the machine was out of memory before there was a result")
    except Exception:  # a defect must not end the server
        return ToolAnswer(f"{traceback.format_exc()}error: this is a defect of tachk, not of the call")


def _rendered(diagnostics: Iterable[Diagnostic]) -> str:
    found = list(dict.fromkeys(diagnostics))
    more = [f"... and {len(found) - _MOST_DIAGNOSTICS} more"] if len(found) > _MOST_DIAGNOSTICS else []
    return "\n".join([*map(render, found[:_MOST_DIAGNOSTICS]), *more])
