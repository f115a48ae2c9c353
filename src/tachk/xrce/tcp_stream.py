"""Messages in one direction of a TCP connection, each behind two bytes of length, little-endian."""

from __future__ import annotations

from typing import Final

_SYN: Final = 0x02
_MOST_WAITING: Final = 1 << 20
"""How many bytes may come behind a gap before it is given up: the segment was not captured."""

Found = list[tuple[bytes, int]]
"""Messages, each with the number of its bytes that were not captured."""


class TcpStream:
    """Puts segments in order and drops what is repeated. Behind a gap a segment is taken to begin with a message."""

    def __init__(self) -> None:
        self._begin(None)

    def _begin(self, number: int | None) -> None:
        self._next = number
        self._waiting: dict[int, bytes] = {}
        self._octets = bytearray()

    def push(self, number: int, octets: bytes, missing: int, flags: int) -> Found:
        """The messages that a segment completes.

        Args:
            number: its sequence number.
            missing: how many bytes of it were not captured.
            flags: those of its header.
        """
        if flags & _SYN:
            found = self.close()
            self._begin((number + 1) % 2**32)
            return found
        if octets and (self._next is None or self._ahead(number) + len(octets) > 0):
            self._next = number if self._next is None else self._next
            self._waiting[number] = max(octets, self._waiting.get(number, b""), key=len)
        found = self._messages()
        if missing or sum(map(len, self._waiting.values())) > _MOST_WAITING:
            return found + self.close()
        return found

    def close(self) -> Found:
        """What has begun and can no longer be completed; reading may go on behind it."""
        found: Found = []
        while self._waiting or self._octets:
            if self._octets:
                size = int.from_bytes(self._octets[:2], "little")
                found.append((bytes(self._octets[2:]), max(size + 2 - len(self._octets), 1)))
                self._octets.clear()
            elif self._waiting:
                found.append((b"", self._ahead(min(self._waiting, key=self._ahead))))
            if self._waiting:
                self._next = min(self._waiting, key=self._ahead)
                found += self._messages()
        self._next = None
        return found

    def _messages(self) -> Found:
        self._join()
        found: Found = []
        while len(self._octets) >= 2:
            size = int.from_bytes(self._octets[:2], "little")
            if len(self._octets) < 2 + size:
                break
            found.append((bytes(self._octets[2 : 2 + size]), 0))
            del self._octets[: 2 + size]
        return found

    def _join(self) -> None:
        """Takes the segments that follow what is there."""
        while self._waiting:
            number = min(self._waiting, key=self._ahead)
            ahead = self._ahead(number)
            if ahead > 0:
                return
            octets = self._waiting.pop(number)[-ahead:] if ahead else self._waiting.pop(number)
            self._octets += octets
            assert self._next is not None
            self._next = (self._next + len(octets)) % 2**32

    def _ahead(self, number: int) -> int:
        """How far in front of what is expected a number is."""
        assert self._next is not None
        return (number - self._next + 2**31) % 2**32 - 2**31
