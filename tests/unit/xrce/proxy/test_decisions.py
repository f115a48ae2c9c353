"""What a relay decides: events in, departures out, without sockets and clocks."""

from __future__ import annotations

from tachk.base.span import Source
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.decisions import Decisions, RelayArrival
from tachk.xrce.proxy.fault_plan import parse_fault_plan
from tachk.xrce.proxy.rules import PacketDirection
from tests.unit.xrce.proxy.packets import CREATE_CLIENT, acknack, data, heartbeat, write_data

MS = 1_000_000
HERE = Endpoint("127.0.0.1", 5)


class Wire:
    """A relay with the packets that have left it, as (time in ms, number of the arrival)."""

    def __init__(self, script: str, seed: int = 0) -> None:
        self.decisions = Decisions(parse_fault_plan(Source("script", script)), seed)
        self.left: list[tuple[float, int]] = []
        self.wake: int | None = None

    def send(self, ms: int, octets: bytes, to_agent: bool = True, port: int = 1) -> None:
        way = PacketDirection.TO_AGENT if to_agent else PacketDirection.TO_CLIENT
        self.wait(ms)
        answer = self.decisions.arrived(RelayArrival(port, HERE, way, octets, ms * MS))
        self.wake = answer.wake
        self.left += [(ms, departure.arrival) for departure in answer.departures]

    def wait(self, ms: int) -> None:
        """Lets time pass, with a stop at each moment at which the relay wants to be asked."""
        while self.wake is not None and self.wake <= ms * MS:
            time = self.wake
            answer = self.decisions.due(time)
            self.wake = answer.wake
            self.left += [(time / MS, departure.arrival) for departure in answer.departures]


def test_what_no_rule_is_about_leaves_at_once() -> None:
    wire = Wire("drop DATA")
    wire.send(0, write_data(1))
    wire.send(1, b"no message")
    wire.send(2, b"")
    assert wire.left == [(0, 0), (1, 1), (2, 2)]
    assert wire.decisions.applied == [0]


def test_packets_are_dropped_by_count_and_number() -> None:
    wire = Wire("drop the 2nd WRITE_DATA\ndrop ACKNACK 3 agent->client\ndrop every HEARTBEAT")
    for number, octets in enumerate((write_data(7), write_data(7), write_data(7), heartbeat(1, 2), heartbeat(1, 2))):
        wire.send(number, octets)
    wire.send(5, acknack(2), to_agent=False)
    wire.send(6, acknack(3), to_agent=True)
    wire.send(7, acknack(3), to_agent=False)
    wire.send(8, acknack(3), to_agent=False)
    assert [number for _, number in wire.left] == [0, 2, 5, 6, 8]
    assert wire.decisions.applied == [1, 1, 2]


def test_only_acknacks_that_name_a_missing_message_are_nacks() -> None:
    wire = Wire("drop every NACK")
    wire.send(0, acknack(1), to_agent=False)
    wire.send(1, acknack(1, bitmap=4), to_agent=False)
    assert wire.left == [(0, 0)]


def test_an_acknack_that_names_a_missing_message_is_an_acknack() -> None:
    wire = Wire("drop every ACKNACK")
    wire.send(0, acknack(1, bitmap=4), to_agent=False)
    assert wire.left == []


def test_what_waits_for_the_same_leaves_in_the_order_of_arrival() -> None:
    wire = Wire("delay every ACKNACK until WRITE_DATA")
    for first in (1, 2, 3):
        wire.send(first, acknack(first), to_agent=False)
    wire.send(4, write_data(1))
    assert wire.left == [(4, 0), (4, 1), (4, 2), (4, 3)]


def test_clients_are_counted_apart() -> None:
    wire = Wire("drop WRITE_DATA\ndrop the 2nd WRITE_DATA on 2")
    for port in (1, 2, 1, 2):
        wire.send(0, write_data(1), port=port)
    assert [number for _, number in wire.left] == [2]


def test_counting_begins_where_it_is_said() -> None:
    wire = Wire("drop the 2nd ACKNACK since WRITE_DATA\ndrop the 2nd WRITE_DATA since WRITE_DATA")
    wire.send(0, acknack(0), to_agent=False)
    wire.send(1, write_data(1))
    wire.send(2, acknack(1), to_agent=False)
    wire.send(3, write_data(2))
    wire.send(4, acknack(2), to_agent=False)
    assert [number for _, number in wire.left] == [0, 1, 2]


def test_delays_let_packets_overtake_and_add_up() -> None:
    wire = Wire("delay DATA 1 by 30 ms\ndelay DATA 1 by 10 ms")
    wire.send(0, data(1), to_agent=False)
    wire.send(20, data(2), to_agent=False)
    wire.wait(100)
    assert wire.left == [(20, 1), (40, 0)]


def test_a_packet_waits_until_another_one_that_goes_the_same_way_has_left() -> None:
    wire = Wire("delay ACKNACK 8 until ACKNACK 9\ndelay ACKNACK 9 by 5 ms")
    wire.send(0, acknack(8), to_agent=False)
    wire.send(10, acknack(9), to_agent=False)
    wire.wait(100)
    assert wire.left == [(15, 1), (15, 0)]


def test_a_lost_packet_has_passed() -> None:
    wire = Wire("delay ACKNACK 8 until ACKNACK 9\ndrop ACKNACK 9")
    wire.send(0, acknack(8), to_agent=False)
    wire.send(10, acknack(9), to_agent=False)
    assert wire.left == [(10, 0)]


def test_a_packet_that_goes_the_other_way_has_passed_when_it_has_come() -> None:
    wire = Wire("delay ACKNACK 8 until WRITE_DATA 9\ndelay WRITE_DATA 9 by 5 ms")
    wire.send(0, acknack(8), to_agent=False)
    wire.send(10, write_data(9))
    wire.wait(100)
    assert wire.left == [(10, 0), (15, 1)]


def test_what_has_passed_before_is_not_waited_for() -> None:
    wire = Wire("delay ACKNACK 8 until WRITE_DATA 1 and the 2nd WRITE_DATA")
    wire.send(0, write_data(1))
    wire.send(1, write_data(2))
    wire.send(2, acknack(8), to_agent=False)
    assert wire.left[-1] == (2, 2)
    assert wire.decisions.held == ()


def test_no_packet_waits_for_itself() -> None:
    wire = Wire("delay every ACKNACK until the 2nd ACKNACK")
    wire.send(0, acknack(1), to_agent=False)
    wire.send(1, acknack(2), to_agent=False)
    assert wire.left == [(1, 1), (1, 0)]


def test_what_waits_for_ever_is_held() -> None:
    wire = Wire("delay ACKNACK until WRITE_DATA")
    wire.send(0, acknack(1), to_agent=False, port=1)
    wire.send(1, write_data(1), port=2)
    assert [departure.arrival for departure in wire.decisions.held] == [0]


def test_copies_come_later_or_after_a_packet() -> None:
    wire = Wire("duplicate CREATE_CLIENT after 20 ms\nduplicate CREATE_CLIENT after WRITE_DATA\ndrop WRITE_DATA")
    wire.send(0, CREATE_CLIENT)
    wire.send(50, write_data(1))
    assert wire.left == [(0, 0), (20, 0), (50, 0)]


def test_a_lost_packet_may_have_copies() -> None:
    wire = Wire("duplicate CREATE_CLIENT after 20 ms\ndrop CREATE_CLIENT")
    wire.send(0, CREATE_CLIENT)
    wire.wait(30)
    assert wire.left == [(20, 0)]


def test_windows_begin_with_the_first_packet_of_a_client() -> None:
    wire = Wire("drop every packet between 10 ms and 20 ms")
    for time, port in ((100, 1), (109, 1), (110, 1), (119, 1), (120, 1), (120, 2)):
        wire.send(time, write_data(1), port=port)
    assert wire.left == [(100, 0), (109, 1), (120, 4), (120, 5)]


def numbers_left(script: str, seed: int, ports: tuple[int, ...]) -> dict[int, list[bool]]:
    """Which packets of each client are not lost."""
    wire = Wire(script, seed)
    found: dict[int, list[bool]] = {port: [] for port in ports}
    for turn in range(200 * len(ports)):
        port = ports[turn % len(ports)]
        before = len(wire.left)
        wire.send(turn, write_data(turn), port=port)
        found[port].append(len(wire.left) > before)
    return found


def test_chance_is_drawn_from_the_seed_for_each_client_apart() -> None:
    script = "drop 20 % of packets"
    together, alone = numbers_left(script, 1, (1, 2)), numbers_left(script, 1, (1,))
    assert together[1] == alone[1] != together[2]
    assert numbers_left(script, 2, (1,)) != alone
    assert 20 <= alone[1].count(False) <= 60


def test_random_delays_are_within_their_bounds() -> None:
    wire = Wire("delay 100 % of packets by 5 ms to 9 ms")
    for number in range(100):
        wire.send(20 * number, write_data(number))
    wire.wait(3000)
    waits = [time - 20 * number for time, number in wire.left]
    assert 5 <= min(waits) < 6
    assert 8 < max(waits) <= 9
