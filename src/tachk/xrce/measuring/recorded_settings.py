"""Measured quantities as constants of a model that recordings are held against: `recorded.ta` and its like.

A recording brings its losses, delays and applications along, so these are periods, windows and what is not exact.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from tachk.base.records import dataclass
from tachk.xrce.measuring.quantity import Confidence, Quantity
from tachk.xrce.measuring.settings import Setting
from tachk.xrce.objects import Numbering

_OUTSIDE = 50.0
"""Milliseconds after which a client that does not answer is taken to be outside its run function."""

_ROUND_TIMES = 1.1
_SHORT = 20.0
"""Milliseconds; no client since 2.1 sends a HEARTBEAT so soon, but where it was overdue."""
_DOUBLING, _DOUBLED = 2, 14
_MILLISECOND = 1e6
_ROUNDS_KNOWN = 20
_USUAL_JITTER = 5
"""Milliseconds by which HEARTBEATs and rounds are late in any case."""


@dataclass(frozen=True, slots=True)
class SettingsEvidence:
    """The sources of such settings.

    Attributes:
        quantities: by their names.
        settings: those for models that are checked; by their names.
        samples: how many different ones are in the captures.
        longest: how many messages the longest stream has.
        clients: how many take part in one capture.
        not_received: packets that came to clients while they slept.
        rounds: when the Agent sent HEARTBEATs, in nanoseconds.
        numberings: the numbers of topics and data readers, of each capture.
    """

    quantities: Mapping[str, Quantity]
    settings: Mapping[str, Setting]
    samples: int
    longest: int
    clients: int
    not_received: int
    rounds: Sequence[int]
    numberings: Sequence[Numbering]


def recorded_settings(found: SettingsEvidence) -> tuple[Setting, ...]:
    """The constants that captures say something about."""
    return tuple(_settings(found))


def _settings(found: SettingsEvidence) -> Iterator[Setting]:
    # a stream of the models has room for 2 * MESSAGES + 16 messages
    # each topic of several has its share of the numbers, and that from which nobody reads the samples of all of them
    shares = max(each.topics * len(each.of_topics) for each in found.numberings)
    messages = max(found.samples * shares, (found.longest - 15) // 2, 1)
    how = f"different samples: {found.samples}; messages in the longest stream: {found.longest}"
    yield Setting("MESSAGES", messages, False, Confidence.MEASURED, how)
    yield Setting("CLIENTS", max(found.clients, 1), False, Confidence.MEASURED, "clients in one capture")
    yield from _objects(found.numberings)
    yield from _client(found)
    for name in ("HISTORY", "AGENT_HEARTBEAT", "DEAD", "AGENT_WINDOW", "KEEP"):
        if name in found.settings:
            yield found.settings[name]
    for name, of in (("CLIENT_JITTER", "client_heartbeat"), ("AGENT_JITTER", "agent_heartbeat")):
        yield _jitter(name, found.quantities[of])
    yield from _delay(found)
    yield Setting("EXACT_BITMAPS", 1, False, Confidence.MEASURED, "packets have every bit of a bitmap")
    yield from _missed_rounds(found.quantities)
    if found.not_received:
        how = f"packets that came to clients while they slept: {found.not_received}"
        yield Setting("SLEEPS", 1, False, Confidence.MEASURED, how)
    else:
        yield from _pauses(found.quantities["client_reaction"], found.quantities["overdue_heartbeat"])


def _objects(numberings: Sequence[Numbering]) -> Iterator[Setting]:
    """Topics and data readers; of several captures together the most, which is right for those that have as many."""
    topics, readers = max(each.topics for each in numberings), max(each.readers for each in numberings)
    if readers > 1:
        how = "topics, those from which nobody reads counted as one"
        yield Setting("TOPICS", topics, False, Confidence.MEASURED, how)
        how = "data readers that the automata have for each client, as many for each topic"
        yield Setting("READERS", readers, False, Confidence.MEASURED, how)
    seconds = max(each.seconds for each in numberings)
    if seconds:
        yield Setting("READ_SECONDS", seconds, False, Confidence.MEASURED, "max_elapsed_time of READ_DATA")
    rate, size = max((each.rate, each.size) for each in numberings)
    if rate:
        yield Setting("READ_BYTES", rate, False, Confidence.MEASURED, "max_bytes_per_second of READ_DATA")
        yield Setting("SAMPLE_BYTES", size, False, Confidence.MEASURED, "octets of a sample")
    if any(each.cancels for each in numberings):
        yield Setting("CANCELS", 1, False, Confidence.MEASURED, "some READ_DATA is for 0 samples")


def _is_doubtful(setting: Setting) -> bool:
    """A steady timer that one HEARTBEAT alone speaks for: it may have been late by chance. No client is known to have
    one, and a model with it refuses what others do."""
    return setting.name == "HEARTBEAT_LAW" and setting.value == 0 and setting.confidence is Confidence.ONE_SAMPLE


def _client(found: SettingsEvidence) -> Iterator[Setting]:
    """The HEARTBEATs of clients: since 2.1 they wait for a tenth of a second, and before that for a millisecond, twice
    as long each time."""
    waits = [sample.value for sample in found.quantities["client_heartbeat"].samples]
    short = sum(wait < _SHORT for wait in waits)
    if 2 * short > len(waits):
        how = f"{short} of {len(waits)} HEARTBEATs came after less than {_SHORT:.0f} ms: a client up to 2.0"
        yield Setting("HEARTBEAT_LAW", _DOUBLING, False, Confidence.MEASURED, how)
        yield Setting("CLIENT_HEARTBEAT", 1, True, Confidence.ASSUMED, "the first wait of clients up to 2.0")
        yield Setting("LOSSES", _DOUBLED, False, Confidence.ASSUMED, "the wait is doubled so often at most")
        return
    for name in ("HEARTBEAT_LAW", "CLIENT_HEARTBEAT"):
        if name in found.settings and not _is_doubtful(found.settings[name]):
            yield found.settings[name]


def _jitter(name: str, period: Quantity) -> Setting:
    """The lateness of HEARTBEATs, except the latest tenth, which the timer does not delay."""
    if period.value is None or period.confidence is not Confidence.MEASURED:
        return Setting(
            name, _USUAL_JITTER, True, Confidence.ASSUMED, "the period was not seen often enough; what is usual"
        )
    near = sorted(s.value for s in period.samples if s.value < _ROUND_TIMES * period.value)
    late = near[max(math.ceil(0.9 * len(near)) - 1, 0)] - period.value if near else 0.0
    how = f"nine of ten waits are at most {late:.1f} ms longer than the period"
    return Setting(name, max(math.ceil(late), _USUAL_JITTER), True, Confidence.MEASURED, how)


def _delay(found: SettingsEvidence) -> Iterator[Setting]:
    """The largest lateness of a round of the Agent's heartbeat thread, from HEARTBEATs that are some rounds apart: the
    thread waits for a period after each round, so it is never early."""
    period = found.quantities["agent_heartbeat"].value
    if period is None:
        return
    between = [(behind - before) / _MILLISECOND for before, behind in pairwise(found.rounds)]
    late = [wait % period for wait in between if wait < _ROUNDS_KNOWN * period]
    late = [each for each in late if each < period / 2]
    most = math.ceil(max(late, default=0.0))
    if most > _USUAL_JITTER:
        how = f"a HEARTBEAT of the Agent came {most} ms later than whole periods after the one before"
        yield Setting("AGENT_DELAY", most, True, Confidence.ONE_SAMPLE, how)


def _pauses(reaction: Quantity, overdue: Quantity) -> Iterator[Setting]:
    """The setting that applications leave the run function for longer."""
    if reaction.maximum is not None and reaction.maximum > _OUTSIDE:
        how = f"a client answered only after {reaction.maximum:.0f} ms"
        yield Setting("PAUSES", 1, False, reaction.confidence, how)
    elif overdue.samples:
        how = f"HEARTBEATs that were overdue when a client called its run function: {len(overdue.samples)}"
        yield Setting("PAUSES", 1, False, overdue.confidence, how)


def _missed_rounds(quantities: Mapping[str, Quantity]) -> Iterator[Setting]:
    period, first = quantities["agent_heartbeat"].value, quantities["agent_first_heartbeat"].maximum
    if first is not None and first > _ROUND_TIMES * (period or first):
        how = f"the first HEARTBEAT came {first:.0f} ms after the message, more than a period"
        yield Setting("MISSED_ROUNDS", 1, False, Confidence.MEASURED, how)
