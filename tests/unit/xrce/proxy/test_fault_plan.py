"""Scripts of the relay: what rules mean, that they say the same in words, and what is said about wrong ones."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.diagnostics.explanation import all_explanations
from tachk.base.span import Source
from tachk.xrce.proxy.fault_plan import parse_fault_plan
from tachk.xrce.proxy.rules import EVERY, Chosen, ChosenPackets, PacketDirection, RelayAction, RelayRule, RuleWindow
from tachk.xrce.wire import SubmessageKind

MS = 1_000_000


def one(text: str) -> RelayRule:
    (rule,) = parse_fault_plan(Source("script", text))
    return rule


def test_packets_are_chosen_by_kind_number_way_and_count() -> None:
    rule = one("drop the 2nd ACKNACK 7 agent->client on 19001 since WRITE_DATA")
    packets = ChosenPackets(SubmessageKind.ACKNACK, number=7, way=PacketDirection.TO_CLIENT, port=19001)
    assert (rule.action, rule.chosen) == (
        RelayAction.DROP,
        Chosen(packets, 2, 2, ChosenPackets(SubmessageKind.WRITE_DATA)),
    )


@pytest.mark.parametrize(
    ("text", "first", "last"),
    [
        ("drop DATA", 1, 1),
        ("drop every DATA", 1, EVERY),
        ("drop 3rd DATA", 3, 3),
        ("drop the 2nd to 4th DATA", 2, 4),
        ("drop the 11th and every further DATA", 11, EVERY),
        ("drop 20 % of DATA", 1, EVERY),
    ],
)
def test_which_ones_are_counted(text: str, first: int, last: int) -> None:
    assert (one(text).chosen.first, one(text).chosen.last) == (first, last)


def test_kinds() -> None:
    assert one("drop packet").chosen.packets == ChosenPackets()
    assert one("drop every packets client->agent").chosen.packets == ChosenPackets(way=PacketDirection.TO_AGENT)
    assert one("drop NACK").chosen.packets == ChosenPackets(SubmessageKind.ACKNACK, names_missing=True)


def test_waits() -> None:
    assert one("delay DATA 5 by 1.5 ms").wait == RuleWindow(1_500_000, 1_500_000)
    assert one("delay 50 % of packets by 0 ms to 60 ms").wait == RuleWindow(0, 60 * MS)
    assert one("duplicate CREATE_CLIENT after 1 s").wait == RuleWindow(1000 * MS, 1000 * MS)
    events = (
        Chosen(ChosenPackets(SubmessageKind.ACKNACK, number=9)),
        Chosen(ChosenPackets(SubmessageKind.WRITE_DATA), 2, 2),
    )
    assert one("delay ACKNACK 8 until ACKNACK 9 and the 2nd WRITE_DATA").wait == RuleWindow(events=events)
    assert one("duplicate DATA after the 2nd WRITE_DATA").wait == RuleWindow(events=events[1:])


def test_shares_and_windows() -> None:
    rule = one("drop 12.5 % of packets between 3 s and 53 s")
    assert (rule.share, rule.begin, rule.end) == (Fraction(1, 8), 3000 * MS, 53000 * MS)


def test_lines_are_rules_and_comments() -> None:
    rules = parse_fault_plan(Source("script", "# first\n\ndrop DATA 5   # why\n  delay DATA by 1 ms\n"))
    assert [str(rule.span) for rule in rules] == ["script:3:1", "script:4:3"]


@pytest.mark.parametrize(
    "text",
    [
        "drop the 2nd ACKNACK 7 agent->client on 19001 since WRITE_DATA",
        "drop every packet between 3 s and 1500 ms",
        "drop the 3rd and every further NACK",
        "drop the 21st to 112th packet",
        "delay 12.5 % of packet agent->client by 0 s to 60 ms",
        "delay the 1st ACKNACK 8 until the 1st ACKNACK 9 and the 2nd WRITE_DATA since WRITE_DATA",
        "duplicate the 1st CREATE_CLIENT after the 3rd WRITE_DATA",
    ],
)
def test_a_rule_in_words_is_the_rule(text: str) -> None:
    text = text.replace("1500 ms", "4500 ms")
    assert str(one(text)) == text


@pytest.mark.parametrize(
    ("text", "column", "code", "message"),
    [
        ("drp DATA", 1, "E0951", "not with 'drp'"),
        ("drop", 5, "E0951", "expected a kind of packet"),
        ("drop DAT 5", 6, "E0952", "'DAT'"),
        ("drop DATA 5 client->agent", 13, "E0953", "DATA goes agent->client only"),
        ("drop packet 7", 13, "E0953", "a packet has no number"),
        ("drop DATA 70000", 11, "E0953", "numbers end at 65535"),
        ("drop CREATE_CLIENT 1", 20, "E0953", "CREATE_CLIENT has no number"),
        ("drop the 0th DATA", 6, "E0953", "counted from the 1st"),
        ("drop the 3rd to 2nd DATA", 6, "E0953", "counted from the 1st"),
        ("drop the 3rd to DATA", 17, "E0951", "a number such as 2nd, found 'DATA'"),
        ("drop the 3rd and every DATA", 24, "E0951", "expected 'further', found 'DATA'"),
        ("drop 0 % of DATA", 6, "E0953", "more than 0 %"),
        ("drop 101 % of DATA", 6, "E0953", "at most 100 %"),
        ("drop 5 % DATA", 10, "E0951", "expected 'of', found 'DATA'"),
        ("drop DATA extra", 11, "E0951", "expected the end of the line, found 'extra'"),
        ("drop DATA on here", 14, "E0951", "expected a port, found 'here'"),
        ("drop DATA on 77", 14, "E0953", "does not listen on port 77"),
        ("delay DATA 5", 13, "E0951", "expected 'by' and a time or 'until' and packets"),
        ("delay DATA by 5", 16, "E0951", "expected a unit of time"),
        ("delay DATA by ms", 15, "E0951", "expected a number, found 'ms'"),
        ("delay DATA by 3 s to 2 s", 15, "E0953", "the first time is the longer one"),
        ("delay DATA until every DATA", 18, "E0953", "waits for one packet"),
        ("drop DATA between 3 s and 3 s", 19, "E0953", "nothing is between"),
    ],
)
def test_wrong_rules(text: str, column: int, code: str, message: str) -> None:
    with pytest.raises(InputError) as raised:
        parse_fault_plan(Source("script", f"drop DATA\n{text}\n"), [19001])
    (found,) = raised.value.diagnostics
    assert found.span.source.line_column(found.span.start) == (2, column)
    assert found.code == code
    assert message in found.message
    assert code in all_explanations()


def test_every_wrong_line_is_reported() -> None:
    with pytest.raises(InputError) as raised:
        parse_fault_plan(Source("script", "drp DATA\ndrop DATA\ndrop DAT"))
    assert [found.help for found in raised.value.diagnostics] == ["did you mean drop?", "did you mean DATA?"]
