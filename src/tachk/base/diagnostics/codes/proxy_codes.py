"""Explanations of what is reported about rules of a relay."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

PROXY_CODES: dict[str, Explanation] = {
    "E0951": Explanation(
        "line that is no rule",
        "A rule says what is done (drop, delay, duplicate), with which packets, and for a delay how long (by 500 ms) "
        "or until which packet has passed, for a duplicate after what time or which packet. docs/real_system.md has "
        "the grammar.",
        "delay DATA 5 for 500 ms",
        "delay DATA 5 by 500 ms",
    ),
    "E0952": Explanation(
        "unknown kind of packet",
        "Packets are called as tachk decode prints them, such as WRITE_DATA, ACKNACK, CREATE_CLIENT. NACK is an "
        "ACKNACK that names a missing message, packet is any.",
        "drop the 2nd ACK agent->client",
        "drop the 2nd ACKNACK agent->client",
    ),
    "E0953": Explanation(
        "rule that can never apply",
        "A kind of packet that never goes this way, or has no such number; a range or an interval in which nothing is; "
        "a port at which the relay does not listen.",
        "drop DATA 5 client->agent",
        "drop WRITE_DATA 5 client->agent",
    ),
}
