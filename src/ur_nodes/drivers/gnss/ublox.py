"""u-blox receivers of the series 7, 8, M8 and 9: the protocol UBX, by pyubx2.

Sources: "u-blox 8 / u-blox M8 Receiver Description Including Protocol Specification". A message is B5 62, its class and
number, a length of 16 bits, data, and a checksum of two bytes. UBX-NAV-PVT has all that is known of the place.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from pyubx2 import SET, UBXMessage, UBXReader, calc_checksum

from ur_nodes.drivers.frames import MORE, FrameReader

_LONGEST = 300  # bytes; NAV-PVT has 100
_HEAD, _ENDS = 6, 8
_NAV_PVT = (0x01, 0x07)
_NMEA = range(6)  # its sentences GGA, GLL, GSA, GSV, RMC, VTG
_PERIOD = 200  # ms
_PLACED = (2, 3, 4)  # types of a fix: in the plane, in space, and with dead reckoning


@dataclass(frozen=True, slots=True)
class MeasuredPlace:
    """Degrees, m above the ellipsoid, and standard deviations along the ground and of height, m."""

    latitude: float
    longitude: float
    altitude: float
    accuracy: tuple[float, float]
    satellites: int
    fixed: bool
    corrected: bool


class Ublox:
    """The protocol: bytes in, places out. It opens nothing, waits for nothing and knows no time."""

    name = "u-blox receiver"
    baud = 9600

    def __init__(self) -> None:
        self._frames = FrameReader(b"\xb5\x62", _measure, _is_valid, _LONGEST)

    @property
    def rejected(self) -> int:
        """Damaged messages so far."""
        return self._frames.rejected

    def greet(self) -> bytes:
        """Ask for NAV-PVT five times a second, and for no text, for which a line of 9600 baud has no time."""
        quiet = [_rate(0xF0, number, 0) for number in _NMEA]
        period = UBXMessage("CFG", "CFG-RATE", SET, measRate=_PERIOD, navRate=1, timeRef=1)
        return b"".join([*quiet, _rate(*_NAV_PVT, 1), period.serialize()])

    def take(self, data: bytes) -> Iterator[MeasuredPlace]:
        """Take bytes as they arrive, and return the places that they complete. No bytes make it raise."""
        for frame in self._frames.take(data):
            if tuple(frame[2:4]) == _NAV_PVT:
                yield from _read(frame)


def _rate(group: int, number: int, rate: int) -> bytes:
    """A request to send a message with each measurement (`rate` 1) or never (0), on the port that it arrives at."""
    message: bytes = UBXMessage("CFG", "CFG-MSG", SET, payload=bytes((group, number, rate))).serialize()
    return message


def _read(frame: bytes) -> Iterator[MeasuredPlace]:
    try:
        message = UBXReader.parse(frame)
        place = MeasuredPlace(
            message.lat,
            message.lon,
            message.height / 1000.0,
            (message.hAcc / 1000.0, message.vAcc / 1000.0),
            message.numSV,
            bool(message.gnssFixOk) and message.fixType in _PLACED,
            bool(message.diffSoln),
        )
    except Exception:
        return
    if abs(place.latitude) <= 90.0 and abs(place.longitude) <= 180.0 and math.hypot(*place.accuracy) >= 0.0:
        yield place


def _measure(data: bytes) -> int:
    return MORE if len(data) < _HEAD else int.from_bytes(data[4:6], "little") + _ENDS


def _is_valid(frame: bytes) -> bool:
    return bool(calc_checksum(frame[2:-2]) == frame[-2:])
