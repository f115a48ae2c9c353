"""`tachk xrce proxy`: relay packets of DDS-XRCE, and lose, delay or duplicate some."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.base.span import Source
from tachk.cli import options
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.formats.written_reports import check_report, read_json

if TYPE_CHECKING:
    from tachk.xrce.proxy.decisions import Decisions, RelayArrival, RelayDecision
    from tachk.xrce.proxy.relay import Plan
    from tachk.xrce.proxy.rules import RelayRule


@click.command(name="proxy")
@click.option(
    "listen",
    "--listen",
    metavar="[HOST:]PORT",
    multiple=True,
    required=True,
    help="The address at which a client reaches the relay. Once for each client. HOST is 127.0.0.1 without it.",
)
@click.option("to", "--to", metavar="HOST:PORT", help="Where the Agent listens.")
@click.option(
    "scripts", "--script", metavar="FILE", type=options.type_of_file, multiple=True, help="Rules, one on each line."
)
@click.option("given", "--rule", metavar="RULE", multiple=True, help="A rule, as in a script.")
@click.option(
    "trace",
    "--from-trace",
    metavar="TRACE.json",
    type=options.type_of_file,
    help="Do what the network does in this run of a model, a report of tachk verify --format json.",
)
@click.option("prop", "--property", metavar="NAME", help="The property whose run it is, if the report has several.")
@click.option(
    "seed",
    "--seed",
    type=options.Count(0),
    default=0,
    show_default=True,
    help="Seed of the rules for a share of packets.",
)
@click.option("record", "--record", metavar="FILE", type=options.written_file, help="Write both sides to a capture.")
@click.option(
    "idle",
    "--idle",
    metavar="SECONDS",
    type=options.Seconds(min=0, min_open=True),
    help="Stop when nothing has come for so long after the first packet.",
)
@click.option("show", "--show", is_flag=True, help="Print the rules and do nothing else.")
def command(**given: Any) -> None:
    """Relay UDP packets between clients and Agent of DDS-XRCE, and lose, delay or duplicate some of them.

    A rule says drop, delay or duplicate, which packets, and how long: drop the 2nd ACKNACK agent->client;
    delay DATA 5 by 500 ms; delay ACKNACK 8 until ACKNACK 9; duplicate CREATE_CLIENT after 1 s; drop 20 % of packets.
    docs/real_system.md lists all forms.

    Ends with Ctrl-C, SIGTERM or --idle, and then prints how often each rule applied. The exit status is 10 if a rule
    never did, unless it has a share.
    """

    (proxying,) = distributed(given, Proxying)
    options.finish(lambda: run_proxy(proxying))


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
    """Raises InputError for a line that is not a rule, UsageError for a wrong option, OSError for a used port."""
    import asyncio

    from tachk.cli.places import place
    from tachk.xrce.proxy.decisions import Decisions
    from tachk.xrce.proxy.recording import CaptureWriter
    from tachk.xrce.proxy.relay import Plan, Relay

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
    from tachk.xrce.proxy.counterexample import rules_of
    from tachk.xrce.proxy.fault_plan import parse_fault_plan
    from tachk.xrce.proxy.run_of_model import REPORT_WITH_RUN, read_run

    rules: list[RelayRule] = []
    for path in proxying.scripts:
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            raise UsageError(f"{path} is not text in UTF-8") from None
        rules += parse_fault_plan(Source(str(path), text), ports)
    for rule in proxying.given:
        rules += parse_fault_plan(Source("--rule", rule), ports)
    if proxying.trace is not None:
        name = str(proxying.trace)
        document = read_json(proxying.trace, REPORT_WITH_RUN)
        check_report(document, "verify", proxying.trace, REPORT_WITH_RUN)
        rules += rules_of(read_run(document, name, proxying.prop), ports, name)
    elif proxying.prop is not None:
        raise UsageError(
            "--property chooses among the runs of a report", "--from-trace names the report of tachk verify"
        )
    return rules


class _RelayLog:
    """Prints the effects of rules, a line for each packet."""

    def __init__(self, rules: list[RelayRule]) -> None:
        self.rules = rules
        self.start: int | None = None

    def __call__(self, arrival: RelayArrival, answer: RelayDecision) -> None:
        from tachk.xrce.proxy.sightings import said

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
