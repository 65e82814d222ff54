"""The public protocols of an RPLidar A1 and of Magni's motor controller.

RPLidar: Slamtec's "RPLIDAR interface protocol and application notes". Magni: the packets of ubiquity_motor's
motor_message.h and motor_message.cc.
"""

import struct

NUMBER = bytes(range(16))


class RplidarA1:
    """Answers GET_INFO and GET_HEALTH; `scans` between SCAN and STOP."""

    def __init__(self, firmware: tuple[int, int] = (1, 29), *, healthy: bool = True) -> None:
        self._firmware, self._healthy = firmware, healthy
        self.scans, self.requests = False, b""

    def receive(self, data: bytes) -> bytes:
        self.requests += data
        answer = b""
        while (at := data.find(b"\xa5")) >= 0 and at + 1 < len(data):
            answer += self._answer(data[at + 1])
            data = data[at + 2 :]
        return answer

    def tick(self) -> bytes:
        return b""

    def _answer(self, command: int) -> bytes:
        if command == 0x50:
            major, minor = self._firmware
            return b"\xa5\x5a\x14\x00\x00\x00\x04" + bytes((0x18, minor, major, 7)) + NUMBER
        if command == 0x52:
            return b"\xa5\x5a\x03\x00\x00\x00\x06" + bytes((0 if self._healthy else 2, 0, 0))
        if command == 0x20:
            self.scans = True
            return b"\xa5\x5a\x05\x00\x00\x40\x81"
        if command in (0x25, 0x40):
            self.scans = False
        return b""


READ, WRITE, RESPONSE = 0xA, 0xB, 0xC
FIRMWARE_VERSION, BOTH_SPEED_SET = 0x22, 0x2A


class MagniMotors:
    """Answers reads of registers and keeps writes; what has a wrong checksum is ignored."""

    def __init__(self) -> None:
        self.registers = {FIRMWARE_VERSION: 35, BOTH_SPEED_SET: 0}
        self.writes = 0
        self._data = b""

    def receive(self, data: bytes) -> bytes:
        self._data += data
        answer = b""
        while (at := self._data.find(b"\x7e")) >= 0 and len(self._data) >= at + 8:
            packet = self._data[at : at + 8]
            if magni_checksum(packet) != packet[7] or packet[1] >> 4 != 3:
                self._data = self._data[at + 1 :]
                continue
            self._data = self._data[at + 8 :]
            kind, register = packet[1] & 15, packet[2]
            if kind == READ:
                answer += make_magni_packet(RESPONSE, register, self.registers.get(register, 0))
            elif kind == WRITE:
                self.writes += 1
                self.registers[register] = struct.unpack(">i", packet[3:7])[0]
        return answer

    def tick(self) -> bytes:
        return b""


def make_magni_packet(kind: int, register: int, value: int = 0) -> bytes:
    """Delimiter, protocol 3 and kind, register, value, checksum."""
    packet = struct.pack(">BBBi", 0x7E, 3 << 4 | kind, register, value)
    return packet + bytes((magni_checksum(packet),))


def magni_checksum(packet: bytes) -> int:
    """That of the bytes between delimiter and checksum."""
    return 0xFF - (sum(packet[1:7]) & 0xFF)
