"""Devices that are asked what they are, on pseudo-terminals."""

import os
import subprocess
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ur.devices.known import Device, DeviceHolder, DeviceSnapshot
from ur.devices.probe import list_questions, parse_answers, probe_script


@contextmanager
def line(answer: Callable[[bytes], bytes], *, first: bytes = b"") -> Iterator[str]:
    """A serial line whose other end sends `first` and answers what it gets until it is closed."""
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    stop, wake = os.pipe()

    def serve() -> None:
        import select

        sent = not first
        while True:
            ready, writable, _ = select.select([ours, stop], [] if sent else [ours], [])
            if stop in ready:
                return
            if ours in ready:
                os.write(ours, answer(os.read(ours, 100)))
            elif writable:
                os.write(ours, first)

    worker = threading.Thread(target=serve)
    worker.start()
    try:
        yield os.ttyname(theirs)
    finally:
        os.write(wake, b"x")
        worker.join()
        for each in (ours, theirs, stop, wake):
            os.close(each)


def ask(path: str, *kinds: str) -> str:
    script = probe_script([(path, kind, 115200) for kind in kinds])
    done = subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=True)
    return parse_answers(done.stdout)[path]


def rplidar(request: bytes) -> bytes:
    return b"\xa5\x5a\x14\x00\x00\x00\x04\x18\x1d\x01\x07" + bytes(range(16)) if b"\xa5\x50" in request else b""


def test_rplidar_names_its_model_firmware_and_number() -> None:
    with line(rplidar) as path:
        assert ask(path, "rplidar") == "RPLIDAR model 1.8, firmware 1.29, number 000102030405060708090A0B0C0D0E0F"


def test_neato_names_its_model_and_software() -> None:
    table = b"GetVersion\r\nComponent,Major,Minor,Build\r\nModelID,BotVac85,,\r\nSoftware,3,4,24079\r\n\x1a"
    with line(lambda request: table if b"GetVersion" in request else b"") as path:
        assert ask(path, "neato") == "Neato BotVac85, software 3.4.24079"


def test_xv11_is_known_by_what_it_sends_unasked() -> None:
    packet = b"\xfa\xa0" + bytes(18)
    total = 0
    for index in range(10):
        total = (total << 1) + packet[2 * index] + (packet[2 * index + 1] << 8)
    total = ((total & 0x7FFF) + (total >> 15)) & 0x7FFF
    with line(lambda _: b"", first=packet + bytes((total & 255, total >> 8))) as path:
        assert ask(path, "rplidar", "xv11") == "XV-11 lidar, packets arrive"


def test_noise_is_no_answer() -> None:
    with line(lambda _: b"\xa5\x5a\x14\x00noise") as path:
        assert ask(path, "rplidar") == ""
    assert parse_answers("{") == {}


def test_device_that_is_unplugged_while_it_is_asked_ends_the_question() -> None:
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    path = os.ttyname(theirs)

    def unplug() -> None:
        os.read(ours, 1)
        os.close(theirs)
        os.close(ours)

    worker = threading.Thread(target=unplug)
    worker.start()
    assert ask(path, "rplidar") == "cannot be asked: it was unplugged"
    worker.join()


def test_device_in_use_is_not_asked() -> None:
    lidar = Device("/dev/ttyUSB0", "serial", "10c4:ea60")
    used = Device("/dev/ttyUSB1", "serial", "10c4:ea60", holders=(DeviceHolder(1, "rplidarNode"),))
    assert list_questions(DeviceSnapshot(devices=(lidar, used))) == [("/dev/ttyUSB0", "rplidar", 115200)]


def test_output_that_is_no_table_of_answers_answers_nothing() -> None:
    for output in ("", "no JSON", "[1]", "3"):
        assert parse_answers(output) == {}
