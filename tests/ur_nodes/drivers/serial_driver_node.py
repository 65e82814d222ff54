"""A small driver of a lidar (XV-11) and of Magni's motor board, for their stand-ins; upstream's are not installed.

Arguments: the two devices. It publishes `driver/scan` and `odom`, opens what was unplugged again, and writes a line to
standard output for what it rejects: `rejected lidar`, `gone motors`.
"""

from __future__ import annotations

import math
import os
import select
import struct
import sys
import termios
import threading
import tty
from collections.abc import Callable, Iterator

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from tests.devices.stand_ins.firmwares import BOTH_ODOM, READ, magni_checksum, make_magni_packet, make_xv11_packet

PERIOD = 0.05  # s
TICK = 0.001  # m
PAUSE = 0.02  # s


def report(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def open_line(path: str, speed: int) -> int:
    line = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    tty.setraw(line)
    mode = termios.tcgetattr(line)
    mode[4] = mode[5] = speed
    termios.tcsetattr(line, termios.TCSANOW, mode)
    return line


def keep_open(name: str, path: str, speed: int, serve: Callable[[int], None]) -> None:
    """Serve a device for as long as it is there, and again when it is back."""
    while not rospy.is_shutdown():
        try:
            line = open_line(path, speed)
        except (OSError, termios.error):
            rospy.rostime.wallsleep(PAUSE)
            continue
        try:
            serve(line)
        except (OSError, termios.error):
            report(f"gone {name}")
        finally:
            os.close(line)


def receive(line: int) -> bytes:
    """What has come within a period; b'' where nothing has. Raises OSError when the device was unplugged."""
    if not select.select([line], [], [], PERIOD)[0]:
        return b""
    data = os.read(line, 4096)
    if not data:
        raise OSError("unplugged")
    return data


def split(data: bytearray, head: int, size: int, is_good: Callable[[bytes], bool], name: str) -> Iterator[bytes]:
    """Take the good packets from the beginning of data; bytes that begin none are dropped."""
    dropped = 0
    while len(data) >= size:
        packet = bytes(data[:size])
        good = packet[0] == head and is_good(packet)
        del data[: size if good else 1]
        dropped += not good
        if good:
            yield packet
    if dropped:
        report(f"rejected {name}")


def is_xv11(packet: bytes) -> bool:
    distance = int.from_bytes(packet[4:6], "little")
    return 0xA0 <= packet[1] < 0xFA and packet == make_xv11_packet(packet[1] - 0xA0, distance)


def is_magni(packet: bytes) -> bool:
    return magni_checksum(packet) == packet[7] and packet[2] == BOTH_ODOM


class Lidar:
    def __init__(self) -> None:
        self._scan = rospy.Publisher("driver/scan", LaserScan, queue_size=5)

    def serve(self, line: int) -> None:
        data, ranges = bytearray(), dict[int, float]()
        while not rospy.is_shutdown():
            data += receive(line)
            for packet in split(data, 0xFA, 22, is_xv11, "lidar"):
                first = 4 * (packet[1] - 0xA0)
                for number in range(4):
                    ranges[first + number] = struct.unpack_from("<H", packet, 4 + 4 * number)[0] / 1000.0
                if first == 356 and len(ranges) == 360:
                    self._publish([ranges[degree] for degree in range(360)])
                    ranges.clear()

    def _publish(self, ranges: list[float]) -> None:
        message = LaserScan(ranges=ranges, angle_max=2 * math.pi, angle_increment=math.radians(1), range_max=6.0)
        message.header.stamp, message.header.frame_id = rospy.Time.now(), "xv11"
        self._scan.publish(message)


class Motors:
    def __init__(self) -> None:
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=10)
        self._time, self._way = 100.0, 0.0  # its own clock: PERIOD between two readings

    def serve(self, line: int) -> None:
        data = bytearray()
        while not rospy.is_shutdown():
            os.write(line, make_magni_packet(READ, BOTH_ODOM))
            data += receive(line)
            rospy.rostime.wallsleep(PAUSE)
            for packet in split(data, 0x7E, 8, is_magni, "motors"):
                left, right = struct.unpack(">hh", packet[3:7])
                self._publish((left + right) / 2.0 * TICK)

    def _publish(self, distance: float) -> None:
        self._time, self._way = self._time + PERIOD, self._way + distance
        message = Odometry()
        message.header.stamp, message.header.frame_id = rospy.Time.from_sec(self._time), "odom"
        message.pose.pose.position.x, message.pose.pose.orientation.w = self._way, 1.0
        message.twist.twist.linear.x = distance / PERIOD
        self._odometry.publish(message)


def main() -> None:
    lidar, motors = sys.argv[1:3]
    rospy.init_node("serial_driver")
    for name, path, speed, serve in (
        ("lidar", lidar, termios.B115200, Lidar().serve),
        ("motors", motors, termios.B38400, Motors().serve),
    ):
        threading.Thread(target=keep_open, args=(name, path, speed, serve), daemon=True).start()
    rospy.spin()


if __name__ == "__main__":
    main()
