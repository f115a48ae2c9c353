"""UDP datagrams and TCP segments in packets, found in all packets of a piece at once."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.xrce.packets import Numbers, Octets, Packets

Flags = NDArray[np.bool_]

UDP: Final = 17
TCP: Final = 6

_ETHERNET, _COOKED, _COOKED_2, _NULL, _LOOP = 1, 113, 276, 0, 108
_RAW: Final = (12, 14, 101, 228, 229)
_VLAN: Final = (0x8100, 0x88A8, 0x9100)
_IPV4, _IPV6 = 0x0800, 0x86DD


@dataclass(frozen=True, slots=True)
class Datagrams:
    """The payloads of UDP and TCP; one entry for each datagram or segment in every column but ``octets``.

    Attributes:
        octets: as in `Packets`.
        packets: number of the packet in the capture.
        times: nanoseconds since the epoch.
        protocol: UDP or TCP.
        sources, destinations: hosts as they stand in the IP header, 16 bytes each; those of IPv4 as IPv6 maps them.
        source_ports, destination_ports: ports.
        starts, sizes: where the payload is in ``octets``.
        missing: how many bytes of the payload the packet should have and has not.
        headers: where the UDP or TCP header begins.
    """

    octets: Octets
    packets: Numbers
    times: Numbers
    protocol: Numbers
    sources: Octets
    destinations: Octets
    source_ports: Numbers
    destination_ports: Numbers
    starts: Numbers
    sizes: Numbers
    missing: Numbers
    headers: Numbers


def datagrams(packets: Packets) -> Datagrams:
    """The datagrams and segments among packets. What is neither, or cut before its ports, is left out."""
    octets = packets.octets
    ends = packets.starts + packets.sizes
    network, ip = _network_headers(packets, ends)
    four = ip & (_byte(octets, network, ends) >> 4 == 4) & (network + 20 <= ends)
    six = ip & (_byte(octets, network, ends) >> 4 == 6) & (network + 40 <= ends)
    length = np.where(four, (_byte(octets, network, ends) & 15) * 4, 40)
    protocol = np.where(four, _byte(octets, network + 9, ends), _byte(octets, network + 6, ends))
    # A later piece of a fragmented packet has no ports; of the first piece the rest is missing.
    later = four & (_u16(octets, network + 6, ends) & 0x1FFF != 0)
    stated = np.where(four, _u16(octets, network + 2, ends), _u16(octets, network + 4, ends) + 40)
    stated = np.where(stated == np.where(four, 0, 40), ends - network, stated)  # segmentation left to the hardware
    headers = network + length
    known = (four | six) & ~later & ((protocol == UDP) | (protocol == TCP)) & (headers + 8 <= ends)
    chosen = np.flatnonzero(known & ((protocol == UDP) | (headers + 20 <= ends)))
    network, headers, ends, protocol = network[chosen], headers[chosen], ends[chosen], protocol[chosen]
    is_udp, is_four = protocol == UDP, four[chosen]
    starts = headers + np.where(is_udp, 8, (_byte(octets, headers + 12, ends) >> 4) * 4)
    until = np.where(is_udp, headers + np.maximum(_u16(octets, headers + 4, ends), 8), network + stated[chosen])
    until = np.maximum(until, starts)
    return Datagrams(
        octets,
        packets.first + chosen,
        packets.times[chosen],
        protocol,
        _hosts(octets, network, is_four, 12, 8),
        _hosts(octets, network, is_four, 16, 24),
        _u16(octets, headers, ends),
        _u16(octets, headers + 2, ends),
        starts,
        np.maximum(np.minimum(until, ends) - starts, 0),
        np.maximum(until - np.maximum(ends, starts), 0),
        headers,
    )


def _network_headers(packets: Packets, ends: Numbers) -> tuple[Numbers, Flags]:
    """The beginning of the network header, and True if it is one of IP."""
    octets, starts, links = packets.octets, packets.starts, packets.links
    network = starts.copy()
    kind = np.zeros(len(starts), np.int64)
    for link, offset, at in ((_ETHERNET, 14, 12), (_COOKED, 16, 14), (_COOKED_2, 20, 0)):
        here = links == link
        network = np.where(here, starts + offset, network)
        kind = np.where(here, _u16(octets, starts + at, ends), kind)
    for _ in range(2):
        tagged = np.isin(kind, _VLAN)
        if not tagged.any():
            break
        kind = np.where(tagged, _u16(octets, network + 2, ends), kind)
        network = np.where(tagged, network + 4, network)
    null = (links == _NULL) | (links == _LOOP)
    network = np.where(null, starts + 4, network)
    return network, (kind == _IPV4) | (kind == _IPV6) | null | np.isin(links, _RAW)


def _byte(octets: Octets, at: Numbers, ends: Numbers) -> Numbers:
    """The bytes at places, 0 behind the ends of their packets."""
    return np.where(at < ends, octets.take(at, mode="clip"), 0).astype(np.int64)


def _u16(octets: Octets, at: Numbers, ends: Numbers) -> Numbers:
    return _byte(octets, at, ends) << 8 | _byte(octets, at + 1, ends)


def _hosts(octets: Octets, network: Numbers, is_four: Flags, at_four: int, at_six: int) -> Octets:
    hosts = np.zeros((len(network), 16), np.uint8)
    places = (network[is_four] + at_four)[:, None] + np.arange(4)
    hosts[is_four, 10:12] = 255
    hosts[is_four, 12:] = octets[places]
    places = (network[~is_four] + at_six)[:, None] + np.arange(16)
    hosts[~is_four] = octets[places]
    return hosts
