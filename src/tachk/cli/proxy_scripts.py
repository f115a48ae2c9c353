"""Runs of models of DDS-XRCE as scripts for `tachk xrce proxy`: a network that loses, holds and copies packets so."""

from __future__ import annotations

from tachk.meaning.run_view import view_trace
from tachk.model.network import Network
from tachk.model.run import TimedTrace
from tachk.report.json_report import trace_to_json
from tachk.xrce.proxy.counterexample import rules_of
from tachk.xrce.proxy.run_of_model import run_of_trace

_FIRST_PORT = 9001
"""The ports in the documentation."""


def proxy_script(network: Network, run: TimedTrace, name: str) -> str:
    """The rules, behind comments that say how the relay is started.

    Args:
        name: of the file that has the run.

    Raises UsageError where the run has no message, or one that stands for no packet.
    """
    found = run_of_trace(dict(network.constants), trace_to_json(view_trace(network, run)), name)
    ports = range(_FIRST_PORT, _FIRST_PORT + found.clients)
    listening = " ".join(f"--listen {port}" for port in ports)
    heading = (f"what the network does in {name}", f"tachk xrce proxy {listening} --to AGENT:PORT --script FILE")
    rules = rules_of(found, ports, name)
    return "".join(f"{line}\n" for line in (*(f"# {each}" for each in heading), *map(str, rules)))
