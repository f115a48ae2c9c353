"""Fault-injection plans of a relay: text to rules, a rule on each line.

    rule    = action [NUMBER "%" "of"] chosen [wait] ["between" time "and" time]
    action  = "drop" | "delay" | "duplicate"
    chosen  = [which] packets ["since" packets]
    which   = "every" | ["the"] NTH ["to" NTH | "and" "every" "further"]
    packets = KIND [NUMBER] ["client->agent" | "agent->client"] ["on" PORT]
    wait    = ("by" | "after") time ["to" time]
            | ("until" | "after") chosen {"and" chosen}
    time    = NUMBER UNIT

What is behind # is a comment.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from fractions import Fraction
from typing import Final

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.exact_numbers import DIGITS, is_whole
from tachk.base.span import Source, Span
from tachk.base.time_units import NANOSECONDS, SPELLINGS
from tachk.xrce.proxy.rules import (
    EVERY,
    NUMBERED,
    ONE_WAY,
    Chosen,
    ChosenPackets,
    PacketDirection,
    RelayAction,
    RelayRule,
    RuleWindow,
)
from tachk.xrce.wire import SubmessageKind

_TOKEN: Final = re.compile(r"\d+(?:st|nd|rd|th)\b|\d+(?:\.\d+)?|[A-Za-z_]+(?:->[A-Za-z]+)?|\S")
_NUMBER: Final = re.compile(rf"{DIGITS}(?:\.{DIGITS})?")
_ORDINAL: Final = re.compile(rf"({DIGITS})(?:st|nd|rd|th)")
_ACTIONS: Final = {action.value: action for action in RelayAction}
_WAYS: Final = {way.value: way for way in PacketDirection}
_KINDS: Final = ("packet", "NACK", *(kind.name for kind in SubmessageKind))
_PLURALS: Final = {"packets": "packet"}
_WAITS: Final = {RelayAction.DELAY: ("by", "until"), RelayAction.DUPLICATE: ("after", "after")}
_LAST_NUMBER: Final = 65535


def parse_fault_plan(source: Source, ports: Collection[int] = ()) -> tuple[RelayRule, ...]:
    """The rules of a script, in its order.

    Args:
        source: the script.
        ports: where the relay listens; empty where that does not matter.

    Raises InputError with a diagnostic for each line that is not a rule.
    """
    rules: list[RelayRule] = []
    problems: list[Diagnostic] = []
    start = 0
    for line in source.text.splitlines(keepends=True):
        text = line.partition("#")[0].rstrip()
        if text:
            try:
                rules.append(_Line(source, start, text, ports).rule())
            except InputError as error:
                problems += error.diagnostics
        start += len(line)
    if problems:
        raise InputError(problems)
    return tuple(rules)


class _Line:
    """A line, read from left to right."""

    def __init__(self, source: Source, start: int, text: str, ports: Collection[int]) -> None:
        self.tokens = [Span(source, start + m.start(), start + m.end()) for m in _TOKEN.finditer(text)]
        self.behind = Span(source, start + len(text), start + len(text))
        self.whole = self.tokens[0].to(self.tokens[-1])
        self.ports = ports
        self.next = 0

    # ---- tokens ------------------------------------------------------------------------------------------------------

    @property
    def place(self) -> Span:
        """The next token, or the end of the line."""
        return self.tokens[self.next] if self.next < len(self.tokens) else self.behind

    @property
    def following(self) -> str:
        """The text of the token behind the next one; empty where there is none."""
        return self.tokens[self.next + 1].text if self.next + 1 < len(self.tokens) else ""

    def sees(self, text: str) -> bool:
        return self.place.text == text

    def take(self) -> Span:
        token = self.place
        self.next += 1
        return token

    def skip(self, text: str) -> bool:
        """True if this was next; then it is taken."""
        found = self.sees(text)
        self.next += found
        return found

    def expect(self, text: str) -> None:
        if not self.skip(text):
            raise self.wrong(f"expected {text!r}{self.found}")

    @property
    def found(self) -> str:
        return f", found {self.place.text!r}" if self.next < len(self.tokens) else ""

    def wrong(self, message: str, help: str | None = None, span: Span | None = None, code: str = "E0951") -> InputError:
        return InputError([Diagnostic(code, message, self.place if span is None else span, help)])

    # ---- rules -------------------------------------------------------------------------------------------------------

    def rule(self) -> RelayRule:
        verb = self.take()
        if verb.text not in _ACTIONS:
            close = closest(verb.text, _ACTIONS)
            raise self.wrong(
                f"a rule begins with drop, delay or duplicate, not with {verb.text!r}",
                f"did you mean {close}?" if close else "for example: drop the 2nd ACKNACK agent->client",
                verb,
            )
        action = _ACTIONS[verb.text]
        share = self.share()
        chosen = self.chosen(all_of_them=share is not None)
        wait = RuleWindow() if action is RelayAction.DROP else self.wait(action)
        begin, end = self.window()
        if self.next < len(self.tokens):
            raise self.wrong(f"expected the end of the line{self.found}")
        return RelayRule(action, chosen, self.whole, share, wait, begin, end)

    def share(self) -> Fraction | None:
        if self.following != "%":
            return None
        place = self.place
        share = self.number() / 100
        self.take()
        self.expect("of")
        if not 0 < share <= 1:
            raise self.wrong("a share is more than 0 % and at most 100 %", None, place, "E0953")
        return share

    def chosen(self, all_of_them: bool = False) -> Chosen:
        place = self.place
        first, last = (1, EVERY) if all_of_them else self.which()
        packets = self.packets()
        since = self.packets() if self.skip("since") else None
        if not 1 <= first <= last:
            raise self.wrong("packets are counted from the 1st, upwards", None, place, "E0953")
        return Chosen(packets, first, last, since)

    def which(self) -> tuple[int, int]:
        if self.skip("every"):
            return 1, EVERY
        self.skip("the")
        if not _ORDINAL.fullmatch(self.place.text):
            return 1, 1
        first = self.ordinal()
        if self.skip("to"):
            return first, self.ordinal()
        if (
            self.sees("and")
            and self.tokens[self.next + 1 : self.next + 2]
            and self.tokens[self.next + 1].text == "every"
        ):
            self.take()
            self.take()
            self.expect("further")
            return first, EVERY
        return first, first

    def ordinal(self) -> int:
        found = _ORDINAL.fullmatch(self.place.text)
        if found is None:
            raise self.wrong(f"expected a number such as 2nd{self.found}")
        self.take()
        return int(found[1])

    def packets(self) -> ChosenPackets:
        kind, names_missing = self.kind()
        number, number_place = None, self.place
        if is_whole(self.place.text) and self.following.lower() not in SPELLINGS:
            number = int(self.take().text)
        way_place = self.place
        way = _WAYS[self.take().text] if self.place.text in _WAYS else None
        port = self.port() if self.skip("on") else None
        if number is not None and (kind not in NUMBERED or number > _LAST_NUMBER):
            packet_name = "a packet" if kind is None else kind.name
            reason = f"numbers end at {_LAST_NUMBER}" if kind in NUMBERED else f"{packet_name} has no number"
            raise self.wrong(reason, None, number_place, "E0953")
        if kind in ONE_WAY and way not in (None, ONE_WAY[kind]):
            help = "the samples that clients write are WRITE_DATA" if kind is SubmessageKind.DATA else None
            help = "the samples that the Agent sends are DATA" if kind is SubmessageKind.WRITE_DATA else help
            raise self.wrong(f"{kind.name} goes {ONE_WAY[kind].value} only", help, way_place, "E0953")
        return ChosenPackets(kind, names_missing, number, way, port)

    def kind(self) -> tuple[SubmessageKind | None, bool]:
        name = _PLURALS.get(self.place.text, self.place.text)
        if name not in _KINDS:
            if self.next == len(self.tokens):
                raise self.wrong("expected a kind of packet, such as ACKNACK, or packet for all of them")
            close = closest(name, _KINDS) or closest(name.upper(), _KINDS)
            help = f"did you mean {close}?" if close else f"there are {', '.join(_KINDS)}"
            raise self.wrong(f"there is no kind of packet called {name!r}", help, None, "E0952")
        self.take()
        if name == "packet":
            return None, False
        return (SubmessageKind.ACKNACK, True) if name == "NACK" else (SubmessageKind[name], False)

    def port(self) -> int:
        place = self.place
        if not is_whole(place.text):
            raise self.wrong(f"expected a port{self.found}")
        port = int(self.take().text)
        if self.ports and port not in self.ports:
            known = ", ".join(map(str, self.ports))
            raise self.wrong(f"the relay does not listen on port {port}", f"it listens on {known}", place, "E0953")
        return port

    def wait(self, action: RelayAction) -> RuleWindow:
        for_time, for_packets = _WAITS[action]
        if self.skip(for_time):
            if for_time != for_packets or _NUMBER.fullmatch(self.place.text):
                return self.interval()
        elif not self.skip(for_packets):
            raise self.wrong(f"expected '{for_time}' and a time or '{for_packets}' and packets{self.found}")
        events = [self.awaited()]
        while self.skip("and"):
            events.append(self.awaited())
        return RuleWindow(events=tuple(events))

    def awaited(self) -> Chosen:
        place = self.place
        chosen = self.chosen()
        if chosen.first != chosen.last:
            raise self.wrong("a packet waits for one packet, not for several", None, place, "E0953")
        return chosen

    def interval(self) -> RuleWindow:
        place = self.place
        shortest = self.time()
        longest = self.time() if self.skip("to") else shortest
        if longest < shortest:
            raise self.wrong("the first time is the longer one", None, place, "E0953")
        return RuleWindow(shortest, longest)

    def window(self) -> tuple[int, int]:
        if not self.skip("between"):
            return 0, EVERY
        place = self.place
        begin = self.time()
        self.expect("and")
        end = self.time()
        if end <= begin:
            raise self.wrong("nothing is between these times", None, place, "E0953")
        return begin, end

    def time(self) -> int:
        amount = self.number()
        unit = SPELLINGS.get(self.place.text.lower())
        if unit is None:
            raise self.wrong(f"expected a unit of time, such as ms{self.found}")
        self.take()
        return round(amount * NANOSECONDS[unit])

    def number(self) -> Fraction:
        if not _NUMBER.fullmatch(self.place.text):
            raise self.wrong(f"expected a number{self.found}")
        return Fraction(self.take().text)
