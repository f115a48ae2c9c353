"""The tools that execute models: simulate and step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from random import Random
from typing import Any

from tachk.api.model import Model
from tachk.api.tools.answer import Evidence, EvidenceKind, ToolAnswer, answer, answer_schema, report_schema
from tachk.api.tools.inputs import read_model
from tachk.api.tools.limits import GRACE, ToolLimits
from tachk.base.diagnostics.diagnostic import Diagnostic, UsageError
from tachk.base.diagnostics.render import render
from tachk.base.job import StoppedError, check_job, unhurried
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Source
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import RecordedChanges, Simulated, SimulationOptions
from tachk.meaning.run_view import RunNames, Snapshot
from tachk.model.quantity import decimal, duration
from tachk.report.statistics.drawn_runs import SimulationHeading, tally_lines, tally_to_json
from tachk.simulation.fault_injection import read_plan, with_faults
from tachk.simulation.formulas import columns_with, formulas_for
from tachk.simulation.runs import Runs, steps_of
from tachk.simulation.stepping.enabled import EnabledTransition
from tachk.simulation.stepping.files import check_determined, constants_of
from tachk.simulation.stepping.rejections import rejection_diagnostic
from tachk.simulation.stepping.replaying import replay_submitted
from tachk.simulation.stepping.run_file import read_run_file, run_text, step_line, steps_text
from tachk.simulation.stepping.session import NotPossibleError, Session
from tachk.simulation.stepping.submitted import SubmittedRun
from tachk.simulation.tally import Tally, drawn_runs, take_run, take_until_stopped
from tachk.simulation.times import parsed_time_bound

_RUN_TEXT = "<run>"
_CONFIDENCE = 0.95


def simulate(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """Random runs: how they end, which formulas they violate, and the steps of the first ones."""
    model = read_model(arguments, keeps_doubles=True)
    network = model.network
    constants = arguments.get("constants", {})
    formulas = formulas_for(arguments.get("formula"), network, constants)
    until = parsed_time_bound(str(arguments.get("until", 100)), network.time_unit)
    wanted = with_faults(network, read_plan(arguments.get("faults", ())))
    columns = columns_with(network, (), formulas)
    runs = Runs(wanted.network, columns, [*wanted.done.values(), *wanted.missed.values()])
    heading = SimulationHeading(
        model.path,
        arguments.get("runs", 100),
        0,
        str(arguments.get("until", 100)),
        arguments.get("seed", DEFAULT_SEED),
        arguments.get("policy", Policy.STOCHASTIC.value),
        _CONFIDENCE,
    )
    drawing = SimulationOptions(heading.seed, until.ticks, Policy(heading.policy), None, 1, until.ticks_per_unit)
    shown_runs: list[Simulated] = []
    shown = arguments.get("show", 1)

    def keep(run: Simulated, _: Runs) -> None:
        if len(shown_runs) < shown:
            shown_runs.append(run)

    tally = Tally()
    recorded = RecordedChanges(shown > 0, bool(formulas or wanted.done))
    drawn = drawn_runs(runs, formulas, drawing, range(heading.runs), recorded, all_rows=False)
    take_until_stopped(drawn, partial(take_run, runs, wanted, tally, keep, False), tally)
    with unhurried(GRACE):
        found = [_drawn_run(model, run, constants, not arguments.get("faults")) for run in shown_runs]
    result = {
        "totals": tally_to_json(heading, tally, {each.name: each.text for each in formulas}),
        "runs": [
            {"number": run.number, "ending": run.ending.value, "steps": text}
            for run, (text, _) in zip(shown_runs, found, strict=True)
        ],
    }
    lines = list(tally_lines(heading, tally))
    texts = [f"run {run.number}:\n{text}" for run, (text, _) in zip(shown_runs, found, strict=True)]
    notes = [render(each) for each in (*model.refusals, *model.warnings)]
    return answer(lines[0], result, "\n".join([*lines[1:], "", *texts]), [each for _, each in found], limits, notes)


def _drawn_run(model: Model, run: Simulated, constants: Mapping[str, object], as_written: bool) -> tuple[str, Evidence]:
    """The steps of a run as text that the tool `step` takes, and whether the reference semantics can take them."""
    about = f"run {run.number}"
    names = RunNames(model.network)
    chosen = {name: value for name, value in model.constants.items() if name in constants}
    text = steps_text(names, steps_of(run), (), chosen)
    if not as_written:
        how = "the run has injected faults, which are not part of the model as written"
        return text, Evidence(about, EvidenceKind.RUN, False, how)
    try:
        check_determined(model.network)
    except UsageError as error:
        return text, Evidence(about, EvidenceKind.RUN, False, error.message)
    try:
        replayed = replay_submitted(names, read_run_file(Source(_RUN_TEXT, text)))
    except StoppedError as error:
        return text, Evidence(about, EvidenceKind.RUN, False, f"no time was left to replay the run: {error.reason}")
    if replayed.refusal is None:
        how = f"all {len(replayed.trace.steps)} steps replayed by the reference semantics"
        return text, Evidence(about, EvidenceKind.RUN, True, how)
    return text, Evidence(about, EvidenceKind.RUN, False, rejection_diagnostic(replayed.refusal).message)


def simulation_schema() -> dict[str, Any]:
    """The totals are the first form of docs/schema/simulate.schema.json."""
    totals = report_schema("simulate")["$defs"]["report"]["oneOf"][0]
    run = {
        "type": "object",
        "additionalProperties": False,
        "required": ["number", "ending", "steps"],
        "properties": {
            "number": {"type": "integer"},
            "ending": {"type": "string"},
            "steps": {"type": "string", "description": "A line for each step: time, then what moves; `step` takes it."},
        },
    }
    result = {
        "type": "object",
        "additionalProperties": False,
        "required": ["totals", "runs"],
        "properties": {"totals": {"$ref": "#/$defs/totals"}, "runs": {"type": "array", "items": run}},
    }
    return answer_schema(result, {"totals": totals})


# ---- step by step ---------------------------------------------------------------------------------------------------


def step(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """The state after a run, and all that can happen next. Nothing is kept between calls."""
    submitted = read_run_file(Source(_RUN_TEXT, arguments.get("run", "")))
    model = _model_of_run(arguments, submitted)
    check_determined(model.network)
    names = RunNames(model.network)
    session, rejection = Session.begin(names).loaded(submitted)
    rejected = None if rejection is None else rejection_diagnostic(rejection)
    if rejected is None:
        session = _with_random_steps(session, arguments.get("random_steps", 0), arguments.get("seed", DEFAULT_SEED))
    taken = len(session.steps)
    state = names.timed_snapshot(session.state)
    result = {
        "accepted": rejected is None,
        "steps_taken": taken,
        "run": run_text(names, session.trace, (), submitted.constants),
        **_state_to_json(state),
        **_possible(session),
        "rejection": None if rejected is None else render(rejected),
    }
    places = ", ".join(f"{process}.{location}" for process, location in state.locations)
    when = duration(session.state.time, model.network.time_unit)
    summary = f"after {taken} step{'' if taken == 1 else 's'}, time {when}: {places}"
    if rejected is not None:
        summary = f"step {taken + 1} cannot be taken: {rejected.message}"
    evidence = Evidence("run", EvidenceKind.RUN, True, f"the reference semantics has taken all {taken} steps")
    return answer(summary, result, "\n".join(_step_lines(result, rejected)), [evidence], limits)


def _model_of_run(arguments: Mapping[str, Any], submitted: SubmittedRun) -> Model:
    """The model with the constants of the run, where the call names no others."""
    model = read_model(arguments, keeps_doubles=True)
    given = arguments.get("constants", {})
    of_run = constants_of(submitted, model.constants, given)
    return read_model({**arguments, "constants": {**of_run, **given}}, keeps_doubles=True) if of_run else model


def _with_random_steps(session: Session, steps: int, seed: int) -> Session:
    """Fewer, where nothing can happen any more."""
    random = Random(seed)
    for _ in range(steps):
        check_job()
        try:
            session = session.random(random)
        except NotPossibleError:
            break
    return session


def _state_to_json(state: Snapshot) -> dict[str, Any]:
    return {
        "time": str(state.time),
        "locations": dict(state.locations),
        "variables": dict(state.variables),
        "clocks": {name: str(value) for name, value in state.clocks or ()},
    }


def _possible(session: Session) -> dict[str, Any]:
    enabled = session.enabled()
    return {
        "possible": [_choice(session, each) for each in enabled.transitions],
        "delays": str(enabled.delays),
        "run_time_errors": [f"{fault} ({fault.span})" for fault in enabled.faults],
    }


def _choice(session: Session, choice: EnabledTransition) -> dict[str, Any]:
    when = f"+{decimal(choice.windows[0].some, 9)}"
    line = step_line(session.names, session.state.discrete, when, choice.transition)
    return {"line": line, "delays": [str(window) for window in choice.windows]}


def _step_lines(result: Mapping[str, Any], rejected: Diagnostic | None) -> Iterator[str]:
    if rejected is not None:
        yield render(rejected)
        yield "the state before it:"
    for name in ("locations", "variables", "clocks"):
        if result[name]:
            yield f"{name}: " + ", ".join(f"{key} = {value}" for key, value in result[name].items())
    yield f"time can pass: {result['delays']}"
    yield from (f"a run-time error is possible: {each}" for each in result["run_time_errors"])
    if not result["possible"]:
        yield "no transition can happen"
        return
    yield "possible next lines of the run, with the delays after which each can happen:"
    for each in result["possible"]:
        yield f"  {each['line']}    delay in {' or '.join(each['delays'])}"


def step_schema() -> dict[str, Any]:
    """The state after a run, and what can happen there."""
    number = {"type": "string", "description": "An exact number such as 5 or 28/3."}
    choice = {
        "type": "object",
        "additionalProperties": False,
        "required": ["line", "delays"],
        "properties": {
            "line": {"type": "string", "description": "Appended to `run`, it takes the step as early as it can."},
            "delays": {"type": "array", "items": {"type": "string"}, "description": "From now on, such as [3, 5]."},
        },
    }
    properties = {
        "accepted": {"type": "boolean", "description": "Whether all of the given run is a run of the model."},
        "steps_taken": {"type": "integer", "minimum": 0},
        "run": {"type": "string", "description": "The run up to this state."},
        "time": number,
        "locations": {"type": "object", "additionalProperties": {"type": "string"}},
        "variables": {"type": "object", "additionalProperties": {"type": ["integer", "boolean"]}},
        "clocks": {"type": "object", "additionalProperties": number},
        "possible": {"type": "array", "items": choice},
        "delays": {"type": "string", "description": "How long time can pass with no transition."},
        "run_time_errors": {"type": "array", "items": {"type": "string"}},
        "rejection": {"type": ["string", "null"], "description": "Why the next step of the given run cannot be taken."},
    }
    result = {"type": "object", "additionalProperties": False, "required": list(properties), "properties": properties}
    return answer_schema(result, {})
