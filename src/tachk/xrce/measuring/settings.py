"""Measured quantities as constants of the models of the protocol: `client_3_0.ta` and its like."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from statistics import median
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.measuring.heartbeats import USUAL_PERIOD, HeartbeatLaw
from tachk.xrce.measuring.keeping import LateRequest
from tachk.xrce.measuring.quantity import Confidence, Quantity
from tachk.xrce.measuring.sleeps import UNLIMITED, ReadRequest, Sleep

_LAWS: Final = {HeartbeatLaw.STEADY: 0, HeartbeatLaw.REARMED: 1, HeartbeatLaw.DOUBLING: 2}
_PUSH, _PULL, _PUSH_PING, _READ_LATE = 0, 1, 2, 4
_WINDOW: Final = 16
"""Messages that the Agent has unacknowledged at most. For n that are missing it sends n(n+1)/2 repetitions."""

_USUAL_HISTORY: Final = 4
"""Slots that a client has at least: those of micro-ROS."""

_NO_STARVATION: Final = "no capture shows that run calls are shorter than the heartbeat: taken to be as long"


@dataclass(frozen=True, slots=True)
class Setting:
    """A constant of a model.

    Attributes:
        name: of the constant.
        value: a number, or milliseconds.
        is_time: whether the value is in milliseconds.
        confidence, how: as of a `Quantity`.
    """

    name: str
    value: float
    is_time: bool
    confidence: Confidence
    how: str

    def in_units(self, milliseconds: float) -> int:
        """The value as the constant of a model whose unit of time has so many milliseconds. A time that is not 0 is at
        least one unit; between two units it is the nearer one."""
        if not self.is_time:
            return int(self.value)
        return max(math.floor(self.value / milliseconds + 0.5), 1) if self.value else 0


@dataclass(frozen=True, slots=True)
class LinkDirection:
    """One way of a link: of a client that writes samples, or of one that does not."""

    of_writer: bool
    to_agent: bool

    @property
    def bit(self) -> int:
        """The bit of the link in the models: client_publisher to Agent, back, client_subscriber to Agent, back."""
        return 1 << 2 * (not self.of_writer) + (not self.to_agent)


@dataclass(frozen=True, slots=True)
class SettingsFindings:
    """The sources of settings.

    Attributes:
        quantities: by their names.
        law: of the client's HEARTBEATs, where it is known.
        sleeps: of all clients.
        read_requests: every READ_DATA.
        written: samples of the client that waits longest for an ACKNACK.
        pace: of the same client.
        late_readings: first READ_DATA of clients for which samples were waiting.
        stopped: ways on which nothing comes through in the end.
        created_again: how often CREATE_CLIENT came to the Agent when the client had sent messages of its streams.
        lost: packets lost on their way to a receiver that is awake; None where that was not examined.
    """

    quantities: Mapping[str, Quantity]
    law: HeartbeatLaw | None
    sleeps: tuple[Sleep, ...]
    read_requests: tuple[ReadRequest, ...]
    late_requests: tuple[LateRequest, ...]
    stopped: tuple[LinkDirection, ...]
    written: int
    pace: Quantity
    created_again: int
    lost: int | None


def settings(found: SettingsFindings) -> tuple[Setting, ...]:
    """The constants that captures determine; others keep their values of the model."""
    return (*_client(found), *_agent(found), *_network(found), *_subscriber(found))


def _client(found: SettingsFindings) -> Iterator[Setting]:
    if found.written:
        how = "samples of the client that waits longest for an ACKNACK"
        yield Setting("MESSAGES", found.written, False, Confidence.MEASURED, how)
        missing = min(found.written, _WINDOW)
        how = f"not measured; room for the {missing * (missing + 1) // 2} repetitions of {missing} missing messages"
        yield Setting("PLACES", missing * (missing + 3) // 2, False, Confidence.ASSUMED, how)
    if found.law is not None:
        law_found = found.quantities["client_heartbeat_law"]
        yield Setting("HEARTBEAT_LAW", _LAWS[found.law], False, law_found.confidence, law_found.how)
    period = found.quantities["client_heartbeat"]
    yield from _time("CLIENT_HEARTBEAT", period)
    yield from _time("PACE", found.pace)
    yield _spin(found.quantities["run_slice"], period.value or USUAL_PERIOD)
    yield from _time("TRAFFIC", found.quantities["traffic"])
    yield from _history(found.quantities["history"])


def _history(history: Quantity) -> Iterator[Setting]:
    """A power of two, as the client demands."""
    if history.confidence is Confidence.MEASURED:
        yield from _count("HISTORY", history)
    elif history.value is not None and history.value > _USUAL_HISTORY:
        slots = 1 << math.ceil(math.log2(history.value))
        yield Setting("HISTORY", slots, False, history.confidence, f"{history.how}; it is a power of two")


def _spin(slices: Quantity, period: float) -> Setting:
    """Run calls: as long as a heartbeat unless HEARTBEATs have been missing."""
    if slices.how.startswith("shorter"):
        return Setting("SPIN", period / 2, True, slices.confidence, f"{slices.how}; half of it is taken")
    if slices.confidence is Confidence.BOUND:
        return Setting("SPIN", period, True, slices.confidence, slices.how)
    return Setting("SPIN", period, True, Confidence.ASSUMED, _NO_STARVATION)


def _agent(found: SettingsFindings) -> Iterator[Setting]:
    yield from _time("AGENT_HEARTBEAT", found.quantities["agent_heartbeat"])
    yield from _time("DEAD", found.quantities["dead_time"])
    yield from _count("AGENT_WINDOW", found.quantities["agent_window"])


def _network(found: SettingsFindings) -> Iterator[Setting]:
    if found.lost is not None:
        how = f"lost on the way to a receiver that is awake: {found.lost}"
        how += "; one, whichever it is, is what the model tries" if found.lost > 1 else ""
        yield Setting("LOSSES", min(found.lost, 1), False, Confidence.MEASURED, how)
    overtaking = found.quantities["overtaking"]
    if overtaking.samples:
        how = f"packets that came after one sent later: {len(overtaking.samples)}; one is what the model tries"
        yield Setting("LATES", 1, False, overtaking.confidence, how)
    if found.stopped:
        stopped = found.quantities["stopped"]
        bits = sum({way.bit for way in found.stopped})
        yield Setting("BREAKS", bits, False, stopped.confidence, stopped.how)


def _subscriber(found: SettingsFindings) -> Iterator[Setting]:
    limited = [request for request in found.read_requests if request.samples not in (UNLIMITED, 0)]
    retained = found.quantities["kept"]
    if retained.value is not None and retained.confidence is not Confidence.BOUND:
        yield Setting("KEEP", retained.value, False, retained.confidence, retained.how)
    copies = found.created_again
    if copies:
        how = f"CREATE_CLIENT reached the Agent again while messages were under way: {copies}"
        yield Setting("DUPLICATES", 1, False, Confidence.MEASURED, how)
    spoken = any(sleep.speaks_first for sleep in found.sleeps)
    if limited:
        how = "READ_DATA asks for a number of samples"
        yield Setting("SUBSCRIPTION", _PULL, False, Confidence.MEASURED, how)
        samples = limited[0].samples
        yield Setting("QUOTA", 1 if samples is None else samples, False, Confidence.MEASURED, how)
        yield from _pulling(limited)
    elif found.late_requests:
        yield from _late_requests(found.late_requests)
    elif spoken:
        how = "after its silence the client speaks first"
        yield Setting("SUBSCRIPTION", _PUSH_PING, False, Confidence.MEASURED, how)
    elif found.read_requests:
        yield Setting("SUBSCRIPTION", _PUSH, False, Confidence.MEASURED, "READ_DATA asks without limit")
    if found.read_requests and not limited and not found.late_requests:
        sleep = found.quantities["sleep"]
        yield Setting("SLEEPS", min(len(found.sleeps), 1), False, sleep.confidence, sleep.how)
        yield from _time("SLEEP", sleep)


def _late_requests(found: tuple[LateRequest, ...]) -> Iterator[Setting]:
    how = f"samples that had been written before READ_DATA: {max(one.written for one in found)}"
    yield Setting("SUBSCRIPTION", _READ_LATE, False, Confidence.MEASURED, how)
    yield Setting("SLEEPS", 1, False, Confidence.MEASURED, how)
    longest = max(one.waited for one in found)
    yield Setting("SLEEP", longest, True, Confidence.ONE_SAMPLE, "from the first sample to READ_DATA")


def _pulling(limited: list[ReadRequest]) -> Iterator[Setting]:
    """A client that asks again and again sleeps between two READ_DATA."""
    first = {(request.link, request.number): request.time for request in reversed(limited)}
    times = [time for (link, _), time in reversed(first.items()) if link == limited[0].link]
    yield Setting("SLEEPS", len(times) - 1, False, Confidence.MEASURED, "between two READ_DATA")
    if len(times) > 1:
        between = median((b - a) / 1e6 for a, b in pairwise(sorted(times)))
        yield Setting("SLEEP", between, True, Confidence.MEASURED, "the median time between two READ_DATA")


def _time(name: str, quantity: Quantity) -> Iterator[Setting]:
    if quantity.value is not None:
        yield Setting(name, quantity.value, True, quantity.confidence, quantity.how)


def _count(name: str, quantity: Quantity) -> Iterator[Setting]:
    if quantity.value is not None and quantity.confidence is Confidence.MEASURED:
        yield Setting(name, quantity.value, False, quantity.confidence, quantity.how)
