"""The least and the largest time between two events of a model, for `Model.time` and `tachk time`."""

from __future__ import annotations

from tachk.engine.options import Limits, Options
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.queries.events import read_event
from tachk.report.time_report import TimedInterval, TimesReport
from tachk.verify.times import BEST, WORST, times_between

ARGUMENTS, OPTIONS = ("start", "end"), ("--from", "--to")
"""What messages call the two events: the arguments of Python, the options of the command."""


def measured_times(
    loaded: LoadedModel,
    interval: TimedInterval,
    named: tuple[str, str],
    best: bool,
    worst: bool,
    settled: bool,
    options: Options,
    limits: Limits,
    trace: bool,
) -> TimesReport:
    """The times of a model; `tachk.api.model.Model.time` says what the arguments mean.

    Args:
        named: what messages call the events.

    Raises InputError, UsageError, UnsupportedError.
    """
    network = loaded.network
    first = None if interval.start is None else read_event(loaded, interval.start, named[0], settled)
    second = read_event(loaded, interval.end, named[1], settled)
    requested = [name for name, wanted in ((BEST, best), (WORST, worst)) if wanted]
    times = times_between(network, first, second, interval.last, options, limits, requested, trace)
    return TimesReport.of(times, interval, network)
