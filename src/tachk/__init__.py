"""Model checking of networks of timed automata.

``tachk.load("train.ta", N=3).verify()`` reads a model, instantiates it and checks its properties; see `tachk.api`.
"""

from __future__ import annotations

TYPE_CHECKING = False  # that of `typing` takes longer to load than a call by way of `tachk serve`
if TYPE_CHECKING:
    from tachk.api.mining import mine
    from tachk.api.model import (
        Answer,
        Engine,
        Extrapolation,
        InputError,
        Limits,
        Model,
        Options,
        Report,
        SearchOrder,
        TachkError,
        UnsupportedError,
        UsageError,
        Verdict,
        conform,
        diff,
        draw,
        export,
        load,
        loads,
        random_network,
    )
    from tachk.api.monitoring import MonitorReport, monitor
    from tachk.api.repairing import repair
    from tachk.model.builder import NetworkBuilder
    from tachk.recordings.monitors.online import Monitor
    from tachk.recordings.traces.node_signal import Truth
    from tachk.recordings.traces.trace_files import open_trace
    from tachk.simulation.stepping.library import replay, simulate
    from tachk.simulation.stepping.walk import step
    from tachk.xrce.bridge.clock import Clock, SteppedClock, WallClock
    from tachk.xrce.measuring.measure import measure

__version__ = "0.3.0"

__all__ = [
    "Answer",
    "Clock",
    "Engine",
    "Extrapolation",
    "InputError",
    "Limits",
    "Model",
    "Monitor",
    "MonitorReport",
    "NetworkBuilder",
    "Options",
    "Report",
    "SearchOrder",
    "SteppedClock",
    "TachkError",
    "Truth",
    "UnsupportedError",
    "UsageError",
    "Verdict",
    "WallClock",
    "__version__",
    "conform",
    "diff",
    "draw",
    "export",
    "load",
    "loads",
    "measure",
    "mine",
    "monitor",
    "open_trace",
    "random_network",
    "repair",
    "replay",
    "simulate",
    "step",
]


_HOMES = {
    **dict.fromkeys(("Clock", "SteppedClock", "WallClock"), "tachk.xrce.bridge.clock"),
    "Monitor": "tachk.recordings.monitors.online",
    "MonitorReport": "tachk.api.monitoring",
    "NetworkBuilder": "tachk.model.builder",
    "Truth": "tachk.recordings.traces.node_signal",
    "measure": "tachk.xrce.measuring.measure",
    "mine": "tachk.api.mining",
    "monitor": "tachk.api.monitoring",
    "open_trace": "tachk.recordings.traces.trace_files",
    "repair": "tachk.api.repairing",
    "replay": "tachk.simulation.stepping.library",
    "simulate": "tachk.simulation.stepping.library",
    "step": "tachk.simulation.stepping.walk",
}


def __getattr__(name: str) -> object:
    """Loads a name of the package when it is first used, so that ``tachk --version`` need not wait for it."""
    if name in __all__:
        from importlib import import_module

        return getattr(import_module(_HOMES.get(name, "tachk.api.model")), name)
    raise AttributeError(f"module 'tachk' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
