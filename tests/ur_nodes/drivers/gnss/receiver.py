"""A u-blox receiver at the end of a line, from the tables of its "Receiver Description"."""

from __future__ import annotations

import struct
from dataclasses import dataclass


@dataclass
class Receiver:
    """Degrees, m above the ellipsoid, and the `kind` of the fix: 0 none, 3 in space."""

    latitude: float = 48.1373932
    longitude: float = -11.5754485
    height: float = 519.25
    accuracy: tuple[float, float] = (1.5, 2.5)
    kind: int = 3
    corrected: bool = False
    asked: bool = False
    text: bool = True

    def take(self, data: bytes) -> bytes:
        """Obey requests whose checksum is right, and acknowledge them."""
        answer = b""
        while (at := data.find(b"\xb5\x62")) >= 0 and len(data) >= at + 8:
            group, number, size = struct.unpack_from("<BBH", data, at + 2)
            body = data[at + 2 : at + 6 + size]
            if self._sum(body) == data[at + 6 + size : at + 8 + size] and (group, number) == (0x06, 0x01):
                message, rate = tuple(body[4:6]), body[6]
                self.asked |= message == (0x01, 0x07) and rate == 1
                self.text &= not (message == (0xF0, 0x00) and rate == 0)
                answer += self._frame(0x05, 0x01, bytes((group, number)))
            data = data[at + 8 + size :]
        return answer

    def tick(self) -> bytes:
        """Return what it sends at each measurement."""
        sent = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n" if self.text else b""
        return sent + (self._frame(0x01, 0x07, self._place()) if self.asked else b"")

    def _place(self) -> bytes:
        flags = (self.kind >= 2) | self.corrected << 1
        head = struct.pack("<IH5B2xIi", 1000, 2026, 11, 26, 18, 0, 0, 30, 0)[:20]
        return (
            head
            + struct.pack("<BBBB", self.kind, flags, 0, 9)
            + struct.pack("<iiii", *(round(each * 1e7) for each in (self.longitude, self.latitude)),
                          round(self.height * 1000), round(self.height * 1000) - 47000)
            + struct.pack("<II", *(round(each * 1000) for each in self.accuracy))
            + bytes(92 - 48)
        )  # fmt: skip

    def _frame(self, group: int, number: int, data: bytes) -> bytes:
        body = struct.pack("<BBH", group, number, len(data)) + data
        return b"\xb5\x62" + body + self._sum(body)

    @staticmethod
    def _sum(body: bytes) -> bytes:
        a = b = 0
        for byte in body:
            a = (a + byte) & 0xFF
            b = (b + a) & 0xFF
        return bytes((a, b))
