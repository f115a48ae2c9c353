"""The action of `tachk proxy`."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.base.span import Source
from tachk.cli.exit_status import ExitStatus
from tachk.cli.places import place
from tachk.formats.written_reports import check_report, read_json
from tachk.xrce.proxy.counterexample import rules_of
from tachk.xrce.proxy.decisions import Decisions, RelayArrival, RelayDecision
from tachk.xrce.proxy.recording import CaptureWriter
from tachk.xrce.proxy.relay import Plan, Relay
from tachk.xrce.proxy.rules import RelayRule
from tachk.xrce.proxy.run_of_model import REPORT_WITH_RUN, read_run
from tachk.xrce.proxy.script import parse_script
from tachk.xrce.proxy.sightings import said


@dataclass(frozen=True, slots=True)
class Proxying:
    """``given``: rules of the command line; ``prop``: whose run of ``trace``; ``show``: only print the rules."""

    listen: tuple[str, ...]
    to: str | None
    scripts: tuple[Path, ...]
    given: tuple[str, ...]
    trace: Path | None
    prop: str | None
    seed: int
    record: Path | None
    idle: float | None
    show: bool


def run_proxy(proxying: Proxying) -> ExitStatus:
    """Raises InputError for what is no rule, UsageError for a wrong option, OSError for a port that is taken."""
    listening = [place(text, "--listen") for text in proxying.listen]
    ports = [each.port for each in listening]
    if len({*ports}) < len(ports):
        raise UsageError("--listen: two clients at the same port", "each client needs a port of its own")
    rules = _rules(proxying, ports)
    if proxying.show:
        print("\n".join(map(str, rules)))
        return ExitStatus.AS_EXPECTED
    if proxying.to is None:
        raise UsageError("--to is missing", "--to HOST:PORT says where the Agent listens")
    plan = Plan(listening, place(proxying.to, "--to", needs_host=True), proxying.idle)
    decisions = Decisions(rules, proxying.seed)
    with nullcontext() if proxying.record is None else proxying.record.open("wb") as file:
        relay = Relay(plan, decisions, None if file is None else CaptureWriter(file), _RelayLog(rules))
        asyncio.run(relay.run(lambda: _report_ready(plan)))
    return _report_end(decisions)


def _rules(proxying: Proxying, ports: list[int]) -> list[RelayRule]:
    rules: list[RelayRule] = []
    for path in proxying.scripts:
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            raise UsageError(f"{path} is not text in UTF-8") from None
        rules += parse_script(Source(str(path), text), ports)
    for rule in proxying.given:
        rules += parse_script(Source("--rule", rule), ports)
    if proxying.trace is not None:
        name = str(proxying.trace)
        document = read_json(proxying.trace, REPORT_WITH_RUN)
        check_report(document, "verify", proxying.trace, REPORT_WITH_RUN)
        rules += rules_of(read_run(document, name, proxying.prop), ports, name)
    return rules


class _RelayLog:
    """Prints what rules do, a line for each packet."""

    def __init__(self, rules: list[RelayRule]) -> None:
        self.rules = rules
        self.start: int | None = None

    def __call__(self, arrival: RelayArrival, answer: RelayDecision) -> None:
        self.start = arrival.time if self.start is None else self.start
        for index in answer.applied:
            time = (arrival.time - self.start) / 1_000_000_000
            what = " + ".join(one.kind.name for one in said(arrival.octets)) or "malformed"
            numbers = [one.number for one in said(arrival.octets) if one.number is not None]
            number = f" {numbers[0]}" if numbers else ""
            print(
                f"{time:11.6f} s  {arrival.port}  {arrival.way.value}  {what}{number}: {self.rules[index]}", flush=True
            )


def _report_ready(plan: Plan) -> None:
    for each in plan.listening:
        print(f"{each} -> {plan.agent}", flush=True)


def _report_end(decisions: Decisions) -> ExitStatus:
    status = ExitStatus.AS_EXPECTED
    for rule, count in zip(decisions.rules, decisions.applied, strict=True):
        print(f"{count:6} x  {rule}")
        if not count and rule.share is None:
            status = ExitStatus.NOT_AS_EXPECTED
    for departure in decisions.held:
        print(f"not sent any more: packet {departure.arrival + 1} on {departure.port} {departure.way.value}")
    return status
