"""What a run-time error of the model was about: the values involved, and the timed run that leads there."""

from __future__ import annotations

from dataclasses import replace

from tachk.engines.concretise import concretise
from tachk.engines.protocol import RunTimeFault
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.semantics.discrete import execute_updates, prepare


def explain(network: Network, fault: RunTimeFault) -> RunTimeFault:
    """The fault with its run and, where an update failed, the values as the reference evaluator finds them."""
    run = concretise(network, fault.path)
    detail = ""
    if run is not None and fault.transition is not None:
        try:
            execute_updates(prepare(network), run.states[-1].discrete, fault.transition)
        except EvaluationFault as error:
            detail = error.detail
    return replace(fault, detail=detail, run=run)
